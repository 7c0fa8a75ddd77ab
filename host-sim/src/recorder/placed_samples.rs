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
const SLOT: usize = 149;
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

#[cfg(test)]
mod tests {
    use super::*;
    use estimator_core::sample::{AltitudeContinuity, EffectInputs, ForceInputs};
    use estimator_core::{Condition, Disagreement};

    /// A vehicle at 20 m/s, whose position counts the metres, as the altitude does.
    fn kept(cell: u32, used: Duration, true_s: f64) -> (Sample, Duration) {
        let taken_m = f64::from(cell) * 2.5 - 20.0 * (true_s - f64::from(used.seconds()));
        let sample = Sample {
            end: CellEnd {
                cell,
                time: Instant::from_micros(u64::from(cell) * 125_000),
                position_e7: Some((100 * taken_m as i32, -100 * taken_m as i32)),
                speed_mps: 20.0,
                condition: Condition::default(),
            },
            gap_cells: 0,
            length_m: 2.5,
            duration_s: 0.125,
            forces: ForceInputs {
                traction_n: 0.0,
                rotating_kg: 0.0,
                mass_kg: 39_000.0,
                air_density: 1.2,
            },
            effect_inputs: EffectInputs::default(),
            speed: None,
            altitude: Some(AltitudeMeasurement {
                altitude_m: taken_m as f32,
                behind_m: 0.0,
                dilution: 1.0,
                continuity: AltitudeContinuity::Followed,
            }),
            inertial: None,
            after_load_change: false,
            after_stop: false,
            mass_is_reported: false,
            disagreement: Disagreement::default(),
        };
        (sample, used)
    }

    fn drive(cells: u32) -> PlacedSamples {
        let mut samples = PlacedSamples::default();
        for cell in 1..=cells {
            let used = Duration::from_millis(if cell < 700 { 150 } else { 2_150 });
            let (sample, used) = kept(cell, used, 2.15);
            samples.push(&sample, used).unwrap();
        }
        samples
    }

    fn read(samples: &mut PlacedSamples, part: Range<usize>) -> Vec<Sample> {
        let mut read = Vec::new();
        samples.each(part, |sample| read.push(*sample)).unwrap();
        read
    }

    #[test]
    fn every_fix_is_where_it_was_taken() {
        let mut samples = drive(2_000);
        for sample in read(&mut samples, 0..2_000) {
            let end_m = sample.end.distance_m();
            let (latitude_e7, longitude_e7) = sample.end.position_e7.unwrap();
            assert_eq!(latitude_e7, -longitude_e7);
            assert!(
                (f64::from(latitude_e7) - 100.0 * end_m).abs() < 101.0,
                "{sample:?}"
            );
            if let Some(altitude) = sample.altitude {
                let taken_m = end_m as f32 - altitude.behind_m;
                assert!((altitude.altitude_m - taken_m).abs() < 0.01, "{sample:?}");
            }
        }
    }

    #[test]
    fn a_sample_is_the_same_in_every_part() {
        let mut samples = drive(2_000);
        let all = read(&mut samples, 0..2_000);
        for part in [0..1, 399..1_203, 650..730, 1_990..2_000] {
            assert_eq!(read(&mut samples, part.clone()), all[part]);
        }
    }
}
