//! Least squares on the evidence: amounts, their sigmas and likelihoods.

use super::evidence::Evidence;
use nalgebra::{DMatrix, DVector};
use std::collections::{BTreeMap, BTreeSet};

/// Fewest drives whose scatter is used.
const FEWEST_DRIVES: usize = 3;

/// Amounts to estimate, each with its columns of force and its prior precision.
#[derive(Clone, Debug, Default)]
pub struct Basis {
    amounts: Vec<Vec<usize>>,
    precision: Vec<f64>,
    /// Columns of drives held out that have an amount of their own, and its prior precision.
    held_out: Vec<(usize, f64)>,
}

impl Basis {
    /// Returns the number of amounts.
    #[must_use]
    pub fn size(&self) -> usize {
        self.amounts.len()
    }

    /// Returns the basis with additional amounts, whose priors have this standard deviation.
    #[must_use]
    pub fn with(&self, amounts: &[Vec<usize>], typical: f64) -> Self {
        let mut basis = self.clone();
        basis.amounts.extend_from_slice(amounts);
        basis.precision.resize(basis.size(), typical.powi(-2));
        basis
    }

    /// Returns the basis with an amount for each of these columns of drives held out. Whatever the
    /// fit says, such an amount is that drive's own: how cold its tyres were, for example.
    #[must_use]
    pub fn with_held_out(mut self, columns: &[usize], typical: f64) -> Self {
        let own = columns.iter().map(|&column| (column, typical.powi(-2)));
        self.held_out.extend(own);
        self
    }

    fn prior(&self) -> DMatrix<f64> {
        DMatrix::from_diagonal(&DVector::from_column_slice(&self.precision))
    }
}

/// Returns the information matrix of amounts, each of which is a sum of columns.
fn information_of(amounts: &[Vec<usize>], columns: &DMatrix<f64>) -> DMatrix<f64> {
    DMatrix::from_fn(amounts.len(), amounts.len(), |a, b| {
        let pairs = amounts[a]
            .iter()
            .flat_map(|&i| amounts[b].iter().map(move |&j| (i, j)));
        pairs.map(|pair| columns[pair]).sum()
    })
}

fn score_of(amounts: &[Vec<usize>], columns: &DVector<f64>) -> DVector<f64> {
    let own = amounts
        .iter()
        .map(|own| own.iter().map(|&i| columns[i]).sum());
    DVector::from_iterator(amounts.len(), own)
}

/// Estimates of the amounts of a basis.
#[derive(Clone, Debug)]
pub struct Fit {
    /// The amounts.
    pub amounts: DVector<f64>,
    /// Their covariance, widened by the scatter of the scores.
    pub covariance: DMatrix<f64>,
    /// Ratio of the scatter of the last amount's score (squared) to that of the model, at least
    /// one.
    pub scatter: f64,
}

/// Sums of one drive, less the fitted amounts.
pub struct OfDrive {
    /// Whether the drive is held out.
    pub held_out: bool,
    information: DMatrix<f64>,
    score: DVector<f64>,
}

impl OfDrive {
    /// Returns the information and the score of amounts.
    #[must_use]
    pub fn of(&self, amounts: &[Vec<usize>]) -> (DMatrix<f64>, DVector<f64>) {
        let information = information_of(amounts, &self.information);
        (information, score_of(amounts, &self.score))
    }
}

/// Regression on the evidence of the drives that are not held out.
pub struct Regression<'a> {
    evidence: &'a Evidence,
    is_held_out: Box<dyn Fn(usize) -> bool + 'a>,
    information: DMatrix<f64>,
    score: DVector<f64>,
    held_information: DMatrix<f64>,
    held_score: DVector<f64>,
}

impl<'a> Regression<'a> {
    /// Creates the regression. `is_held_out` selects drives by index.
    pub fn new(evidence: &'a Evidence, is_held_out: impl Fn(usize) -> bool + 'a) -> Self {
        let (information, score) = evidence.sums(|drive| !is_held_out(drive));
        let (held_information, held_score) = evidence.sums(&is_held_out);
        Self {
            evidence,
            is_held_out: Box::new(is_held_out),
            information,
            score,
            held_information,
            held_score,
        }
    }

    /// Returns minus twice the log likelihood of the drives to fit, without any missing force.
    #[must_use]
    pub fn negative_log_likelihood(&self) -> f64 {
        let segments = self.evidence.segments.iter();
        segments
            .filter(|segment| !(self.is_held_out)(segment.drive))
            .map(|segment| segment.negative_log_likelihood)
            .sum()
    }

    /// Returns twice the gain in log likelihood of a basis, without its priors.
    #[must_use]
    pub fn explained(&self, basis: &Basis) -> f64 {
        let (information, score) = self.of(basis);
        let solution = information.cholesky().map(|c| c.solve(&score));
        solution.map_or(0.0, |amounts| score.dot(&amounts))
    }

    /// Returns twice the logarithm of the Bayes factor of a basis against none. `scatter` is the
    /// ratio of the scatter of the scores (squared) to that of the model.
    #[must_use]
    pub fn bayes(&self, basis: &Basis, scatter: f64) -> Option<f64> {
        if basis.size() == 0 {
            return Some(0.0);
        }
        let (information, score) = self.of(basis);
        let information = information / scatter + basis.prior();
        let score = score / scatter;
        let cholesky = information.cholesky()?;
        let quadratic = score.dot(&cholesky.solve(&score));
        let determinant = 2.0 * cholesky.l().diagonal().iter().map(|d| d.ln()).sum::<f64>()
            - basis.precision.iter().map(|p| p.ln()).sum::<f64>();
        Some(quadratic - determinant)
    }

    /// Returns twice the gain in log likelihood on the drives held out, with these amounts of the
    /// columns. Over the amounts that are those drives' own, it is the marginal likelihood.
    #[must_use]
    pub fn held_out(&self, basis: &Basis, columns: &DVector<f64>) -> f64 {
        let explained = &self.held_information * columns;
        let fixed = 2.0 * columns.dot(&self.held_score) - columns.dot(&explained);
        let left = &self.held_score - explained;
        let own = basis.held_out.iter().map(|&(column, precision)| {
            let information = self.held_information[(column, column)];
            left[column].powi(2) / (information + precision) - (1.0 + information / precision).ln()
        });
        fixed + own.sum::<f64>()
    }

    /// Returns the sums of each drive, less these amounts of the columns.
    #[must_use]
    pub fn drives(&self, columns: &DVector<f64>) -> Vec<OfDrive> {
        let drives: BTreeSet<usize> = self.evidence.segments.iter().map(|s| s.drive).collect();
        let of_drive = |drive| {
            let (information, score) = self.evidence.sums(|other| other == drive);
            OfDrive {
                held_out: (self.is_held_out)(drive),
                score: score - &information * columns,
                information,
            }
        };
        drives.into_iter().map(of_drive).collect()
    }

    /// Returns the estimates of a basis with at least one amount; `None` if they cannot be
    /// separated.
    #[must_use]
    pub fn fit(&self, basis: &Basis) -> Option<Fit> {
        let (information, score) = self.of(basis);
        let inverse = (information + basis.prior()).try_inverse()?;
        let amounts = &inverse * score;
        let columns = self.columns(basis, &amounts);
        // Scatter of the scores around the fit, from segment to segment and from drive to drive.
        let scores: Vec<(usize, DVector<f64>)> = self
            .evidence
            .segments
            .iter()
            .filter(|segment| !(self.is_held_out)(segment.drive))
            .map(|segment| {
                let left = &segment.score - &segment.information * &columns;
                (segment.drive, score_of(&basis.amounts, &left))
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
        let by_segment = sandwich(&mut scores.iter().map(|(_, score)| score));
        let by_drive = sandwich(&mut of_drives.values());
        let sandwich = if of_drives.len() >= FEWEST_DRIVES {
            by_segment.sup(&by_drive)
        } else {
            by_segment
        };
        // The last amounts are the new ones. The result is their scatter.
        let last = amounts.len() - 1;
        let scatter = (sandwich[(last, last)] / inverse[(last, last)]).max(1.0);
        // Widened with its correlations kept.
        let factors: Vec<f64> = (0..amounts.len())
            .map(|i| (sandwich[(i, i)] / inverse[(i, i)]).max(1.0).sqrt())
            .collect();
        let covariance = DMatrix::from_fn(amounts.len(), amounts.len(), |i, j| {
            factors[i] * factors[j] * inverse[(i, j)]
        });
        Some(Fit {
            amounts,
            covariance,
            scatter,
        })
    }

    /// Returns the amounts of the columns.
    #[must_use]
    pub fn columns(&self, basis: &Basis, amounts: &DVector<f64>) -> DVector<f64> {
        let mut columns = DVector::zeros(self.score.len());
        for (own, amount) in basis.amounts.iter().zip(amounts) {
            for &column in own {
                columns[column] += amount;
            }
        }
        columns
    }

    /// Returns information and score of a basis, summed over the drives to fit.
    fn of(&self, basis: &Basis) -> (DMatrix<f64>, DVector<f64>) {
        let information = information_of(&basis.amounts, &self.information);
        (information, score_of(&basis.amounts, &self.score))
    }
}
