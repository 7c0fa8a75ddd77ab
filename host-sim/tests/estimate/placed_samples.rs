//! Samples whose fixes are placed by what the whole drive has shown of the receiver.

use estimator_core::sample::{
    AltitudeContinuity, AltitudeMeasurement, EffectInputs, ForceInputs, Sample,
};
use estimator_core::{CellEnd, Condition, Disagreement, Duration, Instant};
use host_sim::recorder::placed_samples::PlacedSamples;
use host_sim::smooth::Samples;
use std::ops::Range;

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
        slope: None,
        after_load_change: false,
        after_stop: false,
        mass_is_reported: false,
        torque_rest: Default::default(),
        retarder_n: 0.0,
        service_braking: false,
        traction_late_s: 0.0,
        disagreement: Disagreement::default(),
        disagreeing_cells: 0,
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
