//! Selection of effects on the evidence.
//!
//! Steps forward by Bayes factors. The normal prior of a candidate's amount has the usual size
//! of such amounts as its standard deviation. An effect that explains little is therefore not
//! adopted, and a candidate with many choices needs more evidence (R. E. Kass and A. E. Raftery,
//! "Bayes factors", J. Am. Stat. Assoc. 90:773, 1995). Estimates are generalised least squares.
//! Where scores scatter from segment to segment more than the model predicts, the evidence is
//! divided by that ratio.
//!
//! Each step forward may be followed by steps backward: an effect goes if what was adopted after it
//! explains the same. Where no single candidate is left to adopt, [`pairs`](super::pairs) are.

use super::candidates::Menu;
use super::case::{CandidateFit, Ground};
use super::evidence::Evidence;
use super::pairs;
use super::regression::{Basis, Regression};
use super::rivals::{SelectionStep, group, step};

/// Largest number of adopted effects.
pub(super) const MOST_ADOPTED: usize = 4;
/// Largest number of steps forward. Steps backward make room for more than are adopted.
const MOST_STEPS: usize = 2 * MOST_ADOPTED;
/// An effect is dropped if its evidence, given the effects adopted after it, is below this: it is
/// then less likely than no effect.
const SUPERFLUOUS: f64 = 0.0;

/// Result of a selection.
#[derive(Clone, Debug, Default)]
pub struct Selection {
    /// The steps, in the order of adoption.
    pub steps: Vec<SelectionStep>,
    /// Every candidate before the first step.
    pub alone: Vec<CandidateFit>,
    /// Minus twice the log likelihood of the drives to fit, with the adopted candidates.
    pub negative_log_likelihood: f64,
}

/// Selection among the candidates of a menu.
pub struct Selector<'a> {
    pub(super) menu: &'a Menu,
    pub(super) regression: Regression<'a>,
}

impl<'a> Selector<'a> {
    /// Creates a selector. `is_held_out` selects drives by index.
    pub fn new(
        menu: &'a Menu,
        evidence: &'a Evidence,
        is_held_out: impl Fn(usize) -> bool + 'a,
    ) -> Self {
        Self {
            menu,
            regression: Regression::new(evidence, is_held_out),
        }
    }

    /// Adopts effects until the evidence for another one is too small. `first`, if given, replaces
    /// the adopted candidate of the first step, where the evidence cannot separate them.
    #[must_use]
    pub fn select(&self, first: Option<usize>) -> Selection {
        let mut selection = Selection {
            alone: self.cases(&[]),
            ..Selection::default()
        };
        let mut cases = selection.alone.clone();
        let steps = &mut selection.steps;
        for number in 0..MOST_STEPS {
            let mut found: Vec<SelectionStep> = step(&cases, self.menu).into_iter().collect();
            if found.is_empty() {
                found = pairs::best(self, steps, &cases);
            }
            if found.is_empty() || steps.len() + found.len() > MOST_ADOPTED {
                break;
            }
            if let (Some(first), 0, [only]) = (first, number, &mut found[..]) {
                only.lead(first);
            }
            let latest: Vec<usize> = found.iter().map(|s| s.adopted.candidate).collect();
            steps.extend(found);
            self.drop_superfluous(steps, &latest);
            cases = self.cases(steps);
        }
        self.conclude(steps);
        let basis = basis(steps);
        let explained = self.regression.bayes(&basis, 1.0).unwrap_or_default();
        selection.negative_log_likelihood = self.regression.negative_log_likelihood() - explained;
        selection
    }

    /// Drops effects that those adopted after them explain. The latest ones stay.
    fn drop_superfluous(&self, steps: &mut Vec<SelectionStep>, latest: &[usize]) {
        while let Some(worst) = self.superfluous(steps, latest) {
            steps.remove(worst);
        }
    }

    fn superfluous(&self, steps: &[SelectionStep], latest: &[usize]) -> Option<usize> {
        let evidence = |index: usize| {
            let adopted = &steps[index].adopted;
            let stays = latest.contains(&adopted.candidate) || adopted.choice.is_cycle();
            if stays {
                return None;
            }
            let case = self.again(steps, index)?;
            Some((index, case.evidence))
        };
        let worst = (0..steps.len())
            .filter_map(evidence)
            .min_by(|a, b| a.1.total_cmp(&b.1))?;
        (worst.1 < SUPERFLUOUS).then_some(worst.0)
    }

    /// Returns the case of an adopted effect, given all others that are adopted.
    fn again(&self, steps: &[SelectionStep], index: usize) -> Option<CandidateFit> {
        let candidate = steps[index].adopted.candidate;
        self.case(&self.ground(&without(steps, index))?, candidate)
    }

    /// Gives each step the evidence, the amounts and the group of its effect, given all others.
    fn conclude(&self, steps: &mut [SelectionStep]) {
        if steps.len() > 1 {
            for index in 0..steps.len() {
                if steps[index].adopted.choice.is_cycle() {
                    continue;
                }
                let others = without(steps, index);
                let cases = self.cases(&others);
                let candidate = steps[index].adopted.candidate;
                if let Some(own) = cases.iter().find(|case| case.candidate == candidate) {
                    steps[index].group = group(own, &cases, self.menu);
                    steps[index].adopted.evidence = own.evidence;
                }
            }
        }
        self.refit(steps);
    }

    /// Returns the fit of adopted effects, on which others are judged.
    pub(super) fn ground(&self, steps: &[SelectionStep]) -> Option<Ground> {
        Ground::of(basis(steps), &self.regression)
    }

    /// Returns the case of a candidate.
    pub(super) fn case(&self, ground: &Ground, candidate: usize) -> Option<CandidateFit> {
        let of_menu = &self.menu.candidates[candidate];
        ground.case(&self.regression, candidate, of_menu)
    }

    /// Returns the cases of all candidates that are not adopted.
    fn cases(&self, steps: &[SelectionStep]) -> Vec<CandidateFit> {
        let Some(ground) = self.ground(steps) else {
            return Vec::new();
        };
        let is_taken = |index: &usize| steps.iter().any(|s| s.adopted.candidate == *index);
        let candidates = (0..self.menu.candidates.len()).filter(|index| !is_taken(index));
        candidates
            .filter_map(|index| self.case(&ground, index))
            .collect()
    }

    /// Fits the amounts of all adopted effects together.
    fn refit(&self, steps: &mut [SelectionStep]) {
        let basis = basis(steps);
        if basis.size() == 0 {
            return;
        }
        let Some(fit) = self.regression.fit(&basis) else {
            return;
        };
        let mut from = 0;
        for step in steps {
            if step.adopted.choice.is_cycle() {
                continue;
            }
            let count = step.adopted.amounts.len();
            step.adopted.amounts = (from..from + count).map(|i| fit.amounts[i]).collect();
            let own = fit.covariance.view((from, from), (count, count));
            step.adopted.covariance = own.into_owned();
            from += count;
        }
    }
}

/// Returns the amounts of adopted effects. A cycle has none: its phases are each drive's own.
pub(super) fn basis(steps: &[SelectionStep]) -> Basis {
    let adopted = steps.iter().map(|step| &step.adopted);
    adopted
        .filter(|case| !case.choice.is_cycle())
        .fold(Basis::default(), |basis, case| {
            basis.with(&case.choice.amounts, case.width)
        })
}

fn without(steps: &[SelectionStep], index: usize) -> Vec<SelectionStep> {
    let mut others = steps.to_vec();
    others.remove(index);
    others
}
