//! How the filter answers a part of the model that is missing.

use super::cell_input::CellInput;
use super::covariance::StateVector;
use super::dynamics::Dynamics;
use super::measurement::{Update, altitude, speed};
use super::noise::Score;
use super::state::Record;
use super::state_index::StateIndex::{self, Altitude, Bias, Slope, Wind};
use crate::scalar::Scalar;

impl<S: Scalar> Record<S> {
    /// Propagates the mean error of the state that a missing part of the model causes over this
    /// step. In this cell the road climbs `missing_climb_m` less than the model reads. Returns the
    /// error of the altitude innovation, m; `None` without an altitude.
    ///
    /// The filter is linear, so this is the derivative of its innovations with respect to the
    /// amount of what is missing, times that amount (B. Rosenberg, "Random coefficients models",
    /// Annals of Economic and Social Measurement 2:399, 1973; P. de Jong, "The diffuse Kalman
    /// filter", Annals of Statistics 19:1073, 1991). What is missing is a part of the slope that is
    /// read, as the bias is, and not a force on the speed. Drivers answer the road, so force and
    /// road are correlated, and only the altitude separates them.
    pub fn carry_error(
        &self,
        cell: &CellInput,
        dynamics: &Dynamics<S>,
        error: &mut StateVector<S>,
        missing_climb_m: S,
    ) -> Option<S> {
        self.propagate_error(cell, dynamics, error, missing_climb_m);
        self.answer(cell, error)[1]
    }

    /// Propagates the error over the step, up to the measurements.
    #[inline(never)] // One copy: flash is small.
    fn propagate_error(
        &self,
        cell: &CellInput,
        dynamics: &Dynamics<S>,
        error: &mut StateVector<S>,
        missing_climb_m: S,
    ) {
        if cell.marks.gap {
            for index in StateIndex::ENDED_BY_GAP {
                error[index as usize] = S::ZERO;
            }
            error[Slope as usize] = error[Bias as usize] + error[Wind as usize];
        } else {
            dynamics.forward_vector(error);
            error[Altitude as usize] += -missing_climb_m;
        }
    }

    /// Takes the error over the updates. Returns those of their innovations: speed, altitude, slope.
    #[inline(never)] // One copy: flash is small.
    pub(crate) fn answer(&self, cell: &CellInput, error: &mut StateVector<S>) -> [Option<S>; 3] {
        let speed = speed::row(cell).of(error);
        let speed = carry(error, speed, self.speed.as_ref());
        let altitude = altitude::row().of(error);
        let altitude = carry(error, altitude, self.altitude.as_ref());
        let slope = self.state.slope_row(cell).of(error);
        [speed, altitude, carry(error, slope, self.slope.as_ref())]
    }

    /// Takes the error over the step. Returns the score of its amount: what the innovations say of it,
    /// and their information.
    pub(crate) fn score_error(
        &self,
        cell: &CellInput,
        dynamics: &Dynamics<S>,
        error: &mut StateVector<S>,
    ) -> Score<S> {
        self.propagate_error(cell, dynamics, error, S::ZERO);
        self.score_answers(cell, error)
    }

    /// Returns the score of an error that begins before the measurements of the step.
    pub(crate) fn score_answers(&self, cell: &CellInput, error: &mut StateVector<S>) -> Score<S> {
        let mut score = Score {
            sum: S::ZERO,
            information: S::ZERO,
        };
        let answers = self.answer(cell, error);
        for (update, answer) in [&self.speed, &self.altitude, &self.slope]
            .into_iter()
            .zip(answers)
        {
            if let (Some(update), Some(answer)) = (update, answer) {
                let weighted = answer / update.innovation_variance;
                score.sum += weighted * update.innovation;
                score.information += weighted * answer;
            }
        }
        score
    }
}

/// Applies an update to the error. Returns that of its innovation.
fn carry<S: Scalar>(
    error: &mut StateVector<S>,
    observed: S,
    update: Option<&Update<S>>,
) -> Option<S> {
    let update = update?.used()?;
    S::add_products(error, -observed, &update.gain);
    Some(observed)
}
