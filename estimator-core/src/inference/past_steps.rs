//! Steps of the bias, and changes of the load, behind the window: what the data since say of them.
//!
//! A step of some tenths of a per cent needs a kilometre and more until altitudes tell it from the
//! road and the receiver; so does a load on a level road. A segment that leaves the window with its step
//! closed therefore goes on as a candidate, and so does a stop. The filter is linear, so a step moves its
//! state by a known response; the innovations since give its score.
//!
//! Source: P. de Jong and J. Penzer, "Diagnosing shocks in time series", Journal of the American
//! Statistical Association 93:796, 1998; B. Rosenberg, "Random coefficients models", Annals of Economic
//! and Social Measurement 2:399, 1973.

use super::fixed_point::{ClosedStep, FixedPoint};
use crate::filter::StateIndex::{self, Bias, Scale, Slope};
use crate::filter::{Adjoint, CellInput, Dynamics, Record, STATES, Score, State, StateVector};
use crate::scalar::Scalar;
use crate::tuning::Numbers;
use heapless::Deque;

/// Candidates, at most one a segment of 50 m.
const CANDIDATES: usize = 32;

/// What the cells between a place and the window say of an error of one that begins there.
#[derive(Clone, Copy, Debug)]
struct Followed<S> {
    /// Error of the filter's state.
    response: StateVector<S>,
    score: Score<S>,
}

impl<S: Scalar> Followed<S> {
    fn carry(&mut self, cell: &CellInput, dynamics: &Dynamics<S>, record: &Record<S>) {
        let score = record.score_error(cell, dynamics, &mut self.response);
        self.score.sum += score.sum;
        self.score.information += score.information;
    }

    /// Returns the score with what the window says, of which the backward pass has left that of the
    /// state before it.
    fn with(&self, window: &Adjoint<S>) -> Score<S> {
        let spread = window.information.times(&self.response);
        Score {
            sum: self.score.sum + S::dot(&self.response, &window.vector),
            information: self.score.information + S::dot(&self.response, &spread),
        }
    }
}

/// A step that is not open, of one per cent, or a change of the scale by one.
#[derive(Clone, Copy, Debug)]
struct Candidate<S> {
    /// Largest sigma of its size.
    most: f32,
    of: Followed<S>,
    /// For a step of the bias: a kink of the road at its place. For a load there is none.
    kink: Option<Followed<S>>,
}

impl<S: Scalar> Candidate<S> {
    /// Returns whether its step is no kink of the road.
    fn is_clear(&self, step: &ClosedStep, window: &Adjoint<S>, numbers: &Numbers) -> bool {
        let Some(kink) = &self.kink else { return true };
        step.exceeds(&ClosedStep::new(0, &kink.with(window)), numbers)
    }
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
            candidate.of.carry(cell, dynamics, record);
            if let Some(kink) = &mut candidate.kink {
                kink.carry(cell, dynamics, record);
            }
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
                most: Scalar::sqrt(cell.load_variance),
                of: Followed { response, score },
                kink: None,
            });
        }
        if begins {
            let follow = |indices: &[StateIndex]| {
                let mut response = [S::ZERO; STATES];
                for index in indices {
                    response[*index as usize] = S::ONE;
                }
                let score = record.score_answers(cell, &mut response);
                Followed { response, score }
            };
            self.add(Candidate {
                most: numbers.bias_shock_most_percent,
                of: follow(&[Bias, Slope]),
                kink: Some(follow(&[Slope])),
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
            let score = candidate.of.with(window);
            let step = ClosedStep::new(0, &score);
            found.add_odds(&step, score.information.to_f32(), candidate.most);
            let is_best = best.is_none_or(|(_, evidence)| step.evidence > evidence);
            if step.evidence > numbers.gate && is_best && candidate.is_clear(&step, window, numbers)
            {
                best = Some((at, step.evidence));
            }
        }
        best.map(|(at, _)| at)
    }

    /// Opens a candidate: the state is then that of a filter that allowed for the step.
    pub(super) fn open(&mut self, at: usize, state: &mut State<S>) {
        let Some(candidate) = self.0.iter().nth(at) else {
            return;
        };
        let variance = S::from_f32(candidate.most).squared();
        let Followed { response, score } = &candidate.of;
        let Score { sum, information } = *score;
        let left = variance / (S::ONE + variance * information);
        S::add_products(&mut state.mean, left * sum, response);
        state.covariance.add_square(left, response);
        let opens_load = candidate.kink.is_none();
        self.begin_anew(opens_load);
    }

    /// Forgets what was said so far: the filter explains it otherwise now. A load stays possible.
    fn begin_anew(&mut self, opens_load: bool) {
        for _ in 0..self.0.len() {
            if let Some(mut candidate) = self.0.pop_front()
                && candidate.kink.is_none()
                && !opens_load
            {
                candidate.of.score = Score {
                    sum: S::ZERO,
                    information: S::ZERO,
                };
                let _ = self.0.push_back(candidate);
            }
        }
    }
}
