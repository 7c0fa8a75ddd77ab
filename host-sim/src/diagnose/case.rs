//! The fit of one candidate, given the effects that are already adopted.

use super::candidates::{Candidate, Choice, Detail, Menu};
use super::regression::{Basis, Regression};
use nalgebra::{DMatrix, DVector};

/// Width of a prior that leaves an amount free, as a multiple of its usual size.
const FREE: f64 = 100.0;
/// Largest width of a prior, as a multiple of the usual size.
const UNUSUAL: f64 = 4.0;

/// Fit of one candidate, given the effects that are already adopted.
#[derive(Clone, Debug)]
pub struct CandidateFit {
    /// Index of the candidate.
    pub candidate: usize,
    /// The best of its choices.
    pub choice: Choice,
    /// Estimates of its amounts.
    pub amounts: Vec<f64>,
    /// Their covariance.
    pub covariance: DMatrix<f64>,
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
    /// Returns the standard deviation of an amount.
    #[must_use]
    pub fn sigma(&self, amount: usize) -> f64 {
        self.covariance[(amount, amount)].sqrt()
    }

    /// Returns the gain for a common scatter. A candidate with an amount for each drive has no
    /// scatter from drive to drive. Two cases are therefore compared at the same scatter.
    pub(super) fn gain_at(&self, scatter: f64) -> f64 {
        self.gain * self.scatter / scatter
    }

    /// Returns the evidence for a common scatter.
    pub(super) fn evidence_at(&self, scatter: f64) -> f64 {
        self.evidence - self.gain + self.gain_at(scatter)
    }

    /// Returns whether a vehicle can have the effect.
    pub(super) fn is_possible(&self, menu: &Menu) -> bool {
        let Some(effect) = menu.candidates[self.candidate].effect else {
            return true;
        };
        match self.choice.detail {
            // On each drive the effect is present or absent; it has no negative amount.
            Detail::EachDrive(..) | Detail::SomeDrives { .. } => {
                let mut amounts = self.amounts.iter().enumerate();
                amounts.all(|(i, amount)| {
                    *amount > -1.5 * self.sigma(i) && effect.range.holds(*amount as f32)
                })
            }
            _ => {
                let size = match self.amounts[..] {
                    [amount] => amount,
                    _ => self.amounts.iter().map(|a| a * a).sum::<f64>().sqrt(),
                };
                effect.range.holds(size as f32)
            }
        }
    }
}

/// The adopted effects and their fit.
pub(super) struct Ground {
    basis: Basis,
    /// Amounts of the columns.
    columns: DVector<f64>,
    /// Twice the gain in log likelihood, on the drives to fit and on those held out.
    explained: f64,
    held_out: f64,
    /// Twice the logarithm of the Bayes factor, with the scatter that the model predicts.
    bayes: f64,
}

impl Ground {
    /// Fits the amounts of a basis; `None` if they cannot be separated.
    pub(super) fn of(basis: Basis, regression: &Regression<'_>) -> Option<Self> {
        let columns = if basis.size() == 0 {
            regression.columns(&basis, &DVector::zeros(0))
        } else {
            regression.columns(&basis, &regression.fit(&basis)?.amounts)
        };
        Some(Self {
            explained: regression.explained(&basis),
            held_out: regression.held_out(&basis, &columns),
            bayes: regression.bayes(&basis, 1.0)?,
            basis,
            columns,
        })
    }

    /// Returns the fit of the best choice of a candidate.
    pub(super) fn case(
        &self,
        regression: &Regression<'_>,
        index: usize,
        candidate: &Candidate,
    ) -> Option<CandidateFit> {
        if candidate.choices.first()?.is_cycle() {
            return self.cycle(regression, index, candidate);
        }
        let basis = &self.basis;
        let choices = self.choices(regression, candidate);
        // The gain of each choice with its prior probability.
        let gains: Vec<(usize, f64, f64)> = choices
            .iter()
            .enumerate()
            .filter_map(|(i, (choice, probability))| {
                let with = basis.with(&choice.amounts, candidate.typical);
                let gain = regression.bayes(&with, 1.0)? - self.bayes;
                Some((i, gain, *probability))
            })
            .collect();
        let odds = |&(_, gain, probability): &(usize, f64, f64)| gain + 2.0 * probability.ln();
        let best = gains
            .iter()
            .max_by(|a, b| odds(a).total_cmp(&odds(b)))
            .copied()?;
        let relative = gains
            .iter()
            .map(|(_, gain, p)| p * (0.5 * (gain - best.1)).exp());
        let mean: f64 = relative.sum();
        let choice = &choices[best.0].0;
        let amounts = &choice.amounts;
        let own = basis.size()..basis.size() + amounts.len();
        // The prior's width is the usual size. Faults are unusual: if this amount is larger, the
        // width is that amount, up to a few times the usual size.
        let free = regression.fit(&basis.with(amounts, FREE * candidate.typical))?;
        let square: f64 = own.clone().map(|i| free.amounts[i].powi(2)).sum();
        let size = (square / amounts.len() as f64).sqrt();
        let width = size.clamp(candidate.typical, UNUSUAL * candidate.typical);
        let with = basis.with(amounts, width);
        let with = with.with_held_out(&choice.held_out, width);
        let fit = regression.fit(&with)?;
        let columns = regression.columns(&with, &fit.amounts);
        let bayes = regression.bayes(&with, fit.scatter)? - regression.bayes(basis, fit.scatter)?;
        let (from, count) = (own.start, own.len());
        Some(CandidateFit {
            candidate: index,
            choice: choice.clone(),
            amounts: own.map(|i| fit.amounts[i]).collect(),
            covariance: fit
                .covariance
                .view((from, from), (count, count))
                .into_owned(),
            evidence: bayes + 2.0 * mean.ln(),
            gain: (regression.explained(&with) - self.explained) / fit.scatter,
            scatter: fit.scatter,
            width,
            held_out: regression.held_out(&with, &columns) - self.held_out,
        })
    }

    /// Returns the choices of a candidate with their prior probabilities.
    ///
    /// A candidate with an amount for each drive may as well have one amount on the drives that
    /// began alike, and none on the others. Either is equally likely, and so is each number of
    /// such drives. Of each number, only the drives with the largest amounts are tried; the others
    /// keep their part of the probability.
    fn choices(&self, regression: &Regression<'_>, candidate: &Candidate) -> Vec<(Choice, f64)> {
        let even = 1.0 / candidate.choices.len() as f64;
        let mut choices = Vec::new();
        for choice in &candidate.choices {
            let of = choice.amounts.len();
            let some = match choice.detail {
                Detail::EachDrive(key, value) if of > 1 => Some((key, value)),
                _ => None,
            };
            let Some((key, value)) = some else {
                choices.push((choice.clone(), even));
                continue;
            };
            choices.push((choice.clone(), 0.5 * even));
            let free = self.basis.with(&choice.amounts, FREE * candidate.typical);
            let Some(fit) = regression.fit(&free) else {
                continue;
            };
            let mut order: Vec<usize> = (0..of).collect();
            let amount = |drive: usize| fit.amounts[self.basis.size() + drive];
            order.sort_by(|a, b| amount(*b).total_cmp(&amount(*a)));
            let mut ways = 1.0;
            for with in 1..=of {
                ways *= (of - with + 1) as f64 / with as f64;
                let columns = order[..with].iter().map(|&drive| &choice.amounts[drive]);
                let some = Choice {
                    amounts: vec![columns.flatten().copied().collect()],
                    held_out: choice.held_out.clone(),
                    detail: Detail::SomeDrives {
                        key,
                        value,
                        with,
                        of,
                    },
                };
                choices.push((some, 0.5 * even / (of as f64 * ways)));
            }
        }
        choices
    }

    /// Returns the fit of a cycle. Its phase differs between drives, so each drive is fitted alone.
    fn cycle(
        &self,
        regression: &Regression<'_>,
        index: usize,
        candidate: &Candidate,
    ) -> Option<CandidateFit> {
        let drives = regression.drives(&self.columns);
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
            choice: candidate.choices[choice].clone(),
            amounts: vec![best.1.sqrt()],
            covariance: DMatrix::zeros(1, 1),
            evidence: best.0[0] + 2.0 * mean.ln(),
            gain: best.0[0],
            scatter: 1.0,
            width: candidate.typical,
            held_out: best.0[1],
        })
    }
}
