//! Torques that are reported in Nm, and powertrains with a single reduction.

use estimator_core::sample::Sample;
use estimator_core::{Signal, Value};
use test_kit::readings_drive::ReadingsDrive;
use test_kit::{by_force, truck, truck_with};

/// Reference torque of the electric car, Nm, and the ratio of its only gear.
const REFERENCE_NM: f32 = 250.0;
const REDUCTION: f32 = 3.2;
/// Force at its wheels for one Nm of the motor: final drive, efficiencies and radius of the kit's truck.
const N_PER_NM: f32 = REDUCTION * 2.92 * 0.985 * 0.98 / 0.5;

fn electric() -> ReadingsDrive {
    ReadingsDrive::of(truck_with(REFERENCE_NM, &[REDUCTION]))
}

/// Drives for 10 s at 20 m/s, and returns the last sample.
fn last(drive: &mut ReadingsDrive, readings: &[(Signal, f32)]) -> Sample {
    let mut all = readings.to_vec();
    all.push((Signal::WheelSpeed, 20.0));
    *drive.on(10.0, &all).last().unwrap()
}

fn assert_force(sample: &Sample, torque_nm: f32) {
    let expected_n = torque_nm * N_PER_NM;
    let off_n = sample.forces.traction_n - expected_n;
    assert!(
        off_n.abs() < 0.01,
        "{} N: {torque_nm} Nm",
        expected_n + off_n
    );
    assert!(!sample.end.condition.no_traction);
}

#[test]
fn a_motor_through_a_single_reduction_needs_neither_gear_nor_speed() {
    for torque_nm in [120.0, 0.0, -80.0] {
        let sample = last(&mut electric(), &[(Signal::MotorTorque, torque_nm)]);
        assert_force(&sample, torque_nm);
        assert!(sample.end.condition.is_valid());
        assert!(sample.effect_inputs.engaged);
    }
}

#[test]
fn a_part_of_the_reference_torque_through_a_single_reduction_needs_none_either() {
    let sample = last(&mut electric(), &[(Signal::EngineTorque, 40.0)]);
    assert_force(&sample, 0.4 * REFERENCE_NM);
}

#[test]
fn neither_a_motor_speed_nor_a_selector_opens_a_single_reduction() {
    // Neither a speed at which no gear turns nor the number of a selector's position.
    for more in [(Signal::MotorSpeed, 700.0), (Signal::CurrentGear, 4.0)] {
        let sample = last(&mut electric(), &[more, (Signal::MotorTorque, 100.0)]);
        assert_force(&sample, 100.0);
    }
}

#[test]
fn the_only_gear_of_a_file_is_not_in_while_the_engine_turns_otherwise() {
    // A truck whose file has the gear of the motorway alone, in that gear and in another one, fast and
    // at launch.
    for (speed_mps, of_the_gear, is_in) in [
        (20.0, 1.0, true),
        (20.0, 1.3, false),
        (3.0, 1.3, true),
        (3.0, 4.0, false),
    ] {
        let turned_rpm = speed_mps / 0.5 * 2.92 * REDUCTION * 30.0 / std::f32::consts::PI;
        let readings = [
            (Signal::EngineSpeed, of_the_gear * turned_rpm),
            (Signal::EngineTorque, 40.0),
            (Signal::WheelSpeed, speed_mps),
        ];
        let sample = *electric().on(10.0, &readings).last().unwrap();
        assert_eq!(
            sample.end.condition.no_traction, !is_in,
            "{speed_mps} m/s, {of_the_gear}"
        );
    }
}

#[test]
fn a_single_reduction_is_open_where_a_signal_says_so() {
    for open in [
        (Signal::CurrentGear, 0.0),
        (Signal::DrivelineEngaged, 0.0),
        (Signal::ClutchSwitch, 1.0),
    ] {
        let sample = last(&mut electric(), &[open, (Signal::MotorTorque, 100.0)]);
        assert_eq!(sample.forces.traction_n, 0.0, "{open:?}");
        assert!(!sample.effect_inputs.engaged);
    }
}

#[test]
fn several_gears_need_a_gear_or_a_speed_which_may_be_the_motors() {
    let mut unknown = ReadingsDrive::of(truck());
    let sample = last(&mut unknown, &[(Signal::MotorTorque, 800.0)]);
    assert!(sample.end.condition.no_traction);

    // The direct gear turns so at 20 m/s.
    let mut known = ReadingsDrive::of(truck());
    let speed = (Signal::MotorSpeed, 1_115.4);
    let sample = last(&mut known, &[speed, (Signal::MotorTorque, 800.0)]);
    assert!(!sample.end.condition.no_traction);
    let expected_n = 800.0 * 2.92 * 0.985 * 0.98 / 0.5;
    assert!((sample.forces.traction_n / expected_n - 1.0).abs() < 1e-5);
}

#[test]
fn a_torque_in_nm_is_net_and_goes_before_parts_of_the_reference_torque() {
    let parts = [(Signal::FrictionTorque, 10.0), (Signal::EngineTorque, 90.0)];
    for signal in [Signal::NetEngineTorque, Signal::MotorTorque] {
        let mut drive = electric();
        let mut both = parts.to_vec();
        both.push((signal, 50.0));
        assert_force(&last(&mut drive, &both), 50.0);
        both.rotate_right(1);
        assert_force(&last(&mut drive, &both), 50.0);
        // Without it, the parts stand in.
        assert_force(&last(&mut drive, &parts), 0.8 * REFERENCE_NM);
    }
}

#[test]
fn the_torque_of_a_motor_goes_before_that_of_an_engine() {
    let mut drive = electric();
    let engine = (Signal::NetEngineTorque, 200.0);
    let both = [engine, (Signal::MotorTorque, 60.0), engine];
    assert_force(&last(&mut drive, &both), 60.0);
    assert_force(&last(&mut drive, &[engine]), 200.0);
}

#[test]
fn the_same_torque_in_nm_and_in_parts_gives_the_same_samples() {
    let drive_of = |percent: bool| {
        let mut drive = ReadingsDrive::of(truck());
        for k in 0..100 {
            let torque_percent = 40.0 + 30.0 * (0.3 * k as f32).sin();
            let torque = if percent {
                (Signal::EngineTorque, torque_percent)
            } else {
                (Signal::NetEngineTorque, 17.5 * torque_percent)
            };
            let gear = (Signal::CurrentGear, if k < 50 { 10.0 } else { 11.0 });
            drive.on(0.5, &[gear, torque, (Signal::WheelSpeed, 20.0)]);
        }
        drive.samples
    };
    let (nm, percent) = (drive_of(false), drive_of(true));
    assert_eq!(nm.len(), percent.len());
    for (nm, percent) in nm.iter().zip(&percent) {
        let off_n = nm.forces.traction_n - percent.forces.traction_n;
        assert!(off_n.abs() < 0.02, "{off_n} N");
        assert_eq!(nm.end.condition, percent.end.condition);
    }
}

#[test]
fn a_measured_force_is_not_touched_by_torques() {
    let mut drive = ReadingsDrive::of(by_force());
    let readings = [(Signal::MotorTorque, 100.0), (Signal::TractionForce, 5e3)];
    assert_eq!(last(&mut drive, &readings).forces.traction_n, 5e3);
}

#[test]
fn a_force_counts_where_the_vehicle_is_known_by_it_and_only_with_a_value() {
    let force = [(Signal::TractionForce, 5e3)];
    let torque = [(Signal::MotorTorque, 100.0), force[0]];
    let mut by_torque = electric();
    assert_force(&last(&mut by_torque, &torque), 100.0);
    let mut without = electric();
    assert_force(&last(&mut without, &torque[..1]), 100.0);
    let used = |drive: &ReadingsDrive| drive.context.counters.tractions_used;
    assert_eq!(used(&by_torque), used(&without));

    let mut by_force = ReadingsDrive::of(by_force());
    let nothing = [
        (Signal::TractionForce, Value::NotAvailable),
        (Signal::WheelSpeed, Value::Real(20.0)),
    ];
    let blind = *by_force.on_values(10.0, &nothing).last().unwrap();
    assert!(blind.end.condition.no_traction, "{blind:?}");
    assert_eq!(used(&by_force), 0);
    assert_eq!(last(&mut by_force, &force).forces.traction_n, 5e3);
    assert_eq!(used(&by_force), 100);
}

#[test]
fn a_torque_in_nm_that_is_not_available_is_none() {
    let mut drive = electric();
    assert_force(&last(&mut drive, &[(Signal::MotorTorque, 100.0)]), 100.0);
    let nothing = [
        (Signal::MotorTorque, Value::NotAvailable),
        (Signal::WheelSpeed, Value::Real(20.0)),
    ];
    let blind = *drive.on_values(10.0, &nothing).last().unwrap();
    assert!(blind.end.condition.no_traction, "{blind:?}");
}

#[test]
fn a_single_reduction_has_the_ratio_that_is_measured_and_is_open_in_reverse() {
    let ratio = (Signal::GearRatio, REDUCTION);
    let sample = last(&mut electric(), &[ratio, (Signal::MotorTorque, 100.0)]);
    assert_force(&sample, 100.0);
    let reverse = (Signal::CurrentGear, -1.0);
    let mut drive = electric();
    drive.on(
        10.0,
        &[(Signal::MotorTorque, 100.0), (Signal::WheelSpeed, 20.0)],
    );
    let readings = [
        reverse,
        (Signal::MotorTorque, 100.0),
        (Signal::WheelSpeed, 3.0),
    ];
    assert_eq!(drive.on(10.0, &readings), [], "it reverses");
}
