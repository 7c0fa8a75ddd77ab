//! The backward pass: what later cells say about earlier ones, and the scores of the noises.
//!
//! Source: P. de Jong, "Smoothing and interpolation with the state-space model", Journal of the
//! American Statistical Association 84:1085, 1989; S. J. Koopman, "Disturbance smoother for state
//! space models", Biometrika 80:117, 1993.

use super::cell_input::CellInput;
use super::covariance::{Covariance, StateVector};
use super::dynamics::Dynamics;
use super::measurement::{Row, Update, altitude, speed};
use super::noise::{NOISES, Noise, Score};
use super::state::{Moments, Quantity, Record, State};
use super::state_index::STATES;
use super::state_index::StateIndex::{self, Bias, Scale, Slope, Wind};
use crate::scalar::Scalar;

/// Least part of a variance that later cells leave: a two-hundredth of its sigma. Single precision
/// knows the difference of two variances no better.
const LEAST_PART: f32 = 25e-6;

/// What later cells say about earlier ones: the vector r and its information matrix N.
#[derive(Clone, Copy, Debug)]
pub struct Adjoint<S> {
    /// r.
    pub vector: StateVector<S>,
    /// N.
    pub information: Covariance<S>,
}

/// What the backward pass finds in a cell.
#[derive(Clone, Copy, Debug)]
pub struct Disturbances<S> {
    /// Scores of the noises, in the order of [`Noise::ALL`].
    pub of: [Score<S>; NOISES],
    /// Score of the load before the cell.
    pub load: Score<S>,
    /// Score of the speed's noise, which had the mean R ρ and the variance R − R² n.
    pub speed: Option<Score<S>>,
    /// Score of the altitude's noise, likewise.
    pub altitude: Option<Score<S>>,
    /// Score of the noise of a slope that was measured directly, likewise.
    pub slope: Option<Score<S>>,
}

impl<S: Scalar> Adjoint<S> {
    /// Nothing later is known.
    pub const NONE: Self = Self {
        vector: [S::ZERO; STATES],
        information: Covariance::ZERO,
    };

    /// Returns mean and variance of a quantity, given the state that the filter had.
    #[inline]
    #[must_use]
    pub fn smooth(&self, filtered: &State<S>, quantity: Quantity) -> Moments<S> {
        let (moments, cross) = filtered.quantity(quantity);
        let spread = self.information.times(&cross);
        let least = moments.variance * S::from_f32(LEAST_PART);
        Moments {
            mean: moments.mean + S::dot(&cross, &self.vector),
            variance: (moments.variance - S::dot(&cross, &spread)).max(least),
        }
    }

    /// Goes back over a step: from after its measurements to after those of the step before. Returns
    /// the scores of its noises.
    #[inline]
    pub fn retreat(
        &mut self,
        cell: &CellInput,
        dynamics: &Dynamics<S>,
        record: &Record<S>,
    ) -> Disturbances<S> {
        // In the reverse order of the updates.
        let slope = self.undo(&record.state.slope_row(cell), record.slope.as_ref());
        let altitude = self.undo(&altitude::row(), record.altitude.as_ref());
        let speed = self.undo(&speed::row(cell), record.speed.as_ref());
        let of = Noise::ALL.map(|noise| noise.score(&self.vector, &self.information));
        if cell.marks.gap {
            // Behind a gap the slope that is read starts with bias and wind in it.
            for error in [Bias, Wind] {
                let slope = self.vector[Slope as usize];
                self.vector[error as usize] += slope;
                self.information.shear(error, Slope, S::ONE);
            }
            for index in StateIndex::ENDED_BY_GAP {
                self.vector[index as usize] = S::ZERO;
                self.information.clear(index);
            }
        } else {
            dynamics.transpose(&mut self.vector, &mut self.information);
        }
        Disturbances {
            of,
            load: self.load_score(record.net_traction_before),
            speed,
            altitude,
            slope,
        }
    }

    fn load_score(&self, net_traction: S) -> Score<S> {
        let (l, n) = (net_traction, &self.information);
        Score {
            sum: self.vector[Scale as usize] - l * self.vector[Slope as usize],
            information: n.get(Scale, Scale) - (l + l) * n.get(Scale, Slope)
                + l * l * n.get(Slope, Slope),
        }
    }

    /// Goes back over an update with the row h: r ← (I − K h)' r + h' ν/S, and N ← (I − K h)' N (I − K h)
    /// + h' h/S. Returns the score of the measurement's noise.
    #[inline(always)]
    fn undo<const N: usize>(
        &mut self,
        row: &Row<S, N>,
        update: Option<&Update<S>>,
    ) -> Option<Score<S>> {
        let update = update?.used()?;
        let gain = &update.gain;
        let spread = self.information.times(gain);
        let per_variance = S::ONE / update.innovation_variance;
        let sum = update.innovation * per_variance - S::dot(gain, &self.vector);
        let information = per_variance + S::dot(gain, &spread);
        for &(i, h) in &row.0 {
            self.vector[i as usize] += h * sum;
            self.information.subtract_cross(i, h, &spread);
        }
        for (at, &(i, h)) in row.0.iter().enumerate() {
            for &(j, other) in row.0.get(at..).unwrap_or_default() {
                self.information.add(i, j, h * other * information);
            }
        }
        Some(Score { sum, information })
    }
}
