//! Which effects the evidence asks for.
//!
//! Forward selection by Bayes factors: each candidate's amount has a normal prior as wide as such
//! amounts usually are, so that an effect is not adopted for explaining a little, and choices are
//! paid for (R. E. Kass and A. E. Raftery, "Bayes factors", J. Am. Stat. Assoc. 90:773, 1995).
//! Estimates are generalised least squares; where scores scatter from segment to segment more than
//! the model says, the evidence counts that much less.

use super::candidates::{Candidate, Choice, Detail, Menu};
use super::evidence::Evidence;
use super::regression::{Basis, Regression};
use estimator_core::effect::search_of;
use nalgebra::{DMatrix, DVector};

/// Twice the logarithm of the odds from which an effect is adopted, against nothing and after the
/// number of candidates is paid for.
pub const ADOPTED: f64 = 3.0;
/// Candidates whose evidence is within this of the best cannot be separated from it: 20 to 1.
pub const TOLD_APART: f64 = 6.0;
/// A parameter of the base model is preferred where others are better by no more than this.
const PREFERENCE: f64 = 2.0;
/// A prior this much wider than usual leaves an amount free.
const FREE: f64 = 100.0;
/// Amounts that are this many times as large as usual are still faults.
const UNUSUAL: f64 = 4.0;
/// Most effects that are adopted.
const MOST_ADOPTED: usize = 4;

/// Fit of one candidate, given the effects that are already adopted.
#[derive(Clone, Debug)]
pub struct CandidateFit {
    /// Which of the menu.
    pub candidate: usize,
    /// The best of its choices.
    pub choice: usize,
    /// Estimates of its amounts.
    pub amounts: Vec<f64>,
    /// Their sigmas.
    pub sigmas: Vec<f64>,
    /// Twice the logarithm of the Bayes factor against not having it.
    pub evidence: f64,
    /// Twice the gain in log likelihood, the prior left out.
    pub gain: f64,
    /// How much more its score scatters (squared) than the model says; evidence and gain are so
    /// much less.
    pub scatter: f64,
    /// Width of the prior of each amount.
    pub width: f64,
    /// Twice the gain in log likelihood on the drives held out, with the amounts of the others.
    pub held_out: f64,
}

impl CandidateFit {
    /// Returns its gain if scores scattered so much more than the model says. An amount of its own
    /// for each drive leaves no scatter from drive to drive: two cases are compared as if both had
    /// the same.
    fn gain_at(&self, scatter: f64) -> f64 {
        self.gain * self.scatter / scatter
    }

    /// Returns the same of its evidence.
    fn evidence_at(&self, scatter: f64) -> f64 {
        self.evidence - self.gain + self.gain_at(scatter)
    }
}

/// What was adopted in one step of the selection, and what could have been instead.
#[derive(Clone, Debug)]
pub struct SelectionStep {
    /// The one adopted.
    pub adopted: CandidateFit,
    /// Other candidates that the data cannot separate from it.
    pub group: Vec<CandidateFit>,
}

impl SelectionStep {
    /// Has another of the group stand for it.
    fn lead(&mut self, candidate: usize) {
        let same = |case: &CandidateFit| case.candidate == candidate;
        if let Some(index) = self.group.iter().position(same) {
            std::mem::swap(&mut self.adopted, &mut self.group[index]);
        }
    }
}

/// The result.
#[derive(Clone, Debug, Default)]
pub struct Selection {
    /// In the order of adoption.
    pub steps: Vec<SelectionStep>,
    /// Every candidate as it stood before the first step.
    pub alone: Vec<CandidateFit>,
    /// Minus twice the logarithm of the likelihood of the drives to fit with what was adopted.
    pub negative_log_likelihood: f64,
}

/// What is adopted so far, and what that does.
struct Ground {
    basis: Basis,
    /// Amounts of the columns.
    columns: DVector<f64>,
    /// Twice the gain in log likelihood, on the drives to fit and on those held out.
    explained: f64,
    held_out: f64,
    /// Twice the logarithm of the Bayes factor, the model's word taken for the scatter.
    bayes: f64,
}

/// Selects from a menu.
pub struct Selector<'a> {
    menu: &'a Menu,
    regression: Regression<'a>,
}

impl<'a> Selector<'a> {
    /// For these drives.
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

    /// Adopts one effect after the other as long as the evidence asks for one; `first` is that which
    /// stands for those that the evidence cannot separate in the first step, if it is given.
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
                // Its phases are each drive's own.
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

    /// Returns the best choice of a candidate.
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
        // All choices are equally likely beforehand: the mean of their Bayes factors.
        let relative = gains.iter().map(|(_, gain)| (0.5 * (gain - best)).exp());
        let mean = relative.sum::<f64>() / candidate.choices.len() as f64;
        let amounts = &candidate.choices[choice].amounts;
        let own = basis.size()..basis.size() + amounts.len();
        // A prior as wide as such amounts usually are, or, since faults are unusual, as this one
        // is, up to a few times that.
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

    /// Returns a cycle has its own phase on each drive, so that each is fitted alone.
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

    /// The amounts of all that is adopted, together.
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

/// Returns the effect that the cases ask for, if any does.
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
    // Among those that the fitted drives cannot separate, the drives held out decide; and a
    // parameter of the base model comes first where they do not either.
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

/// Returns whether the drives cannot separate a case from the best one: it fits as well, whatever
/// its prior, and is no less likely after all by more than that.
fn is_rival(case: &CandidateFit, best: &CandidateFit) -> bool {
    let scatter = best.scatter.max(case.scatter);
    let is_usual = |amount: &f64| amount.abs() <= 1.5 * case.width;
    let fits_as_well = best.evidence_at(scatter) - case.evidence_at(scatter) <= TOLD_APART
        || (best.gain_at(scatter) - case.gain_at(scatter) <= TOLD_APART
            && case.amounts.len() <= best.amounts.len()
            && case.amounts.iter().all(is_usual));
    // What is less likely than nothing is no rival of anything.
    fits_as_well && case.evidence > 0.0
}

fn by(
    value: impl Fn(&CandidateFit) -> f64,
) -> impl Fn(&&CandidateFit, &&CandidateFit) -> std::cmp::Ordering {
    move |a, b| value(a).total_cmp(&value(b))
}

/// Returns whether a vehicle can have it.
fn is_possible(case: &CandidateFit, menu: &Menu) -> bool {
    let candidate = &menu.candidates[case.candidate];
    let Some(range) = candidate.effect.map(|effect| effect.range) else {
        return true;
    };
    match candidate.choices[case.choice].detail {
        // On each drive the effect is there or not; it does not turn round.
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
