//! The first section of a page of drives: whether they are to be trusted.

use super::section::{Note, Section};
use crate::recorder::{RunSummary, Warning};

/// Returns the section of these runs, each with its name.
#[must_use]
pub fn verdict_section(runs: &[(&str, &RunSummary)]) -> Section {
    let suspect = || runs.iter().filter(|(_, of)| of.verdict != "consistent");
    let words = match (runs.len(), suspect().count()) {
        (1, 0) => "Consistent: the signals agree with each other and with the vehicle.".to_owned(),
        (_, 0) => "Consistent: the signals of each run agree with each other and with the vehicle."
            .to_owned(),
        (1, _) => "Suspect: signals disagree.".to_owned(),
        (all, count) => format!("Suspect: signals disagree in {count} of {all} runs."),
    };
    let section = Section::new("Verdict").paragraph(words);
    suspect().fold(section, |section, (name, of)| {
        let marked = format!(
            "{:.2} of {:.2} km are marked as suspect.",
            of.suspect_km, of.distance_km
        );
        section.note(Note::warning(format!("{name}: {}.", of.verdict), marked))
    })
}

/// Returns the section with a note for each warning, behind the words that say whose it is.
#[must_use]
pub fn with_warnings(section: Section, whose: &str, warnings: &[Warning]) -> Section {
    warnings.iter().fold(section, |section, of| {
        section.note(Note::warning(format!("{whose}{}", of.message), of.advice))
    })
}
