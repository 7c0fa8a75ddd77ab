//! The facade: the results of drives of known shape, and invalid input.

use estimator_core::signal::{encode, messages};
use estimator_core::{
    Cell, Estimator, Instant, Live, Outcome, ParameterError, Reading, Signal, Traction, Tuning,
    Uncertain, Value, VehicleParameters,
};
use proptest::prelude::*;
use test_kit::{TestFrame, by_force, frames_of, truck};

fn put(estimator: &mut Estimator<f32>, micros: u64, signal: Signal, value: f32) -> Outcome {
    estimator.on_reading(
        Instant::from_micros(micros),
        Reading {
            signal,
            value: Value::Real(value),
        },
    )
}

fn fetch(estimator: &mut Estimator<f32>, cells: &mut Vec<Cell>) {
    while estimator.step().is_some() {
        while let Some(cell) = estimator.next_cell() {
            cells.push(cell);
        }
    }
}

fn drain(estimator: &mut Estimator<f32>, cells: &mut Vec<Cell>) {
    fetch(estimator, cells);
    while let Some(cell) = estimator.drain_cell() {
        cells.push(cell);
    }
}

/// Drives a steady climb of `grade` percent at 20 m/s. Force and speed come at these periods.
fn climb(grade: f32, force_ms: u64, speed_ms: u64, seconds: u64) -> Vec<Cell> {
    let vehicle = by_force();
    let sine = 0.01 * grade / (1.0 + 1e-4 * grade * grade).sqrt();
    let weight = vehicle.mass_kg * 9.806_65;
    let force =
        0.5 * vehicle.drag_area_m2 * 1.2 * 400.0 + weight * (vehicle.rolling_resistance + sine);
    let mut estimator = Estimator::new(vehicle, Tuning::default()).unwrap();
    let mut cells = Vec::new();
    for ms in 0..seconds * 1000 {
        let micros = ms * 1000;
        if ms % force_ms == 0 {
            put(&mut estimator, micros, Signal::TractionForce, force);
        }
        if ms % 1000 == 150 {
            let distance_m = 20.0 * (ms as f32 / 1000.0 - 0.15);
            put(
                &mut estimator,
                micros,
                Signal::Altitude,
                200.0 + distance_m * sine,
            );
        }
        if ms % speed_ms == 0 {
            put(&mut estimator, micros, Signal::WheelSpeed, 20.0);
        }
        fetch(&mut estimator, &mut cells);
    }
    drain(&mut estimator, &mut cells);
    cells
}

#[test]
fn a_steady_climb_is_found_whatever_the_rates() {
    for (force_ms, speed_ms) in [(10, 100), (100, 100), (100, 50), (250, 20), (1000, 1000)] {
        for grade in [-4.0, 0.0, 2.5] {
            let cells = climb(grade, force_ms, speed_ms, 60);
            let distance_m = cells.last().unwrap().end.distance_m();
            assert!((distance_m - 1_200.0).abs() < 25.0, "{distance_m} m");
            for cell in &cells[80..] {
                let found = cell.lagged_grade_percent.value;
                // The prior of slope zero has some weight until GNSS has corrected the model.
                assert!(
                    (found - grade).abs() < 0.05,
                    "force each {force_ms} ms, speed each {speed_ms} ms, \
                     {:.0} m: {found} %, should be {grade} %",
                    cell.end.distance_m()
                );
                assert!(cell.end.condition.is_valid());
            }
        }
    }
}

#[test]
fn distance_counts_from_the_first_frame_and_time_is_the_crossing() {
    let cells = climb(0.0, 100, 100, 10);
    for cell in &cells {
        let seconds = cell.end.time.micros() as f64 * 1e-6;
        assert!((cell.end.distance_m() - 20.0 * seconds).abs() < 0.01);
    }
    assert_eq!(cells[0].end.cell, 1);
    assert!(cells.windows(2).all(|w| w[1].end.cell == w[0].end.cell + 1));
}

#[test]
fn lagged_sigma_is_below_live_sigma_and_both_cover_the_truth() {
    let cells = climb(2.0, 100, 100, 120);
    let cell = &cells[cells.len() / 2];
    assert!(cell.lagged_grade_percent.sigma < cell.live_grade_percent.sigma);
    for grade in [cell.live_grade_percent, cell.lagged_grade_percent] {
        assert!((grade.value - 2.0).abs() < 2.0 * grade.sigma);
    }
    let altitude = cell.altitude_m.unwrap();
    assert!((altitude.value - 200.0 - cell.end.distance_m() as f32 * 0.02).abs() < 1.0);
}

#[test]
fn a_standing_vehicle_gives_no_cells() {
    let mut estimator = Estimator::<f32>::new(by_force(), Tuning::default()).unwrap();
    let mut cells = Vec::new();
    for ms in (0..60_000).step_by(100) {
        put(&mut estimator, ms * 1000, Signal::TractionForce, 0.0);
        put(&mut estimator, ms * 1000, Signal::WheelSpeed, 0.0);
    }
    drain(&mut estimator, &mut cells);
    assert!(cells.is_empty());
    assert!(estimator.live().is_none());
    assert_eq!(estimator.counters().speeds_used, 600);
}

#[test]
fn braking_makes_unsure_and_invalid_until_its_hold_is_over() {
    let vehicle = by_force();
    let mut estimator = Estimator::new(vehicle, Tuning::default()).unwrap();
    let mut cells = Vec::new();
    for ms in (0..60_000).step_by(100) {
        let braking = (30_000..32_000).contains(&ms);
        // An open load would make the grade unsure before the brake does.
        put(&mut estimator, ms * 1000, Signal::Mass, 39_000.0);
        put(&mut estimator, ms * 1000, Signal::TractionForce, 4_000.0);
        put(
            &mut estimator,
            ms * 1000,
            Signal::BrakeSwitch,
            braking.into(),
        );
        put(&mut estimator, ms * 1000, Signal::WheelSpeed, 20.0);
        fetch(&mut estimator, &mut cells);
    }
    drain(&mut estimator, &mut cells);
    let at = |seconds: f64| {
        cells
            .iter()
            .find(|cell| cell.end.time.micros() as f64 * 1e-6 >= seconds)
            .unwrap()
    };
    assert!(at(29.5).end.condition.is_valid());
    assert!(at(31.0).end.condition.braking);
    assert!(at(32.3).end.condition.braking, "hold time");
    assert!(at(34.0).end.condition.is_valid());
    assert!(
        at(31.9).live_grade_percent.sigma > 1.1 * at(29.5).live_grade_percent.sigma,
        "{} {}",
        at(31.9).live_grade_percent.sigma,
        at(29.5).live_grade_percent.sigma
    );
}

#[test]
fn a_gap_starts_the_slope_anew_and_keeps_counting_distance() {
    let mut estimator = Estimator::<f32>::new(by_force(), Tuning::default()).unwrap();
    let mut cells = Vec::new();
    for ms in (0..60_000).step_by(100) {
        if (20_000..30_000).contains(&ms) {
            continue;
        }
        put(&mut estimator, ms * 1000, Signal::TractionForce, 4_000.0);
        put(&mut estimator, ms * 1000, Signal::WheelSpeed, 20.0);
        fetch(&mut estimator, &mut cells);
    }
    drain(&mut estimator, &mut cells);
    assert_eq!(estimator.counters().gaps, 1);
    let behind = cells
        .windows(2)
        .find(|w| w[1].end.cell > w[0].end.cell + 1)
        .unwrap();
    let hole = f64::from(behind[1].end.cell - behind[0].end.cell) * 2.5;
    assert!((hole - 200.0).abs() < 8.0, "{hole} m");
    assert!(behind[1].live_grade_percent.sigma > 2.0);
    assert!((cells.last().unwrap().end.distance_m() - 1_200.0).abs() < 8.0);
}

#[test]
fn cells_that_are_not_fetched_are_counted() {
    let mut estimator = Estimator::<f32>::new(by_force(), Tuning::default()).unwrap();
    for ms in (0..60_000).step_by(100) {
        put(&mut estimator, ms * 1000, Signal::TractionForce, 4_000.0);
        put(&mut estimator, ms * 1000, Signal::WheelSpeed, 20.0);
        while estimator.step().is_some() {}
    }
    let mut fetched = 0;
    while estimator.drain_cell().is_some() {
        fetched += 1;
    }
    let counters = estimator.counters();
    assert!(counters.cells_lost > 0);
    assert_eq!(
        u64::from(counters.cells_lost) + fetched,
        u64::from(counters.steps)
    );
}

#[test]
fn time_running_backwards_is_counted_and_left_out() {
    let mut estimator = Estimator::<f32>::new(by_force(), Tuning::default()).unwrap();
    assert_eq!(
        put(&mut estimator, 2_000_000, Signal::WheelSpeed, 20.0),
        Outcome::Used
    );
    assert_eq!(
        put(&mut estimator, 1_000_000, Signal::WheelSpeed, 5.0),
        Outcome::TimeBackwards
    );
    assert_eq!(estimator.counters().time_backwards, 1);
}

#[test]
fn a_second_sender_of_the_same_signal_is_not_mixed_in() {
    let mut estimator = Estimator::<f32>::new(truck(), Tuning::default()).unwrap();
    let frame = |source, kmh: f32| {
        let mut payload = [0; 8];
        encode(65_265, &mut payload, |signal| match signal {
            Signal::WheelSpeed => Value::Real(kmh / 3.6),
            _ => Value::NotAvailable,
        });
        TestFrame::of_pgn(65_265, source, &payload)
    };
    for k in 0..100 {
        let now = Instant::from_micros(k * 100_000);
        assert_eq!(estimator.on_frame(now, &frame(0, 72.0)), Outcome::Used);
        assert_eq!(estimator.on_frame(now, &frame(11, 30.0)), Outcome::Ignored);
        while estimator.step().is_some() {}
    }
    let live = estimator.live().unwrap();
    assert!((live.estimate.speed_mps - 20.0).abs() < 0.1);
    // Its wheel speed. Signals that neither source has available take no ownership.
    assert_eq!(estimator.counters().other_source, 100);
    // When the first falls silent, the other takes over.
    for k in 0..100 {
        let now = Instant::from_micros(10_000_000 + k * 100_000);
        estimator.on_frame(now, &frame(11, 30.0));
        while estimator.step().is_some() {}
    }
    assert_eq!(estimator.counters().source_switches, 1);
    assert!((estimator.live().unwrap().estimate.speed_mps - 30.0 / 3.6).abs() < 0.1);
}

#[test]
fn impossible_vehicles_are_refused_by_name() {
    let refused = |change: &dyn Fn(&mut VehicleParameters)| -> ParameterError {
        let mut vehicle = truck();
        change(&mut vehicle);
        Estimator::<f32>::new(vehicle, Tuning::default()).unwrap_err()
    };
    let mass = refused(&|v| v.mass_kg = -1.0);
    assert_eq!(mass.key, "vehicle.mass_kg");
    let words = format!("vehicle.mass_kg = -1: expected {}", mass.expected);
    assert_eq!(mass.to_string(), words);
    assert_eq!(refused(&|v| v.mass_kg = f32::NAN).key, "vehicle.mass_kg");
    assert_eq!(
        refused(&|v| v.wheel_radius_m = 0.0).key,
        "vehicle.wheel_radius_m"
    );
    let gearless = refused(&|v| {
        if let Traction::Powertrain(p) = &mut v.traction {
            p.gears.clear();
        }
    });
    assert_eq!(gearless.key, "powertrain.gears");
}

/// Returns frames with valid and random payloads at valid and random times.
fn hostile_frames() -> impl Strategy<Value = Vec<(u64, TestFrame)>> {
    let payload = prop_oneof![
        prop::collection::vec(any::<u8>(), 0..9),
        Just(vec![0xff; 8]),
        Just(vec![0; 8]),
        prop::collection::vec(0x30..0x70_u8, 8),
    ];
    let frame = (
        0..messages().count(),
        any::<u8>(),
        payload,
        0..400_000_u64,
        0..50_u8,
    );
    prop::collection::vec(frame, 0..400).prop_map(|frames| {
        let mut now = 0_u64;
        let mut sequence = 0;
        frames
            .into_iter()
            .flat_map(|(which, source, data, step, dice)| {
                now = match dice {
                    0 => now.saturating_sub(10 * step),
                    1 => now + 1_000 * step,
                    2 => u64::MAX - step,
                    _ => now + step,
                };
                sequence = (sequence + 1) % 8;
                let message = messages().nth(which).unwrap();
                let payload: Vec<u8> = data.iter().copied().cycle().take(43).collect();
                let frames = if message.length() > 8 && payload.len() == 43 {
                    frames_of(message.pgn(), source % 3, sequence, &payload)
                } else {
                    vec![TestFrame::of_pgn(message.pgn(), source % 3, &data)]
                };
                let time = now;
                if dice == 2 {
                    now = 0;
                }
                frames.into_iter().map(move |frame| (time, frame))
            })
            .collect()
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    /// For any input: no panic, every number finite, no sigma negative.
    #[test]
    fn hostile_traffic_leaves_numbers_finite(frames in hostile_frames()) {
        let mut estimator = Estimator::<f32>::new(truck(), Tuning::default()).unwrap();
        let mut cells = Vec::new();
        for (micros, frame) in &frames {
            estimator.on_frame(Instant::from_micros(*micros), frame);
            fetch(&mut estimator, &mut cells);
        }
        drain(&mut estimator, &mut cells);
        prop_assert_eq!(estimator.counters().frames, frames.len() as u64);
        let finite = |known: Uncertain| {
            known.value.is_finite() && known.sigma.is_finite() && known.sigma >= 0.0
        };
        for cell in &cells {
            prop_assert!(finite(cell.live_grade_percent));
            prop_assert!(finite(cell.lagged_grade_percent));
            prop_assert!(cell.altitude_m.is_none_or(finite));
        }
        if let Some(Live { estimate, .. }) = estimator.live() {
            prop_assert!(finite(estimate.bias_percent) && finite(estimate.scale));
            prop_assert!(estimate.speed_mps.is_finite());
        }
    }
}
