//! What the core counted, in words.

use estimator_core::Counters;

/// What happened, without what did not.
#[must_use]
pub fn events(c: &Counters) -> Vec<(&'static str, u64)> {
    [
        ("frames malformed", c.frames_malformed.into()),
        ("fast packets broken", c.fast_packets_broken.into()),
        ("inputs back in time", c.time_backwards.into()),
        ("inputs far ahead", c.times_ahead.into()),
        ("clocks set back", c.clocks_set_back.into()),
        ("long silences", c.silences.into()),
        ("values not available", c.not_available.into()),
        ("values in error", c.errors.into()),
        ("values of other senders", c.other_source.into()),
        ("sender switches", c.source_switches.into()),
        ("rates exceeded", c.rates_exceeded.into()),
        ("speeds that leapt", c.speed_leaps.into()),
        ("speeds that were frozen", c.frozen_speeds.into()),
        ("steps of the speed", c.speed_steps.into()),
        ("poor fixes", c.poor_fixes.into()),
        ("gaps in speed", c.gaps.into()),
        (
            "cells lost",
            c.samples_lost.saturating_add(c.cells_lost).into(),
        ),
        ("cells that are no numbers", c.cells_unsound.into()),
        ("cells with brakes guessed", c.brakes_guessed.into()),
        ("stops that reopened the load", c.loads_reopened.into()),
        ("scales far from the file", c.scales_reopened.into()),
        ("fixes of a frozen receiver", c.frozen_fixes.into()),
        ("altitudes left out", c.altitudes_rejected.into()),
        ("altitudes left out singly", c.altitude_outliers.into()),
        ("gaps in altitude", c.altitude_gaps.into()),
        ("drifts of GNSS altitude", c.altitude_drifts.into()),
        ("of these taken for true", c.altitude_drifts_believed.into()),
        ("steps of GNSS altitude", c.altitude_steps.into()),
        ("altitude set anew", c.altitude_resets.into()),
        ("filter restarts", c.restarts.into()),
    ]
    .into_iter()
    .filter(|(_, count)| *count > 0)
    .collect()
}
