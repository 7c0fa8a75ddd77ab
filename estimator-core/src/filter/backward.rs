//! The smoothing recursion, backwards over steps: Bryson-Frazier as modified by Bierman.
//!
//! It carries the adjoint λ and its information Λ, so that no covariance is ever inverted:
//! smoothed mean x − P λ, smoothed covariance P − P Λ P, with x and P as the filter had them at each
//! cell (G. J. Bierman, "Fixed interval smoothing with discrete measurements", Int. J. Control
//! 18:65, 1973). One step costs less than one of the filter, whose gains it finds in the trace.

use super::covariance::Covariance;
use super::record::Trace;
use super::state::{
    ALTITUDE, ENERGY, GNSS_ERROR, Look, Quantity, SLOPE, SLOPE_RATE, STATES, State,
};
use super::update::{Applied, Observation};
use crate::cell::{Estimate, Uncertain};
use crate::scalar::Scalar;

/// What later steps say about earlier ones.
#[derive(Clone, Copy, Debug)]
pub struct Backward<S> {
    lambda: [S; STATES],
    information: Covariance<S>,
}

impl<S: Scalar> Backward<S> {
    /// At the newest step: nothing later is known.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            lambda: [S::ZERO; STATES],
            information: Covariance::ZERO,
        }
    }

    /// A quantity as the filter had it at the cell, corrected by what came later.
    #[must_use]
    pub fn correct(&self, look: &Look<S>) -> Look<S> {
        let spread = self.information.times(&look.cross);
        let known = S::dot(&look.cross, &spread);
        Look {
            mean: look.mean - S::dot(&look.cross, &self.lambda),
            variance: (look.variance - known).max(S::ZERO),
            cross: look.cross,
        }
    }

    /// The smoothed estimate where the filter had `state`.
    #[must_use]
    pub fn estimate(&self, state: &State<S>) -> Estimate {
        let look = |quantity| self.correct(&state.look(quantity));
        let scale = look(Quantity::Scale).known();
        let correction = self.correct_energy(state);
        Estimate {
            grade_percent: look(Quantity::Slope).grade(),
            altitude_m: look(Quantity::Altitude).altitude(state.origin_m),
            speed_mps: (correction + correction).sqrt().to_f32(),
            bias_percent: look(Quantity::Bias).known(),
            scale: Uncertain {
                value: 1.0 + scale.value,
                ..scale
            },
        }
    }

    fn correct_energy(&self, state: &State<S>) -> S {
        state.x[ENERGY] - S::dot(&state.p.row(ENERGY), &self.lambda)
    }

    /// Goes back over a step, from after its measurements to after those of the step before.
    pub fn retreat(&mut self, trace: &Trace<S>) {
        // In the reverse of the order in which the filter took them in.
        for (observation, applied) in trace.measurements() {
            self.undo(observation, applied);
        }
        if trace.link.sets_altitude() {
            self.information.shear(GNSS_ERROR, ALTITUDE, -S::ONE);
            self.information.clear(ALTITUDE);
        }
        if trace.link.breaks() {
            break_matrix(&mut self.information);
        } else {
            trace.motion.transpose_matrix(&mut self.information);
        }
        trace.retreat_behind_measurements(&mut self.lambda);
    }

    /// λ ← (I − K h)' λ − h' ν/s and Λ ← (I − K h)' Λ (I − K h) + h' h/s: only the states that
    /// the measurement saw change.
    fn undo(&mut self, observation: Observation, applied: &Applied<S>) {
        let per_variance = S::ONE / applied.innovation_variance;
        let spread = self.information.times(&applied.gain);
        let within = S::dot(&applied.gain, &spread);
        applied.undo(observation, &mut self.lambda);
        observation.add_to(&mut self.lambda, -(applied.innovation * per_variance));
        observation.add_products(&mut self.information, &spread, within + per_variance);
    }

    /// Goes back over many steps at once.
    pub fn retreat_through(&mut self, passage: &Passage<S>) {
        let mut lambda = passage.backward.lambda;
        for (factor, image) in self.lambda.iter().zip(&passage.images) {
            for (element, image) in lambda.iter_mut().zip(image) {
                element.add_product(*factor, image);
            }
        }
        self.lambda = lambda;
        self.information = passage
            .backward
            .information
            .plus_congruence(&passage.images, &self.information);
    }
}

/// States of which a gap leaves nothing.
const BROKEN: [usize; 4] = [ENERGY, ALTITUDE, SLOPE, SLOPE_RATE];

/// Leaves nothing of the states that a gap breaks, in a vector.
#[inline(always)]
pub(super) fn break_vector<S: Scalar>(vector: &mut [S; STATES]) {
    for (i, element) in vector.iter_mut().enumerate() {
        if BROKEN.contains(&i) {
            *element = S::ZERO;
        }
    }
}

/// The same in a symmetric matrix, by rows and columns.
#[inline(always)]
pub(super) fn break_matrix<S: Scalar>(matrix: &mut Covariance<S>) {
    for i in BROKEN {
        matrix.clear(i);
    }
}

/// The way back over many steps, whatever comes after them: λ ← λ₀ + Ψ λ and Λ ← Λ₀ + Ψ Λ Ψ'.
///
/// With it a fixed lag goes back over each step once, and over blocks of steps from then on.
#[derive(Clone, Copy, Debug)]
pub struct Passage<S> {
    /// λ₀ and Λ₀: what the steps themselves say.
    backward: Backward<S>,
    /// Columns of Ψ: what becomes of each element of λ.
    images: [[S; STATES]; STATES],
}

impl<S: Scalar> Passage<S> {
    /// Over no step.
    #[must_use]
    pub fn new() -> Self {
        let mut images = [[S::ZERO; STATES]; STATES];
        for (i, image) in images.iter_mut().enumerate() {
            image[i] = S::ONE;
        }
        Self {
            backward: Backward::new(),
            images,
        }
    }

    /// Goes back over one more step.
    pub fn retreat(&mut self, trace: &Trace<S>) {
        self.backward.retreat(trace);
        for image in &mut self.images {
            for (observation, applied) in trace.measurements() {
                applied.undo(observation, image);
            }
            trace.retreat_behind_measurements(image);
        }
    }

    /// What the steps gone over say, and nothing after them.
    #[must_use]
    pub const fn backward(&self) -> &Backward<S> {
        &self.backward
    }

    /// A quantity as the filter had it here, corrected by the steps gone over; what hangs on the
    /// states here then hangs on those where they end.
    #[must_use]
    pub fn correct(&self, look: &Look<S>) -> Look<S> {
        Look {
            cross: self.images.map(|image| S::dot(&look.cross, &image)),
            ..self.backward.correct(look)
        }
    }
}

impl<S: Scalar> Default for Passage<S> {
    fn default() -> Self {
        Self::new()
    }
}

impl<S: Scalar> Default for Backward<S> {
    fn default() -> Self {
        Self::new()
    }
}
