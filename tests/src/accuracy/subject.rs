//! What is judged.

use super::errors::Errors;
use super::table::AccuracyRow;
use super::{bus_passes, car_trips, simulated_drive, track_laps};
use crate::image::measured_mission;
use estimator_core::Tuning;
use host_sim::error::Result;
use rayon::prelude::*;

/// What gives one or two names in the table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Subject {
    /// A drive of another simulator.
    Drive(&'static str),
    /// A trip of the measured car.
    Trip(&'static str),
    /// All trips of the measured car.
    Trips,
    /// The measured truck on a track.
    Laps,
    /// The measured bus.
    Passes,
}

use Subject::{Drive, Laps, Passes, Trip, Trips};

/// What `tests/run` judges.
pub const QUICK: &[Subject] = &[
    Drive("e4-a2"),
    Drive("nrel-linehaul-32t"),
    Drive("regional-28t"),
    Drive("hills-60t"),
    Trip("TripA08"),
];

/// What `tests/run all` judges besides. What takes longest comes first.
pub const OTHERS: &[Subject] = &[
    Trips,
    Passes,
    Laps,
    Drive("e4-a0"),
    Drive("e4-b2"),
    Drive("e4-b3"),
    Drive("motorway-b0"),
    Drive("wind-a4"),
    Drive("full-load-12km"),
    Drive("coach-e4-19t"),
    Drive("flat-foot-40t"),
    Drive("traffic-24t"),
    Drive("city-hilly-12t"),
];

impl Subject {
    /// Returns its names in the table.
    #[must_use]
    pub fn names(self) -> Vec<String> {
        let name = |name: &str| vec![name.to_owned()];
        match self {
            Drive(drive) => name(drive),
            Trip(trip) => vec![format!("i3-{trip}")],
            Trips => ["i3-median", "i3-nine-in-ten"].map(str::to_owned).into(),
            Laps => name("peterbilt-laps"),
            Passes => name("ztbus-passes"),
        }
    }

    /// Returns whether its data are present.
    #[must_use]
    pub fn is_present(self) -> bool {
        match self {
            Drive(drive) => simulated_drive::folder(drive).exists(),
            Trip(trip) => car_trips::file(trip).exists(),
            Trips => car_trips::folder().exists(),
            Laps => track_laps::folder().exists(),
            Passes => measured_mission().exists(),
        }
    }

    /// Judges it. Returns the errors of each of its names.
    ///
    /// # Errors
    /// Returns an error if its data cannot be read.
    pub fn errors(self, tuning: &Tuning) -> Result<Vec<Errors>> {
        Ok(match self {
            Drive(drive) => vec![simulated_drive::judge(drive, tuning)?],
            Trip(trip) => vec![car_trips::judge(&car_trips::file(trip), tuning)?],
            Trips => car_trips::judge_all(tuning)?.into(),
            Laps => vec![track_laps::judge(tuning)?],
            Passes => vec![bus_passes::judge(tuning)?],
        })
    }

    fn rows(self, tuning: &Tuning) -> Result<Vec<AccuracyRow>> {
        let named = self.names().into_iter().zip(self.errors(tuning)?);
        let rows = named.map(|(name, errors)| AccuracyRow::new(&name, &errors));
        Ok(rows.collect())
    }
}

/// Errors of what is present.
#[derive(Clone, Debug, Default)]
pub struct Measured {
    /// In the order of the subjects.
    pub rows: Vec<AccuracyRow>,
    /// Names of what is absent.
    pub absent: Vec<String>,
}

/// Judges these subjects, several at once.
///
/// # Errors
/// Returns an error if what is present of the data cannot be read.
pub fn measure(subjects: &[Subject], tuning: &Tuning) -> Result<Measured> {
    let (present, absent): (Vec<Subject>, Vec<Subject>) = subjects
        .iter()
        .copied()
        .partition(|subject| subject.is_present());
    let rows = present
        .par_iter()
        .with_max_len(1)
        .map(|subject| subject.rows(tuning));
    let rows: Vec<Vec<AccuracyRow>> = rows.collect::<Result<_>>()?;
    Ok(Measured {
        rows: rows.concat(),
        absent: absent.into_iter().flat_map(Subject::names).collect(),
    })
}

#[cfg(test)]
mod tests {
    use super::super::table::committed;
    use super::*;

    #[test]
    fn the_committed_table_has_all_that_is_judged_and_nothing_else() {
        let subjects = QUICK.iter().chain(OTHERS);
        let mut expected: Vec<String> = subjects.flat_map(|subject| subject.names()).collect();
        let rows = committed().unwrap();
        let mut found: Vec<String> = rows.into_iter().map(|row| row.drive).collect();
        expected.sort();
        found.sort();
        assert_eq!(found, expected);
    }
}
