//! What each mechanism of the estimator buys: `tests/mechanisms.csv`.
//!
//! A mechanism is listed if settings of the tuning turn it off. No setting does so for the multipliers of
//! the slow GNSS error, and for hidden brakes and the doubt of a retarder: a large step opens however small
//! its prior is.

use super::at_once::at_once;
use super::{Baseline, Change, merged, parameter};
use crate::image::root;
use estimator_core::Tuning;
use estimator_core::tuning::TuningError;
use host_sim::error::{Error, Result};
use host_sim::files::csv::{read_csv, write_csv};
use serde::{Deserialize, Serialize};
use std::path::PathBuf;
use std::sync::{Mutex, PoisonError};

/// Command that measures and commits the table.
pub const WRITE: &str = "cargo run -p cross-tests --example sensitivity -- mechanisms --write";

/// A mechanism, and what turns it off.
#[derive(Clone, Copy, Debug)]
pub struct Mechanism {
    /// Its name.
    pub name: &'static str,
    /// Keys with their values. Where a number cannot be nought, it is the smallest possible.
    pub off: &'static [(&'static str, f64)],
}

macro_rules! mechanisms {
    ($($name:literal: $($key:ident = $value:literal),+;)*) => {
        /// The mechanisms.
        pub const MECHANISMS: &[Mechanism] = &[$(Mechanism {
            name: $name,
            off: &[$((stringify!($key), $value)),+],
        }),*];
    };
}

mechanisms! {
    "level of the road": road_level_low = 1.0, road_level_high = 1.0;
    "multipliers of the road": road_most = 1.0, live_multiplier = 1.0;
    "both of these": road_level_low = 1.0, road_level_high = 1.0, road_most = 1.0, live_multiplier = 1.0;
    "multipliers without information between mode and mean": uninformed = 0.005;
    "kinks of the road": kink_percent = 0.0001, kink_most_percent = 0.01;
    "rougher road where the force is hidden": invalid_road = 1.0;
    "bias of the force": bias_force_n = 2.0, bias_resistance = 0.002;
    "steps of the bias": bias_shock_percent = 0.00001, bias_shock_most_percent = 0.006,
        step_odds = 0.00001;
    "steps against kinks in their place": step_margin = 0.0;
    "gate of the live filter, revival of closed steps": gate = 10000.0;
    "undecided steps in the sigma": step_odds = 0.00001;
    "scale of the force": prior_scale = 0.001, any_load = 0.005, load_told = 0.001,
        scale_walk_per_sqrt_km = 0.00002;
    "another load after a stop": load_stop_ms = 600000.0;
    "changing wind": wind_noise_mps = 0.008;
    "traction that changes": traction_noise = 0.0002;
    "levels of force, speed and receiver": level_low = 1.0, level_high = 1.0, slow_gnss_level_low = 1.0;
    "weights of fixes, multipliers of the road": freedom = 400.0;
    "delays of receiver and force": delay_evidence = 1000000000.0;
    "torque that rests": rest_doubt = 0.005, rest_walk_percent = 0.006;
    "cold tyres": prior_cold_tyre = 0.005;
    "slip of the tyres": prior_tyre_slip = 0.0002;
    "factor of the retarder": prior_retarder = 0.004;
    "noise of a retarder that changes": retarder_step_noise = 0.02;
    "noise of a launch": inertia_noise = 0.005;
    "age of signals in the sigma": timing_s = 0.002;
}

/// The changes where a mechanism is off.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct MechanismRow {
    /// Name of the mechanism.
    pub name: String,
    /// What turns it off.
    pub settings: String,
    smoothed_percent: f64,
    lagged_percent: f64,
    live_percent: f64,
    nees_percent: f64,
}

impl MechanismRow {
    fn new(mechanism: &Mechanism, change: &Change) -> Self {
        let [smoothed_percent, lagged_percent, live_percent] = change.errors_percent;
        Self {
            name: mechanism.name.to_owned(),
            settings: mechanism.settings(),
            smoothed_percent,
            lagged_percent,
            live_percent,
            nees_percent: change.nees_percent,
        }
    }

    /// Returns the changes.
    #[must_use]
    pub const fn change(&self) -> Change {
        Change {
            errors_percent: [
                self.smoothed_percent,
                self.lagged_percent,
                self.live_percent,
            ],
            nees_percent: self.nees_percent,
        }
    }

    /// Returns true if it is of this mechanism, turned off as it is now.
    #[must_use]
    pub fn is_of(&self, mechanism: &Mechanism) -> bool {
        self.name == mechanism.name && self.settings == mechanism.settings()
    }
}

impl Mechanism {
    /// Returns what turns it off, as in the table.
    #[must_use]
    pub fn settings(&self) -> String {
        let settings = self
            .off
            .iter()
            .map(|(key, value)| format!("{key} = {value}"));
        settings.collect::<Vec<_>>().join("; ")
    }

    /// Returns the tuning without it.
    ///
    /// # Errors
    /// Returns an error that names a key that is unknown or cannot have its value.
    pub fn off_tuning(&self) -> Result<Tuning> {
        let mut tuning = Tuning::default();
        for (key, value) in self.off {
            let set = parameter(key)
                .ok_or(TuningError::Unknown)
                .and_then(|of| tuning.set(of.group, key, *value));
            set.map_err(|problem| {
                let name = self.name;
                let problem =
                    format!("\"{name}\": {key} = {value}: {problem}; change the list here");
                Error::content(&root().join("tests/src/sensitivity/mechanisms.rs"), problem)
            })?;
        }
        Ok(tuning)
    }
}

/// Returns the mechanisms of these names; all if there are none.
///
/// # Errors
/// Returns an error that names an unknown one.
pub fn mechanisms(names: &[String]) -> Result<Vec<&'static Mechanism>> {
    if names.is_empty() {
        return Ok(MECHANISMS.iter().collect());
    }
    let known = |name: &String| {
        let problem = format!("{name}: unknown mechanism; expected one of docs/theory.md");
        let mut all = MECHANISMS.iter();
        all.find(|of| of.name == name).ok_or(Error::Usage(problem))
    };
    names.iter().map(known).collect()
}

/// Measures mechanisms, as many at once as there are processors, and commits each at once if it
/// `writes`. One that cannot be measured costs no other one.
///
/// # Errors
/// Returns an error if one of them has an impossible setting, or if the drives cannot be judged with the
/// defaults.
pub fn measure(mechanisms: &[&Mechanism], writes: bool) -> Result<Vec<Result<MechanismRow>>> {
    let tunings = mechanisms.iter().map(|of| Ok((*of, of.off_tuning()?)));
    let tunings: Vec<(&Mechanism, Tuning)> = tunings.collect::<Result<_>>()?;
    let file = Mutex::new(writes);
    let baseline = Baseline::measure()?;
    let row = |(mechanism, tuning): &(&Mechanism, Tuning)| {
        let change = baseline.change(mechanism.name, tuning)?;
        let row = MechanismRow::new(mechanism, &change);
        // One thread after the other.
        if *file.lock().unwrap_or_else(PoisonError::into_inner) {
            write(&row)?;
        }
        Ok(row)
    };
    let words = |row: &MechanismRow| format!("{}: {}", row.name, row.change().line());
    Ok(at_once(&tunings, row, words))
}

/// Returns the path of the committed table.
#[must_use]
pub fn committed_file() -> PathBuf {
    root().join("tests/mechanisms.csv")
}

/// Reads the committed table.
///
/// # Errors
/// Returns an error that names the file and the line.
pub fn committed() -> Result<Vec<MechanismRow>> {
    read_csv(&committed_file())
}

/// Commits a row. Those of mechanisms that are no longer listed go.
///
/// # Errors
/// Returns the error of the file system.
fn write(row: &MechanismRow) -> Result<()> {
    let names = MECHANISMS.iter().map(|of| of.name.to_owned());
    let rows = merged(names, row, &committed()?, |row| row.name.clone());
    write_csv(&committed_file(), rows)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_mechanism_can_be_turned_off() {
        for mechanism in MECHANISMS {
            let tuning = mechanism
                .off_tuning()
                .unwrap_or_else(|error| panic!("{error}"));
            assert_ne!(tuning, Tuning::default(), "{}", mechanism.name);
        }
    }

    #[test]
    fn an_unknown_key_and_an_impossible_value_are_errors_that_name_them() {
        let problem = |off| {
            let error = Mechanism { name: "a", off }.off_tuning().unwrap_err();
            error.to_string()
        };
        let unknown = problem(&[("no_such_key", 1.0)]);
        assert!(
            unknown.contains("\"a\": no_such_key = 1: unknown key"),
            "{unknown}"
        );
        const FAR: &[(&str, f64)] = &[(MECHANISMS[0].off[0].0, 1e30)];
        let far = problem(FAR);
        assert!(far.contains("expected a value from"), "{far}");
    }

    #[test]
    fn every_committed_row_is_of_a_listed_mechanism() {
        for row in committed().unwrap() {
            let is_listed = MECHANISMS.iter().any(|mechanism| row.is_of(mechanism));
            let file = committed_file();
            assert!(
                is_listed,
                "{}: {} with {} is not listed; to measure anew: {WRITE}",
                file.display(),
                row.name,
                row.settings
            );
        }
    }
}
