//! What it costs if a number of the tuning is wrong by a factor of two: `tests/tuning_costs.csv`.

use super::at_once::at_once;
use super::{Baseline, Change, merged, parameter};
use crate::image::root;
use estimator_core::Tuning;
use estimator_core::tuning::{TuningError, TuningParameter};
use host_sim::error::{Error, Result};
use host_sim::files::csv::{read_csv, write_csv};
use serde::{Deserialize, Serialize};
use std::path::PathBuf;
use std::sync::{Mutex, PoisonError};

/// Command that measures and commits the costs.
pub const WRITE: &str = "cargo run -p cross-tests --example sensitivity -- numbers --write";

/// The changes of a number that is halved, and doubled.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CostRow {
    /// Key of the number.
    pub key: String,
    halved_smoothed_percent: f64,
    halved_lagged_percent: f64,
    halved_live_percent: f64,
    halved_nees_percent: f64,
    doubled_smoothed_percent: f64,
    doubled_lagged_percent: f64,
    doubled_live_percent: f64,
    doubled_nees_percent: f64,
}

impl CostRow {
    fn new(key: &str, halved: &Change, doubled: &Change) -> Self {
        Self {
            key: key.to_owned(),
            halved_smoothed_percent: halved.errors_percent[0],
            halved_lagged_percent: halved.errors_percent[1],
            halved_live_percent: halved.errors_percent[2],
            halved_nees_percent: halved.nees_percent,
            doubled_smoothed_percent: doubled.errors_percent[0],
            doubled_lagged_percent: doubled.errors_percent[1],
            doubled_live_percent: doubled.errors_percent[2],
            doubled_nees_percent: doubled.nees_percent,
        }
    }

    /// Returns the worse of both changes.
    #[must_use]
    pub fn worse(&self) -> Change {
        let halved = Change {
            errors_percent: [
                self.halved_smoothed_percent,
                self.halved_lagged_percent,
                self.halved_live_percent,
            ],
            nees_percent: self.halved_nees_percent,
        };
        let doubled = Change {
            errors_percent: [
                self.doubled_smoothed_percent,
                self.doubled_lagged_percent,
                self.doubled_live_percent,
            ],
            nees_percent: self.doubled_nees_percent,
        };
        halved.worse(doubled)
    }
}

/// Returns the parameters of these keys; all if there are none.
///
/// # Errors
/// Returns an error that names an unknown key.
pub fn parameters(keys: &[String]) -> Result<Vec<&'static TuningParameter>> {
    if keys.is_empty() {
        return Ok(Tuning::PARAMETERS.iter().collect());
    }
    let known = |key: &String| {
        let problem = format!("{key}: unknown key; expected one of docs/tuning.md");
        parameter(key).ok_or(Error::Usage(problem))
    };
    keys.iter().map(known).collect()
}

/// Measures numbers, as many at once as there are processors, and commits each at once if it `writes`.
/// One that cannot be measured costs no other one.
///
/// # Errors
/// Returns an error if the drives cannot be judged with the defaults.
pub fn measure(parameters: &[&TuningParameter], writes: bool) -> Result<Vec<Result<CostRow>>> {
    let file = Mutex::new(writes);
    let baseline = Baseline::measure()?;
    let row = |parameter: &&TuningParameter| {
        let of = |factor| match scaled(parameter, factor) {
            Some(tuning) => baseline.change(parameter.key, &tuning),
            None => Ok(Change::default()),
        };
        let row = CostRow::new(parameter.key, &of(0.5)?, &of(2.0)?);
        // One thread after the other.
        if *file.lock().unwrap_or_else(PoisonError::into_inner) {
            write(&row)?;
        }
        Ok(row)
    };
    let words = |row: &CostRow| format!("{}: {}", row.key, row.worse().line());
    Ok(at_once(parameters, row, words))
}

/// Returns the tuning with a number times a factor, within its range; whole numbers are rounded down.
/// `None` if that is its default.
fn scaled(parameter: &TuningParameter, factor: f64) -> Option<Tuning> {
    let TuningParameter { group, key, .. } = *parameter;
    let mut tuning = Tuning::default();
    let default = tuning.get(group, key)?;
    let value = (default * factor).clamp(parameter.low.into(), parameter.high.into());
    if tuning.set(group, key, value) == Err(TuningError::NotWhole) {
        tuning.set(group, key, value.floor()).ok()?;
    }
    (tuning.get(group, key)? != default).then_some(tuning)
}

/// Returns the path of the committed costs.
#[must_use]
pub fn committed_file() -> PathBuf {
    root().join("tests/tuning_costs.csv")
}

/// Reads the committed costs.
///
/// # Errors
/// Returns an error that names the file and the line.
pub fn committed() -> Result<Vec<CostRow>> {
    read_csv(&committed_file())
}

/// Commits a row. Those of other numbers stay, and those of keys that no longer exist go.
///
/// # Errors
/// Returns the error of the file system.
fn write(row: &CostRow) -> Result<()> {
    let keys = Tuning::PARAMETERS.iter().map(|of| of.key.to_owned());
    let rows = merged(keys, row, &committed()?, |row| row.key.clone());
    write_csv(&committed_file(), rows)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_committed_row_is_of_a_number() {
        let rows = committed().unwrap();
        let unknown = rows.iter().filter(|row| parameter(&row.key).is_none());
        let unknown: Vec<&str> = unknown.map(|row| &*row.key).collect();
        let file = committed_file();
        assert!(
            unknown.is_empty(),
            "{}: unknown keys: {}; to drop their rows: {WRITE} KEY",
            file.display(),
            unknown.join(", ")
        );
    }

    #[test]
    fn every_key_is_of_one_group() {
        for of in Tuning::PARAMETERS {
            let group = parameter(of.key).unwrap().group;
            assert_eq!(group, of.group, "{}", of.key);
        }
    }

    #[test]
    fn every_number_is_halved_and_doubled_within_its_range() {
        for of in Tuning::PARAMETERS {
            let default = Tuning::default().get(of.group, of.key).unwrap();
            for factor in [0.5, 2.0] {
                let tuning = scaled(of, factor).unwrap_or_default();
                let value = tuning.get(of.group, of.key).unwrap();
                let wanted = (default * factor).clamp(of.low.into(), of.high.into());
                let below = wanted - value;
                assert!((0.0..1.0).contains(&below), "{}: {value}", of.key);
                let is_whole = default.fract() == 0.0;
                assert!(below == 0.0 || is_whole, "{}: {value}", of.key);
            }
        }
    }

    #[test]
    fn an_unknown_key_is_an_error_that_names_it() {
        let problem = parameters(&["no_such_key".to_owned()]).unwrap_err();
        let expected = "no_such_key: unknown key; expected one of docs/tuning.md";
        assert_eq!(problem.to_string(), expected);
        assert_eq!(parameters(&[]).unwrap().len(), Tuning::PARAMETERS.len());
    }
}
