//! Units of brake pressure, and the sign of the retarder torque.

use super::warning::Warning;
use estimator_core::Instant;

/// Pressure below which brakes do nothing, Pa.
const USELESS_PA: f64 = 2_000.0;
/// Smallest pressure that is more than an offset in any unit.
const LEAST: f64 = 0.2;
/// Retarder torque beyond an offset, %.
const RETARDING_PERCENT: f64 = 1.5;
/// Times that a brake must be used until it is judged.
const LEAST_USED: u32 = 20;
/// Deceleration that shows a brake, m/s².
const BRAKING_MPS2: f64 = 0.3;
/// Longest time between two speeds that give an acceleration, s.
const LONGEST_S: f64 = 2.5;
/// Least time between two speeds that give an acceleration, s.
const SHORTEST_S: f64 = 0.5;

/// Mean of some numbers.
#[derive(Clone, Copy, Debug, Default)]
struct Mean {
    sum: f64,
    count: u32,
}

impl Mean {
    fn add(&mut self, number: f64) {
        self.sum += number;
        self.count = self.count.saturating_add(1);
    }

    fn value(&self) -> Option<f64> {
        (self.count >= LEAST_USED).then(|| self.sum / f64::from(self.count))
    }
}

/// Collects brake pressures, retarder torques and what the vehicle does meanwhile.
#[derive(Clone, Debug, Default)]
pub(super) struct Brakes {
    since: Option<(Instant, f64)>,
    mps2: Option<f64>,
    largest_pa: f64,
    pressed_mps2: Mean,
    released_mps2: Mean,
    drives: u32,
    brakes: u32,
}

impl Brakes {
    /// Takes a speed of the wheels, m/s.
    pub(super) fn speed(&mut self, now: Instant, mps: f64) {
        let (time, from_mps) = *self.since.get_or_insert((now, mps));
        let seconds = now.since(time).as_secs_f64();
        if seconds < SHORTEST_S {
            return;
        }
        let is_moving = mps > 1.0 && seconds <= LONGEST_S;
        self.mps2 = is_moving.then(|| (mps - from_mps) / seconds);
        self.since = Some((now, mps));
    }

    /// Takes a brake pressure, Pa.
    pub(super) fn pressure(&mut self, pa: f64) {
        self.largest_pa = self.largest_pa.max(pa);
        let Some(mps2) = self.mps2.filter(|_| self.largest_pa > LEAST) else {
            return;
        };
        if pa > 0.25 * self.largest_pa {
            self.pressed_mps2.add(mps2);
        } else {
            self.released_mps2.add(mps2);
        }
    }

    /// Takes a retarder torque, %.
    pub(super) const fn retarder(&mut self, percent: f64) {
        if percent > RETARDING_PERCENT {
            self.drives = self.drives.saturating_add(1);
        } else if percent < -RETARDING_PERCENT {
            self.brakes = self.brakes.saturating_add(1);
        }
    }

    /// Returns what is not plausible.
    pub(super) fn judge(&self, found: &mut Vec<Warning>) {
        let means = self.pressed_mps2.value().zip(self.released_mps2.value());
        // The pressure brakes the vehicle, and is far too small to do so.
        let brakes = means.is_some_and(|(pressed, released)| {
            pressed < -BRAKING_MPS2 && pressed < released - BRAKING_MPS2
        });
        if self.largest_pa < USELESS_PA && brakes {
            found.push(Warning::major(
                "brake_pressure_unit",
                "the brake pressure is not in Pa",
                format!(
                    "the vehicle brakes with a pressure of at most {:.1} Pa: it looks like bar, psi or \
                     kPa",
                    self.largest_pa
                ),
                "give the brake pressure in Pa (column brake_pressure_pa): multiply bar by 100000",
            ));
        }
        if self.drives >= LEAST_USED && self.drives > self.brakes {
            found.push(Warning::major(
                "retarder_sign",
                "the retarder torque has the wrong sign",
                "the retarder torque is above zero, so that the retarder would drive the vehicle"
                    .to_owned(),
                "give the retarder torque below zero where it brakes (SPN 520; column \
                 retarder_torque_percent)",
            ));
        }
    }
}
