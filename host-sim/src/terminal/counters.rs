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

/// Returns the counters that are not zero, in a fixed order.
#[must_use]
pub fn events(c: &Counters) -> Vec<CountedEvent> {
    let same = |name, count: u64| CountedEvent {
        key: name,
        name,
        count,
    };
    let named = |key, name, count: u64| CountedEvent { key, name, count };
    [
        named(
            "frames malformed",
            "malformed frames",
            c.frames_malformed.into(),
        ),
        named(
            "fast packets broken",
            "incomplete fast packets",
            c.fast_packets_broken.into(),
        ),
        named(
            "inputs back in time",
            "inputs with earlier time stamps",
            c.time_backwards.into(),
        ),
        named(
            "inputs far ahead",
            "inputs with time stamps far ahead",
            c.times_ahead.into(),
        ),
        same("clocks set back", c.clocks_set_back.into()),
        same("long silences", c.silences.into()),
        same("values not available", c.not_available.into()),
        same("values in error", c.errors.into()),
        named(
            "values of other senders",
            "values of other source addresses",
            c.other_source.into(),
        ),
        named(
            "sender switches",
            "source address switches",
            c.source_switches.into(),
        ),
        same("rates exceeded", c.rates_exceeded.into()),
        named("speeds that leapt", "speed jumps", c.speed_leaps.into()),
        named(
            "speeds that were frozen",
            "frozen speeds",
            c.frozen_speeds.into(),
        ),
        named("steps of the speed", "speed steps", c.speed_steps.into()),
        same("poor fixes", c.poor_fixes.into()),
        named("gaps in speed", "speed gaps", c.gaps.into()),
        same(
            "cells lost",
            c.samples_lost.saturating_add(c.cells_lost).into(),
        ),
        named(
            "cells that are no numbers",
            "non-finite cells",
            c.cells_unsound.into(),
        ),
        named(
            "cells with brakes guessed",
            "cells with inferred braking",
            c.brakes_guessed.into(),
        ),
        named(
            "stops that reopened the load",
            "load prior resets at stops",
            c.loads_reopened.into(),
        ),
        named(
            "scales far from the file",
            "scale prior resets",
            c.scales_reopened.into(),
        ),
        named(
            "fixes of a frozen receiver",
            "frozen fixes",
            c.frozen_fixes.into(),
        ),
        named(
            "altitudes left out",
            "altitudes rejected",
            c.altitudes_rejected.into(),
        ),
        named(
            "altitudes left out singly",
            "single altitude outliers",
            c.altitude_outliers.into(),
        ),
        named("gaps in altitude", "altitude gaps", c.altitude_gaps.into()),
        named(
            "drifts of GNSS altitude",
            "GNSS altitude drifts",
            c.altitude_drifts.into(),
        ),
        named(
            "of these taken for true",
            "of these accepted",
            c.altitude_drifts_believed.into(),
        ),
        named(
            "steps of GNSS altitude",
            "GNSS altitude steps",
            c.altitude_steps.into(),
        ),
        named(
            "altitude set anew",
            "altitude resets",
            c.altitude_resets.into(),
        ),
        same("filter restarts", c.restarts.into()),
    ]
    .into_iter()
    .filter(|event| event.count > 0)
    .collect()
}
