//! A drive in the distance domain, the input of the thesis's methods.

use estimator_core::sample::ForceInputs;
use estimator_core::sample::Sample;
use estimator_core::vehicle::GRAVITY;
use estimator_core::{CELL_LENGTH_M, VehicleParameters};

/// Length of a step, m.
pub const STEP_M: f64 = CELL_LENGTH_M as f64;

/// Longest distance between two fixes over which altitude is interpolated, m. The slowest receivers
/// report once a second, every 30 m on a motorway; two or three fixes may be missing. A longer gap
/// counts as a loss of the satellites.
const LONGEST_GNSS_GAP_M: f64 = 100.0;

/// The measurements at one point of a drive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeasuredPoint {
    /// Driven distance, m.
    pub distance_m: f64,
    /// Wheel speed, m/s.
    pub speed_mps: f64,
    /// Force at the wheels, N.
    pub traction_n: f64,
    /// Mass that rotating parts add, kg.
    pub rotating_kg: f64,
    /// Air density, kg/m³.
    pub air_density: f64,
    /// GNSS altitude, linear between fixes, m; `None` without satellites.
    pub altitude_m: Option<f64>,
    /// A gear shift, or its hold time.
    pub shifting: bool,
    /// Braking, or its hold time.
    pub braking: bool,
}

impl MeasuredPoint {
    /// Returns whether the vehicle model is valid here.
    #[must_use]
    pub const fn is_valid(&self) -> bool {
        !(self.shifting || self.braking)
    }
}

/// One drive in the distance domain, with the assumed parameters.
#[derive(Clone, Debug)]
pub struct MeasuredDrive {
    /// Assumed mass, kg.
    pub mass_kg: f64,
    /// Assumed drag area, m².
    pub drag_area_m2: f64,
    /// Assumed rolling resistance coefficient.
    pub rolling_resistance: f64,
    /// The points, one per [`STEP_M`].
    pub points: Vec<MeasuredPoint>,
}

/// Grade and its standard deviation, point by point, %.
#[derive(Clone, Debug, Default)]
pub struct Profile {
    /// Grade, 100 tan of the slope angle.
    pub grade_percent: Vec<f64>,
    /// Standard deviation that the method states.
    pub sigma_percent: Vec<f64>,
}

/// Weight over mass, m/s².
pub const G: f64 = GRAVITY as f64;

/// Returns the grade (%) from the sine of its slope angle.
pub(super) fn percent_of_sine(sine: f64) -> f64 {
    let sine = sine.clamp(-0.7, 0.7);
    100.0 * sine / (1.0 - sine * sine).sqrt()
}

impl MeasuredDrive {
    /// Creates a drive from the samples of one run, which must have no gap. GNSS altitude is
    /// interpolated over the distance between fixes.
    ///
    /// The mass is the mean over the samples: the reported mass, or the parameter where none was
    /// reported.
    #[must_use]
    pub fn new(vehicle: &VehicleParameters, samples: &[Sample]) -> Self {
        let distances: Vec<f64> = samples.iter().map(|s| s.end.distance_m()).collect();
        let fixes: Vec<(f64, f64)> = samples
            .iter()
            .zip(&distances)
            .filter_map(|(sample, distance_m)| {
                let fix = sample.altitude?;
                Some((distance_m - f64::from(fix.behind_m), fix.altitude_m.into()))
            })
            .collect();
        let points = samples
            .iter()
            .zip(&distances)
            .map(|(sample, &distance_m)| {
                let ForceInputs {
                    traction_n,
                    rotating_kg,
                    air_density,
                    ..
                } = sample.forces;
                let condition = sample.end.condition;
                MeasuredPoint {
                    distance_m,
                    speed_mps: sample.end.speed_mps.into(),
                    traction_n: traction_n.into(),
                    rotating_kg: rotating_kg.into(),
                    air_density: air_density.into(),
                    altitude_m: interpolated(&fixes, distance_m),
                    // The thesis always has the torque. A segment without it counts as a shift.
                    shifting: condition.shifting || condition.no_traction,
                    braking: condition.braking,
                }
            })
            .collect();
        let masses = samples
            .iter()
            .map(|sample| f64::from(sample.forces.mass_kg));
        Self {
            mass_kg: masses.sum::<f64>() / samples.len().max(1) as f64,
            drag_area_m2: vehicle.drag_area_m2.into(),
            rolling_resistance: vehicle.rolling_resistance.into(),
            points,
        }
    }
}

/// Splits the samples of a run where cells are missing. Each part is a drive of its own, because
/// the thesis's methods allow no gaps.
pub fn without_gaps(samples: &[Sample]) -> impl Iterator<Item = &[Sample]> {
    samples.chunk_by(|_, next| next.gap_cells == 0)
}

/// Returns the mean over `length_m` about each value of a series with one value per [`STEP_M`].
#[must_use]
pub fn moving_mean(values: &[f64], length_m: f64) -> Vec<f64> {
    let half = (0.5 * length_m / STEP_M).round() as usize;
    let n = values.len();
    let mut sums = Vec::with_capacity(n + 1);
    let mut sum = 0.0;
    sums.push(sum);
    for value in values {
        sum += value;
        sums.push(sum);
    }
    (0..n)
        .map(|k| {
            // Symmetric, so that values at the ends are not shifted.
            let reach = half.min(k).min(n - 1 - k);
            (sums[k + reach + 1] - sums[k - reach]) / (2 * reach + 1) as f64
        })
        .collect()
}

fn interpolated(fixes: &[(f64, f64)], at: f64) -> Option<f64> {
    let after = fixes.partition_point(|(x, _)| *x < at);
    let (x1, z1) = *fixes.get(after)?;
    let (x0, z0) = *fixes.get(after.checked_sub(1)?)?;
    (x1 - x0 <= LONGEST_GNSS_GAP_M).then(|| z0 + (z1 - z0) * (at - x0) / (x1 - x0).max(1e-9))
}
