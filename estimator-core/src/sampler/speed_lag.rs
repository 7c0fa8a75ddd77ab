//! How late the speed over ground is, to a few milliseconds.
//!
//! A receiver that is later than assumed by δ reports a speed that differs from that of the wheels
//! by −δ times the acceleration. Linear regression of the difference on the acceleration gives δ with
//! its sigma. Driven wheels slip in proportion to the force, and a force accelerates: so the force is
//! the second regressor, and slip is not taken for delay.
//!
//! Wheel speeds become means over slots of equal length, speeds over ground means over what arrives
//! in a slot. A slot is judged once the wheel speeds after it are known.

use super::accepted_ranges::SPEEDS_MPS;
use super::lag_regression::{Pair, Sums};
use super::latest::TimedValue;
use super::traction_lag::{SLOTS, Slot, TractionLag};
use crate::scalar::Scalar;
use crate::shift_in::shift_in;
use crate::time::{Duration, Instant};
use crate::tuning::Detection;

/// Length of a slot.
const SLOT: Duration = Duration::from_micros(250_000);
const SLOT_S: f32 = 0.25;
/// Slots on either side of a time over which its acceleration is taken: a second.
const SIDE: usize = 4;
/// Longest time between two wheel speeds that is bridged.
const LONGEST: Duration = Duration::from_micros(1_250_000);
/// Longest delay that fits the kept slots, s.
const LONGEST_LAG_S: f32 = 1.5;
/// Unit of the force, N, so that all sums are of similar size.
const FORCE_UNIT_N: f32 = 1e4;
/// Slots between two decisions: 10 s.
const DECIDE_EVERY: u8 = 40;
/// Delay from that of the comparison, s, at which the comparison moves to it.
const FAR_S: f32 = 0.05;

/// Mean of the speeds over ground that arrived in a slot.
#[derive(Clone, Copy, Debug, Default)]
struct GroundMean {
    count: u8,
    /// Sum of the speeds, m/s, and of their times before the end of the slot, s.
    sum_mps: f32,
    before_end_s: f32,
}

/// The comparison of both speeds.
#[derive(Clone, Debug)]
pub(super) struct SpeedLag {
    last: Option<TimedValue>,
    /// End of the open slot, and the way in it so far, m.
    slot_end: Instant,
    way_m: f32,
    force: f32,
    /// The newest first.
    slots: [Slot; SLOTS],
    filled: u8,
    /// Speeds over ground: of the slot after the open one, of the open one, and of those before.
    ground: [GroundMean; SIDE + 3],
    sums: Sums,
    /// Delay at which the speeds are compared, s.
    compared_s: Option<f32>,
    until_decision: u8,
    learned_s: Option<f32>,
    traction: TractionLag,
}

impl SpeedLag {
    pub(super) fn new() -> Self {
        Self {
            last: None,
            slot_end: Instant::ZERO,
            way_m: 0.0,
            force: 0.0,
            slots: [Slot {
                wheels_mps: 0.0,
                force: 0.0,
            }; SLOTS],
            filled: 0,
            ground: [GroundMean {
                count: 0,
                sum_mps: 0.0,
                before_end_s: 0.0,
            }; SIDE + 3],
            sums: Sums::NONE,
            compared_s: None,
            until_decision: DECIDE_EVERY,
            learned_s: None,
            traction: TractionLag::new(),
        }
    }

    /// Takes a change of the receiver. What wheels and force show stays.
    pub(super) fn switch_receiver(&mut self) {
        self.ground = [GroundMean::default(); SIDE + 3];
        self.sums = Sums::NONE;
        self.compared_s = None;
        self.until_decision = DECIDE_EVERY;
        self.learned_s = None;
    }

    /// Returns the delay, if it is surely another one than assumed.
    #[inline(never)] // Several places ask.
    pub(super) fn learned(&self) -> Option<Duration> {
        self.learned_s.map(Duration::from_seconds)
    }

    /// Returns by how much the force is later than the wheel speed, s; zero unless that is certain.
    pub(super) const fn traction_late_s(&self) -> f32 {
        self.traction.late_s()
    }

    /// Takes the mean force since the last wheel speed, N.
    pub(super) const fn force(&mut self, force_n: f32) {
        self.force = force_n / FORCE_UNIT_N;
    }

    /// Takes a wheel speed.
    pub(super) fn wheels(&mut self, speed: TimedValue, assumed: Duration, tuning: &Detection) {
        let Some(last) = self.last.replace(speed) else {
            self.slot_end = speed.time + SLOT;
            return;
        };
        let duration = speed.time.since(last.time);
        if duration > LONGEST {
            self.interrupt(speed.time);
            return;
        }
        if duration == Duration::default() {
            return;
        }
        let slope = (speed.value - last.value) / duration.seconds();
        let mut from = last;
        // At most five slots and a part: LONGEST.
        while from.time < speed.time {
            let to = self.slot_end.min(speed.time);
            let seconds = to.seconds_since(from.time);
            let value = from.value + slope * seconds;
            self.way_m += 0.5 * (from.value + value) * seconds;
            from = TimedValue { value, time: to };
            if to == self.slot_end {
                self.close(assumed, tuning);
            }
        }
    }

    /// Takes a speed over ground.
    pub(super) fn ground(&mut self, now: Instant, speed_mps: f32, tuning: &Detection) {
        let is_possible = SPEEDS_MPS.contains(&speed_mps);
        if self.last.is_none() || !is_possible || speed_mps < tuning.turn_mps {
            return;
        }
        let is_next = now > self.slot_end;
        let end = if is_next {
            self.slot_end + SLOT
        } else {
            self.slot_end
        };
        if now > end {
            return;
        }
        let [next, open, ..] = &mut self.ground;
        let mean = if is_next { next } else { open };
        mean.count = mean.count.saturating_add(1);
        mean.sum_mps += speed_mps;
        mean.before_end_s += end.seconds_since(now);
    }

    /// Notes that the wheel speeds after here do not follow from those before.
    fn interrupt(&mut self, now: Instant) {
        self.slot_end = now + SLOT;
        self.way_m = 0.0;
        self.filled = 0;
        self.ground = [GroundMean::default(); SIDE + 3];
    }

    fn close(&mut self, assumed: Duration, tuning: &Detection) {
        let slot = Slot {
            wheels_mps: self.way_m / SLOT_S,
            force: self.force,
        };
        shift_in(&mut self.slots, slot);
        self.way_m = 0.0;
        self.slot_end = self.slot_end + SLOT;
        self.filled = self.filled.saturating_add(1).min(SLOTS as u8);
        shift_in(&mut self.ground, GroundMean::default());
        if usize::from(self.filled) < SLOTS {
            return;
        }
        let forget = 1.0 / f32::from(tuning.traction_lag_slots);
        self.traction.slot(&self.slots, tuning.crawl_mps, forget);
        let compared_s = *self
            .compared_s
            .get_or_insert(Scalar::min(assumed.seconds(), LONGEST_LAG_S));
        if let Some(pair) = self.pair(compared_s, tuning.standing_mps) {
            self.sums.add(&pair, 1.0 / f32::from(tuning.lag_slots));
            self.decide(compared_s, assumed, tuning);
        }
    }

    /// Returns difference, acceleration and force for the slot that is [`SIDE`] slots old.
    fn pair(&self, compared_s: f32, standing_mps: f32) -> Option<Pair> {
        let ground = self.ground.last().filter(|mean| mean.count > 0)?;
        let count = f32::from(ground.count);
        // Time before the end of the newest slot at which the speed was measured.
        let before_s = SIDE as f32 * SLOT_S + ground.before_end_s / count + compared_s;
        let centre = (before_s / SLOT_S + 0.5) as usize;
        let around = self.slots.get(centre.checked_sub(SIDE)?..centre + SIDE)?;
        // Something carries the vehicle: a ferry, or a train.
        if around.iter().all(|slot| slot.wheels_mps < standing_mps) {
            return None;
        }
        let (newer, older) = around.split_at_checked(SIDE)?;
        let mean = |slots: &[Slot]| {
            let sum: f32 = slots.iter().map(|slot| slot.wheels_mps).sum();
            sum / SIDE as f32
        };
        let acceleration = (mean(newer) - mean(older)) / (SIDE as f32 * SLOT_S);
        let (newer, older) = (newer.last()?, older.first()?);
        let centre_mps = 0.5 * (newer.wheels_mps + older.wheels_mps);
        let after_centre_s = centre as f32 * SLOT_S - before_s;
        let wheels_mps = centre_mps + acceleration * after_centre_s;
        Some(Pair {
            apart_mps: ground.sum_mps / count - wheels_mps,
            acceleration,
            force: 0.5 * (newer.force + older.force),
        })
    }

    /// Decides on the delay, now and then.
    fn decide(&mut self, compared_s: f32, assumed: Duration, tuning: &Detection) {
        self.until_decision = self.until_decision.saturating_sub(1);
        if self.until_decision > 0 {
            return;
        }
        self.until_decision = DECIDE_EVERY;
        let Some(found) = self.sums.lag() else { return };
        let lag_s = (compared_s + found.lag_s).clamp(0.0, LONGEST_LAG_S);
        if (lag_s - compared_s).abs() > FAR_S {
            self.sums.shift(lag_s - compared_s);
            self.compared_s = Some(lag_s);
        }
        let sigma_s = Scalar::sqrt(found.variance_s2);
        if sigma_s > tuning.lag_sigma_s {
            return;
        }
        let assumed_s = assumed.seconds();
        let apart_s = (lag_s - assumed_s).abs();
        match self.learned_s {
            None if apart_s > tuning.lag_apart_s + 2.0 * sigma_s => self.learned_s = Some(lag_s),
            None => {}
            Some(_) if apart_s < 0.5 * tuning.lag_apart_s => self.learned_s = None,
            // Smaller changes are noise, and each one moves the last fixes.
            Some(learned_s) if (lag_s - learned_s).abs() > 0.5 * sigma_s => {
                self.learned_s = Some(lag_s);
            }
            Some(_) => {}
        }
    }
}
