//! The ratio at which the engine turns counts where it is not that of the reported gear.

use estimator_core::Signal;
use estimator_core::sample::Sample;
use test_kit::readings_drive::ReadingsDrive;
use test_kit::truck;

/// The direct gear of the truck, its eleventh, turns the engine at this at 20 m/s, rpm.
const DIRECT_RPM: f32 = 1_115.4;
/// Net torque of the engine, Nm, and that of it at the wheels in a gear of ratio one, as a force, N.
const NET_NM: f32 = 0.5 * 1_750.0;
const DIRECT_N: f32 = NET_NM * 2.92 * 0.985 * 0.98 / 0.5;

/// Returns readings at 20 m/s with half of the torque, in a reported gear.
fn in_gear(gear: f32, rpm: f32) -> Vec<(Signal, f32)> {
    vec![
        (Signal::DrivelineEngaged, 1.0),
        (Signal::FrictionTorque, 7.0),
        (Signal::EngineSpeed, rpm),
        (Signal::CurrentGear, gear),
        (Signal::EngineTorque, 57.0),
        (Signal::WheelSpeed, 20.0),
    ]
}

/// Returns the drive after 100 s in the direct gear, reported as such.
fn driven() -> ReadingsDrive {
    let mut drive = ReadingsDrive::of(truck());
    drive.on(100.0, &in_gear(11.0, DIRECT_RPM));
    drive
}

/// Returns the driven time after which the model holds to the end, s.
fn valid_from_s(samples: &[Sample]) -> f64 {
    let begin = samples[0].end.time;
    let last = samples.iter().rfind(|s| !s.end.condition.is_valid());
    last.map_or(0.0, |s| 1e-6 * s.end.time.since(begin).micros() as f64)
}

#[test]
fn the_true_ratio_counts_for_as_long_as_a_wrong_gear_is_reported() {
    // From the seventh to the twelfth gear: every other one is wrong.
    for (told, ratio) in [(7.0, 2.9), (9.0, 1.8), (10.0, 1.4), (12.0, 0.8)] {
        let mut drive = driven();
        let wrong = drive.on(300.0, &in_gear(told, DIRECT_RPM));
        let from_s = valid_from_s(&wrong);
        // Two seconds of doubt, and the hold time of a shift.
        assert!((2.0..3.5).contains(&from_s), "gear {told}: {from_s} s");
        let force_n = wrong.last().unwrap().forces.traction_n;
        let off = force_n / DIRECT_N - 1.0;
        assert!(off.abs() < 0.01, "gear {told}: {force_n} N");
        let told_n = ratio * DIRECT_N;
        assert!((told_n - DIRECT_N).abs() > 0.15 * DIRECT_N, "{told_n} N");
        // The true gear again.
        let right = drive.on(10.0, &in_gear(11.0, DIRECT_RPM));
        assert!(valid_from_s(&right) < 1.5);
        let force_n = right.last().unwrap().forces.traction_n;
        assert!((force_n / DIRECT_N - 1.0).abs() < 0.01, "{force_n} N");
    }
}

#[test]
fn a_range_gear_that_nobody_reports_raises_force_and_rotating_mass() {
    let mut drive = driven();
    let plain = *drive.samples.last().unwrap();
    let low = *drive
        .on(60.0, &in_gear(11.0, 2.0 * DIRECT_RPM))
        .last()
        .unwrap();
    let ratio = low.forces.traction_n / plain.forces.traction_n;
    assert!((ratio - 2.0).abs() < 0.02, "{ratio}");
    // The engine's inertia counts with the square of the ratio, the wheels' does not.
    let of_engine = |rotating_kg: f32| rotating_kg - 100.0 / 0.25;
    let ratio = of_engine(low.forces.rotating_kg) / of_engine(plain.forces.rotating_kg);
    assert!((ratio - 4.0).abs() < 0.08, "{ratio}");
}

#[test]
fn an_engine_that_idles_in_a_reported_gear_drives_nothing() {
    // The clutch is open, and no signal reports that: the torque is that of friction.
    let mut drive = driven();
    let mut idling = in_gear(11.0, 600.0);
    for (signal, value) in &mut idling {
        if *signal == Signal::EngineTorque {
            *value = 7.0;
        }
    }
    for sample in drive.on(30.0, &idling).iter().skip(2) {
        assert!(sample.forces.traction_n.abs() < 1.0, "{sample:?}");
    }
}

#[test]
fn a_ratio_that_changes_all_the_time_is_that_of_a_slipping_clutch() {
    let mut drive = driven();
    for second in 0..20_u8 {
        // 8 % a second: never the same for two.
        let rpm = DIRECT_RPM * 1.4 * 1.08_f32.powi(second.into());
        let slipping = drive.on(1.0, &in_gear(11.0, rpm));
        let first = usize::from(second == 0);
        for sample in slipping.iter().skip(first) {
            assert!(!sample.end.condition.is_valid(), "second {second}");
        }
    }
}
