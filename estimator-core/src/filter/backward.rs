//! The smoothing recursion, backwards over records: Bryson-Frazier as modified by Bierman.
//!
//! It carries the adjoint λ and its information Λ, so that no covariance is ever inverted:
//! smoothed mean x − P λ, smoothed covariance P − P Λ P, with x and P as predicted at each cell
//! (G. J. Bierman, "Fixed interval smoothing with discrete measurements", Int. J. Control 18:65,
//! 1973). One step costs about as much as one of the filter.

use super::covariance::Covariance;
use super::record::{Link, Record};
use super::state::{ALTITUDE, ENERGY, GNSS_ERROR, SLOPE, SLOPE_RATE, STATES, State, dot, estimate};
use super::update::{Gain, Update};
use crate::cell::Estimate;
use crate::scalar::Scalar;

/// What later records say about earlier ones.
#[derive(Clone, Copy, Debug)]
pub struct Backward<S> {
    lambda: [S; STATES],
    information: Covariance<S>,
}

impl<S: Scalar> Backward<S> {
    /// At the newest record: nothing later is known.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            lambda: [S::ZERO; STATES],
            information: Covariance::ZERO,
        }
    }

    /// Takes in the measurements of `record`, going backwards, and tells its state after them
    /// as the filter had it.
    pub fn absorb(&mut self, record: &Record<S>) -> State<S> {
        let mut state = record.predicted;
        let speed = record
            .speed
            .map(|update| (update, update.apply(&mut state)));
        let altitude = record
            .altitude
            .map(|update| (update, update.apply(&mut state)));
        for (update, gain) in [altitude, speed].into_iter().flatten() {
            self.undo(&update, &gain);
        }
        state
    }

    /// λ ← (I − K h)' λ − h' ν/s and Λ ← (I − K h)' Λ (I − K h) + h' h/s: only the states that
    /// the measurement saw change.
    fn undo(&mut self, update: &Update<S>, gain: &Gain<S>) {
        let per_variance = S::ONE / gain.innovation_variance;
        let spread = self.information.times(&gain.gain);
        let along = dot(&gain.gain, &self.lambda);
        let within = dot(&gain.gain, &spread);
        update.observation.add_to(
            &mut self.lambda,
            -(along + update.innovation * per_variance),
        );
        let row = update.observation.row::<S>();
        let added = within + per_variance;
        self.information.add_products(&row, &spread, added);
    }

    /// The smoothed estimate at `record`, whose measurements have been absorbed.
    #[must_use]
    pub fn estimate(&self, record: &Record<S>) -> Estimate {
        let predicted = &record.predicted;
        let correction = predicted.p.times(&self.lambda);
        let mut x = predicted.x;
        for (x, correction) in x.iter_mut().zip(&correction) {
            *x += -*correction;
        }
        estimate(&x, predicted.load, predicted.origin_m, |h| {
            let spread = predicted.p.times(h);
            let known = dot(&spread, &self.information.times(&spread));
            (dot(h, &spread) - known).max(S::ZERO)
        })
    }

    /// Goes over the step into `record`, to the record before it.
    pub fn retreat(&mut self, record: &Record<S>) {
        match record.link {
            Link::Chained => {}
            Link::AltitudeSet => {
                let step = -self.lambda[ALTITUDE];
                self.lambda[GNSS_ERROR] += step;
                self.information.shear(GNSS_ERROR, ALTITUDE, -S::ONE);
                self.forget(ALTITUDE);
            }
            Link::Broken => {
                // A fix that set the altitude in this very cell tied it to the GNSS error.
                if record.predicted.origin_m.is_some() {
                    let step = -self.lambda[ALTITUDE];
                    self.lambda[GNSS_ERROR] += step;
                    self.information.shear(GNSS_ERROR, ALTITUDE, -S::ONE);
                }
                for i in [ENERGY, ALTITUDE, SLOPE, SLOPE_RATE] {
                    self.forget(i);
                }
                return;
            }
        }
        record
            .transition
            .transpose(&mut self.lambda, &mut self.information);
    }

    fn forget(&mut self, i: usize) {
        self.lambda[i] = S::ZERO;
        self.information.clear(i);
    }
}

impl<S: Scalar> Default for Backward<S> {
    fn default() -> Self {
        Self::new()
    }
}
