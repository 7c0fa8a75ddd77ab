//! What is believed of the slow states where a drive begins.
//!
//! Between two drives each slow state takes one Gauss-Markov step: a part of its mean is kept, and
//! its variance goes some of the way to that of a vehicle of which nothing is known,
//! x' = k x + w, var w = (1 − k²) σ². A chain of short drives thus forgets what it does not learn
//! again.

use super::covariance::Covariance;
use super::doubt;
use super::state::{BIAS, GNSS_ERROR, SCALE, STATES, State, WIND};
use super::transition::{bias_variance, wind_variance};
use crate::sampler::Sample;
use crate::scalar::Scalar;
use crate::tuning::Tuning;
use crate::vehicle::VehicleParameters;

/// Part of the scale that is kept if the mass that the model takes is the same.
///
/// The scale is told by mass and torque. Where no message tells the mass, a truck that has loaded
/// looks like one that has not: with probability k the scale is what it was, else it is anything
/// that a load can make it. The mean and variance of such a mixture are those of a Markov step.
/// One drive in ten, because regular hauls are the rule; a stop that changes the load and a message
/// that tells it usually come together.
const KEEP_SCALE: f32 = 0.9;
/// Scale of a vehicle whose load may be any, 1 sigma: 30 % more load make 0.23 of it.
///
/// More than a first drive's [`Tuning::scale_sigma`], whose parameters were written down for the
/// load at hand. Both together leave 0.11 where a drive had found out all: an unnoticed 30 % is
/// then two of its sigmas.
const SCALE_OF_ANY_LOAD: f32 = 0.25;
/// Part of the bias that is the vehicle's own.
///
/// Drag area and what is wrong with the parameters of shape and tyres come along; wind, weather,
/// road and tyre temperature do not (of all that the model lacks, only mass and drag area outlast a
/// trip). In the default tuning drag, and of rolling resistance the part that a wrong parameter
/// makes (0.1 of 0.15), are 0.3 (12 t) to 0.4 (39 t) of the variance. It matters little: beside
/// cold tyres all of it is small.
const KEEP_BIAS: f32 = 0.35;
/// Largest change of the mass that is no other load, as a part of it: scatter of axle loads.
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

    /// One step from the end of that drive to the start of this one, of which `fresh` is what a
    /// first drive would believe, with this mass.
    ///
    /// A scale that was learned for another load says nothing of this one.
    fn carry_over<S: Scalar>(&self, fresh: &mut State<S>, mass_kg: f32) {
        let markov = |keep: f32, variance: f32, of_any: S| {
            let kept = S::from_f32(keep * keep);
            kept * S::from_f32(variance) + (S::ONE - kept) * of_any
        };
        let bias = markov(KEEP_BIAS, self.bias_variance, fresh.p.get(BIAS, BIAS));
        fresh.x[BIAS] = S::from_f32(KEEP_BIAS * self.bias_percent);
        fresh.p.set(BIAS, BIAS, bias);
        if (mass_kg - self.mass_kg).abs() <= SAME_LOAD * self.mass_kg {
            let of_any_load = S::from_f32(SCALE_OF_ANY_LOAD * SCALE_OF_ANY_LOAD);
            let scale = markov(KEEP_SCALE, self.scale_variance, of_any_load);
            let covariance = KEEP_BIAS * KEEP_SCALE * self.covariance;
            fresh.x[SCALE] = S::from_f32(KEEP_SCALE * self.scale_error);
            fresh.p.set(SCALE, SCALE, scale);
            fresh.p.set(BIAS, SCALE, S::from_f32(covariance));
        }
    }
}

/// The slow states at the first cell of a drive, the others zero.
pub(super) fn state_at_start<S: Scalar>(
    known: Option<&SlowStates>,
    vehicle: &VehicleParameters,
    tuning: &Tuning,
    sample: &Sample,
) -> State<S> {
    let mut state = State {
        x: [S::ZERO; STATES],
        p: Covariance::ZERO,
        load: S::ZERO,
        origin_m: None,
    };
    let square = |sigma: f32| sigma * sigma;
    for (i, variance) in [
        (BIAS, bias_variance(vehicle, tuning, sample)),
        (WIND, wind_variance(vehicle, tuning, sample)),
        (SCALE, square(tuning.scale_sigma)),
        (GNSS_ERROR, square(tuning.gnss_error_sigma_m)),
    ] {
        state.p.set(i, i, S::from_f32(variance));
    }
    let (bias, scale) = doubt::variances(vehicle, sample);
    state.p.add_variance(BIAS, S::from_f32(bias));
    state.p.add_variance(SCALE, S::from_f32(scale));
    if let Some(known) = known {
        known.carry_over(&mut state, sample.load.mass_kg);
    }
    // Tyres are cold again, whatever the last drive found them to be.
    let cold = cold_tyres(vehicle, tuning);
    state.p.add_variance(BIAS, S::from_f32(cold * cold));
    state
}

/// Gives up what was learned of bias and scale before a stop. The means stay: there are no better
/// ones, and noise that is added leaves the smoothing as it is.
pub(super) fn reopen<S: Scalar>(
    state: &mut State<S>,
    vehicle: &VehicleParameters,
    tuning: &Tuning,
    sample: &Sample,
) {
    let bias = bias_variance(vehicle, tuning, sample);
    let cold = cold_tyres(vehicle, tuning);
    let scale = tuning.scale_sigma;
    let (bias_doubt, scale_doubt) = doubt::variances(vehicle, sample);
    for (i, variance) in [
        (BIAS, bias + cold * cold + bias_doubt),
        (SCALE, scale * scale + scale_doubt),
    ] {
        let known = state.p.get(i, i).to_f32();
        state
            .p
            .add_variance(i, S::from_f32((variance - known).max(0.0)));
    }
}

/// What cold tyres may add to the resistance, %.
fn cold_tyres(vehicle: &VehicleParameters, tuning: &Tuning) -> f32 {
    100.0 * vehicle.rolling_resistance * tuning.bias_start_rolling
}
