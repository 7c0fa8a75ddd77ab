//! Selection of effects on the evidence.
//!
//! Forward selection by Bayes factors. The normal prior of a candidate's amount has the usual size
//! of such amounts as its standard deviation. An effect that explains little is therefore not
//! adopted, and a candidate with many choices needs more evidence (R. E. Kass and A. E. Raftery,
//! "Bayes factors", J. Am. Stat. Assoc. 90:773, 1995). Estimates are generalised least squares.
//! Where scores scatter from segment to segment more than the model predicts, the evidence is
//! divided by that ratio.

use super::candidates::{Candidate, Choice, Detail, Menu};
use super::evidence::Evidence;
use super::regression::{Basis, Regression};
use estimator_core::effect::search_of;
use nalgebra::{DMatrix, DVector};

/// An effect is adopted from this evidence on: twice the logarithm of its odds against no effect,
/// corrected for the number of candidates.
pub const ADOPTED: f64 = 3.0;
/// Candidates whose evidence is within this of the best cannot be separated from it: 20 to 1.
const SEPARATED: f64 = 6.0;
/// A parameter of the base model is preferred if other candidates are better by at most this.
const PREFERENCE: f64 = 2.0;
/// Width of a prior that leaves an amount free, as a multiple of its usual size.
const FREE: f64 = 100.0;
/// Largest width of a prior, as a multiple of the usual size.
const UNUSUAL: f64 = 4.0;
/// Largest number of adopted effects.
const MOST_ADOPTED: usize = 4;

/// Fit of one candidate, given the effects that are already adopted.
#[derive(Clone, Debug)]
pub struct CandidateFit {
    /// Index of the candidate.
    pub candidate: usize,
    /// Index of the best of its choices.
    pub choice: usize,
    /// Estimates of its amounts.
    pub amounts: Vec<f64>,
    /// Their sigmas.
    pub sigmas: Vec<f64>,
    /// Twice the logarithm of the Bayes factor against not having it.
    pub evidence: f64,
    /// Twice the gain in log likelihood, without the prior.
    pub gain: f64,
    /// Ratio of its score's scatter (squared) to that of the model. Evidence and gain are divided
    /// by it.
    pub scatter: f64,
    /// Standard deviation of the prior of each amount.
    pub width: f64,
    /// Twice the gain in log likelihood on the drives held out, with the amounts fitted on the
    /// others.
    pub held_out: f64,
}

impl CandidateFit {
    /// Returns the gain for a common scatter. A candidate with an amount for each drive has no
    /// scatter from drive to drive. Two cases are therefore compared at the same scatter.
    fn gain_at(&self, scatter: f64) -> f64 {
        self.gain * self.scatter / scatter
    }

    /// Returns the evidence for a common scatter.
    fn evidence_at(&self, scatter: f64) -> f64 {
        self.evidence - self.gain + self.gain_at(scatter)
    }
}

/// One step of the selection: the adopted candidate and its rivals.
#[derive(Clone, Debug)]
pub struct SelectionStep {
    /// The adopted candidate.
    pub adopted: CandidateFit,
    /// Other candidates that the data cannot separate from it.
    pub group: Vec<CandidateFit>,
}

impl SelectionStep {
    /// Exchanges the adopted candidate for another of the group.
    fn lead(&mut self, candidate: usize) {
        let same = |case: &CandidateFit| case.candidate == candidate;
        if let Some(index) = self.group.iter().position(same) {
            std::mem::swap(&mut self.adopted, &mut self.group[index]);
        }
    }
}

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

/// The adopted effects and their fit.
struct Ground {
    basis: Basis,
    /// Amounts of the columns.
    columns: DVector<f64>,
    /// Twice the gain in log likelihood, on the drives to fit and on those held out.
    explained: f64,
    held_out: f64,
    /// Twice the logarithm of the Bayes factor, with the scatter that the model predicts.
    bayes: f64,
}

/// Selection among the candidates of a menu.
pub struct Selector<'a> {
    menu: &'a Menu,
    regression: Regression<'a>,
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

    /// Adopts one effect after the other until the evidence for the next is too small. `first`, if
    /// given, replaces the adopted candidate of the first step, where the evidence cannot separate
    /// them.
    #[must_use]
    pub fn select(&self, first: Option<usize>) -> Selection {
        let mut basis = Basis::default();
        let mut selection = Selection {
            alone: self.cases(&basis, &[]),
            ..Selection::default()
        };
        let mut cases = selection.alone.clone();
        let mut taken: Vec<usize> = Vec::new();
        while let Some(mut step) = step(&cases, self.menu).filter(|_| taken.len() < MOST_ADOPTED) {
            if let Some(first) = first.filter(|_| taken.is_empty()) {
                step.lead(first);
            }
            let choice = self.choice(&step.adopted);
            taken.push(step.adopted.candidate);
            if choice.is_cycle() {
                // The phases of a cycle are each drive's own.
                cases.retain(|case| !taken.contains(&case.candidate));
            } else {
                basis = basis.with(&choice.amounts, step.adopted.width);
                cases = self.cases(&basis, &taken);
            }
            selection.steps.push(step);
        }
        let explained = self.regression.bayes(&basis, 1.0).unwrap_or_default();
        selection.negative_log_likelihood = self.regression.negative_log_likelihood() - explained;
        self.refit(&basis, &mut selection.steps);
        selection
    }

    fn choice(&self, case: &CandidateFit) -> &Choice {
        &self.menu.candidates[case.candidate].choices[case.choice]
    }

    fn ground(&self, basis: &Basis) -> Option<Ground> {
        let columns = if basis.size() == 0 {
            DVector::zeros(self.menu.width())
        } else {
            let fit = self.regression.fit(basis)?;
            self.regression.columns(basis, &fit.amounts)
        };
        Some(Ground {
            explained: self.regression.explained(basis),
            held_out: self.regression.held_out(&columns),
            bayes: self.regression.bayes(basis, 1.0)?,
            basis: basis.clone(),
            columns,
        })
    }

    fn cases(&self, basis: &Basis, taken: &[usize]) -> Vec<CandidateFit> {
        let Some(ground) = self.ground(basis) else {
            return Vec::new();
        };
        let candidates = self.menu.candidates.iter().enumerate();
        candidates
            .filter(|(index, _)| !taken.contains(index))
            .filter_map(|(index, candidate)| self.case(&ground, index, candidate))
            .collect()
    }

    /// Returns the fit of the best choice of a candidate.
    fn case(&self, ground: &Ground, index: usize, candidate: &Candidate) -> Option<CandidateFit> {
        if candidate.choices.first()?.is_cycle() {
            return self.cycle(ground, index, candidate);
        }
        let (basis, regression) = (&ground.basis, &self.regression);
        let gain = |choice: &Choice| -> Option<f64> {
            let with = basis.with(&choice.amounts, candidate.typical);
            Some(regression.bayes(&with, 1.0)? - ground.bayes)
        };
        let gains: Vec<(usize, f64)> = candidate
            .choices
            .iter()
            .enumerate()
            .filter_map(|(i, choice)| Some((i, gain(choice)?)))
            .collect();
        let (choice, best) = gains.iter().copied().max_by(|a, b| a.1.total_cmp(&b.1))?;
        // All choices have equal prior probability: the mean of their Bayes factors counts.
        let relative = gains.iter().map(|(_, gain)| (0.5 * (gain - best)).exp());
        let mean = relative.sum::<f64>() / candidate.choices.len() as f64;
        let amounts = &candidate.choices[choice].amounts;
        let own = basis.size()..basis.size() + amounts.len();
        // The prior's width is the usual size. Faults are unusual: if this amount is larger, the
        // width is that amount, up to a few times the usual size.
        let free = regression.fit(&basis.with(amounts, FREE * candidate.typical))?;
        let square: f64 = own.clone().map(|i| free.amounts[i].powi(2)).sum();
        let size = (square / amounts.len() as f64).sqrt();
        let width = size.clamp(candidate.typical, UNUSUAL * candidate.typical);
        let with = basis.with(amounts, width);
        let fit = regression.fit(&with)?;
        let bayes = regression.bayes(&with, fit.scatter)? - regression.bayes(basis, fit.scatter)?;
        Some(CandidateFit {
            candidate: index,
            choice,
            amounts: own.clone().map(|i| fit.amounts[i]).collect(),
            sigmas: own.map(|i| fit.covariance[(i, i)].sqrt()).collect(),
            evidence: bayes + 2.0 * mean.ln(),
            gain: (regression.explained(&with) - ground.explained) / fit.scatter,
            scatter: fit.scatter,
            width,
            held_out: regression.held_out(&regression.columns(&with, &fit.amounts))
                - ground.held_out,
        })
    }

    /// Returns the fit of a cycle. Its phase differs between drives, so each drive is fitted alone.
    fn cycle(&self, ground: &Ground, index: usize, candidate: &Candidate) -> Option<CandidateFit> {
        let drives = self.regression.drives(&ground.columns);
        let prior = DMatrix::from_diagonal_element(2, 2, candidate.typical.powi(-2));
        // Gains on drives to fit and held out, and the mean square of the size.
        let gain = |choice: &Choice| -> Option<([f64; 2], f64)> {
            let mut gains = [0.0; 2];
            let mut square = 0.0;
            for drive in &drives {
                let (own, score) = drive.of(&choice.amounts);
                let inverse = (&own + &prior).try_inverse()?;
                let amounts = &inverse * &score;
                let determinant = ((&own + &prior) / prior[(0, 0)]).determinant();
                gains[usize::from(drive.held_out)] += score.dot(&amounts) - determinant.ln();
                square += amounts.norm_squared() / drives.len() as f64;
            }
            Some((gains, square))
        };
        let gains: Vec<([f64; 2], f64)> =
            candidate.choices.iter().map(gain).collect::<Option<_>>()?;
        let (choice, best) = gains
            .iter()
            .enumerate()
            .max_by(|a, b| a.1.0[0].total_cmp(&b.1.0[0]))?;
        let relative = gains.iter().map(|g| (0.5 * (g.0[0] - best.0[0])).exp());
        let mean = relative.sum::<f64>() / gains.len() as f64;
        Some(CandidateFit {
            candidate: index,
            choice,
            amounts: vec![best.1.sqrt()],
            sigmas: vec![0.0],
            evidence: best.0[0] + 2.0 * mean.ln(),
            gain: best.0[0],
            scatter: 1.0,
            width: candidate.typical,
            held_out: best.0[1],
        })
    }

    /// Fits the amounts of all adopted effects together.
    fn refit(&self, basis: &Basis, steps: &mut [SelectionStep]) {
        if basis.size() == 0 {
            return;
        }
        let Some(fit) = self.regression.fit(basis) else {
            return;
        };
        let mut i = 0;
        for step in steps {
            if self.choice(&step.adopted).is_cycle() {
                continue;
            }
            for k in 0..step.adopted.amounts.len() {
                step.adopted.amounts[k] = fit.amounts[i];
                step.adopted.sigmas[k] = fit.covariance[(i, i)].sqrt();
                i += 1;
            }
        }
    }
}

/// Returns the step that the cases justify, if any.
fn step(cases: &[CandidateFit], menu: &Menu) -> Option<SelectionStep> {
    let price = 2.0 * (menu.candidates.len() as f64).ln();
    let asked = |case: &&CandidateFit| {
        case.evidence - price >= ADOPTED && case.held_out > -1.0 && is_possible(case, menu)
    };
    let best = cases
        .iter()
        .filter(asked)
        .max_by(by(|case| case.evidence_at(1.0)))?;
    let rivals: Vec<&CandidateFit> = cases
        .iter()
        .filter(|case| is_rival(case, best) && is_possible(case, menu))
        .collect();
    // Among candidates that the fitted drives cannot separate, the drives held out decide. If they
    // do not either, a parameter of the base model comes first.
    let scatter = rivals.iter().map(|case| case.scatter).fold(1.0, f64::max);
    let merit = |case: &CandidateFit| {
        let effect = menu.candidates[case.candidate].effect;
        let is_base = effect
            .and_then(search_of)
            .is_some_and(|search| search.is_base_parameter);
        case.evidence_at(scatter) + case.held_out + if is_base { PREFERENCE } else { 0.0 }
    };
    let adopted = *rivals
        .iter()
        .filter(|case| asked(case))
        .max_by(|a, b| merit(a).total_cmp(&merit(b)))?;
    let group = rivals
        .iter()
        .filter(|case| case.candidate != adopted.candidate)
        .map(|&case| case.clone())
        .collect();
    Some(SelectionStep {
        adopted: adopted.clone(),
        group,
    })
}

/// Returns whether the drives cannot separate a case from the best one: its evidence is close to
/// the best, or its gain without the prior is.
fn is_rival(case: &CandidateFit, best: &CandidateFit) -> bool {
    let scatter = best.scatter.max(case.scatter);
    let is_usual = |amount: &f64| amount.abs() <= 1.5 * case.width;
    let fits_as_well = best.evidence_at(scatter) - case.evidence_at(scatter) <= SEPARATED
        || (best.gain_at(scatter) - case.gain_at(scatter) <= SEPARATED
            && case.amounts.len() <= best.amounts.len()
            && case.amounts.iter().all(is_usual));
    // A case that is less likely than no effect is no rival.
    fits_as_well && case.evidence > 0.0
}

fn by(
    value: impl Fn(&CandidateFit) -> f64,
) -> impl Fn(&&CandidateFit, &&CandidateFit) -> std::cmp::Ordering {
    move |a, b| value(a).total_cmp(&value(b))
}

/// Returns whether a vehicle can have the effect.
fn is_possible(case: &CandidateFit, menu: &Menu) -> bool {
    let candidate = &menu.candidates[case.candidate];
    let Some(range) = candidate.effect.map(|effect| effect.range) else {
        return true;
    };
    match candidate.choices[case.choice].detail {
        // On each drive the effect is present or absent; it has no negative amount.
        Detail::EachDrive(..) => {
            let mut amounts = case.amounts.iter().zip(&case.sigmas);
            amounts.all(|(amount, sigma)| *amount > -1.5 * sigma && range.holds(*amount as f32))
        }
        _ => {
            let square: f64 = case.amounts.iter().map(|a| a * a).sum();
            let size = if case.amounts.len() == 1 {
                case.amounts[0]
            } else {
                square.sqrt()
            };
            range.holds(size as f32)
        }
    }
}
