//! One experiment, driven, and what disturbs it.

use super::experiment::Experiment;
use crate::comparison::MeasuredDrive;

/// What disturbs a run, as factors of what is assumed: all 1 in the experiments, others to see what
/// an error is made of.
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
    /// Everything, as in the experiments.
    pub const ALL: Self = Self {
        speed: 1.0,
        gps: 1.0,
        wind: 1.0,
        constant: 1.0,
        warm_up: 1.0,
        torque: 1.0,
    };
    /// Nothing.
    pub const NONE: Self = Self {
        speed: 0.0,
        gps: 0.0,
        wind: 0.0,
        constant: 0.0,
        warm_up: 0.0,
        torque: 0.0,
    };
}

/// The two numbers of a run that are fitted.
#[derive(Clone, Copy, Debug)]
pub struct Fitted {
    /// Constant model error, %.
    pub constant_percent: f64,
    /// Noise on wheel speed, m/s.
    pub speed_mps: f64,
}

/// One experiment, driven.
#[derive(Clone, Debug)]
pub struct Replica {
    /// Which one.
    pub experiment: Experiment,
    /// What was fitted to it.
    pub fitted: Fitted,
    /// What was measured.
    pub drive: MeasuredDrive,
    /// True grade, %.
    pub truth: Vec<f64>,
}
