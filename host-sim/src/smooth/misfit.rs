//! How unlikely the measurements of a run are, along the run.

use estimator_core::Scalar;
use estimator_core::filter::SmootherInput;
use estimator_core::filter::measurement::Observation;
use std::iter::Sum;
use std::ops::{Add, Range};

/// Number of cells whose measurements are summed: 1 km.
const CELLS: u32 = 400;

/// Minus twice the log-likelihood of measurements, but for a constant.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct MisfitSum {
    /// Of all measurements.
    pub all: f64,
    /// Of the altitudes.
    pub altitudes: f64,
}

impl Add for MisfitSum {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self {
            all: self.all + other.all,
            altitudes: self.altitudes + other.altitudes,
        }
    }
}

impl Sum for MisfitSum {
    fn sum<I: Iterator<Item = Self>>(sums: I) -> Self {
        sums.fold(Self::default(), Add::add)
    }
}

/// The misfit of a run, by kilometres, and the number of its altitudes.
#[derive(Clone, Debug, Default)]
pub(super) struct Misfit {
    kilometres: Vec<MisfitSum>,
    altitudes: usize,
}

impl Misfit {
    /// Adds the measurements of a step.
    pub(super) fn add<S: Scalar>(&mut self, cell: u32, step: &SmootherInput<S>) {
        let kilometre = (cell / CELLS) as usize;
        if self.kilometres.len() <= kilometre {
            self.kilometres.resize(kilometre + 1, MisfitSum::default());
        }
        let sum = &mut self.kilometres[kilometre];
        for (observation, update) in step.updates() {
            let variance = update.innovation_variance.to_f64();
            let misfit = update.innovation.to_f64().powi(2) / variance + variance.ln();
            sum.all += misfit;
            if observation == Observation::Altitude {
                sum.altitudes += misfit;
                self.altitudes += 1;
            }
        }
    }

    /// Returns the mean over all altitudes. It is not a number if there are none.
    pub(super) fn mean_of_altitudes(&self) -> f64 {
        self.total().altitudes / self.altitudes as f64
    }

    /// Returns the misfit of the run.
    pub(super) fn total(&self) -> MisfitSum {
        self.kilometres.iter().copied().sum()
    }

    /// Returns the misfit in whole kilometres, from that of the first cell to that before the end's.
    pub(super) fn within(&self, cells: Range<u32>) -> MisfitSum {
        let kilometre = |cell| ((cell / CELLS) as usize).min(self.kilometres.len());
        let range = kilometre(cells.start)..kilometre(cells.end);
        self.kilometres[range].iter().copied().sum()
    }
}
