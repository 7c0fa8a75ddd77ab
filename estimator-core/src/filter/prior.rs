//! What is believed of the slow states where a drive begins.
//!
//! Between two drives each slow state takes one Gauss-Markov step: a part of its mean is kept, and
//! its variance goes the rest of the way to that of a drive of which nothing is known,
//! x' = k x + w, var w = (1 − k²) σ². So a chain of short drives never believes more than its
//! drives have seen, nor less than a first drive would.

use super::covariance::Covariance;
use super::state::{BIAS, GNSS_ERROR, SCALE, STATES, State, WIND};
use super::transition::{bias_sigma, wind_sigma};
use crate::sampler::Sample;
use crate::scalar::Scalar;
use crate::tuning::Tuning;
use crate::vehicle::VehicleParameters;

/// How likely the scale is still what it was, if the mass that the model takes is.
///
/// The scale is told by mass and torque. Where no message tells the mass, a truck that has loaded
/// or left a trailer looks like one that has not: the scale is x with probability k, and anything
/// that a vehicle may have else. Such a mixture has the mean k x, and about the variance of the
/// Markov step. A regular haul keeps its load, or changes it where the mass is told.
const KEEP_SCALE: f32 = 0.7;
/// Part of the bias that is the vehicle's own.
///
/// Shape, and what is wrong with the parameters of shape and tyres, come along; wind, weather, road
/// and tyre temperature do not (literature: of tyres, oil, wind, mass and drag area, only the last
/// two outlast a trip). In the default tuning drag, and of rolling the part that a wrong parameter
/// makes (0.1 of 0.15), are 0.3 (12 t) to 0.4 (39 t) of the bias's variance.
const KEEP_BIAS: f32 = 0.35;
/// Largest change of mass that is no other load: scatter of weighing by axle load, 1.
const SAME_LOAD: f32 = 0.05;

/// What a drive knew at its end of the states that belong to the vehicle.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct SlowStates {
    /// Mass that the model took: as told on the bus, else the parameter, kg.
    pub mass_kg: f32,
    /// Grade that the model reads too high for long, %.
    pub bias_percent: f32,
    /// Its variance, %².
    pub bias_variance: f32,
    /// True over modelled traction per kilogram, less one.
    pub scale_error: f32,
    /// Its variance, 1.
    pub scale_variance: f32,
    /// Covariance of the two, %.
    pub covariance: f32,
}

impl SlowStates {
    /// Of a state, learned with this mass.
    #[must_use]
    pub fn of<S: Scalar>(state: &State<S>, mass_kg: f32) -> Self {
        Self {
            mass_kg,
            bias_percent: state.x[BIAS].to_f32(),
            bias_variance: state.p.get(BIAS, BIAS).to_f32(),
            scale_error: state.x[SCALE].to_f32(),
            scale_variance: state.p.get(SCALE, SCALE).to_f32(),
            covariance: state.p.get(BIAS, SCALE).to_f32(),
        }
    }

    /// The parts of bias and scale that are kept for a vehicle of this mass.
    ///
    /// A scale that was learned for another mass says nothing of this one.
    fn keeps(&self, mass_kg: f32) -> (f32, f32) {
        let same_load = (mass_kg - self.mass_kg).abs() <= SAME_LOAD * self.mass_kg;
        (KEEP_BIAS, if same_load { KEEP_SCALE } else { 0.0 })
    }
}

/// The slow states at the first cell of a drive, the others zero.
pub(super) fn state_at_start<S: Scalar>(
    known: Option<&SlowStates>,
    vehicle: &VehicleParameters,
    tuning: &Tuning,
    sample: &Sample,
) -> State<S> {
    let mut x = [S::ZERO; STATES];
    let mut p = Covariance::ZERO;
    let mut set = |i: usize, variance: f32| p.set(i, i, S::from_f32(variance));
    let square = |sigma: f32| sigma * sigma;
    // Tyres are cold again, whatever the last drive found them to be.
    let cold = square(100.0 * vehicle.rolling_resistance * tuning.bias_start_rolling);
    let (mut bias, mut scale) = (
        square(bias_sigma(vehicle, tuning, sample)),
        square(tuning.scale_sigma),
    );
    set(WIND, square(wind_sigma(vehicle, tuning, sample)));
    set(GNSS_ERROR, square(tuning.gnss_error_sigma_m));
    if let Some(known) = known {
        let (keep_bias, keep_scale) = known.keeps(sample.load.mass_kg);
        let step = |keep: f32, variance: f32, fresh: f32| fresh + keep * keep * (variance - fresh);
        bias = step(keep_bias, known.bias_variance, bias);
        scale = step(keep_scale, known.scale_variance, scale);
        x[BIAS] = S::from_f32(keep_bias * known.bias_percent);
        x[SCALE] = S::from_f32(keep_scale * known.scale_error);
        p.set(
            BIAS,
            SCALE,
            S::from_f32(keep_bias * keep_scale * known.covariance),
        );
    }
    p.set(BIAS, BIAS, S::from_f32(bias + cold));
    p.set(SCALE, SCALE, S::from_f32(scale));
    State {
        x,
        p,
        load: S::ZERO,
        origin_m: None,
    }
}
