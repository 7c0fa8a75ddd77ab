//! Vertical speed and pitch: readings become one measured slope a cell.

use estimator_core::sample::{Sample, SlopeMeasurement, SlopeSensor};
use estimator_core::{Signal, Value};
use test_kit::readings_drive::ReadingsDrive;
use test_kit::truck;

const SPEED_MPS: f32 = 20.0;

/// Drives some seconds with these readings before each speed, ten times a second.
fn drive(readings: &[(Signal, f32)], mps: f32) -> Vec<SlopeMeasurement> {
    let mut drive = ReadingsDrive::of(truck());
    let mut tenth = readings.to_vec();
    tenth.push((Signal::WheelSpeed, mps));
    slopes(&drive.on(10.0, &tenth))
}

fn slopes(samples: &[Sample]) -> Vec<SlopeMeasurement> {
    samples.iter().filter_map(|sample| sample.slope).collect()
}

#[test]
fn a_vertical_speed_over_the_speed_is_the_sine_of_the_slope() {
    let measured = drive(&[(Signal::VerticalSpeed, -0.5)], SPEED_MPS);
    assert!(measured.len() > 70);
    for slope in measured {
        assert_eq!(slope.sensor, SlopeSensor::VerticalSpeed);
        assert!((slope.slope_percent + 2.5).abs() < 1e-4);
    }
}

#[test]
fn a_pitch_is_the_mean_of_a_cell() {
    let degrees = |percent: f32| (0.01 * percent).asin().to_degrees();
    let [low, high] = [degrees(9.0), degrees(11.0)];
    let measured = drive(&[(Signal::Pitch, low), (Signal::Pitch, high)], SPEED_MPS);
    assert!(measured.len() > 70);
    for slope in measured {
        assert_eq!(slope.sensor, SlopeSensor::Pitch);
        assert!((slope.slope_percent - 10.0).abs() < 0.005, "{slope:?}");
    }
}

#[test]
fn a_vertical_speed_goes_before_a_pitch_unless_the_vehicle_crawls() {
    let both = [(Signal::VerticalSpeed, 0.2), (Signal::Pitch, 1.0)];
    for (mps, sensor) in [
        (SPEED_MPS, SlopeSensor::VerticalSpeed),
        (3.0, SlopeSensor::Pitch),
    ] {
        let measured = drive(&both, mps);
        assert!(!measured.is_empty());
        assert!(measured.iter().all(|slope| slope.sensor == sensor));
    }
    assert!(drive(&[(Signal::VerticalSpeed, 0.2)], 3.0).is_empty());
}

#[test]
fn a_reading_counts_in_one_cell() {
    let mut drive = ReadingsDrive::of(truck());
    drive.on(5.0, &[(Signal::WheelSpeed, SPEED_MPS)]);
    let once = [
        (Signal::VerticalSpeed, 0.1),
        (Signal::WheelSpeed, SPEED_MPS),
    ];
    let mut samples = drive.on(0.1, &once);
    samples.extend(drive.on(5.0, &[(Signal::WheelSpeed, SPEED_MPS)]));
    assert_eq!(slopes(&samples).len(), 1);
}

#[test]
fn more_pitches_than_are_counted_leave_the_mean() {
    let mut readings = vec![(Signal::Pitch, 1.0); 70_000];
    readings.push((Signal::WheelSpeed, SPEED_MPS));
    let samples = ReadingsDrive::of(truck()).on(1.0, &readings);
    let measured = slopes(&samples);
    assert!(!measured.is_empty());
    for slope in measured {
        assert!((slope.slope_percent - 1.745).abs() < 0.01, "{slope:?}");
    }
}

#[test]
fn what_no_vehicle_does_is_no_slope() {
    for reading in [
        (Signal::VerticalSpeed, 25.0),
        (Signal::VerticalSpeed, 15.0),
        (Signal::VerticalSpeed, f32::NAN),
        (Signal::Pitch, 80.0),
        (Signal::Pitch, 40.0),
        (Signal::Pitch, f32::NAN),
    ] {
        assert!(drive(&[reading], SPEED_MPS).is_empty(), "{reading:?}");
    }
}

#[test]
fn a_vertical_speed_without_a_fix_does_not_count() {
    let with = |signal, value| [(signal, value), (Signal::VerticalSpeed, 0.1)];
    assert!(drive(&with(Signal::FixMethod, 0.0), SPEED_MPS).is_empty());
    assert!(drive(&with(Signal::Satellites, 2.0), SPEED_MPS).is_empty());
    assert!(!drive(&with(Signal::Satellites, 9.0), SPEED_MPS).is_empty());
}

#[test]
fn an_unavailable_vertical_speed_takes_the_last_one_back() {
    let mut drive = ReadingsDrive::of(truck());
    drive.on(5.0, &[(Signal::WheelSpeed, SPEED_MPS)]);
    let speed = (Signal::WheelSpeed, Value::Real(SPEED_MPS));
    let [there, gone] =
        [Value::Real(0.1), Value::NotAvailable].map(|value| (Signal::VerticalSpeed, value));
    let during = drive.on_values(0.1, &[there, gone, speed]);
    let after = drive.on_values(5.0, &[speed]);
    assert!(slopes(&during).is_empty() && slopes(&after).is_empty());
}
