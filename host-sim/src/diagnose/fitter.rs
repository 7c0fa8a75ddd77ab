//! Fits of the candidates of a menu beside effects that are adopted.

use super::candidates::Menu;
use super::case::{CandidateFit, Ground};
use super::evidence::Evidence;
use super::regression::{Basis, Regression};

/// The candidates, and the regression on the evidence for them.
pub(super) struct Fitter<'a> {
    pub(super) menu: &'a Menu,
    pub(super) regression: Regression<'a>,
}

impl<'a> Fitter<'a> {
    /// Creates the fitter. `is_held_out` selects drives by index.
    pub(super) fn new(
        menu: &'a Menu,
        evidence: &'a Evidence,
        is_held_out: impl Fn(usize) -> bool + 'a,
    ) -> Self {
        Self {
            menu,
            regression: Regression::new(evidence, is_held_out),
        }
    }

    /// Returns the case of a candidate beside adopted ones.
    pub(super) fn case(&self, adopted: &[&CandidateFit], candidate: usize) -> Option<CandidateFit> {
        let ground = Ground::of(self.basis(adopted), &self.regression)?;
        let of_menu = &self.menu.candidates[candidate];
        ground.case(&self.regression, candidate, of_menu)
    }

    /// Returns the cases of all other candidates beside adopted ones.
    pub(super) fn cases(&self, adopted: &[&CandidateFit]) -> Vec<CandidateFit> {
        let Some(ground) = Ground::of(self.basis(adopted), &self.regression) else {
            return Vec::new();
        };
        let is_taken = |index: usize| adopted.iter().any(|case| case.candidate == index);
        let candidates = self.menu.candidates.iter().enumerate();
        candidates
            .filter(|(index, _)| !is_taken(*index))
            .filter_map(|(index, candidate)| ground.case(&self.regression, index, candidate))
            .collect()
    }

    /// Returns the amounts of adopted candidates, behind the errors of sensors. A cycle has none:
    /// its phases are each drive's own.
    pub(super) fn basis(&self, adopted: &[&CandidateFit]) -> Basis {
        let errors = self.menu.sensor_errors.iter();
        let errors = errors.fold(Basis::default(), |basis, &(column, sigma)| {
            basis.with(&[vec![column]], sigma)
        });
        let adopted = adopted.iter().filter(|case| !case.choice.is_cycle());
        adopted.fold(errors, |basis, case| {
            let with = basis.with(&case.choice.amounts, case.width);
            with.with_held_out(&case.choice.held_out, case.width)
        })
    }
}
