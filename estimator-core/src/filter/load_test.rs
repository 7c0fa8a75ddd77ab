//! Load changes that nobody reports.
//!
//! At any stop a vehicle may be loaded, unloaded, coupled or uncoupled, and no bus has to report it.
//! So the scale is open after a stop: its variance is that of any load. The launch then shows the
//! load, since traction changes by many times what a road can bend. If the scale that the launch
//! shows agrees with the one from before the stop, the load is most likely the same, and the old
//! scale is taken as a measurement. Otherwise the new one stays, and the smoothing of the cells
//! before the stop is not touched by it.

use super::measurement::{Observation, ScalarMeasurement, ScalarUpdate};
use super::state::State;
use super::state_index::StateIndex;
use crate::sample::Sample;
use crate::scalar::Scalar;
use crate::tuning::Prior;

/// The test of the load since the last stop.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct LoadTest {
    before: Option<ScaleBefore>,
    /// Whether the vehicle launches with the load that was opened.
    launches: bool,
    /// Distance driven since with a valid model, m.
    driven_m: f32,
}

/// The scale before a stop.
#[derive(Clone, Copy, Debug)]
struct ScaleBefore {
    error: f32,
    variance: f32,
}

/// Where the load was opened.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Opened {
    /// At a standstill: a launch follows.
    Standing,
    /// Where a drive begins in motion. It takes kilometres to show a load that is not that of the
    /// file.
    Moving,
}

/// What the launch shows.
#[derive(Clone, Copy, Debug)]
pub(super) enum LoadDecision<S> {
    /// The load is the same: the old scale was taken as a measurement.
    Same(ScalarUpdate<S>),
    /// The load changed.
    Changed,
}

impl LoadTest {
    /// Returns whether the vehicle launches with a load that is not known yet.
    pub(super) const fn is_launching(&self, tuning: &Prior) -> bool {
        self.launches && self.driven_m < tuning.launch_longest_m
    }

    /// Opens the scale: its load may be any.
    pub(super) fn open<S: Scalar>(&mut self, state: &mut State<S>, opened: Opened, tuning: &Prior) {
        let scale = StateIndex::Scale;
        // Two stops in a row: the scale from before the first one counts.
        let before = self.before.get_or_insert(ScaleBefore {
            error: state.mean[scale].to_f32(),
            variance: state.covariance.variance(scale).to_f32(),
        });
        before.variance += tuning.same_load_sigma * tuning.same_load_sigma;
        self.launches = opened == Opened::Standing;
        self.driven_m = 0.0;
        let relative_sigma = match opened {
            Opened::Standing => tuning.open_scale_sigma,
            Opened::Moving => tuning.unreported_scale_sigma,
        };
        let sigma = relative_sigma * (1.0 + state.mean[scale].to_f32());
        let lacking = S::from_f32(sigma * sigma) - state.covariance.variance(scale);
        state.covariance.add_variance(scale, lacking.max(S::ZERO));
    }

    /// Decides at the end of a cell, once the launch has shown the scale.
    pub(super) fn decide<S: Scalar>(
        &mut self,
        state: &mut State<S>,
        sample: &Sample,
        tuning: &Prior,
    ) -> Option<LoadDecision<S>> {
        if sample.end.condition.is_valid() {
            self.driven_m += sample.length_m;
        }
        let ScaleBefore { error, variance } = self.before?;
        if self.driven_m < tuning.launch_m {
            return None;
        }
        let scale = StateIndex::Scale;
        let now = state.covariance.variance(scale).to_f32();
        let innovation = error - state.mean[scale].to_f32();
        let sigmas = tuning.same_load_sigmas;
        let agrees = innovation * innovation <= sigmas * sigmas * (now + variance);
        let known = tuning.launch_scale_sigma * (1.0 + error);
        if agrees && now > known * known && self.driven_m < tuning.open_longest_m {
            return None;
        }
        self.before = None;
        if !agrees {
            return Some(LoadDecision::Changed);
        }
        // The old scale says more than the rest of the launch.
        self.launches = false;
        let measurement = ScalarMeasurement {
            observation: Observation::Scale,
            innovation: S::from_f32(innovation),
            variance: S::from_f32(variance),
        };
        Some(LoadDecision::Same(measurement.apply(state)))
    }
}
