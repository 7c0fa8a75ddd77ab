//! Samples whose fixes are placed by what the whole drive has shown of the receiver.
//!
//! The estimator places a fix by the latency that it knows when the fix arrives. If the drive shows
//! later that fixes are older, each was taken before where it was placed: an altitude belongs to an
//! earlier cell, and a position to an earlier time. Where nothing was learned, nothing is changed.

use super::latencies::{Latencies, Latency};
use crate::files::spool::{Spool, blocks};
use crate::smooth::Samples;
use estimator_core::Duration;
use estimator_core::sample::{AltitudeMeasurement, Sample};
use serde::{Deserialize, Serialize};
use std::io;
use std::ops::Range;

/// Slot size, bytes. Integers of variable length count with their longest form.
const SLOT: usize = 139;
/// Time between two fixes, s. At a standstill the receiver catches up after its latency and one fix.
const FIX_S: f64 = 1.0;
/// Least speed that divides a distance, m/s.
const LEAST_MPS: f32 = 0.5;
/// Samples on either side of one between which its position is looked for: 10 s at 70 m/s.
const REACH: usize = 280;

/// A sample, and the latency by which its fixes were placed.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
struct Kept {
    sample: Sample,
    latency: Latency,
}

/// The samples of a drive, in memory or on disk.
#[derive(Debug, Default)]
pub(super) struct PlacedSamples {
    kept: Spool<Kept, SLOT>,
    latencies: Latencies,
}

impl PlacedSamples {
    /// Appends a sample, whose fixes were placed by this latency.
    pub(super) fn push(&mut self, sample: &Sample, latency: Duration) -> io::Result<()> {
        let latency = Latency::from(latency);
        self.latencies.note(latency);
        self.kept.push(&Kept {
            sample: *sample,
            latency,
        })
    }

    /// Returns the samples of a block.
    fn block(&mut self, block: Range<usize>) -> io::Result<Vec<Sample>> {
        let Some(latency) = self.latencies.learned() else {
            let kept = self.kept.read(block)?;
            return Ok(kept.iter().map(|kept| kept.sample).collect());
        };
        let from = block.start.saturating_sub(REACH);
        let to = self.kept.count().min(block.end + REACH);
        let around = self.kept.read(from..to)?;
        Ok(placed(
            &around,
            block.start - from..block.end - from,
            latency,
        ))
    }
}

impl Samples for PlacedSamples {
    type Error = io::Error;

    fn count(&self) -> usize {
        self.kept.count()
    }

    fn each(&mut self, part: Range<usize>, mut take: impl FnMut(&Sample)) -> io::Result<()> {
        for block in blocks(part) {
            self.block(block)?.iter().for_each(&mut take);
        }
        Ok(())
    }
}

/// Returns a part of these samples, with all fixes placed by this latency.
fn placed(around: &[Kept], part: Range<usize>, latency: Latency) -> Vec<Sample> {
    let position = |index: usize| {
        let near = &around[index.saturating_sub(REACH)..around.len().min(index + REACH)];
        position_e7(near, seconds(&around[index].sample), latency)
    };
    let without_altitude = |index: usize| {
        let mut sample = around[index].sample;
        sample.altitude = None;
        sample.end.position_e7 = position(index);
        sample
    };
    let mut samples: Vec<Sample> = part.clone().map(without_altitude).collect();
    for kept in around {
        let Some((altitude, taken_s)) = altitude(kept, latency) else {
            continue;
        };
        let index = around.partition_point(|kept| seconds(&kept.sample) < taken_s);
        if part.contains(&index) {
            place(&mut samples[index - part.start], altitude, taken_s);
        }
    }
    samples
}

/// Returns the altitude that a sample has, and when it was taken, s.
fn altitude(kept: &Kept, latency: Latency) -> Option<(AltitudeMeasurement, f64)> {
    let Kept {
        sample,
        latency: used,
    } = kept;
    let altitude = sample.altitude?;
    let mps = f64::from(sample.end.speed_mps.max(LEAST_MPS));
    let before_s = f64::from(altitude.behind_m) / mps + latency.beyond_s(*used);
    Some((altitude, seconds(sample) - before_s))
}

/// Gives an altitude to the sample in whose cell it was taken. Where within a gap that was is not
/// known.
fn place(sample: &mut Sample, altitude: AltitudeMeasurement, taken_s: f64) {
    if sample.gap_cells > 0 {
        return;
    }
    let behind_m = (seconds(sample) - taken_s) as f32 * sample.end.speed_mps;
    sample.altitude = Some(AltitudeMeasurement {
        behind_m: behind_m.min(sample.length_m),
        ..altitude
    });
}

fn seconds(sample: &Sample) -> f64 {
    1e-6 * sample.end.time.micros() as f64
}

/// Returns the position at a time, between the two that were taken before and after it.
fn position_e7(near: &[Kept], at_s: f64, latency: Latency) -> Option<(i32, i32)> {
    let late_s = |kept: &Kept| latency.beyond_s(kept.latency);
    let taken_s = |kept: &Kept| seconds(&kept.sample) - late_s(kept);
    let mut pairs = near.windows(2);
    let pair = pairs.find(|pair| taken_s(&pair[0]) <= at_s && at_s <= taken_s(&pair[1]))?;
    let [before, after] = [&pair[0], &pair[1]];
    if after.sample.gap_cells > 0 {
        return None;
    }
    let apart_s = taken_s(after) - taken_s(before);
    let caught_up_s = late_s(before).abs() + FIX_S;
    let part = (at_s - taken_s(before)) / apart_s.min(caught_up_s);
    let (from, to) = (
        before.sample.end.position_e7?,
        after.sample.end.position_e7?,
    );
    Some(between(from, to, part.min(1.0)))
}

/// Returns the position at a part of the way from one to another.
fn between(from: (i32, i32), to: (i32, i32), part: f64) -> (i32, i32) {
    if from.1.abs_diff(to.1) > 1_800_000_000 {
        // The date line.
        return from;
    }
    let between = |from: i32, to: i32| from + (part * f64::from(to - from)) as i32;
    (between(from.0, to.0), between(from.1, to.1))
}
