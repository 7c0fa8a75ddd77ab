//! Whether drives are to be trusted: the first words of a page, and the section behind them.

use super::page::Page;
use super::section::{Note, Section};
use crate::recorder::{RunSummary, Warning};

/// Returns the page with the verdict on these runs before its lead, and behind it what is wrong, if
/// anything is.
#[must_use]
pub fn with_verdict(mut page: Page, runs: &[(&str, &RunSummary)], wrong: Section) -> Page {
    page.lead = format!("{} {}", verdict(runs), page.lead);
    if !wrong.notes.is_empty() {
        page.sections.insert(0, wrong);
    }
    page
}

/// Returns in a sentence whether these runs are to be trusted.
fn verdict(runs: &[(&str, &RunSummary)]) -> String {
    match (runs.len(), suspect(runs).count()) {
        (1, 0) => "Consistent: the signals agree with each other and with the vehicle.".to_owned(),
        (_, 0) => "Consistent: the signals of each run agree with each other and with the vehicle."
            .to_owned(),
        (1, _) => "Suspect: signals disagree.".to_owned(),
        (all, count) => format!("Suspect: signals disagree in {count} of {all} runs."),
    }
}

/// Returns a section with a note for each of these runs that is suspect.
#[must_use]
pub fn suspect_section(runs: &[(&str, &RunSummary)]) -> Section {
    suspect(runs).fold(Section::new("What is wrong"), |section, (name, of)| {
        let marked = format!(
            "{:.2} of {:.2} km are marked as suspect.",
            of.suspect_km, of.distance_km
        );
        section.note(Note::warning(format!("{name}: {}.", of.verdict), marked))
    })
}

fn suspect<'a>(
    runs: &'a [(&'a str, &'a RunSummary)],
) -> impl Iterator<Item = &'a (&'a str, &'a RunSummary)> {
    runs.iter().filter(|(_, of)| of.verdict != "consistent")
}

/// Returns the section with a note for each warning, behind the words that say whose it is.
#[must_use]
pub fn with_warnings(section: Section, whose: &str, warnings: &[Warning]) -> Section {
    warnings.iter().fold(section, |section, of| {
        section.note(Note::warning(format!("{whose}{}", of.message), of.advice))
    })
}
