//! What the estimate itself says: cells in which the model does not hold, and the scale at the end.

use super::warning::Warning;
use crate::smooth::SmoothedCell;
use estimator_core::Sample;

/// Least number of cells from which anything is concluded: 1 km.
const CELLS: u32 = 400;
/// Part of the cells that is as good as all of them.
const ALL: f64 = 0.95;
/// Difference of the scale from 1 that torque and mass of a right vehicle file do not have.
const LARGEST_OFF: f64 = 0.15;
/// Largest relative sigma of a scale that counts.
const KNOWN: f64 = 0.1;
/// Kilograms over pounds.
const POUNDS: f64 = 0.453_592;

/// Collects samples and smoothed cells.
#[derive(Clone, Debug, Default)]
pub(super) struct ModelFit {
    cells: u32,
    shifting: u32,
    braking: u32,
    no_traction: u32,
    /// Mass that the model takes, kg, and whether the bus reported it.
    model_mass_kg: f64,
    mass_is_reported: bool,
    /// By how much the force is later than the speed, s, and cells with it.
    late_s: f32,
    late_cells: u32,
    last: Option<LastCell>,
}

#[derive(Clone, Copy, Debug)]
struct LastCell {
    distance_m: f64,
    scale: f64,
    sigma: f64,
}

impl ModelFit {
    /// Takes a sample of the estimator.
    pub(super) fn sample(&mut self, sample: &Sample) {
        let condition = sample.end.condition;
        self.cells = self.cells.saturating_add(1);
        self.shifting += u32::from(condition.shifting);
        self.braking += u32::from(condition.braking);
        self.no_traction += u32::from(condition.no_traction);
        self.model_mass_kg = f64::from(sample.forces.mass_kg);
        self.mass_is_reported = sample.mass_is_reported;
        if sample.traction_late_s > 0.0 {
            self.late_s = sample.traction_late_s;
            self.late_cells = self.late_cells.saturating_add(1);
        }
    }

    /// Takes a cell of the smoothed run, in any order.
    pub(super) fn smoothed(&mut self, cell: &SmoothedCell) {
        let distance_m = cell.end.distance_m();
        let is_last = |last: LastCell| distance_m >= last.distance_m;
        if self.last.is_none_or(is_last) {
            self.last = Some(LastCell {
                distance_m,
                scale: f64::from(cell.estimate.scale.value),
                sigma: f64::from(cell.estimate.scale.sigma),
            });
        }
    }

    /// Returns why the model never holds, if it never does. `gears` is about the gears.
    pub(super) fn never_valid(&self, gears: impl FnOnce() -> Option<String>) -> Option<Warning> {
        let is_all = |count: u32| f64::from(count) > ALL * f64::from(self.cells);
        if self.cells < CELLS {
            return None;
        }
        if is_all(self.no_traction) {
            let gears = gears()?;
            return Some(Warning::major(
                "no_gear",
                "no gear of the vehicle file ever matches",
                format!("the gear is never known, so no force is: {gears}"),
                "check gears, final_drive_ratio and wheel_radius_m in the vehicle file against the \
                 vehicle, and the units of engine speed and wheel speed",
            ));
        }
        if is_all(self.braking) {
            return Some(Warning::major(
                "always_braking",
                "a brake is always on",
                "a brake is reported in nearly every cell, so the vehicle model never holds"
                    .to_owned(),
                "check the brake signals: switches are 1 where a brake is on, pressures are in Pa, \
                 retarder torques are below zero where they brake",
            ));
        }
        is_all(self.shifting).then(|| {
            Warning::major(
                "always_shifting",
                "a gear shift is always on",
                "a gear shift or an open clutch is reported in nearly every cell, so the vehicle \
                 model never holds"
                    .to_owned(),
                "check the signals of shift and clutch: 1 is a shift in process, an open clutch, or \
                 an engaged driveline",
            )
        })
    }

    /// Returns that the force comes after the speed.
    pub(super) fn late(&self) -> Option<Warning> {
        (self.late_cells >= CELLS).then(|| {
            Warning::minor(
                "torque_late",
                format!(
                    "the torque comes {:.1} s after the speed that it causes; most of what it lacks \
                     is added, and the sigmas have the rest",
                    self.late_s
                ),
                "record each signal with the time of its message: loggers that poll signals in turn, \
                 or resample them, move them against each other",
            )
        })
    }

    /// Returns a scale that is too far from 1.
    pub(super) fn scale(&self) -> Option<Warning> {
        let LastCell { scale, sigma, .. } = self.last?;
        let is_off = (scale - 1.0).abs() > LARGEST_OFF + sigma;
        if !is_off || sigma > KNOWN * scale || self.cells < CELLS {
            return None;
        }
        let origin = if self.mass_is_reported {
            "the reported mass (CVW)"
        } else {
            "mass_kg of the vehicle file"
        };
        let looks = if [POUNDS, 1.0 / POUNDS]
            .iter()
            .any(|factor| (scale / factor).ln().abs() < 0.1)
        {
            ", which may be in pounds,"
        } else {
            ""
        };
        Some(Warning::minor(
            "scale",
            format!(
                "the vehicle moves as if its traction per kilogram were {scale:.2} times what \
                 {origin}{looks} and the torque say: by the forces alone, the gross mass is {:.0} kg",
                self.model_mass_kg / scale
            ),
            "check mass_kg, reference_torque_nm, the gear ratios, final_drive_ratio and \
             wheel_radius_m, and the unit of the altitude",
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use test_kit::sample;

    /// Returns the fit of a drive whose force is so late in so many of its cells.
    fn fit(late_s: f32, late_cells: u32) -> ModelFit {
        let mut fit = ModelFit::default();
        for cell in 0..2_000 {
            let mut sample = sample(cell, 4_000.0, 20.0);
            if cell < late_cells {
                sample.traction_late_s = late_s;
            }
            fit.sample(&sample);
        }
        fit
    }

    #[test]
    fn a_force_that_is_late_over_a_kilometre_is_told() {
        let told = fit(1.96, 400).late().unwrap();
        assert_eq!(told.code, "torque_late");
        assert!(told.message.contains("comes 2.0 s after"), "{told:?}");
        assert_eq!(told.spoils, None);
        assert_eq!(fit(1.96, 399).late(), None);
        assert_eq!(fit(0.0, 400).late(), None);
    }
}
