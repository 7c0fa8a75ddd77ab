//! One replicated experiment and its disturbances.

use super::experiment::Experiment;
use crate::comparison::MeasuredDrive;

/// Disturbances of a run, as factors of the assumed ones. The experiments have all of them at 1;
/// other values show the contribution of each.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sources {
    /// Noise on wheel speed.
    pub speed: f64,
    /// GPS altitude errors, the large ones included.
    pub gps: f64,
    /// Wind.
    pub wind: f64,
    /// The fitted constant.
    pub constant: f64,
    /// Cold tyres.
    pub warm_up: f64,
    /// False torque.
    pub torque: f64,
}

impl Sources {
    /// All disturbances, as in the experiments.
    pub const ALL: Self = Self {
        speed: 1.0,
        gps: 1.0,
        wind: 1.0,
        constant: 1.0,
        warm_up: 1.0,
        torque: 1.0,
    };
    /// No disturbance.
    pub const NONE: Self = Self {
        speed: 0.0,
        gps: 0.0,
        wind: 0.0,
        constant: 0.0,
        warm_up: 0.0,
        torque: 0.0,
    };
}

/// The two fitted numbers of a run.
#[derive(Clone, Copy, Debug)]
pub struct Fitted {
    /// Constant model error, %.
    pub constant_percent: f64,
    /// Noise on wheel speed, m/s.
    pub speed_mps: f64,
}

/// One replicated experiment.
#[derive(Clone, Debug)]
pub struct Replica {
    /// The experiment.
    pub experiment: Experiment,
    /// The fitted numbers.
    pub fitted: Fitted,
    /// The measurements.
    pub drive: MeasuredDrive,
    /// True grade, %.
    pub truth: Vec<f64>,
}
