//! Smoothing of a whole run with only a part of its records in memory. The result equals that with
//! all records in memory.

use estimator_core::filter::{AltitudeEvent, Filter};
use estimator_core::sample::{AltitudeContinuity, Sample};
use estimator_core::smoother::BackwardPass;
use estimator_core::{Context, Counters, Estimate, Estimator, Model, Scalar, Tuning};
use host_sim::recorder::Recorder;
use host_sim::simulator::{SimulatedRun, simulate};
use host_sim::smooth::{ForwardCell, SmoothedCell, held_bytes, smooth_run};
use std::collections::BTreeSet;
use std::ops::RangeInclusive;
use test_kit::simulated::scenario;

/// Simulates a drive with wrong parameters and these faults of the receiver.
fn drive(truck: &str, length_m: f64, faults: &str) -> SimulatedRun {
    let text = format!(
        "seed = 5\n[road]\nlength_m = {length_m:?}\n\
         [errors]\nmass_sigma = 0.1\ndrag_sigma = 0.1\nrolling_sigma = 0.1\ntorque_sigma = 0.04\n\
         [wind]\nspeed_mps = 2.0\nfrom_deg = 250.0\ngust_sigma_mps = 0.3\n\
         [gnss]\naltitude_sigma_m = 2.0\naltitude_time_s = 250.0\n\
         altitude_white_sigma_m = 0.3\n{faults}\n\
         [[runs]]\nname = \"x\"\ntruck = \"{truck}\"\n"
    );
    simulate(&scenario(&[&text]), 0).unwrap()
}

/// Smooths with all records in memory. Returns the cells, and whether drifts were left out.
fn keeping_all<S: Scalar>(
    model: &Model,
    filter: &Filter<S>,
    samples: &[Sample],
) -> (Vec<SmoothedCell>, bool) {
    let pass = |samples: &[Sample], tuning: &Tuning| -> Vec<ForwardCell<S>> {
        let mut filter = filter.clone();
        let mut context = Context::new(model.clone(), tuning.clone()).unwrap();
        samples
            .iter()
            .filter_map(|sample| ForwardCell::step(&mut filter, &mut context, sample))
            .collect()
    };
    let mut records = pass(samples, &Tuning::default());
    let drifts: Vec<RangeInclusive<u32>> = records
        .iter()
        .filter_map(|cell| match cell.record.event {
            Some(AltitudeEvent::DriftEnded(since)) => Some(since..=cell.record.end.cell),
            _ => None,
        })
        .collect();
    let without = pass(&without_drifts(samples, &drifts), &Tuning::default());
    let mut leaves_out =
        !drifts.is_empty() && negative_log_likelihood(&without) < negative_log_likelihood(&records);
    if leaves_out {
        records = without;
    }
    let mut believing = Tuning::default();
    believing.gates.drift_sigmas = f32::INFINITY;
    let all = pass(samples, &believing);
    if !drifts.is_empty() && negative_log_likelihood(&all) < negative_log_likelihood(&records) {
        (records, leaves_out) = (all, false);
    }
    let mut backward = BackwardPass::new();
    let mut estimates: Vec<Estimate> = Vec::new();
    for cell in records.iter().rev() {
        estimates.push(backward.estimate(&cell.state, &cell.mass));
        backward.retreat(&cell.record.smoother_input);
    }
    let disagreeing: BTreeSet<u32> = records
        .iter()
        .flat_map(|ForwardCell { record, .. }| {
            let end = record.end.cell + 1;
            end.saturating_sub(record.disagreeing_cells)..end
        })
        .collect();
    let cells = records.iter().zip(estimates.into_iter().rev());
    let smoothed = cells.map(|(cell, estimate)| SmoothedCell {
        end: cell.record.end,
        estimate,
        is_consistent: !disagreeing.contains(&cell.record.end.cell),
    });
    (smoothed.collect(), leaves_out)
}

fn negative_log_likelihood<S: Scalar>(cells: &[ForwardCell<S>]) -> f64 {
    let each: Vec<f64> = cells
        .iter()
        .filter_map(|cell| cell.record.smoother_input.altitude())
        .map(|used| {
            let variance = used.innovation_variance.to_f64();
            used.innovation.to_f64().powi(2) / variance + variance.ln()
        })
        .collect();
    each.iter().sum::<f64>() / each.len() as f64
}

fn without_drifts(samples: &[Sample], drifts: &[RangeInclusive<u32>]) -> Vec<Sample> {
    let mut has_drifted = false;
    let mut samples = samples.to_vec();
    for sample in &mut samples {
        let cell = sample.end.cell;
        if drifts.iter().any(|drift| drift.contains(&cell)) {
            sample.altitude = None;
            has_drifted = true;
        } else if let Some(altitude) = &mut sample.altitude {
            if has_drifted && altitude.continuity == AltitudeContinuity::Followed {
                altitude.continuity = AltitudeContinuity::Drifted;
            }
            has_drifted = false;
        }
    }
    samples
}

/// Checks a drive of which these frames are received. Returns the counters, the number of cells,
/// and whether drifts were left out.
fn check(run: &SimulatedRun, is_received: impl Fn(usize) -> bool) -> (Counters, usize, bool) {
    let model = &run.vehicle.model;
    let mut recorder = Recorder::<f32>::new(model.clone(), Tuning::default()).unwrap();
    let mut estimator = Estimator::<f32>::new(model.clone(), Tuning::default()).unwrap();
    let mut sampled = Vec::new();
    for (number, frame) in run.frames.iter().enumerate() {
        if is_received(number) {
            recorder.on_frame(frame);
            estimator.on_frame(frame.time, &frame.frame);
            while estimator.step().is_some() {
                sampled.push(*estimator.sample().unwrap());
            }
            while estimator.next_cell().is_some() {}
        }
    }
    let double: Filter<f64> = recorder.estimator().second_pass_filter();
    let single: Filter<f32> = recorder.estimator().second_pass_filter();
    let (found, samples) = recorder.finish_with_samples().unwrap();
    // The samples are those that were stored.
    assert_eq!(samples[..], sampled[sampled.len() - samples.len()..]);
    let (expected, leaves_out) = keeping_all(model, &double, &samples);
    let tuning = Tuning::default();
    // Equal to the last bit. NaN would not be equal.
    assert_eq!(smooth_run(model, &tuning, &double, &samples), expected);
    assert_eq!(
        smooth_run(model, &tuning, &single, &samples),
        keeping_all(model, &single, &samples).0
    );
    assert_eq!(found.rows.len(), expected.len());
    for (row, cell) in found.rows.iter().zip(&expected) {
        let Estimate {
            grade_percent,
            altitude_m,
            speed_mps,
            bias_percent,
            scale,
            mass_kg,
        } = cell.estimate;
        assert_eq!(row.distance_m, cell.end.distance_m());
        assert_eq!(row.grade_percent, f64::from(grade_percent.value));
        assert_eq!(row.grade_sigma_percent, f64::from(grade_percent.sigma));
        assert_eq!(row.altitude_m, altitude_m.map(|z| z.value.into()));
        assert_eq!(row.altitude_sigma_m, altitude_m.map(|z| z.sigma.into()));
        assert_eq!(row.speed_mps, f64::from(speed_mps));
        assert_eq!(row.bias_percent, f64::from(bias_percent.value));
        assert_eq!(row.scale, f64::from(scale.value));
        assert_eq!(row.mass_kg, Some(mass_kg.value.into()));
        assert_eq!(row.mass_sigma_kg, Some(mass_kg.sigma.into()));
        assert_eq!(row.consistent == 1, cell.is_consistent);
    }
    (found.counters, expected.len(), leaves_out)
}

#[test]
fn a_run_of_two_levels_of_parts_is_smoothed_as_with_all_in_memory() {
    let run = drive("A", 45_000.0, "");
    let (_, cells, _) = check(&run, |_| true);
    // More than 512 times 32.
    assert!(
        cells > 16_384 && held_bytes(cells) > held_bytes(16_384),
        "{cells}"
    );
}

#[test]
fn gaps_drifts_that_are_left_out_and_altitude_resets_are_smoothed_alike() {
    let faults = "outages_m = [[4000.0, 6666.0], [20000.0, 26000.0]]\n\
                  steps = [[8000.0, 9000.0, 25.0]]\n\
                  ramps = [[12000.0, 13000.0, 10.0], [15000.0, 17000.0, -20.0]]";
    let mut left_out = 0;
    for truck in ["A", "B"] {
        let run = drive(truck, 30_000.0, faults);
        let count = run.frames.len();
        let gaps = |number: usize| {
            let silent = [0.3..0.34, 0.95..0.951];
            !silent
                .map(|part| part.contains(&(number as f64 / count as f64)))
                .contains(&true)
        };
        let (counters, _, leaves_out) = check(&run, gaps);
        assert!(
            counters.gaps > 0 && counters.altitude_resets > 1,
            "{counters:?}"
        );
        assert!(
            counters.altitude_steps > 0 && counters.altitude_drifts > 0,
            "{counters:?}"
        );
        left_out += usize::from(leaves_out);
    }
    assert!(left_out > 0);
}

#[test]
fn memory_hardly_grows_with_the_run() {
    const KM: usize = 400;
    // A filter with its hypotheses is 6 kB, and each level of parts holds 32 of them.
    assert!(held_bytes(1_000 * KM) < held_bytes(10 * KM) + 256_000);
    assert!(held_bytes(100_000 * KM) < held_bytes(10 * KM) + 3 * 256_000);
    assert!(held_bytes(100_000 * KM) < 2_000_000);
}
