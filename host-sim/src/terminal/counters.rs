//! Names of the core's counters.

use estimator_core::Counters;

/// A counter that is not zero.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CountedEvent {
    /// Its key in JSON output; stable.
    pub key: &'static str,
    /// Its name in tables and on the panel.
    pub name: &'static str,
    /// The count.
    pub count: u64,
}

/// Keys whose name differs from the key.
const NAMES: [(&str, &str); 16] = [
    ("frames malformed", "malformed frames"),
    ("fast packets broken", "incomplete fast packets"),
    ("sessions broken", "incomplete transport sessions"),
    ("inputs back in time", "inputs with earlier time stamps"),
    ("inputs far ahead", "inputs with time stamps far ahead"),
    (
        "values of other senders",
        "values of other source addresses",
    ),
    ("sender switches", "source address switches"),
    ("speeds that leapt", "speed jumps"),
    ("speeds that were frozen", "frozen speeds"),
    ("steps of the speed", "speed steps"),
    ("gaps in speed", "speed gaps"),
    ("cells that are no numbers", "non-finite cells"),
    ("cells suspect", "suspect cells"),
    ("stops that reopened the load", "load prior resets at stops"),
    ("fixes of a frozen receiver", "frozen fixes"),
    ("altitudes left out", "altitudes rejected"),
];

/// Returns the name of a counter with this key.
#[must_use]
pub fn name_of(key: &'static str) -> &'static str {
    let known = NAMES.iter().find(|(known, _)| *known == key);
    known.map_or(key, |(_, name)| name)
}

/// Returns the counters that are not zero, in a fixed order.
#[must_use]
pub fn events(c: &Counters) -> Vec<CountedEvent> {
    [
        ("frames malformed", c.frames_malformed.into()),
        ("fast packets broken", c.fast_packets_broken.into()),
        ("sessions broken", c.sessions_broken.into()),
        ("inputs back in time", c.time_backwards.into()),
        ("inputs far ahead", c.times_ahead.into()),
        ("clocks set back", c.clocks_set_back.into()),
        ("long silences", c.silences.into()),
        ("values not available", c.not_available.into()),
        ("values in error", c.errors.into()),
        (
            "parameters replaced by the bus",
            c.parameters_replaced.into(),
        ),
        ("values of other senders", c.other_source.into()),
        ("sender switches", c.source_switches.into()),
        ("rates exceeded", c.rates_exceeded.into()),
        ("speeds that leapt", c.speed_leaps.into()),
        ("speeds that were frozen", c.frozen_speeds.into()),
        ("steps of the speed", c.speed_steps.into()),
        ("slopes measured and used", c.slopes_used.into()),
        ("slopes measured and rejected", c.slopes_rejected.into()),
        ("poor fixes", c.poor_fixes.into()),
        ("gaps in speed", c.gaps.into()),
        (
            "cells lost",
            c.samples_lost.saturating_add(c.cells_lost).into(),
        ),
        ("cells that are no numbers", c.cells_unsound.into()),
        ("cells suspect", c.cells_suspect.into()),
        ("stops that reopened the load", c.loads_reopened.into()),
        ("fixes of a frozen receiver", c.frozen_fixes.into()),
        ("reversals", c.reversals.into()),
        ("altitudes left out", c.altitudes_rejected.into()),
        ("filter restarts", c.restarts.into()),
    ]
    .into_iter()
    .filter(|(_, count)| *count > 0)
    .map(|(key, count)| CountedEvent {
        key,
        name: name_of(key),
        count,
    })
    .collect()
}
