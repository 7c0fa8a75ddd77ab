//! The accuracy guard: errors of the estimator on what our own simulator has no part in.
//!
//! The errors are committed in `tests/accuracy.csv`. Drives of other simulators have a known grade
//! ([`simulated_drive`]). A measured car has an accelerometer ([`car_trips`]), a truck on a track
//! has the mean of many laps ([`track_laps`]), a bus has its other passes ([`bus_passes`]).
//!
//! * [`subject`]: what is judged, in the quick set and beside it;
//! * [`mod@run`]: a log through the estimator;
//! * [`errors`], [`estimate`], [`window_means`]: errors of cells and of windows;
//! * [`table`](mod@table): the rows, and their file;
//! * [`limits`]: what may change.
//!
//! The data are read from `../shared`. What is absent is not judged.

pub mod bus_passes;
pub mod car_trips;
pub mod errors;
pub mod estimate;
pub mod limits;
pub mod run;
pub mod simulated_drive;
pub mod subject;
pub mod table;
pub mod track_laps;
pub mod window_means;

use estimator_core::Tuning;
use host_sim::error::Result;
use limits::{Comparison, WRITE, compare};
use subject::{Subject, measure};
use table::{committed, text};

/// Judges these subjects beside the committed table. Prints the errors, what is better, and what is
/// absent. Returns what is worse than allowed, one line each, and how to accept it; empty if nothing
/// is.
///
/// # Errors
/// Returns an error if the table or what is present of the data cannot be read.
pub fn check(subjects: &[Subject]) -> Result<String> {
    let committed = committed()?;
    let measured = measure(subjects, &Tuning::default())?;
    if !measured.absent.is_empty() {
        let names = measured.absent.join(", ");
        eprintln!("SKIPPED: the accuracy of {names}: no such data in ../shared");
    }
    if !measured.rows.is_empty() {
        println!("{}", text(&measured.rows, &committed));
    }
    let Comparison { worse, better } = compare(&measured.rows, &committed);
    if !better.is_empty() {
        println!("{}\nto keep this: {WRITE}", better.join("\n"));
    }
    if worse.is_empty() {
        return Ok(String::new());
    }
    Ok(format!("{}\nto accept this: {WRITE}", worse.join("\n")))
}
