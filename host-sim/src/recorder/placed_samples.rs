//! Samples whose fixes are placed by what the whole drive has shown of the receiver.
//!
//! The estimator places a fix by the latency that it knows when the fix arrives. If the drive shows
//! later that fixes are older, each was taken before where it was placed: an altitude belongs to an
//! earlier cell, and a position to an earlier time. Where nothing was learned, nothing is changed.

use super::latencies::{Latencies, Latency};
use crate::files::spool::{Spool, blocks};
use crate::smooth::Samples;
use estimator_core::sample::{AltitudeMeasurement, Sample};
use estimator_core::{CellEnd, Duration, Instant};
use serde::{Deserialize, Serialize};
use std::io;
use std::ops::Range;

/// Slot size, bytes. Integers of variable length count with their longest form.
const SLOT: usize = 172;
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
pub struct PlacedSamples {
    kept: Spool<Kept, SLOT>,
    latencies: Latencies,
}

impl PlacedSamples {
    /// Appends a sample, whose fixes were placed by this latency.
    pub fn push(&mut self, sample: &Sample, latency: Duration) -> io::Result<()> {
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
    // Distances at which the positions were taken.
    let taken = |kept: &Kept| {
        let late_s = latency.beyond_s(kept.latency);
        distance_m(around, seconds(kept.sample.end) - late_s)
    };
    let taken_m: Vec<f64> = around.iter().map(taken).collect();
    let without_altitude = |index: usize| {
        let near = index.saturating_sub(REACH)..around.len().min(index + REACH);
        let mut sample = around[index].sample;
        sample.altitude = None;
        sample.end.position_e7 = position_e7(
            &around[near.clone()],
            &taken_m[near],
            sample.end.distance_m(),
        );
        sample
    };
    let mut samples: Vec<Sample> = part.clone().map(without_altitude).collect();
    for kept in around {
        let Some(altitude) = kept.sample.altitude else {
            continue;
        };
        let taken_s = taken_s(around, kept, &altitude, latency);
        let index = around.partition_point(|kept| seconds(kept.sample.end) < taken_s);
        if part.contains(&index) {
            place(&mut samples[index - part.start], altitude, taken_s);
        }
    }
    samples
}

/// Returns when an altitude of one of these samples was taken, s.
fn taken_s(around: &[Kept], kept: &Kept, altitude: &AltitudeMeasurement, latency: Latency) -> f64 {
    let placed_m = kept.sample.end.distance_m() - f64::from(altitude.behind_m);
    let index = around.partition_point(|kept| kept.sample.end.distance_m() < placed_m);
    let end = around.get(index).unwrap_or(kept).sample.end;
    let mps = f64::from(end.speed_mps.max(LEAST_MPS));
    let passed_s = seconds(end) - (end.distance_m() - placed_m) / mps;
    passed_s - latency.beyond_s(kept.latency)
}

/// Gives an altitude to the sample in whose cell it was taken. Where within a gap that was is not
/// known.
fn place(sample: &mut Sample, altitude: AltitudeMeasurement, taken_s: f64) {
    if sample.gap_cells > 0 {
        return;
    }
    let behind_m = (seconds(sample.end) - taken_s) as f32 * sample.end.speed_mps;
    sample.altitude = Some(AltitudeMeasurement {
        behind_m: behind_m.min(sample.length_m),
        ..altitude
    });
}

fn seconds(end: CellEnd) -> f64 {
    end.time.since(Instant::ZERO).as_secs_f64()
}

/// Returns the driven distance at a time, m.
fn distance_m(around: &[Kept], at_s: f64) -> f64 {
    let index = around.partition_point(|kept| seconds(kept.sample.end) < at_s);
    let Some(Kept { sample, .. }) = around.get(index) else {
        return f64::INFINITY;
    };
    let left_m = (seconds(sample.end) - at_s) * f64::from(sample.end.speed_mps);
    sample.end.distance_m() - left_m.min(sample.length_m.into())
}

/// Returns the position at a distance, between the two that were taken before and after it.
fn position_e7(near: &[Kept], taken_m: &[f64], at_m: f64) -> Option<(i32, i32)> {
    let mut pairs = near.windows(2).zip(taken_m.windows(2));
    let (pair, from_to) = pairs.find(|(_, from_to)| from_to[0] <= at_m && at_m <= from_to[1])?;
    if pair[1].sample.gap_cells > 0 || from_to[1].is_infinite() {
        return None;
    }
    let part = (at_m - from_to[0]) / (from_to[1] - from_to[0]);
    let from = pair[0].sample.end.position_e7?;
    let to = pair[1].sample.end.position_e7?;
    Some(between(from, to, part))
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
