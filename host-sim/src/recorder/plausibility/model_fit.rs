//! What the estimate itself says: cells in which the model does not hold, and the scale at the end.

use super::warning::Warning;
use crate::files::run::RunRow;
use estimator_core::Condition;

/// Least number of cells from which anything is concluded: 1 km.
const CELLS: u32 = 400;
/// Part of the cells that is as good as all of them.
const ALL: f64 = 0.95;
/// Difference of the scale from 1 that torque and mass of a right vehicle file do not have.
const LARGEST_OFF: f64 = 0.15;
/// Largest relative sigma of a mass that counts.
const KNOWN: f64 = 0.1;
/// Kilograms over pounds.
const POUNDS: f64 = 0.453_592;

/// Collects samples and rows.
#[derive(Clone, Debug, Default)]
pub(super) struct ModelFit {
    cells: u32,
    shifting: u32,
    braking: u32,
    no_traction: u32,
    mass_was_reported: bool,
    last: Option<LastRow>,
}

#[derive(Clone, Copy, Debug)]
struct LastRow {
    distance_m: f64,
    scale: f64,
    mass_kg: f64,
    mass_sigma_kg: f64,
}

impl ModelFit {
    /// Takes the condition of a cell, and whether a mass was reported.
    pub(super) fn cell(&mut self, condition: Condition, mass_is_reported: bool) {
        self.cells = self.cells.saturating_add(1);
        self.shifting += u32::from(condition.shifting);
        self.braking += u32::from(condition.braking);
        self.no_traction += u32::from(condition.no_traction);
        self.mass_was_reported = mass_is_reported;
    }

    /// Takes a row of the run, in any order.
    pub(super) fn row(&mut self, row: &RunRow) {
        let is_last = |last: LastRow| row.distance_m >= last.distance_m;
        if let (true, Some(mass_kg), Some(mass_sigma_kg)) = (
            self.last.is_none_or(is_last),
            row.mass_kg,
            row.mass_sigma_kg,
        ) {
            self.last = Some(LastRow {
                distance_m: row.distance_m,
                scale: row.scale,
                mass_kg,
                mass_sigma_kg,
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

    /// Returns a scale that is too far from 1.
    pub(super) fn scale(&self) -> Option<Warning> {
        let last = self.last?;
        let sigma = last.mass_sigma_kg / last.mass_kg;
        let is_off = (last.scale - 1.0).abs() > LARGEST_OFF + sigma * last.scale;
        if !is_off || sigma > KNOWN || self.cells < CELLS {
            return None;
        }
        let scale = last.scale;
        let origin = if self.mass_was_reported {
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
                 {origin}{looks} and the torque say: the gross mass would be {:.0} kg",
                last.mass_kg
            ),
            "check mass_kg, reference_torque_nm, the gear ratios, final_drive_ratio and \
             wheel_radius_m, and the unit of the altitude",
        ))
    }
}
