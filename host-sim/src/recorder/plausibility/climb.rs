//! Altitudes: whether they change at all, and their scale.
//!
//! Work of the traction minus losses minus gain of kinetic energy is the climb times the weight.
//! Torque and mass of a vehicle file may be wrong; kinetic energy is known from the speed alone.
//! A regression of the climb by GNSS on both therefore tells a wrong unit of the altitude from a
//! wrong mass. Its third term is the bias of the model, as a grade.

use super::warning::Warning;
use estimator_core::{Sample, VehicleParameters};
use nalgebra::{Matrix3, Vector3};
use std::collections::VecDeque;

/// Length of a stretch, m.
const STRETCH_M: f64 = 150.0;
/// Number of stretches from which a scale is concluded.
const STRETCHES: u32 = 20;
/// Way over which altitudes are remembered, cells: fixes are late.
const REMEMBERED: usize = 100;
/// Least way in which an altitude of a receiver changes, m, even on a plain and in whole metres.
const CONSTANT_M: f64 = 5_000.0;
/// Altitudes in feet are 3.28 times those in m; no error of a receiver or a speed is so large.
const LARGE: f64 = 1.7;
/// Part of the climb by the forces that no receiver stays below.
const SMALL: f64 = 0.04;
/// Factor on the climb by the forces beyond which altitudes fall where the vehicle climbs.
const TURNED: f64 = -0.4;
/// Least scatter of the climb by the forces on a stretch, m: below, the road is flat.
const HILLY_M: f64 = 0.5;

/// Sums from the start of the drive, m of climb.
#[derive(Clone, Copy, Debug, Default)]
struct Sums {
    distance_m: f64,
    net_work_m: f64,
    kinetic_m: f64,
}

impl Sums {
    fn minus(self, other: Self) -> Self {
        Self {
            distance_m: self.distance_m - other.distance_m,
            net_work_m: self.net_work_m - other.net_work_m,
            kinetic_m: self.kinetic_m - other.kinetic_m,
        }
    }
}

/// Collects altitudes and the climb by the forces.
#[derive(Clone, Debug, Default)]
pub(super) struct Climb {
    newest: Sums,
    remembered: VecDeque<Sums>,
    last_mps: Option<f64>,
    anchor: Option<(Sums, f64)>,
    altitudes: u32,
    range_m: Option<(f64, f64)>,
    from_m: Option<f64>,
    fit: Fit,
}

impl Climb {
    /// Takes an altitude as it was reported, m, after a way of the wheels, m.
    pub(super) fn altitude(&mut self, altitude_m: f64, way_m: f64) {
        self.altitudes = self.altitudes.saturating_add(1);
        self.from_m.get_or_insert(way_m);
        let (low, high) = self.range_m.unwrap_or((altitude_m, altitude_m));
        self.range_m = Some((low.min(altitude_m), high.max(altitude_m)));
    }

    /// Takes a sample of the estimator.
    pub(super) fn sample(&mut self, sample: &Sample, vehicle: &VehicleParameters) {
        let mps = f64::from(sample.end.speed_mps);
        let is_usable = sample.end.condition.is_valid()
            && !sample.end.condition.crawling
            && sample.gap_cells == 0;
        let Some(last_mps) = self.last_mps.replace(mps).filter(|_| is_usable) else {
            self.anchor = None;
            self.remembered.clear();
            return;
        };
        let balance = vehicle.force_balance(&sample.forces);
        let length_m = f64::from(sample.length_m);
        let (before, after) = (0.5 * last_mps * last_mps, 0.5 * mps * mps);
        let gravity = 100.0 * f64::from(balance.gravity);
        let losses = f64::from(balance.rolling) + f64::from(balance.drag) * 0.5 * (before + after);
        self.newest.distance_m += length_m;
        self.newest.net_work_m += (f64::from(balance.traction) - losses) * length_m / gravity;
        self.newest.kinetic_m += (after - before) / gravity;
        self.remembered.push_back(self.newest);
        if self.remembered.len() > REMEMBERED {
            self.remembered.pop_front();
        }
        if let Some(altitude) = &sample.altitude {
            let behind_m = f64::from(altitude.behind_m);
            self.placed(f64::from(altitude.altitude_m), behind_m);
        }
    }

    /// Takes an altitude that was taken so far behind, m.
    fn placed(&mut self, altitude_m: f64, behind_m: f64) {
        let at_m = self.newest.distance_m - behind_m;
        let Some(sums) = self.remembered.iter().find(|sums| sums.distance_m >= at_m) else {
            return;
        };
        if let Some((from, from_m)) = self.anchor {
            let way = sums.minus(from);
            if way.distance_m < STRETCH_M {
                return;
            }
            self.fit.add(&way, altitude_m - from_m);
        }
        self.anchor = Some((*sums, altitude_m));
    }

    /// Returns what is not plausible about altitudes as such, after a way of the wheels, m.
    pub(super) fn judge_changes(&self, way_m: f64) -> Option<Warning> {
        let (low, high) = self.range_m?;
        let is_long = way_m - self.from_m? > CONSTANT_M && self.altitudes >= 100;
        (is_long && low == high).then(|| {
            Warning::major(
                "altitude_constant",
                "the altitude never changes",
                format!("the altitude is always {low} m"),
                "check that the altitude (129029; column altitude_m) is that of the receiver; some \
                 hold it in a fix of two dimensions",
            )
        })
    }

    /// Returns what is not plausible about their scale.
    pub(super) fn judge_scale(&self) -> Option<Warning> {
        let (scale, looks) = self.fit.scale()?;
        Some(Warning::major(
            "altitude_unit",
            "the altitude is not in m",
            format!("altitudes change {scale:.3} times as much as speed and forces say{looks}"),
            "give the altitude in m (column altitude_m): multiply feet by 0.3048",
        ))
    }
}

/// Normal equations of the regression.
#[derive(Clone, Debug, Default)]
struct Fit {
    count: u32,
    normal: Matrix3<f64>,
    right: Vector3<f64>,
    squares: f64,
    modelled_squares: f64,
}

impl Fit {
    fn add(&mut self, way: &Sums, climb_m: f64) {
        let row = Vector3::new(way.net_work_m, -way.kinetic_m, way.distance_m * 0.01);
        self.count = self.count.saturating_add(1);
        self.normal += row * row.transpose();
        self.right += row * climb_m;
        self.squares += climb_m * climb_m;
        self.modelled_squares += (way.net_work_m - way.kinetic_m).powi(2);
    }

    /// Returns the scale of the altitudes if it is not that of metres, and words for it.
    fn scale(&self) -> Option<(f64, &'static str)> {
        if self.count < STRETCHES {
            return None;
        }
        let count = f64::from(self.count);
        let modelled_m = (self.modelled_squares / count).sqrt();
        let part = (self.squares / count).sqrt() / modelled_m;
        if part < SMALL && modelled_m > HILLY_M {
            return Some((part, ": they look like km"));
        }
        let inverse = self.normal.try_inverse()?;
        let solution = inverse * self.right;
        let variance = ((self.squares - solution.dot(&self.right)) / (count - 3.0)).max(0.0);
        let scale = solution[1];
        let sigma = (variance * inverse[(1, 1)]).sqrt();
        if scale + 3.0 * sigma < TURNED && solution[0] < TURNED && modelled_m > HILLY_M {
            return Some((scale, ": their sign is wrong"));
        }
        let is_large = scale - 3.0 * sigma > LARGE && solution[0] > LARGE;
        let looks = if (scale - 3.28).abs() < 3.0 * sigma + 0.3 {
            ": they look like feet"
        } else {
            ""
        };
        is_large.then_some((scale, looks))
    }
}
