//! How late receiver and force are beside the wheel speed.
//!
//! Receiver and wheels measure the same accelerations: the speed over ground less that of the wheels
//! as long ago as the receiver is late varies least. Driven wheels slip in proportion to the force,
//! and a force accelerates: so the force is the regressor, and slip is not taken for delay.
//!
//! A change of the force shows in the acceleration at once, and roads bend more slowly than drivers
//! and gearboxes act. So changes of the acceleration are explained by those of the force, and best at
//! the lag between the two messages.
//!
//! Both are compared once a second. Each slot that ends does a share of it, so that none takes long.

use super::accepted_ranges::SPEEDS_MPS;
use super::lag_likelihood::{LagLikelihood, Row, Sums, bounded};
use super::latest::TimedValue;
use super::speed_scale::SpeedScale;
use super::speed_slots::{SLOT, SLOT_S, SLOTS, SpeedSlots};
use crate::delay::{Delay, Delays};
use crate::scalar::Scalar;
use crate::time::{Duration, Instant};
use crate::tuning::Detection;

/// Time between two comparisons, and slots in it.
const SECOND: Duration = Duration::from_micros(1_000_000);
const PER_SECOND: usize = 4;
/// Lags of the receiver: -0.25 to 5.5 s. Wheel speeds are late as well, by some 30 ms.
const RECEIVER_LAGS: usize = SHARES * AT_ONCE;
const FIRST_LAG: f32 = -1.0;
const RECEIVER: Row = Row {
    first_s: FIRST_LAG * SLOT_S,
    tolerance_s: 0.04,
    is_of_changes: false,
};
/// Slots that do a share of them, and size of a share.
const SHARES: usize = 3;
const AT_ONCE: usize = 8;
/// Lags of the force: -0.5 to 3.25 s.
const TRACTION_LAGS: usize = 16;
const TRACTION: Row = Row {
    first_s: -2.0 * SLOT_S,
    tolerance_s: LEAST_LATE_S,
    is_of_changes: true,
};
/// A force that is less late is not moved: engines answer, and wheels slip.
const LEAST_LATE_S: f32 = 0.4;
/// Age of the acceleration that the force is compared with, in slots: the last lag has two slots more.
const CENTRE: usize = TRACTION_LAGS + 1;
/// Slots in which the force has to be passed: those of the two seconds that a change compares.
const WINDOW: usize = 2 * PER_SECOND + 1;
/// Largest changes that count, so that no single launch decides: acceleration, m/s², and force, in
/// units of 10 kN.
const MOST: (f32, f32) = (0.5, 1.0);
/// Unit of the force, N, so that all sums are of similar size.
const FORCE_UNIT_N: f32 = 1e4;
/// Seconds between two decisions on a delay. A second with one has no time to compare the force.
const DECIDE_EVERY: u8 = 20;
const DECIDE_TRACTION: u8 = 10;

/// Mean of the speeds over ground that arrived in a second.
#[derive(Clone, Copy, Debug, Default)]
struct Ground {
    count: u8,
    mps: f32,
    /// Time before the end of the second, in slots.
    before_end: f32,
}

impl Ground {
    fn add(&mut self, mps: f32, before_end: f32) {
        self.count = self.count.saturating_add(1);
        let gain = 1.0 / f32::from(self.count);
        self.mps += gain * (mps - self.mps);
        self.before_end += gain * (before_end - self.before_end);
    }
}

/// The comparisons.
#[derive(Clone, Debug)]
pub(super) struct DelayEstimator {
    slots: SpeedSlots,
    /// The slot of the second that ended last.
    phase: u8,
    /// End of the open second, and what arrives in it and in the next one.
    second_end: Instant,
    open: Ground,
    next: Ground,
    /// What is compared.
    ground: Option<Ground>,
    scale: SpeedScale,
    until_decision: u8,
    receiver: LagLikelihood<[Sums; RECEIVER_LAGS]>,
    traction: LagLikelihood<[Sums; TRACTION_LAGS]>,
}

impl DelayEstimator {
    #[inline(always)] // See Estimator::new_in().
    pub(super) fn new() -> Self {
        Self {
            slots: SpeedSlots::new(),
            phase: 0,
            second_end: Instant::ZERO,
            open: Ground::default(),
            next: Ground::default(),
            ground: None,
            scale: SpeedScale::NONE,
            until_decision: DECIDE_EVERY,
            receiver: LagLikelihood::new(RECEIVER),
            traction: LagLikelihood::new(TRACTION),
        }
    }

    /// Starts with what an earlier drive found.
    pub(super) const fn resume(&mut self, delays: &Delays) {
        self.receiver.delay = delays.receiver;
        self.traction.delay = delays.traction;
    }

    /// Returns what is known.
    pub(super) const fn delays(&self) -> Delays {
        Delays {
            receiver: self.receiver.delay,
            traction: self.traction.delay,
            altitude: Delay::Unestimated,
        }
    }

    /// Returns the latency of the receiver, or the assumed one unless another is known.
    #[inline(never)] // Several places ask.
    pub(super) fn latency(&self, assumed: Duration) -> Duration {
        let learned_s = self.receiver.delay.estimated_s();
        learned_s.map_or(assumed, Duration::from_seconds)
    }

    /// Returns the way since a fix that arrives now was taken, m; `None` unless the latency was learned
    /// and the speeds since then are known.
    pub(super) fn way_m(&self, now: Instant) -> Option<f32> {
        let latency_s = Scalar::max(0.0, self.receiver.delay.estimated_s()?);
        let way_m = self.slots.way_m(now, latency_s)?;
        Some(way_m * self.scale.factor())
    }

    /// Returns true over measured wheel speed; one unless they differ by more than wheels wear.
    pub(super) const fn speed_factor(&self) -> f32 {
        self.scale.factor()
    }

    /// Returns by how much the force is later than the wheel speed, s; zero unless that is certain.
    #[inline(never)] // Called from two places.
    pub(super) fn traction_late_s(&self) -> f32 {
        let late_s = self.traction.delay.estimated_s().unwrap_or_default();
        if late_s > LEAST_LATE_S { late_s } else { 0.0 }
    }

    /// Takes a change of the receiver: another one has another latency.
    pub(super) fn switch_receiver(&mut self) {
        self.forget_ground();
        self.receiver.of_any_length().clear();
    }

    fn forget_ground(&mut self) {
        self.open = Ground::default();
        self.next = Ground::default();
        self.ground = None;
    }

    /// Takes a wheel speed, without the factor, and the mean force since the last one, N. Returns how
    /// much further back a fix of now was taken than it was with the latency before, m.
    pub(super) fn wheels(
        &mut self,
        speed: TimedValue,
        force_n: f32,
        assumed: Duration,
        tuning: &Detection,
    ) -> f32 {
        if self.slots.begin(speed) {
            self.forget_ground();
            self.second_end = speed.time + SECOND;
            self.phase = 0;
            return 0.0;
        }
        let before = self.latency(assumed);
        while self.slots.drive(speed, force_n / FORCE_UNIT_N) {
            self.follow_slot(assumed, tuning);
        }
        let after = self.latency(assumed);
        if after == before {
            return 0.0;
        }
        let way_m = |latency: Duration| {
            let way_m = self.slots.way_m(speed.time, latency.seconds());
            way_m.unwrap_or(latency.seconds() * speed.value)
        };
        self.scale.factor() * (way_m(after) - way_m(before))
    }

    /// Takes a speed over ground.
    pub(super) fn ground(&mut self, now: Instant, speed_mps: f32, tuning: &Detection) {
        let is_possible = SPEEDS_MPS.contains(&speed_mps);
        if !is_possible || speed_mps < tuning.slow_mps {
            return;
        }
        let next_end = self.second_end + SECOND;
        let (mean, end) = if now <= self.second_end {
            (&mut self.open, self.second_end)
        } else if now <= next_end {
            (&mut self.next, next_end)
        } else {
            return;
        };
        mean.add(speed_mps, end.seconds_since(now) / SLOT_S);
    }

    /// Does the share of the slot that ended.
    #[inline(never)] // Four times a second.
    fn follow_slot(&mut self, assumed: Duration, tuning: &Detection) {
        let share = usize::from(self.phase);
        self.phase += 1;
        if share < SHARES {
            self.compare_speeds(share, assumed, tuning);
            return;
        }
        self.phase = 0;
        self.end_second(tuning);
        self.until_decision = self.until_decision.saturating_sub(1);
        match self.until_decision {
            DECIDE_TRACTION => {
                let traction = self.traction.of_any_length();
                traction.decide(0.0, tuning.delay_evidence);
            }
            0 => {
                self.until_decision = DECIDE_EVERY;
                self.decide(assumed, tuning);
            }
            _ => self.compare_force(tuning),
        }
    }

    /// Ends a second: what arrived in it is compared next.
    fn end_second(&mut self, tuning: &Detection) {
        let ended = core::mem::replace(&mut self.open, core::mem::take(&mut self.next));
        self.second_end = self.second_end + SECOND;
        let stands = |age| self.slots.get(age).wheels_mps < tuning.standing_mps;
        // Something carries a vehicle whose wheels stand: a ferry, or a train.
        let is_compared = ended.count > 0 && self.slots.are_filled() && !(0..SLOTS).all(stands);
        self.ground = is_compared.then_some(ended);
    }

    /// Compares the speeds at a share of the lags. The longest come first: the shortest need slots that
    /// end after the second.
    fn compare_speeds(&mut self, share: usize, assumed: Duration, tuning: &Detection) {
        let Some(ground) = self.ground else { return };
        // Slots that ended since, less the half of one.
        let age = ground.before_end + share as f32 + 0.5;
        if share == 0 {
            self.receiver.of_any_length().begin(tuning.delay_memory_s);
        }
        let first = (SHARES - 1 - share) * AT_ONCE;
        for lag in first..first + AT_ONCE {
            let slot = self.slots.between(age + lag as f32 + FIRST_LAG);
            let apart_mps = ground.mps - slot.wheels_mps;
            self.receiver
                .of_any_length()
                .add(lag, apart_mps, slot.slip());
        }
        if share + 1 == SHARES {
            let latency = self.latency(assumed).seconds() / SLOT_S;
            let latency = Scalar::min(latency, RECEIVER_LAGS as f32);
            let slot = self.slots.between(age + latency);
            self.scale.add(ground.mps, slot.wheels_mps);
        }
    }

    /// Compares a change of the acceleration with changes of the force at all lags.
    fn compare_force(&mut self, tuning: &Detection) {
        let slots = &self.slots;
        let speed_mps = |age| slots.get(age).wheels_mps;
        let (newer, older) = (
            speed_mps(CENTRE - PER_SECOND),
            speed_mps(CENTRE + PER_SECOND),
        );
        // A clutch that slips passes a force that nothing reports.
        let slowest_mps = Scalar::min(speed_mps(0), older);
        if !slots.are_filled() || slowest_mps < tuning.slow_mps {
            return;
        }
        let acceleration = bounded(newer - 2.0 * speed_mps(CENTRE) + older, MOST.0);
        let force = |age| slots.get(age).force;
        let traction = self.traction.of_any_length();
        traction.begin(tuning.delay_memory_s);
        // An open clutch passes no force. Other messages say so, and at another time; and the torque that
        // comes back behind it would explain what the clutch did.
        let mut passed = 0;
        for age in (0..CENTRE + PER_SECOND + PER_SECOND / 2 + 1).rev() {
            passed = if force(age) == 0.0 { 0 } else { passed + 1 };
            let newer = age + PER_SECOND / 2;
            if passed >= WINDOW && newer <= CENTRE {
                let change = bounded(force(newer) - force(newer + PER_SECOND), MOST.1);
                traction.add(CENTRE - newer, acceleration, change);
            }
        }
    }

    /// Decides on the latency of the receiver and on the scale of the wheel speed.
    fn decide(&mut self, assumed: Duration, tuning: &Detection) {
        let before = self.latency(assumed);
        self.receiver
            .of_any_length()
            .decide(assumed.seconds(), tuning.delay_evidence);
        // A vehicle that gets faster has another ratio at another lag.
        let after = self.latency(assumed);
        if after.micros().abs_diff(before.micros()) > SLOT.micros() {
            self.scale.restart();
        }
        self.scale.decide(tuning);
    }
}
