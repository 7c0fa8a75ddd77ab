//! The methods that are compared on the same drives.

use super::experiment::Experiment;
use super::measure::{RunErrors, errors, merged, nees, rmse};
use super::replica::Replica;
use super::{ours, thesis};
use crate::comparison::{self, MeasuredDrive, Profile};
use rayon::prelude::*;

/// A grade estimation method that uses the whole drive.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ThesisMethod {
    /// Section 3 of the thesis.
    Original,
    /// Section 8.1 of the thesis.
    Modified,
    /// Our estimator, smoothed.
    Ours,
}

/// A run estimated by one method.
#[derive(Clone, Debug)]
pub struct Estimated {
    /// The run.
    pub experiment: Experiment,
    /// Its estimate.
    pub profile: Profile,
    /// Errors of the estimate.
    pub errors: RunErrors,
    /// Mean normalised squared error: 1 if the stated sigmas are consistent.
    pub nees: f64,
    /// RMSE(m): of the map of this and all runs before it in the same direction, %.
    pub rmse_merged: f64,
}

impl ThesisMethod {
    /// All methods, in the order of the comparison.
    pub const ALL: [Self; 3] = [Self::Original, Self::Modified, Self::Ours];
    /// The methods of the thesis.
    pub const OF_THESIS: [Self; 2] = [Self::Original, Self::Modified];

    /// Returns the name of the method in names of files and columns.
    #[must_use]
    pub const fn word(self) -> &'static str {
        match self {
            Self::Original => "original",
            Self::Modified => "modified",
            Self::Ours => "ours",
        }
    }

    /// Returns the name of the method in captions.
    #[must_use]
    pub const fn phrase(self) -> &'static str {
        match self {
            Self::Original => "original method",
            Self::Modified => "modified method",
            Self::Ours => "our estimator",
        }
    }

    /// Returns µ, σ, RMSE(v), RMSE(a) and RMSE(m) of a run in the thesis, if it has the method.
    #[must_use]
    pub fn of_thesis(self, experiment: Experiment) -> Option<[f64; 5]> {
        let all = match self {
            Self::Original => thesis::original(experiment.heading),
            Self::Modified => thesis::modified(experiment.heading),
            Self::Ours => return None,
        };
        all.get(experiment.number - 1).copied()
    }

    /// Estimates the grade of a run.
    #[must_use]
    pub fn estimate(self, run: &Replica) -> Profile {
        self.estimate_drive(&run.drive)
    }

    /// Estimates the grade of a drive.
    #[must_use]
    pub fn estimate_drive(self, drive: &MeasuredDrive) -> Profile {
        match self {
            Self::Original => comparison::ComparisonMethod::Original.estimate(drive),
            Self::Modified => comparison::ComparisonMethod::Modified.estimate(drive),
            Self::Ours => ours::estimate(drive).smoothed,
        }
    }

    /// Returns all runs, estimated, and merged one by one in each direction.
    #[must_use]
    pub fn apply(self, runs: &[Replica]) -> Vec<Estimated> {
        let profiles: Vec<Profile> = runs.par_iter().map(|run| self.estimate(run)).collect();
        let mut found: Vec<Estimated> = Vec::new();
        for (run, profile) in runs.iter().zip(profiles) {
            let mut members: Vec<&Profile> = found
                .iter()
                .filter(|before| before.experiment.heading == run.experiment.heading)
                .map(|before| &before.profile)
                .collect();
            members.push(&profile);
            found.push(Estimated {
                experiment: run.experiment,
                errors: errors(run, &profile.grade_percent),
                nees: nees(&run.truth, &profile),
                rmse_merged: rmse(&run.truth, &merged(&members)),
                profile,
            });
        }
        found
    }
}
