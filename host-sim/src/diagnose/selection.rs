//! Which effects the evidence asks for.
//!
//! Forward selection by Bayes factors: each candidate's amount has a normal prior as wide as such
//! amounts usually are, so that an effect is not adopted for explaining a little, and choices are
//! paid for (R. E. Kass and A. E. Raftery, "Bayes factors", J. Am. Stat. Assoc. 90:773, 1995).
//! Estimates are generalised least squares; where scores scatter from stretch to stretch more than
//! the model says, the evidence counts that much less.

use super::candidates::{Candidate, Choice, Detail, Menu};
use super::evidence::Evidence;
use nalgebra::{DMatrix, DVector};
use std::collections::{BTreeMap, BTreeSet};

/// Twice the logarithm of the odds from which an effect is adopted, against nothing and after the
/// number of candidates is paid for.
pub const ADOPTED: f64 = 3.0;
/// Candidates whose evidence is within this of the best cannot be told from it: 20 to 1.
pub const TOLD_APART: f64 = 6.0;
/// A parameter of the base model is preferred where others are better by no more than this.
const PREFERENCE: f64 = 2.0;
/// A prior this much wider than usual leaves an amount free.
const FREE: f64 = 100.0;
/// Amounts that are this many times as large as usual are still faults.
const UNUSUAL: f64 = 4.0;
/// Fewest drives whose scatter says anything.
const FEWEST_DRIVES: usize = 3;
/// Most effects that are adopted.
const MOST_ADOPTED: usize = 4;
/// Parameters that the base model has: a wrong one is no new effect.
const BASE: [&str; 4] = ["rolling_resistance", "air_drag", "mass", "torque_scale"];

/// What one candidate explains, given what is adopted already.
#[derive(Clone, Debug)]
pub struct Case {
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
    /// Width of the prior of each amount.
    pub width: f64,
    /// Twice the gain in log likelihood on the drives held out, with the amounts of the others.
    pub held_out: f64,
}

/// What was adopted in one step of the selection, and what could have been instead.
#[derive(Clone, Debug)]
pub struct Step {
    /// The one adopted.
    pub adopted: Case,
    /// Others that the data cannot tell from it.
    pub group: Vec<Case>,
}

impl Step {
    /// Has another of the group stand for it.
    fn lead(&mut self, candidate: usize) {
        let same = |case: &Case| case.candidate == candidate;
        if let Some(index) = self.group.iter().position(same) {
            std::mem::swap(&mut self.adopted, &mut self.group[index]);
        }
    }
}

/// The result.
#[derive(Clone, Debug, Default)]
pub struct Selection {
    /// In the order of adoption.
    pub steps: Vec<Step>,
    /// Every candidate as it stood before the first step.
    pub alone: Vec<Case>,
    /// Every candidate as it stands after the last.
    pub after: Vec<Case>,
    /// Minus twice the logarithm of the likelihood of the drives to fit, the evidence for what was
    /// adopted taken off.
    pub surprise: f64,
}

/// Patterns of what is adopted, side by side, with the prior precision of each amount.
#[derive(Clone, Debug)]
struct Basis {
    pattern: DMatrix<f64>,
    precision: DVector<f64>,
}

impl Basis {
    fn empty(width: usize) -> Self {
        Self {
            pattern: DMatrix::zeros(width, 0),
            precision: DVector::zeros(0),
        }
    }

    fn with(&self, pattern: &DMatrix<f64>, typical: f64) -> Self {
        let mut wide = DMatrix::zeros(self.pattern.nrows(), self.pattern.ncols() + pattern.ncols());
        wide.columns_mut(0, self.pattern.ncols())
            .copy_from(&self.pattern);
        wide.columns_mut(self.pattern.ncols(), pattern.ncols())
            .copy_from(pattern);
        let mut precision: Vec<f64> = self.precision.iter().copied().collect();
        precision.extend(std::iter::repeat_n(typical.powi(-2), pattern.ncols()));
        Self {
            pattern: wide,
            precision: precision.into(),
        }
    }
}

/// The evidence, and which drives are held out.
pub struct Selector<'a> {
    menu: &'a Menu,
    evidence: &'a Evidence,
    is_held_out: Box<dyn Fn(usize) -> bool + 'a>,
    information: DMatrix<f64>,
    score: DVector<f64>,
    held_information: DMatrix<f64>,
    held_score: DVector<f64>,
}

impl<'a> Selector<'a> {
    /// For these drives.
    pub fn new(
        menu: &'a Menu,
        evidence: &'a Evidence,
        is_held_out: impl Fn(usize) -> bool + 'a,
    ) -> Self {
        let (information, score) = evidence.sums(|drive| !is_held_out(drive));
        let (held_information, held_score) = evidence.sums(&is_held_out);
        Self {
            menu,
            evidence,
            is_held_out: Box::new(is_held_out),
            information,
            score,
            held_information,
            held_score,
        }
    }

    /// Adopts one effect after the other as long as the evidence asks for one; `first` is that which
    /// stands for those that the evidence cannot tell apart in the first step, if it is given.
    #[must_use]
    pub fn select(&self, first: Option<usize>) -> Selection {
        let mut basis = Basis::empty(self.menu.width());
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
            let candidate = &self.menu.candidates[step.adopted.candidate];
            let choice = &candidate.choices[step.adopted.choice];
            taken.push(step.adopted.candidate);
            if matches!(choice.detail, Detail::Period(_)) {
                // Its phases are each drive's own.
                selection.steps.push(step);
                cases.retain(|case| !taken.contains(&case.candidate));
                continue;
            }
            basis = basis.with(&choice.pattern(self.menu.width()), step.adopted.width);
            selection.steps.push(step);
            cases = self.cases(&basis, &taken);
        }
        let stretches = self.evidence.stretches.iter();
        let nothing: f64 = stretches
            .filter(|stretch| !(self.is_held_out)(stretch.drive))
            .map(|stretch| stretch.surprise)
            .sum();
        selection.surprise = nothing - self.explained(&basis);
        self.refit(&basis, &mut selection.steps);
        selection.after = cases;
        selection
    }

    /// Twice the gain in log likelihood of all that is adopted.
    fn explained(&self, basis: &Basis) -> f64 {
        let pattern = basis.pattern.transpose();
        let score = &pattern * &self.score;
        let information = &pattern * &self.information * &basis.pattern;
        let solution = information.cholesky().map(|c| c.solve(&score));
        solution.map_or(0.0, |amounts| score.dot(&amounts))
    }

    fn cases(&self, basis: &Basis, taken: &[usize]) -> Vec<Case> {
        let candidates = self.menu.candidates.iter().enumerate();
        candidates
            .filter(|(index, _)| !taken.contains(index))
            .filter_map(|(index, candidate)| self.case(basis, index, candidate))
            .collect()
    }

    /// The best choice of a candidate.
    fn case(&self, basis: &Basis, index: usize, candidate: &Candidate) -> Option<Case> {
        if matches!(candidate.choices.first()?.detail, Detail::Period(_)) {
            return self.cycle(basis, index, candidate);
        }
        let gain = |choice: &Choice| self.gain(basis, candidate, choice);
        let gains: Vec<(usize, f64)> = candidate
            .choices
            .iter()
            .enumerate()
            .filter_map(|(i, choice)| Some((i, gain(choice)?)))
            .collect();
        let (choice, best) = gains.iter().copied().max_by(|a, b| a.1.total_cmp(&b.1))?;
        // All choices are equally likely beforehand: the mean of their Bayes factors.
        let mean = gains
            .iter()
            .map(|(_, gain)| (0.5 * (gain - best)).exp())
            .sum::<f64>()
            / candidate.choices.len() as f64;
        let pattern = candidate.choices[choice].pattern(self.menu.width());
        let own = basis.pattern.ncols()..basis.pattern.ncols() + pattern.ncols();
        // A prior as wide as such amounts usually are, or, since faults are unusual, as this one
        // is, up to a few times that.
        let free = self.fit(&basis.with(&pattern, FREE * candidate.typical))?;
        let square: f64 = own.clone().map(|i| free.amounts[i].powi(2)).sum();
        let size = (square / pattern.ncols() as f64).sqrt();
        let width = size.clamp(candidate.typical, UNUSUAL * candidate.typical);
        let with = basis.with(&pattern, width);
        let fit = self.fit(&with)?;
        let amounts = with.pattern.ncols() - basis.pattern.ncols();
        Some(Case {
            candidate: index,
            choice,
            amounts: own.clone().map(|i| fit.amounts[i]).collect(),
            sigmas: own.map(|i| fit.covariance[(i, i)].sqrt()).collect(),
            evidence: self.gain_with_scatter(basis, &with, amounts)? + 2.0 * mean.ln(),
            gain: (self.explained(&with) - self.explained(basis)) / fit.scatter,
            width,
            held_out: self.held_out_gain(basis, &with)?,
        })
    }

    /// A cycle has its own phase on each drive, so that each is fitted alone.
    fn cycle(&self, basis: &Basis, index: usize, candidate: &Candidate) -> Option<Case> {
        let fitted = if basis.pattern.ncols() > 0 {
            &basis.pattern * self.fit(basis)?.amounts
        } else {
            DVector::zeros(self.menu.width())
        };
        let drives: BTreeSet<usize> = self.evidence.stretches.iter().map(|s| s.drive).collect();
        let sums: Vec<(bool, DMatrix<f64>, DVector<f64>)> = drives
            .into_iter()
            .map(|drive| {
                let (information, score) = self.evidence.sums(|other| other == drive);
                let left = score - &information * &fitted;
                ((self.is_held_out)(drive), information, left)
            })
            .collect();
        let prior = DMatrix::from_diagonal_element(2, 2, candidate.typical.powi(-2));
        // Gains on drives to fit and held out, and the mean square of the size.
        let gain = |choice: &Choice| -> Option<([f64; 2], f64)> {
            let pattern = choice.pattern(self.menu.width());
            let mut gains = [0.0; 2];
            let mut square = 0.0;
            for (held_out, information, score) in &sums {
                let own = pattern.transpose() * information * &pattern;
                let score = pattern.transpose() * score;
                let inverse = (&own + &prior).try_inverse()?;
                let amounts = &inverse * &score;
                let determinant = ((&own + &prior) / prior[(0, 0)]).determinant();
                gains[usize::from(*held_out)] += score.dot(&amounts) - determinant.ln();
                square += amounts.norm_squared() / sums.len() as f64;
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
        Some(Case {
            candidate: index,
            choice,
            amounts: vec![best.1.sqrt()],
            sigmas: vec![0.0],
            evidence: best.0[0] + 2.0 * mean.ln(),
            gain: best.0[0],
            width: candidate.typical,
            held_out: best.0[1],
        })
    }

    /// Twice the logarithm of the Bayes factor of one choice, taking the model's word for the
    /// scatter.
    fn gain(&self, basis: &Basis, candidate: &Candidate, choice: &Choice) -> Option<f64> {
        let with = basis.with(&choice.pattern(self.menu.width()), candidate.typical);
        let amounts = with.pattern.ncols() - basis.pattern.ncols();
        self.bayes(basis, &with, amounts, 1.0)
    }

    fn gain_with_scatter(&self, basis: &Basis, with: &Basis, amounts: usize) -> Option<f64> {
        let fit = self.fit(with)?;
        self.bayes(basis, with, amounts, fit.scatter)
    }

    /// With scores that scatter `scatter` times as much (squared) as the model says.
    fn bayes(&self, basis: &Basis, with: &Basis, amounts: usize, scatter: f64) -> Option<f64> {
        let evidence = |basis: &Basis| -> Option<(f64, f64)> {
            let information = basis.pattern.transpose() * &self.information * &basis.pattern
                / scatter
                + DMatrix::from_diagonal(&basis.precision);
            let score = basis.pattern.transpose() * &self.score / scatter;
            let cholesky = information.cholesky()?;
            let quadratic = score.dot(&cholesky.solve(&score));
            let determinant = 2.0 * cholesky.l().diagonal().iter().map(|d| d.ln()).sum::<f64>()
                - basis.precision.iter().map(|p| p.ln()).sum::<f64>();
            Some((quadratic, determinant))
        };
        let (q1, d1) = evidence(with)?;
        let (q0, d0) = if basis.pattern.ncols() == 0 {
            (0.0, 0.0)
        } else {
            evidence(basis)?
        };
        debug_assert!(amounts > 0);
        Some((q1 - q0) - (d1 - d0))
    }

    fn fit(&self, basis: &Basis) -> Option<Fit> {
        let pattern = basis.pattern.transpose();
        let information = &pattern * &self.information * &basis.pattern;
        let prior = DMatrix::from_diagonal(&basis.precision);
        let score = &pattern * &self.score;
        let inverse = (&information + &prior).try_inverse()?;
        let amounts = &inverse * score;
        // Scatter of the scores around the fit, from stretch to stretch and from drive to drive.
        let scores: Vec<(usize, DVector<f64>)> = self
            .evidence
            .stretches
            .iter()
            .filter(|stretch| !(self.is_held_out)(stretch.drive))
            .map(|stretch| {
                let left = &stretch.score - &stretch.information * (&basis.pattern * &amounts);
                (stretch.drive, &pattern * left)
            })
            .collect();
        let mut of_drives: BTreeMap<usize, DVector<f64>> = BTreeMap::new();
        for (drive, score) in &scores {
            *of_drives
                .entry(*drive)
                .or_insert_with(|| DVector::zeros(score.len())) += score;
        }
        let sandwich = |clusters: &mut dyn Iterator<Item = &DVector<f64>>| {
            let mut spread: DMatrix<f64> = DMatrix::zeros(amounts.len(), amounts.len());
            let mut count = 0.0;
            for own in clusters {
                spread += own * own.transpose();
                count += 1.0;
            }
            let correction = if count > 1.0 {
                count / (count - 1.0)
            } else {
                1.0
            };
            &inverse * spread * &inverse * correction
        };
        let by_stretch = sandwich(&mut scores.iter().map(|(_, score)| score));
        let by_drive = sandwich(&mut of_drives.values());
        let sandwich = if of_drives.len() >= FEWEST_DRIVES {
            by_stretch.sup(&by_drive)
        } else {
            by_stretch
        };
        // The last amounts are the new ones: their scatter is what is asked for.
        let last = amounts.len() - 1;
        let scatter = (sandwich[(last, last)] / inverse[(last, last)]).max(1.0);
        let mut covariance = inverse;
        for i in 0..amounts.len() {
            let widened = covariance[(i, i)].max(sandwich[(i, i)]);
            covariance[(i, i)] = widened;
        }
        Some(Fit {
            amounts,
            covariance,
            scatter,
        })
    }

    /// What the fit does on the drives held out, beyond what `basis` does.
    fn held_out_gain(&self, basis: &Basis, with: &Basis) -> Option<f64> {
        let gain = |basis: &Basis| -> Option<f64> {
            if basis.pattern.ncols() == 0 {
                return Some(0.0);
            }
            let columns = &basis.pattern * self.fit(basis)?.amounts;
            let square = columns.dot(&(&self.held_information * &columns));
            Some(2.0 * columns.dot(&self.held_score) - square)
        };
        Some(gain(with)? - gain(basis)?)
    }

    /// The amounts of all that is adopted, together.
    fn refit(&self, basis: &Basis, steps: &mut [Step]) {
        if basis.pattern.ncols() == 0 {
            return;
        }
        let Some(fit) = self.fit(basis) else {
            return;
        };
        let mut i = 0;
        for step in steps {
            let choices = &self.menu.candidates[step.adopted.candidate].choices;
            if matches!(choices[step.adopted.choice].detail, Detail::Period(_)) {
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

struct Fit {
    amounts: DVector<f64>,
    covariance: DMatrix<f64>,
    scatter: f64,
}

/// The effect that the cases ask for, if any does.
fn step(cases: &[Case], menu: &Menu) -> Option<Step> {
    let price = 2.0 * (menu.candidates.len() as f64).ln();
    let asked = |case: &&Case| {
        case.evidence - price >= ADOPTED && case.held_out > -1.0 && is_possible(case, menu)
    };
    let best = cases
        .iter()
        .filter(asked)
        .max_by(by(|case| case.evidence))?;
    let rivals: Vec<&Case> = cases
        .iter()
        .filter(|case| is_rival(case, best) && is_possible(case, menu))
        .collect();
    // Among those that the drives to fit cannot tell apart, the drives held out decide; and a
    // parameter of the base model comes first where they do not either.
    let merit = |case: &Case| {
        let is_base = BASE.contains(&menu.candidates[case.candidate].name);
        case.evidence + case.held_out + if is_base { PREFERENCE } else { 0.0 }
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
    Some(Step {
        adopted: adopted.clone(),
        group,
    })
}

/// Whether the drives cannot tell a case from the best: it fits as well, whatever its prior, and is
/// no less likely after all by more than that.
fn is_rival(case: &Case, best: &Case) -> bool {
    best.evidence - case.evidence <= TOLD_APART
        || (best.gain - case.gain <= TOLD_APART
            && case.amounts.len() <= best.amounts.len()
            && case
                .amounts
                .iter()
                .all(|amount| amount.abs() <= 1.5 * case.width))
}

fn by(value: impl Fn(&Case) -> f64) -> impl Fn(&&Case, &&Case) -> std::cmp::Ordering {
    move |a, b| value(a).total_cmp(&value(b))
}

/// Whether a vehicle can have it.
fn is_possible(case: &Case, menu: &Menu) -> bool {
    let candidate = &menu.candidates[case.candidate];
    let Some(range) = candidate.effect.map(|effect| effect.range) else {
        return true;
    };
    match candidate.choices[case.choice].detail {
        // Tyres are cold or not, on each drive; they are never the colder the longer they roll.
        Detail::Time(_) => {
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
