//! Errors with another tuning beside those with the defaults.

use super::drives;
use crate::accuracy::errors::Errors;
use crate::image::root;
use estimator_core::Tuning;
use host_sim::error::{Error, Result};
use host_sim::numeric::statistics::mean;

/// The errors with the defaults, one for each name of the drives.
#[derive(Clone, Debug)]
pub struct Baseline(Vec<Errors>);

/// By how much a tuning changes the errors, %: of the geometric mean over the drives.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Change {
    /// Of the root mean square errors, in the order of [`Estimate::ALL`].
    ///
    /// [`Estimate::ALL`]: crate::accuracy::estimate::Estimate::ALL
    pub errors_percent: [f64; 3],
    /// Of the NEES of all three.
    pub nees_percent: f64,
}

impl Baseline {
    /// Judges the defaults.
    ///
    /// # Errors
    /// Returns an error if a drive is absent or cannot be read.
    pub fn measure() -> Result<Self> {
        let absent = drives().filter(|drive| !drive.is_present());
        let absent: Vec<String> = absent.flat_map(|drive| drive.names()).collect();
        if !absent.is_empty() {
            let absent = absent.join(", ");
            let problem = format!("no data of {absent}; expected those of all drives");
            return Err(Error::content(&root().join("../shared"), problem));
        }
        judged(&Tuning::default()).map(Self)
    }

    /// Judges a tuning that has this name.
    ///
    /// # Errors
    /// Returns an error that has the name if a drive cannot be estimated with it.
    pub fn change(&self, name: &str, tuning: &Tuning) -> Result<Change> {
        let after = judged(tuning).map_err(|error| Error::Usage(format!("{name}: {error}")))?;
        Ok(between(&self.0, &after))
    }
}

/// Judges one drive after the other: several tunings are judged at once.
fn judged(tuning: &Tuning) -> Result<Vec<Errors>> {
    let mut all = Vec::new();
    for drive in drives() {
        for (name, errors) in drive.names().iter().zip(drive.errors(tuning)?) {
            let figures = errors.rmse_percent.iter().chain(&errors.nees);
            if figures.into_iter().any(|figure| !figure.is_finite()) {
                return Err(Error::Usage(format!("{name}: nothing is judged")));
            }
            all.push(errors);
        }
    }
    Ok(all)
}

fn between(before: &[Errors], after: &[Errors]) -> Change {
    let ratios = |of: &dyn Fn(&Errors) -> f64| -> Vec<f64> {
        let pairs = before.iter().zip(after);
        pairs
            .map(|(before, after)| of(after) / of(before))
            .collect()
    };
    let nees = (0..3).flat_map(|k| ratios(&|errors| errors.nees[k]));
    Change {
        errors_percent: std::array::from_fn(|k| percent(&ratios(&|of| of.rmse_percent[k]))),
        nees_percent: percent(&nees.collect::<Vec<_>>()),
    }
}

/// Returns the geometric mean of ratios less one, rounded to 0.1 %.
fn percent(ratios: &[f64]) -> f64 {
    let logarithms: Vec<f64> = ratios.iter().map(|ratio| ratio.ln()).collect();
    let percent = 100.0 * mean(&logarithms).exp_m1();
    // Not the zero below zero.
    (percent * 10.0).round() / 10.0 + 0.0
}

impl Change {
    /// Returns the worse of two: the larger errors, and the NEES that changes by the larger factor.
    #[must_use]
    pub fn worse(self, other: Self) -> Self {
        let factor = |percent: f64| (percent / 100.0).ln_1p().abs();
        let (one, two) = (self.nees_percent, other.nees_percent);
        Self {
            errors_percent: std::array::from_fn(|k| {
                self.errors_percent[k].max(other.errors_percent[k])
            }),
            nees_percent: if factor(two) > factor(one) { two } else { one },
        }
    }

    /// Returns the changes of smoothed, lagged and live errors, and of the NEES, as words: %.
    #[must_use]
    pub fn words(&self) -> [String; 4] {
        let [smoothed, lagged, live] = self.errors_percent;
        [smoothed, lagged, live, self.nees_percent].map(|percent| {
            let words = format!("{percent:+.1}").replace('-', "−");
            match &*words {
                "+0.0" | "−0.0" => "0.0".to_owned(),
                _ => words,
            }
        })
    }

    /// Returns the same in one line.
    #[must_use]
    pub fn line(&self) -> String {
        let [smoothed, lagged, live, nees] = self.words();
        format!("{smoothed} / {lagged} / {live}; {nees}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn errors(smoothed: f64, lagged: f64, nees: f64) -> Errors {
        Errors {
            rmse_percent: [smoothed, lagged, 0.3],
            nees: [nees, 1.0, 1.0],
        }
    }

    #[test]
    fn a_change_is_that_of_the_geometric_mean() {
        let before = [errors(0.1, 0.2, 1.0), errors(0.4, 0.2, 1.0)];
        // Twice as large on one drive and half as large on another: nothing.
        let after = [errors(0.2, 0.22, 4.0), errors(0.2, 0.22, 2.0)];
        let change = between(&before, &after);
        assert_eq!(change.errors_percent, [0.0, 10.0, 0.0]);
        // The sixth root of 4 times 2.
        assert_eq!(change.nees_percent, 41.4);
        assert_eq!(between(&before, &before), Change::default());
    }

    #[test]
    fn the_worse_one_has_larger_errors_and_a_nees_farther_off() {
        let of = |live_percent, nees_percent| Change {
            errors_percent: [1.0, -2.0, live_percent],
            nees_percent,
        };
        assert_eq!(of(3.0, 40.0).worse(of(-4.0, -50.0)), of(3.0, -50.0));
        assert_eq!(of(-3.0, 40.0).worse(of(4.0, -20.0)), of(4.0, 40.0));
    }

    #[test]
    fn a_change_has_a_sign_unless_it_is_none() {
        let change = Change {
            errors_percent: [12.34, -0.04, 0.0],
            nees_percent: -1.26,
        };
        assert_eq!(change.words(), ["+12.3", "0.0", "0.0", "−1.3"]);
    }
}
