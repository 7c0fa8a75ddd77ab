//! Steps of the vehicle model's error, which a whole run shows.
//!
//! Snow begins, a power take-off is switched on, the wind turns. The filter is certain of it after
//! kilometres, and until then it reads slopes that the road does not have. The measurements of the
//! whole run show the cell of the step to some ten metres. λ of the backward pass is the score of a
//! step at each cell, and its square over Λ is the test ratio (P. de Jong and J. Penzer, "Diagnosing
//! shocks in time series", Journal of the American Statistical Association 93:796, 1998).
//!
//! The cell with the largest test ratio is tried. The filter goes over the run twice more: with a step
//! of open size there, and with the likely size as a force from there on. The step stays if one of the
//! two makes the measurements as much more likely as the test ratio says, and the altitudes alone more
//! likely too. If the altitudes do not become so, the road has a kink there. If the gain is much
//! larger, it has another cause: with the step the filter learned another noise of the receiver.
//!
//! At the end the run with the forces of all steps is compared with the one that leaves the sizes open.
//! The forces have an advantage: the levels of the errors are learned beside them, and so the bias
//! is not taken for one that varies as much as it stepped.

use super::disagreements::Disagreements;
use super::misfit::Misfit;
use estimator_core::Uncertain;
use estimator_core::sample::Sample;
use std::ops::RangeInclusive;

/// Least test ratio of a step: six sigmas, since the cell is the best one of some ten thousand.
const LEAST_TEST_RATIO: f64 = 36.0;
/// Gain over the test ratio of a step that stays. In a linear filter it is one.
const GAIN: RangeInclusive<f64> = 0.5..=2.0;
/// Least gain of the altitudes alone, and over the test ratio. A signal that is wrong for a while gains
/// as much for the speeds, and nothing for the altitudes.
const LEAST_ALTITUDE_GAIN: f64 = 3.0;
const LEAST_ALTITUDE_PART: f64 = 0.08;
/// Least number of cells between two steps that are tried at once, 50 km. The measurements from the
/// first to the second one judge the first. Over less, what a step of another kind gains looks like
/// what its test ratio says.
const APART_CELLS: u32 = 20_000;
/// Number of cells on both sides of a step without another one that was tried, and in which no signal
/// disagrees: 1 km. What is wrong at two places so near, or where a signal is wrong, is not the model.
const ALONE_CELLS: u32 = 400;

/// The steps that are known, and those that are being tried.
#[derive(Clone, Debug, Default)]
pub(super) struct ModelSteps {
    known: Vec<ModelStep>,
    /// The last one of the run first.
    suggested: Vec<ModelStep>,
    /// Which of them are forces. The sizes of the others are left open.
    forces: Forces,
    /// Cells of the steps that did not stay.
    refused: Vec<u32>,
}

/// The steps that are taken as forces.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Forces {
    /// None.
    #[default]
    None,
    /// Those that are being tried.
    Suggested,
    /// Those that are known.
    Known,
}

/// A step at the end of a cell.
#[derive(Clone, Copy, Debug)]
struct ModelStep {
    cell: u32,
    /// How much more slope the model reads too high behind than before, %, as far as it is known.
    size_percent: f32,
    /// The same as a part of the weight that the traction has too much, %.
    traction_percent: f32,
    test_ratio: f64,
}

impl ModelSteps {
    fn all(&self) -> impl Iterator<Item = &ModelStep> {
        self.known.iter().chain(&self.suggested)
    }

    /// Returns whether there is a step at the end of this cell.
    pub(super) fn contain(&self, cell: u32) -> bool {
        self.all().any(|step| step.cell == cell)
    }

    /// Returns the sum of the steps that are forces before the end of a cell, %.
    pub(super) fn sum_percent(&self, cell: u32) -> f32 {
        self.before(cell).map(|step| step.size_percent).sum()
    }

    /// Returns the sample with the forces of the steps before.
    pub(super) fn without(&self, mut sample: Sample) -> Sample {
        let steps = self.before(sample.end.cell);
        let percent: f32 = steps.map(|step| step.traction_percent).sum();
        sample.forces.traction_n -= 0.01 * percent * sample.forces.weight_n();
        sample
    }

    fn before(&self, cell: u32) -> impl Iterator<Item = &ModelStep> {
        let sized: &[ModelStep] = match self.forces {
            Forces::None => &[],
            Forces::Suggested => &self.suggested,
            Forces::Known => &self.known,
        };
        sized.iter().filter(move |step| step.cell < cell)
    }

    /// Takes these steps as forces from now on.
    pub(super) const fn take_as_forces(&mut self, forces: Forces) {
        self.forces = forces;
    }

    /// Returns whether no step is known.
    pub(super) const fn is_empty(&self) -> bool {
        self.known.is_empty()
    }

    /// Returns the number of steps to try.
    pub(super) const fn suggested(&self) -> usize {
        self.suggested.len()
    }

    /// Takes the step that is likely at the end of a cell. Cells come from the last one to the first.
    pub(super) fn suggest(
        &mut self,
        cell: u32,
        size_percent: Uncertain,
        scale: impl Fn() -> f32,
        disagreements: &Disagreements,
    ) {
        let test_ratio = f64::from(size_percent.value / size_percent.sigma).powi(2);
        let nearby = cell.saturating_sub(ALONE_CELLS)..=cell.saturating_add(ALONE_CELLS);
        let known = self.known.iter().map(|step| step.cell);
        let mut tried = known.chain(self.refused.iter().copied());
        if test_ratio < LEAST_TEST_RATIO
            || tried.any(|other| other.abs_diff(cell) < ALONE_CELLS)
            || disagreements.signals_disagree(&nearby)
        {
            return;
        }
        let step = ModelStep {
            cell,
            size_percent: size_percent.value,
            traction_percent: size_percent.value / scale(),
            test_ratio,
        };
        match self.suggested.last_mut() {
            Some(last) if last.cell - cell < APART_CELLS => {
                if test_ratio > last.test_ratio {
                    *last = step;
                }
            }
            _ => self.suggested.push(step),
        }
    }

    /// Decides which of the suggested steps stay, from the misfit of the run without them and of the
    /// trials with them. Returns how many of them stay.
    pub(super) fn judge(&mut self, without: &Misfit, trials: [&Misfit; 2]) -> usize {
        let known = self.known.len();
        let mut end = u32::MAX;
        for step in self.suggested.drain(..) {
            let cells = step.cell..end;
            end = step.cell;
            let without = without.within(cells.clone());
            let least_altitude_gain =
                LEAST_ALTITUDE_GAIN.max(LEAST_ALTITUDE_PART * step.test_ratio);
            let stays = trials.iter().any(|trial| {
                let with = trial.within(cells.clone());
                GAIN.contains(&((without.all - with.all) / step.test_ratio))
                    && without.altitudes - with.altitudes >= least_altitude_gain
            });
            if stays {
                self.known.push(step);
            } else {
                self.refused.push(step.cell);
            }
        }
        self.known.len() - known
    }
}
