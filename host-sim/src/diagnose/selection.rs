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
//! explains the same. Where no single candidate is left to adopt, pairs are looked
//! for: beside what is adopted, or instead of one of it.

use super::candidates::Menu;
use super::case::CandidateFit;
use super::evidence::Evidence;
use super::fitter::Fitter;
use super::pairs::{self, Instead, Pair};
use super::rivals::{SelectionStep, group, step};

/// Largest number of adopted effects.
const MOST_ADOPTED: usize = 4;
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
    fitter: Fitter<'a>,
}

impl<'a> Selector<'a> {
    /// Creates a selector. `is_held_out` selects drives by index.
    pub fn new(
        menu: &'a Menu,
        evidence: &'a Evidence,
        is_held_out: impl Fn(usize) -> bool + 'a,
    ) -> Self {
        Self {
            fitter: Fitter::new(menu, evidence, is_held_out),
        }
    }

    /// Adopts effects until the evidence for another one is too small. `first`, if given, replaces
    /// the adopted candidate of the first step, where the evidence cannot separate them.
    #[must_use]
    pub fn select(&self, first: Option<usize>) -> Selection {
        let alone = self.fitter.cases(&[]);
        let mut steps: Vec<SelectionStep> = Vec::new();
        let mut cases = alone.clone();
        for number in 0..MOST_STEPS {
            let mut found = self.forward(&steps, &cases);
            if found.is_empty() {
                found = self.exchange(&mut steps);
            }
            if found.is_empty() || steps.len() + found.len() > MOST_ADOPTED {
                break;
            }
            if let (Some(first), 0, [only]) = (first, number, &mut found[..]) {
                only.lead(first);
            }
            let latest: Vec<usize> = found.iter().map(|s| s.adopted.candidate).collect();
            steps.extend(found);
            self.drop_superfluous(&mut steps, &latest);
            cases = self.fitter.cases(&adopted(&steps));
        }
        self.conclude(&mut steps);
        let regression = &self.fitter.regression;
        let explained = regression.bayes(&self.fitter.basis(&adopted(&steps)), 1.0);
        Selection {
            negative_log_likelihood: regression.negative_log_likelihood()
                - explained.unwrap_or_default(),
            steps,
            alone,
        }
    }

    /// Returns the next step, or the two of a pair; none if nothing is to be adopted.
    fn forward(&self, steps: &[SelectionStep], cases: &[CandidateFit]) -> Vec<SelectionStep> {
        if let Some(step) = step(cases, self.fitter.menu) {
            return vec![step];
        }
        let pair = pairs::best(&self.fitter, &adopted(steps), cases);
        let steps = pair.into_iter().flat_map(|pair| pair.cases);
        steps.map(SelectionStep::from).collect()
    }

    /// Takes out an effect that a pair of others replaces; returns the steps of the pair.
    fn exchange(&self, steps: &mut Vec<SelectionStep>) -> Vec<SelectionStep> {
        if steps.len() >= MOST_ADOPTED {
            return Vec::new();
        }
        for index in 0..steps.len() {
            if steps[index].adopted.choice.is_cycle() {
                continue;
            }
            let better = self
                .instead(steps, index)
                .into_iter()
                .find_map(|(pair, is)| matches!(is, Instead::Better).then_some(pair));
            if let Some(pair) = better {
                steps.remove(index);
                return pair.cases.map(SelectionStep::from).to_vec();
            }
        }
        Vec::new()
    }

    /// Returns pairs of other candidates, the most likely first, and what they are to an adopted
    /// one.
    fn instead(&self, steps: &[SelectionStep], index: usize) -> Vec<(Pair, Instead)> {
        let beside = others(steps, index);
        let candidate = steps[index].adopted.candidate;
        let mut cases = self.fitter.cases(&beside);
        let Some(own) = cases.iter().position(|case| case.candidate == candidate) else {
            return Vec::new();
        };
        let own = cases.remove(own);
        let count = self.fitter.menu.candidates.len();
        let pairs = pairs::fitted(&self.fitter, &beside, &cases).into_iter();
        pairs
            .map(|pair| {
                let is = pair.instead_of(&own, count);
                (pair, is)
            })
            .collect()
    }

    /// Drops effects that those adopted after them explain. The latest ones stay.
    fn drop_superfluous(&self, steps: &mut Vec<SelectionStep>, latest: &[usize]) {
        let stays = |step: &SelectionStep| {
            latest.contains(&step.adopted.candidate) || step.adopted.choice.is_cycle()
        };
        loop {
            let earlier = (0..steps.len()).filter(|&index| !stays(&steps[index]));
            let evidence = |index: usize| Some((index, self.again(steps, index)?.evidence));
            let weakest = earlier
                .filter_map(evidence)
                .min_by(|a, b| a.1.total_cmp(&b.1));
            match weakest {
                Some((index, evidence)) if evidence < SUPERFLUOUS => drop(steps.remove(index)),
                _ => return,
            }
        }
    }

    /// Returns the case of an adopted effect, given all others that are adopted.
    fn again(&self, steps: &[SelectionStep], index: usize) -> Option<CandidateFit> {
        let candidate = steps[index].adopted.candidate;
        self.fitter.case(&others(steps, index), candidate)
    }

    /// Gives each step the evidence, the amounts and the group of its effect, given all others.
    fn conclude(&self, steps: &mut [SelectionStep]) {
        for index in 0..steps.len() {
            if steps[index].adopted.choice.is_cycle() {
                continue;
            }
            let as_good = self.instead(steps, index).into_iter();
            steps[index].pairs = as_good
                .filter(|(_, is)| !matches!(is, Instead::Worse))
                .map(|(pair, _)| pair.cases.map(|case| case.candidate))
                .collect();
            if steps.len() == 1 {
                continue;
            }
            let cases = self.fitter.cases(&others(steps, index));
            let candidate = steps[index].adopted.candidate;
            if let Some(own) = cases.iter().find(|case| case.candidate == candidate) {
                steps[index].group = group(own, &cases, self.fitter.menu);
                steps[index].adopted.evidence = own.evidence;
            }
        }
        self.refit(steps);
    }

    /// Fits the amounts of all adopted effects together.
    fn refit(&self, steps: &mut [SelectionStep]) {
        let basis = self.fitter.basis(&adopted(steps));
        let mut from = self.fitter.menu.sensor_errors.len();
        if basis.size() == from {
            return;
        }
        let Some(fit) = self.fitter.regression.fit(&basis) else {
            return;
        };
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

fn adopted(steps: &[SelectionStep]) -> Vec<&CandidateFit> {
    steps.iter().map(|step| &step.adopted).collect()
}

/// Returns what is adopted beside one of the steps.
fn others(steps: &[SelectionStep], index: usize) -> Vec<&CandidateFit> {
    let mut others = adopted(steps);
    others.remove(index);
    others
}
