//! Messages of a fusion.

use crate::error::{Error, Result, on_one_line};
use crate::map::fusion::grade_map::{Agreement, FusedMap};
use crate::map::geometry::grid::GRID_M;
use crate::map::matching::placing::Coverage;
use crate::terminal::print::{alert, note};
use std::path::Path;

/// Prints a summary of the fusion.
pub fn report(out: &Path, fused: &FusedMap) {
    let cells: usize = fused.ways.iter().map(|way| way.rows.len()).sum();
    let km = cells as f64 * GRID_M / 1000.0;
    let ways = match fused.ways.len() {
        1 => String::new(),
        ways => format!(" on {ways} ways"),
    };
    note(format_args!(
        "{}: {cells} cells, {km:.2} km{ways}",
        on_one_line(out)
    ));
    for (name, agreement) in &fused.within {
        report_agreement(&format!("runs of session {name}"), agreement);
    }
    report_agreement("sessions", &fused.between);
}

/// Prints how well estimates agree, where two of them meet.
fn report_agreement(who: &str, agreement: &Agreement) {
    let Agreement {
        disagreement,
        dependence,
    } = agreement;
    let Some(ratio) = disagreement.ratio() else {
        return;
    };
    let inflation = if dependence.inflation > 1.0 {
        format!(
            ", sigmas made {:.2} times as large",
            dependence.inflation.sqrt()
        )
    } else {
        String::new()
    };
    note(format_args!(
        "{who} differ by {:.2} times their sigmas (squared: {ratio:.2}); taken as \
         common: {:.0} % of the variance{inflation}",
        ratio.sqrt(),
        100.0 * dependence.share
    ));
}

/// Prints the coverage of the road by a run; one that covers nothing is a warning.
pub fn report_coverage(path: &Path, coverage: &Coverage) {
    let Coverage {
        cells,
        matched,
        off_road,
        opposite,
        no_position,
    } = coverage;
    let words = format!(
        "{}: {cells} cells: {matched} matched, {off_road} off the road, {opposite} in the \
         opposite direction, {no_position} without position",
        on_one_line(path)
    );
    if *matched > 0 {
        note(words);
    } else if opposite > off_road {
        alert(format_args!(
            "{words}; warning: opposite direction; fuse it with runs of its own direction"
        ));
    } else {
        alert(format_args!("{words}; warning: never on the road"));
    }
}

/// Reports a damaged file that is left out.
///
/// # Errors
/// Returns the error if it counts as one here, or if it is one of the machine and not of the file.
pub fn report_left_out(e: Error, is_error: bool) -> Result<()> {
    if is_error || e.is_of_the_machine() {
        return Err(e);
    }
    alert(format_args!("{e}: left out"));
    Ok(())
}
