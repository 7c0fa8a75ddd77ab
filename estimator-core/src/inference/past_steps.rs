//! Steps of the bias, and changes of the load, behind the window: what the data since say of them.
//!
//! A step of some tenths of a per cent needs a kilometre and more until altitudes tell it from the
//! road and the receiver; so does a load on a level road. A segment that leaves the window with its step
//! closed therefore goes on as a candidate, and so does a stop. The filter is linear, so a step moves its state by a known response; the innovations
//! since give its score. Source: P. de Jong and J. Penzer, "Diagnosing shocks in time series", Journal
//! of the American Statistical Association 93:796, 1998; B. Rosenberg, "Random coefficients models",
//! Annals of Economic and Social Measurement 2:399, 1973.

use super::fixed_point::{ClosedStep, FixedPoint};
use crate::filter::StateIndex::{Bias, Scale, Slope};
use crate::filter::{Adjoint, CellInput, Dynamics, Record, STATES, Score, State, StateVector};
use crate::scalar::Scalar;
use crate::tuning::Numbers;
use heapless::Deque;

/// Candidates, at most one a segment of 50 m.
const CANDIDATES: usize = 32;

/// A step that is not open, of one per cent, or a change of the scale by one.
#[derive(Clone, Copy, Debug)]
struct Candidate<S> {
    is_load: bool,
    /// Largest sigma of its size.
    most: f32,
    /// Error of the filter's state.
    response: StateVector<S>,
    /// What the cells between it and the window say.
    score: Score<S>,
}

/// The candidates, the oldest first.
#[derive(Clone, Debug)]
pub(super) struct PastSteps<S>(Deque<Candidate<S>, CANDIDATES>);

impl<S: Scalar> PastSteps<S> {
    #[inline(always)] // See Estimator::new_in().
    pub(super) const fn new() -> Self {
        Self(Deque::new())
    }

    pub(super) fn clear(&mut self) {
        self.0.clear();
    }

    /// Takes the candidates over a step of the filter. With `begins`, one begins in this cell.
    pub(super) fn carry(
        &mut self,
        numbers: &Numbers,
        cell: &CellInput,
        dynamics: &Dynamics<S>,
        record: &Record<S>,
        begins: bool,
    ) {
        for candidate in &mut self.0 {
            let score = record.score_error(cell, dynamics, &mut candidate.response);
            candidate.score.sum += score.sum;
            candidate.score.information += score.information;
        }
        if cell.load_variance > 0.0 {
            let mut response = [S::ZERO; STATES];
            response[Scale as usize] = S::ONE;
            if !cell.marks.gap {
                // The slope of the road stays.
                response[Slope as usize] = -record.net_traction_before;
            }
            let score = record.score_error(cell, dynamics, &mut response);
            self.add(Candidate {
                is_load: true,
                most: Scalar::sqrt(cell.load_variance),
                response,
                score,
            });
        }
        if begins {
            let mut response = [S::ZERO; STATES];
            response[Bias as usize] = S::ONE;
            response[Slope as usize] = S::ONE;
            let score = record.score_answers(cell, &mut response);
            self.add(Candidate {
                is_load: false,
                most: numbers.bias_shock_most_percent,
                response,
                score,
            });
        }
    }

    fn add(&mut self, candidate: Candidate<S>) {
        if self.0.is_full() {
            self.0.pop_front();
        }
        // There is room.
        let _ = self.0.push_back(candidate);
    }

    /// Adds the odds of the candidates to those of the window, of which the backward pass has left what
    /// it says of the state before it. Returns the candidate with the most evidence, if it is enough to
    /// open.
    pub(super) fn judge(
        &self,
        numbers: &Numbers,
        window: &Adjoint<S>,
        found: &mut FixedPoint,
    ) -> Option<usize> {
        let mut best: Option<(usize, f32)> = None;
        for (at, candidate) in self.0.iter().enumerate() {
            let spread = window.information.times(&candidate.response);
            let score = Score {
                sum: candidate.score.sum + S::dot(&candidate.response, &window.vector),
                information: candidate.score.information + S::dot(&candidate.response, &spread),
            };
            let step = ClosedStep::new(0, &score);
            found.add_odds(&step, score.information.to_f32(), candidate.most);
            let is_best = best.is_none_or(|(_, evidence)| step.evidence > evidence);
            if step.evidence > numbers.revive && is_best {
                best = Some((at, step.evidence));
            }
        }
        best.map(|(at, _)| at)
    }

    /// Opens a candidate: the state is then that of a filter that allowed for the step.
    pub(super) fn open(&mut self, at: usize, state: &mut State<S>) {
        let Some(&candidate) = self.0.iter().nth(at) else {
            return;
        };
        let variance = S::from_f32(candidate.most).squared();
        let Score { sum, information } = candidate.score;
        let left = variance / (S::ONE + variance * information);
        S::add_products(&mut state.mean, left * sum, &candidate.response);
        state.covariance.add_square(left, &candidate.response);
        self.begin_anew(candidate.is_load);
    }

    /// Forgets what was said so far: the filter explains it otherwise now. A load stays possible.
    fn begin_anew(&mut self, opens_load: bool) {
        for _ in 0..self.0.len() {
            if let Some(mut candidate) = self.0.pop_front()
                && candidate.is_load
                && !opens_load
            {
                candidate.score = Score {
                    sum: S::ZERO,
                    information: S::ZERO,
                };
                let _ = self.0.push_back(candidate);
            }
        }
    }
}
