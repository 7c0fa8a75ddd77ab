//! A measured car with an accelerometer: estimates that do not see it, judged by it.
//!
//! The accelerometer gives the grade without a force model ([`crate::inertial_judge`]). Its own
//! errors are worked out first: offset, pitch of the body, delay, window ends; and its floor, from
//! roads that were driven more than once.

mod bare;
mod brakes;
mod comparison;
mod effects;
mod figures;
mod floor;
mod found;
mod interval;
mod means;
mod own_errors;
mod repeats;
mod tables;
mod trips;

use super::definition::{Setting, Study, StudyOutcome};
use crate::error::{Error, Result};
use crate::files::vehicle::VehicleFile;
use crate::report::page::Section;
use crate::source::i3::vehicle;
use estimator_core::Model;
use found::{Found, WINDOWS_M};
use std::path::Path;
use trips::JudgedTrip;

/// The study, for the list.
pub const STUDY: Study = Study {
    name: "i3",
    about: "a measured car: estimates and the bare model against its accelerometer, by season",
    run,
};

fn run(setting: &Setting) -> Result<StudyOutcome> {
    let (published, with_effects) = (vehicle().model, with_effects()?);
    let mut found = Vec::new();
    for file in trips::files(&setting.data) {
        found.extend(trips::judged(&file, &published, &with_effects)?.map(Found::of));
    }
    if found.is_empty() {
        return Ok(StudyOutcome::Skipped(
            "no i3/Trip*.csv.gz with an accelerometer in it; expected trips of the BMW i3 (--data \
             DIR)"
                .to_owned(),
        ));
    }
    Ok(StudyOutcome::Done(section(&found, setting.seed)))
}

/// Returns the model with the effects that `diagnose` found on 17 of these trips.
fn with_effects() -> Result<Model> {
    let path = Path::new("host-sim/vehicles/i3.toml");
    let table = toml::from_str(include_str!("../../vehicles/i3.toml"))
        .map_err(|error| Error::content(path, error.to_string()))?;
    Ok(VehicleFile::from_table(table, path)?.model)
}

fn section(found: &[Found], seed: u64) -> Section {
    let judged: Vec<JudgedTrip> = found.iter().map(|of| of.trip.clone()).collect();
    let repeats = repeats::repeats(&judged, WINDOWS_M);
    Section {
        heading: "A measured car with an accelerometer".to_owned(),
        words: vec![
            "BMW i3 around Munich, in summer and winter. The judge is the grade by the \
             accelerometer: the work of what it reads, less the change of kinetic energy, over \
             weight and way. Estimates are made without it, with the parameters that are published; \
             nothing is fitted but in the table that says so. The judge's offset is not the road's: it is removed by trip, and told \
             apart."
                .to_owned(),
            "The published elevation is interpolated between points minutes apart. Only these \
             points are used; its slope between them is what a file without a vehicle model tells."
                .to_owned(),
        ],
        tables: vec![
            tables::groups(found, seed),
            effects::table(found),
            tables::trips(found),
            tables::own(found),
            floor::table(&repeats, seed),
        ],
        figures: figures::figures(found),
        ..Section::default()
    }
}
