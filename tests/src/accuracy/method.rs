//! A log through each method of the estimator.

use estimator_core::{Model, Tuning};
use host_sim::error::{Error, Result};
use host_sim::files::run::RunRow;
use host_sim::recorder::Recorder;
use host_sim::source::input::for_each_input;
use host_sim::source::read_options::ReadOptions;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// How the variances of the noises are found, as `estimate --method` names it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Method {
    /// By detectors of single faults.
    Detectors,
    /// All by one inference.
    Robust,
}

impl Method {
    /// All of them.
    pub const ALL: [Self; 2] = [Self::Detectors, Self::Robust];

    /// Returns its name.
    #[must_use]
    pub const fn word(self) -> &'static str {
        match self {
            Self::Detectors => "detectors",
            Self::Robust => "robust",
        }
    }

    /// Returns true if its sigmas must be honest. Those of the detectors never were on these drives.
    #[must_use]
    pub const fn is_held_to_nees(self) -> bool {
        matches!(self, Self::Robust)
    }
}

/// Estimates a log by each method, as `estimate` does. Reads it once.
///
/// # Errors
/// Returns an error for a vehicle or a log that `estimate` refuses.
pub fn runs(
    log: &Path,
    model: &Model,
    options: &ReadOptions,
) -> Result<Vec<(Method, Vec<RunRow>)>> {
    let mut recorders = Vec::new();
    for method in Method::ALL {
        let mut recorder = Recorder::<f32>::new(model.clone(), Tuning::default())
            .map_err(|error| Error::content(log, error.to_string()))?;
        recorder.read_as(options);
        if method == Method::Robust {
            recorder.infer_variances();
        }
        recorders.push((method, recorder));
    }
    for_each_input(
        log,
        options,
        |_| (),
        |input| {
            for (_, recorder) in &mut recorders {
                recorder.on_input(&input);
            }
        },
    )?;
    let runs = recorders.into_iter();
    runs.map(|(method, recorder)| Ok((method, recorder.finish()?.rows)))
        .collect()
}
