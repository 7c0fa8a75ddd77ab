//! The accelerometer: readings become one mean a cell.

use estimator_core::sample::{InertialMeasurement, Sample};
use estimator_core::{Reading, Signal, Value};
use test_kit::readings_drive::ReadingsDrive;
use test_kit::truck;

const FORWARD: Signal = Signal::LongitudinalAcceleration;

/// Returns readings of a tenth of a second: these accelerations, then the speed.
fn tenth(accelerations: &[f32], mps: f32) -> Vec<(Signal, f32)> {
    let mut readings: Vec<_> = accelerations.iter().map(|mps2| (FORWARD, *mps2)).collect();
    readings.push((Signal::WheelSpeed, mps));
    readings
}

fn measured(samples: &[Sample]) -> Vec<InertialMeasurement> {
    samples
        .iter()
        .filter_map(|sample| sample.inertial)
        .collect()
}

#[test]
fn a_cell_has_the_mean_of_its_readings() {
    let mut drive = ReadingsDrive::of(truck());
    let samples = drive.on(10.0, &tenth(&[0.9, 1.1, 0.95, 1.05, 1.0], 20.0));
    let measured = measured(&samples);
    assert_eq!(measured.len(), samples.len());
    for of in &measured[1..] {
        assert!((of.acceleration_mps2 - 1.0).abs() < 1e-5);
        // Five in 2 m.
        assert!((6..=7).contains(&of.count), "{}", of.count);
        assert!((of.resolution_mps2 - 0.05).abs() < 1e-5);
    }
}

#[test]
fn each_cell_has_one_where_cells_are_shorter_than_the_pause_between_readings() {
    let mut drive = ReadingsDrive::of(truck());
    let samples = drive.on(10.0, &tenth(&[0.5], 40.0));
    assert!(samples.len() > 150);
    let measured = measured(&samples);
    assert_eq!(measured.len(), samples.len());
    assert!(measured.iter().all(|of| of.count == 1));
}

#[test]
fn a_change_shows_in_the_cells_of_its_time() {
    let mut drive = ReadingsDrive::of(truck());
    drive.on(10.0, &tenth(&[0.0, 0.0], 20.0));
    let after = measured(&drive.on(2.0, &tenth(&[1.0, 1.0], 20.0)));
    // The first cell began before.
    let first = after[0].acceleration_mps2;
    assert!((0.2..1.0).contains(&first), "{first}");
    assert!(after[1..].iter().all(|of| of.acceleration_mps2 == 1.0));
}

#[test]
fn a_sensor_that_falls_silent_is_stale_after_half_a_second() {
    let mut drive = ReadingsDrive::of(truck());
    drive.on(10.0, &tenth(&[1.0], 20.0));
    let silent = drive.on(5.0, &tenth(&[], 20.0));
    let measured = measured(&silent);
    // Eight cells a second.
    assert!((3..=5).contains(&measured.len()), "{}", measured.len());
    assert!(silent.last().unwrap().inertial.is_none());
}

#[test]
fn without_the_sensor_nothing_is_measured() {
    let mut drive = ReadingsDrive::of(truck());
    assert!(measured(&drive.on(10.0, &tenth(&[], 20.0))).is_empty());
}

#[test]
fn readings_beyond_what_vehicles_reach_are_none() {
    for impossible in [35.0, -35.0, f32::NAN, f32::INFINITY] {
        let mut drive = ReadingsDrive::of(truck());
        let with = measured(&drive.on(5.0, &tenth(&[1.0, impossible], 20.0)));
        assert!(with.len() > 30);
        assert!(with.iter().all(|of| of.acceleration_mps2 == 1.0));
        let mut drive = ReadingsDrive::of(truck());
        let only = drive.on(5.0, &tenth(&[impossible], 20.0));
        assert!(measured(&only).is_empty(), "{impossible}");
    }
}

#[test]
fn readings_of_a_standstill_are_not_those_of_the_cell_in_which_it_is() {
    let mut drive = ReadingsDrive::of(truck());
    drive.on(5.0, &tenth(&[1.0], 10.0));
    drive.on(60.0, &tenth(&[-3.0], 0.0));
    let after = measured(&drive.on(5.0, &tenth(&[1.0], 10.0)));
    // The cell holds the stop within its last tenth, and the way to and from it.
    let first = after[0].acceleration_mps2;
    assert!(first > -1.5, "{first}");
    assert!(after[1..].iter().all(|of| of.acceleration_mps2 == 1.0));
}

#[test]
fn a_constant_sensor_has_no_resolution() {
    let mut drive = ReadingsDrive::of(truck());
    let samples = drive.on(5.0, &tenth(&[1.0], 20.0));
    assert!(
        measured(&samples)
            .iter()
            .all(|of| of.resolution_mps2 == 0.0)
    );
}

#[test]
fn values_that_are_not_available_change_nothing() {
    let reading = |signal, value| Reading { signal, value };
    let mut drive = ReadingsDrive::of(truck());
    for nothing in [Value::NotAvailable, Value::Error] {
        let readings = [
            reading(FORWARD, Value::Real(1.0)),
            reading(FORWARD, nothing),
            reading(Signal::WheelSpeed, Value::Real(20.0)),
        ];
        let readings = readings.map(|of| (of.signal, of.value));
        let with = measured(&drive.on_values(5.0, &readings));
        assert!(with.len() > 30);
        assert!(with.iter().all(|of| of.acceleration_mps2 == 1.0));
    }
}

#[test]
fn more_readings_than_the_counter_holds_leave_the_mean_of_those_it_counted() {
    let mut drive = ReadingsDrive::of(truck());
    drive.on(5.0, &tenth(&[1.0], 20.0));
    let mut flood = vec![1.0; usize::from(u16::MAX)];
    flood.extend([3.0; 1_000]);
    let during = measured(&drive.on(0.2, &tenth(&flood, 20.0)));
    assert!(!during.is_empty());
    assert!(during.iter().all(|of| of.acceleration_mps2 == 1.0));
    assert_eq!(during[0].count, u8::MAX);
}
