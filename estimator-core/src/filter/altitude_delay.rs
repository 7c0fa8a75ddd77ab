//! Delay of GNSS altitudes: receivers that smooth them are late by many seconds.
//!
//! A receiver that smooths altitudes is a low-pass of first order: `τ ẏ + y = h`. What it reports
//! climbs as the forces do behind the same low-pass. A bank of time constants shows which one fits.
//! Noise of the forces also fits better behind a low-pass, though nothing is late. Behind an
//! all-pass it does not: whether the altitude is late is decided there, and by how much in the bank.

use super::low_pass_bank::{LowPassBank, low_pass_gain};
use crate::tuning::MeasurementNoise;

/// Least time between two altitudes that are restored, and that are compared, s: a little less than
/// one and two seconds.
const RESTORED_APART_S: f32 = 0.9;
const COMPARED_APART_S: f32 = 1.9;
/// Largest one, s: beyond, the vehicle stood, or nearly, or altitudes are missing.
const FAR_APART_S: f32 = 4.0;
/// Largest difference of vertical speeds, m/s, whatever the delay: beyond, one of them is an outlier.
const FASTEST_MPS: f32 = 1.0;
/// Faster changes do not count, s: they are noise of altitudes.
const FAST_S: f32 = 4.0;
/// Slower changes do not count, s: they are errors of the forces.
const SLOW_S: f32 = 60.0;
/// Readings before the first decision, and from one to the next.
const FEWEST_READINGS: f32 = 45.0;
const DECISION_READINGS: u8 = 4;
/// Evidence that altitudes are late. Readings next to each other are alike, and some five count as one.
const LATE: f32 = 60.0;
/// Evidence that suffices where low-passes explain so much, evidence a reading.
const LATE_AND_EXPLAINED: (f32, f32) = (30.0, 0.9);
/// Evidence a reading below which altitudes are no longer late.
const NO_LONGER_LATE: f32 = 0.05;
/// Evidence for another time constant, the ratio to the old one from which on it is another, and its
/// sigma at most, as a part of it.
const ANOTHER: (f32, f32, f32) = (15.0, 1.25, 0.9);

/// An altitude as it was received, and what came since.
#[derive(Clone, Copy, Debug)]
struct Since {
    altitude_m: f32,
    /// Climb by the forces, m.
    climb_m: f32,
    duration_s: f32,
    /// Altitudes that were received.
    altitudes: u8,
}

/// An altitude as it was received, and where within its cell it was taken.
#[derive(Clone, Copy, Debug)]
pub(super) struct CellAltitude {
    pub altitude_m: f32,
    /// Climb by the forces from the cell's start, m. Below zero where it was taken before.
    pub climb_m: f32,
    /// Time from the cell's start, s.
    pub duration_s: f32,
}

/// A vertical speed by altitudes, and by forces, m/s.
#[derive(Clone, Copy, Debug)]
struct VerticalSpeeds {
    altitudes_mps: f32,
    forces_mps: f32,
}

/// What was smoothed away is put back.
#[derive(Clone, Copy, Debug)]
pub(super) struct Restored {
    pub altitude_m: f32,
    /// Variance of what the time constant may be off, m².
    pub variance: f32,
}

/// What is to be compared: the speed by forces, that by altitudes, and the time since the last ones.
#[derive(Clone, Copy, Debug)]
struct Reading {
    signal_mps: f32,
    follower_mps: f32,
    duration_s: f32,
}

/// The comparison of both climbs.
#[derive(Clone, Debug)]
pub(super) struct AltitudeDelay {
    /// The last altitude that was restored.
    restored: Option<Since>,
    /// The last altitude that was compared.
    compared: Option<Since>,
    /// The speeds behind a low-pass of `FAST_S`, and of `SLOW_S` besides.
    smooth: Option<(VerticalSpeeds, VerticalSpeeds)>,
    bank: LowPassBank,
    /// The newest reading, which the bank has not seen.
    reading: Option<Reading>,
    readings_to_decision: u8,
    /// Time constant of the receiver, s, and its sigma.
    delay_s: f32,
    sigma_s: f32,
    /// The time constant when altitudes were last set anew, s, and its output of the bank.
    set_s: f32,
    set_output: u8,
    has_changed: bool,
}

impl AltitudeDelay {
    pub(super) fn new() -> Self {
        Self {
            restored: None,
            compared: None,
            smooth: None,
            bank: LowPassBank::new(),
            reading: None,
            readings_to_decision: DECISION_READINGS,
            delay_s: 0.0,
            sigma_s: 0.0,
            set_s: 0.0,
            set_output: 0,
            has_changed: false,
        }
    }

    /// Returns the comparison before its start, with the delay found so far.
    pub(super) fn restarted(&self, tuning: &MeasurementNoise) -> Self {
        let mut done = self.clone();
        done.work(tuning);
        Self {
            set_s: done.delay_s,
            bank: done.bank,
            delay_s: done.delay_s,
            sigma_s: done.sigma_s,
            set_output: done.set_output,
            ..Self::new()
        }
    }

    /// Notes that altitudes after here do not follow from those before.
    pub(super) fn interrupt(&mut self) {
        self.restored = None;
        self.compared = None;
        self.smooth = None;
    }

    /// Returns whether the delay changed, and altitudes were not set anew since.
    pub(super) const fn has_changed(&self) -> bool {
        self.has_changed
    }

    /// Returns whether the delay changed since the last call.
    pub(super) fn take_change(&mut self) -> bool {
        core::mem::take(&mut self.has_changed)
    }

    /// Advances over a cell.
    pub(super) fn advance(&mut self, climb_m: f32, duration_s: f32) {
        for since in [&mut self.restored, &mut self.compared]
            .into_iter()
            .flatten()
        {
            since.climb_m += climb_m;
            since.duration_s += duration_s;
        }
    }

    /// Does what the altitude of the last cell left to do: the bank takes the reading, and a decision
    /// may be due. A cell with an altitude has enough to do, so it is done one cell later.
    #[inline]
    pub(super) fn work(&mut self, tuning: &MeasurementNoise) {
        if let Some(reading) = self.reading.take() {
            self.compare(&reading, tuning);
        }
    }

    #[inline(never)] // Not in every cell.
    fn compare(&mut self, reading: &Reading, tuning: &MeasurementNoise) {
        let Reading {
            signal_mps,
            follower_mps,
            duration_s,
        } = *reading;
        self.bank.advance(signal_mps, duration_s);
        if duration_s <= FAR_APART_S {
            self.bank.compare(follower_mps, tuning.delay_readings);
            self.readings_to_decision = self.readings_to_decision.saturating_sub(1);
        }
        if self.readings_to_decision == 0 {
            self.readings_to_decision = DECISION_READINGS;
            self.decide(tuning);
        }
    }

    /// Returns the altitude that the receiver smoothed to a reported one; `None` as long as that is
    /// not known.
    ///
    /// A receiver takes a step of its low-pass with each altitude: `yₖ + τ (yₖ − yₖ₋₁) / Δt` is what
    /// it took. With several of them between two that are compared, that is right in the middle
    /// of all but the last step. From there on the forces climb.
    pub(super) fn restored(&mut self, at: &CellAltitude) -> Option<Restored> {
        let altitude_m = at.altitude_m;
        if self.delay_s == 0.0 {
            return Some(Restored {
                altitude_m,
                variance: 0.0,
            });
        }
        let since = replace(&mut self.restored, at, RESTORED_APART_S)?;
        let rise_m = altitude_m - since.altitude_m;
        let smoothed_away_m = self.delay_s * rise_m / since.duration_s;
        let after_middle = 0.5 - 0.5 / f32::from(since.altitudes);
        // An error that lasts as long as the low-pass counts as that of so many altitudes.
        let altitudes = self.delay_s / since.duration_s;
        let variance = self.sigma_s * self.sigma_s * self.bank.follower_variance();
        (since.duration_s <= FAR_APART_S).then_some(Restored {
            altitude_m: altitude_m + smoothed_away_m + after_middle * (since.climb_m - rise_m),
            variance: altitudes * variance,
        })
    }

    /// Takes an altitude as it was received.
    pub(super) fn fix(&mut self, at: &CellAltitude) {
        let Some(since) = replace(&mut self.compared, at, COMPARED_APART_S) else {
            return;
        };
        let now = VerticalSpeeds {
            altitudes_mps: (at.altitude_m - since.altitude_m) / since.duration_s,
            forces_mps: since.climb_m / since.duration_s,
        };
        let Some((fast, slow)) = &mut self.smooth else {
            if (now.altitudes_mps - now.forces_mps).abs() <= FASTEST_MPS {
                self.smooth = Some((now, now));
                self.bank.settle();
            }
            return;
        };
        let of_altitudes = now.altitudes_mps - slow.forces_mps;
        let of_forces = now.forces_mps - slow.forces_mps;
        let apart_mps = if self.set_s > 0.0 {
            (of_altitudes - self.bank.output(self.set_output)).abs()
        } else {
            self.bank.beyond(of_altitudes, of_forces)
        };
        if apart_mps > FASTEST_MPS {
            self.smooth = None;
            return;
        }
        fast.follow(now, low_pass_gain(FAST_S, since.duration_s));
        slow.follow(*fast, low_pass_gain(SLOW_S, since.duration_s));
        self.reading = Some(Reading {
            signal_mps: fast.forces_mps - slow.forces_mps,
            follower_mps: fast.altitudes_mps - slow.altitudes_mps,
            duration_s: since.duration_s,
        });
    }

    #[inline(never)] // Rare.
    fn decide(&mut self, tuning: &MeasurementNoise) {
        let memory = tuning.delay_readings;
        let readings = self.bank.readings(memory);
        if readings < FEWEST_READINGS {
            return;
        }
        let late = self.bank.evidence_of_delay(memory);
        let best = self.bank.best(self.set_output, memory);
        let was_late = self.delay_s > 0.0;
        let is_late = if was_late {
            late > NO_LONGER_LATE * readings
        } else {
            let (suffices, explained) = LATE_AND_EXPLAINED;
            (late > LATE && late > self.bank.evidence(1.0, tuning.delay_part, memory))
                || (late > suffices && best.evidence > explained * readings)
        };
        if !is_late {
            self.has_changed |= was_late;
            self.delay_s = 0.0;
            self.set_s = 0.0;
            self.set_output = 0;
            return;
        }
        // A little more or less is no change: what was learned of the forces stays.
        let (evidence, ratio, largest_sigma) = ANOTHER;
        let is_another =
            best.time_constant_s > ratio * self.set_s || self.set_s > ratio * best.time_constant_s;
        let is_known = best.sigma_s < largest_sigma * best.time_constant_s;
        if is_another && is_known && best.evidence > evidence {
            self.set_s = best.time_constant_s;
            self.set_output = best.output;
            self.has_changed = true;
            self.bank.forget(FEWEST_READINGS as u16);
        }
        if self.set_s > 0.0 {
            self.delay_s = best.time_constant_s;
            self.sigma_s = best.sigma_s;
        }
    }
}

impl VerticalSpeeds {
    fn follow(&mut self, other: Self, gain: f32) {
        self.altitudes_mps += gain * (other.altitudes_mps - self.altitudes_mps);
        self.forces_mps += gain * (other.forces_mps - self.forces_mps);
    }
}

/// Puts an altitude in the place of one that is long enough ago. Returns the old one, and what came
/// from it to the new one.
fn replace(last: &mut Option<Since>, at: &CellAltitude, apart_s: f32) -> Option<Since> {
    if let Some(since) = last {
        since.altitudes = since.altitudes.saturating_add(1);
        if since.duration_s + at.duration_s < apart_s {
            return None;
        }
    }
    let since = last.replace(Since {
        altitude_m: at.altitude_m,
        climb_m: -at.climb_m,
        duration_s: -at.duration_s,
        altitudes: 0,
    })?;
    Some(Since {
        climb_m: since.climb_m + at.climb_m,
        duration_s: since.duration_s + at.duration_s,
        ..since
    })
}
