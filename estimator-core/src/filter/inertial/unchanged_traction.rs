//! A traction that stays the same to the last digit: it may be stuck.
//!
//! A driver who coasts, or drives with all there is, keeps the torque as well. Those are told apart
//! by the torque itself: zero or less, or the largest on this drive.

use crate::sample::ForceInputs;
use crate::scalar::Scalar;
use crate::vehicle::VehicleParameters;

/// Relative difference of two tractions that are the same: that of rounding.
const SAME: f32 = 3e-4;
/// Part of the largest torque that is all there is.
const ALL: f32 = 0.93;
/// Shortest time that counts as usual, s.
const LEAST_USUAL_S: f32 = 0.5;

/// For how long the traction is unchanged, and for how long that is usual.
#[derive(Clone, Copy, Debug)]
pub(super) struct UnchangedTraction {
    last_n: f32,
    /// Time since it changed, s.
    unchanged_s: f32,
    /// Longest such time on this drive in which nothing was wrong, s.
    usual_s: f32,
    /// Square of the torque as a force at the wheels in a gear of ratio one, and its largest, N².
    squared_torque: f32,
    largest: f32,
}

impl UnchangedTraction {
    pub(super) const fn new() -> Self {
        Self {
            last_n: f32::NAN,
            unchanged_s: 0.0,
            usual_s: LEAST_USUAL_S,
            squared_torque: 0.0,
            largest: 0.0,
        }
    }

    /// Notes the forces of a cell. `agrees` is whether nothing is wrong with them.
    pub(super) fn note(
        &mut self,
        forces: &ForceInputs,
        vehicle: &VehicleParameters,
        duration_s: f32,
        agrees: bool,
    ) {
        let traction_n = forces.traction_n;
        if (traction_n - self.last_n).abs() <= SAME * traction_n.abs() {
            self.unchanged_s += duration_s;
            return;
        }
        if agrees {
            self.take_for_usual();
        }
        self.last_n = traction_n;
        self.unchanged_s = 0.0;
        self.squared_torque = squared_torque(forces, vehicle);
        if agrees {
            self.largest = Scalar::max(self.largest, self.squared_torque);
        }
    }

    /// Takes the time since it changed for usual.
    pub(super) fn take_for_usual(&mut self) {
        if self.is_partial() {
            self.usual_s = Scalar::max(self.usual_s, self.unchanged_s);
        }
    }

    /// Returns the time for which it is unchanged beyond twice the usual one, s.
    pub(super) fn unusual_s(&self) -> f32 {
        if self.is_partial() {
            Scalar::max(0.0, self.unchanged_s - 2.0 * self.usual_s)
        } else {
            0.0
        }
    }

    /// Returns whether the engine drives, and not with all there is.
    fn is_partial(&self) -> bool {
        self.last_n > 0.0 && self.squared_torque < ALL * ALL * self.largest
    }
}

/// Returns the square of what is proportional to the engine torque in any gear: the mass that the
/// engine adds grows with the square of the ratio, the traction with the ratio.
fn squared_torque(forces: &ForceInputs, vehicle: &VehicleParameters) -> f32 {
    let radius_m = vehicle.wheel_radius_m;
    let wheels_kg = vehicle.wheel_inertia_kgm2 / (radius_m * radius_m);
    let engine_kg = forces.rotating_kg - wheels_kg;
    let squared = forces.traction_n * forces.traction_n;
    if engine_kg > 0.01 * wheels_kg {
        squared / engine_kg
    } else {
        squared
    }
}
