//! Samples whose fixes are placed by what the whole drive has shown of the receiver.
//!
//! The estimator places a fix by the latency that it knows when the fix arrives. If the drive shows
//! later that fixes are older, each was taken before where it was placed: an altitude lies farther
//! behind the end of its cell, and a position belongs to an earlier time.

use super::latencies::{Latencies, Latency};
use crate::files::spool::{Spool, blocks};
use crate::smooth::Samples;
use estimator_core::Duration;
use estimator_core::sample::Sample;
use serde::{Deserialize, Serialize};
use std::io;
use std::ops::Range;

/// Slot size, bytes. Integers of variable length count with their longest form.
const SLOT: usize = 139;
/// Time between two fixes, s. At a standstill the receiver catches up after its latency and one fix.
const FIX_S: f64 = 1.0;
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

    /// Returns the samples of a block, placed by this latency.
    fn block(&mut self, block: Range<usize>, latency: Latency) -> io::Result<Vec<Sample>> {
        let kept = self.kept.read(block.clone())?;
        if kept.iter().all(|kept| kept.latency == latency) {
            return Ok(kept.iter().map(|kept| kept.sample).collect());
        }
        let from = block.start.saturating_sub(REACH);
        let to = self.kept.count().min(block.end + REACH);
        let around = self.kept.read(from..to)?;
        let placed = |index: usize| placed(&around, index - from, latency);
        Ok(block.map(placed).collect())
    }
}

impl Samples for PlacedSamples {
    type Error = io::Error;

    fn count(&self) -> usize {
        self.kept.count()
    }

    fn each(&mut self, part: Range<usize>, mut take: impl FnMut(&Sample)) -> io::Result<()> {
        let latency = self.latencies.of_drive();
        for block in blocks(part) {
            self.block(block, latency)?.iter().for_each(&mut take);
        }
        Ok(())
    }
}

/// Returns one of these samples, placed by a latency.
fn placed(around: &[Kept], index: usize, latency: Latency) -> Sample {
    let kept = &around[index];
    let mut sample = kept.sample;
    if kept.latency == latency {
        return sample;
    }
    if let Some(altitude) = &mut sample.altitude {
        let late_s = latency.beyond_s(kept.latency) as f32;
        altitude.behind_m += late_s * sample.end.speed_mps;
    }
    let near = &around[index.saturating_sub(REACH)..around.len().min(index + REACH)];
    sample.end.position_e7 = position_e7(near, seconds(&sample), latency);
    sample
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
