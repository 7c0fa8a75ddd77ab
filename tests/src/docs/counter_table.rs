//! The counters: their names, their meaning, and their words in `roadgrade`.

use super::pipe_table::pipe_table;
use crate::image::root;
use estimator_core::Counters;
use host_sim::error::{Error, Result};
use host_sim::terminal::counters::events;
use std::fs;

/// Lists all counters by name. The pattern names every field, so a name that is missing below does
/// not compile.
macro_rules! counters {
    ($($name:ident)*) => {
        /// Returns the name of each counter, with counters of which only this one is not zero.
        fn each() -> Vec<(&'static str, Counters)> {
            let Counters { $($name: _),* } = Counters::default();
            vec![$((stringify!($name), Counters { $name: 1, ..Counters::default() })),*]
        }
    };
}

counters! {
    frames frames_decoded frames_ignored frames_malformed fast_packets_broken
    sessions_broken time_backwards times_ahead clocks_set_back silences
    not_available errors parameters_replaced other_source source_switches rates_exceeded
    speed_leaps frozen_speeds speeds_used tractions_used poor_fixes frozen_fixes reversals gaps
    samples_lost cells_lost cells_unsound cells_suspect steps invalid_steps
    altitudes_used altitudes_rejected slopes_used slopes_rejected speed_steps
    loads_reopened restarts
}

/// Makes the table of all counters.
pub fn counters() -> Result<Option<String>> {
    let path = root().join("estimator-core/src/counters.rs");
    let source = fs::read_to_string(&path).map_err(Error::io(&path))?;
    let mut rows = Vec::new();
    for (name, counts) in each() {
        let events = events(&counts);
        let event = events.first();
        let meaning = meaning(&source, name)
            .ok_or_else(|| Error::content(&path, format!("no documentation of {name}")))?;
        rows.push([
            format!("`{name}`"),
            meaning,
            event.map_or("—", |event| event.key).to_owned(),
            event.map_or("—", |event| event.name).to_owned(),
        ]);
    }
    Ok(Some(pipe_table(
        ["counter", "what it counts", "key in JSON", "name in tables"],
        rows,
    )))
}

/// Returns the documentation of a counter.
fn meaning(source: &str, name: &str) -> Option<String> {
    let (before, _) = source.split_once(&format!("pub {name}: "))?;
    let lines = before.lines().rev().skip(1);
    let mut words: Vec<&str> = lines
        .map_while(|line| line.trim().strip_prefix("///"))
        .map(str::trim)
        .collect();
    words.reverse();
    (!words.is_empty()).then(|| words.join(" "))
}
