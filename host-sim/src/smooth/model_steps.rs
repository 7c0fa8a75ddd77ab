//! Steps of the vehicle model's error, which a whole run shows.
//!
//! Snow begins, a power take-off is switched on, the wind turns. The filter is certain of it after
//! kilometres, and until then it reads slopes that the road does not have. The measurements of the
//! whole run show the cell of the step to some ten metres. λ of the backward pass is the score of a
//! step at each cell, and its square over Λ is the test ratio (P. de Jong and J. Penzer, "Diagnosing
//! shocks in time series", Journal of the American Statistical Association 93:796, 1998).
//!
//! The cell with the largest test ratio is tried: the filter goes over the run again, and allows for a
//! step there. The step stays if the measurements become as much more likely as the test ratio says,
//! and the altitudes alone become more likely too. If the altitudes do not, the road has a kink there.
//! If the gain is much larger, it has another cause: with the step the filter learned another noise
//! of the receiver.

use super::misfit::Misfit;
use std::ops::RangeInclusive;

/// Least test ratio of a step: five sigmas, since the cell is the best one of some ten thousand.
const LEAST_TEST_RATIO: f64 = 25.0;
/// Gain over the test ratio of a step that stays. In a linear filter it is one.
const GAIN: RangeInclusive<f64> = 0.5..=2.0;
/// Least gain of the altitudes alone.
const LEAST_ALTITUDE_GAIN: f64 = 3.0;
/// Least number of cells between two steps that are tried at once, 50 km. The measurements from the
/// first to the second one judge the first. Over less, what a step of another kind gains looks like
/// what its test ratio says.
const APART_CELLS: u32 = 20_000;
/// Number of cells on both sides of a tried one in which no other is tried: 100 m.
const NEAR_CELLS: u32 = 40;

/// The steps that are allowed for, and those that are being tried.
#[derive(Clone, Debug, Default)]
pub(super) struct ModelSteps {
    /// Cells at whose end there is a step.
    allowed: Vec<u32>,
    refused: Vec<u32>,
    /// The last one of the run first.
    suggested: Vec<Suggestion>,
}

#[derive(Clone, Copy, Debug)]
struct Suggestion {
    cell: u32,
    test_ratio: f64,
}

impl ModelSteps {
    /// Returns whether the filter allows for a step at the end of this cell.
    pub(super) fn contain(&self, cell: u32) -> bool {
        let mut suggested = self.suggested.iter().map(|step| step.cell);
        self.allowed.contains(&cell) || suggested.any(|other| other == cell)
    }

    /// Returns whether there are steps to try.
    pub(super) const fn are_suggested(&self) -> bool {
        !self.suggested.is_empty()
    }

    /// Takes the test ratio of a step at the end of a cell. Cells come from the last one to the first.
    pub(super) fn suggest(&mut self, cell: u32, test_ratio: f64) {
        let mut tried = self.allowed.iter().chain(&self.refused);
        if test_ratio < LEAST_TEST_RATIO || tried.any(|other| other.abs_diff(cell) < NEAR_CELLS) {
            return;
        }
        let step = Suggestion { cell, test_ratio };
        match self.suggested.last_mut() {
            Some(last) if last.cell - cell < APART_CELLS => {
                if test_ratio > last.test_ratio {
                    *last = step;
                }
            }
            _ => self.suggested.push(step),
        }
    }

    /// Decides which of the suggested steps stay, from the misfit of the run without them and with
    /// them. Returns whether any of them stays.
    pub(super) fn judge(&mut self, without: &Misfit, with: &Misfit) -> bool {
        let allowed = self.allowed.len();
        let mut end = u32::MAX;
        for Suggestion { cell, test_ratio } in self.suggested.drain(..) {
            let (without, with) = (without.within(cell..end), with.within(cell..end));
            end = cell;
            let stays = GAIN.contains(&((without.all - with.all) / test_ratio))
                && without.altitudes - with.altitudes >= LEAST_ALTITUDE_GAIN;
            if stays {
                self.allowed.push(cell);
            } else {
                self.refused.push(cell);
            }
        }
        self.allowed.len() > allowed
    }
}
