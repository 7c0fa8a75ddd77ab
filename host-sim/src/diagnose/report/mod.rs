//! report.json and the page.

mod json;
mod sections;
mod signal;
mod words;

pub use json::to_json;
pub use words::{in_a_sentence, three_digits};

use super::findings::Diagnosis;
use crate::error::Result;
use crate::files::output::stage_text;
use crate::report::page::{PAGE, Page};
use sections::{adopted_section, candidates_section, residual_section};
use std::path::{Path, PathBuf};

const VEHICLE: &str = "vehicle.toml";
const JSON: &str = "report.json";
/// Files that [`write()`] writes, besides those of its tables and figures.
pub const FILES: [&str; 3] = [VEHICLE, JSON, PAGE];

/// Writes report.json, vehicle.toml and the page with its tables and figures, all or none.
///
/// # Errors
/// Returns an error if a file cannot be written.
pub fn write(diagnosis: &Diagnosis, folder: &Path) -> Result<PathBuf> {
    let mut files = page(diagnosis).stage(folder)?;
    let vehicle = folder.join(VEHICLE);
    files.push(stage_text(&vehicle, &diagnosis.vehicle.to_toml())?);
    let json = format!("{:#}\n", to_json(diagnosis));
    files.push(stage_text(&folder.join(JSON), &json)?);
    for file in files {
        file.commit()?;
    }
    Ok(folder.join(PAGE))
}

/// Returns the files that [`write()`] writes.
#[must_use]
pub fn files(diagnosis: &Diagnosis, folder: &Path) -> Vec<PathBuf> {
    let mut files = page(diagnosis).files(folder);
    files.extend([VEHICLE, JSON].map(|name| folder.join(name)));
    files
}

fn page(diagnosis: &Diagnosis) -> Page {
    Page {
        title: format!("What the model of {} lacks", diagnosis.vehicle.name),
        lead: in_a_sentence(diagnosis),
        sections: [
            Some(residual_section(diagnosis)),
            signal::section(diagnosis),
            Some(candidates_section(diagnosis)),
            Some(adopted_section(diagnosis)),
        ]
        .into_iter()
        .flatten()
        .collect(),
    }
}
