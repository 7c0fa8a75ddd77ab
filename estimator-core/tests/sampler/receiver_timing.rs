//! Latency of the receiver and scale of the wheel speed, found from both speeds.

use estimator_core::Signal;
use test_kit::readings_drive::ReadingsDrive;
use test_kit::{Noise, by_force};

/// A drive whose speed is that of a wave.
#[derive(Clone, Copy)]
struct Wave {
    mean_mps: f32,
    swing_mps: f32,
    per_s: f32,
}

/// 11 to 19 m/s within 16 s.
const ROLLING: Wave = Wave {
    mean_mps: 15.0,
    swing_mps: 4.0,
    per_s: 0.2,
};
/// A bus in a city, which never stops.
const CITY: Wave = Wave {
    mean_mps: 9.0,
    swing_mps: 5.5,
    per_s: 0.3,
};

/// A motorway: 21 to 23 m/s within a minute, at 0.1 m/s² at most.
const MOTORWAY: Wave = Wave {
    mean_mps: 22.0,
    swing_mps: 1.0,
    per_s: 0.1,
};

impl Wave {
    /// Returns speed and distance at a time.
    fn at(self, seconds: f32) -> (f32, f32) {
        let phase = self.per_s * seconds;
        let swing_m = self.swing_mps / self.per_s * (1.0 - phase.cos());
        let mps = self.mean_mps + self.swing_mps * phase.sin();
        (mps, self.mean_mps * seconds + swing_m)
    }
}

/// Drives 200 s with a receiver that is so late, and wheels that turn by so much too fast. An
/// altitude is a tenth of the place at which it was taken. Returns, for the last 50 s, how much too
/// far the sampler places the fixes, m, and the driven over the true distance.
fn driven(wave: Wave, late_s: f32, wheels: f32, noise_mps: f32) -> (Vec<f32>, f32) {
    driven_with_pauses(wave, late_s, wheels, noise_mps, |_| false)
}

/// Returns the same of a drive without wheel speed in the tenths of a second that `pauses` names.
fn driven_with_pauses(
    wave: Wave,
    late_s: f32,
    wheels: f32,
    noise_mps: f32,
    pauses: impl Fn(u16) -> bool,
) -> (Vec<f32>, f32) {
    let mut drive = ReadingsDrive::of(by_force());
    let mut noise = Noise(7);
    let (mut fixes, mut at_150_s) = (Vec::new(), 0.0);
    for tick in 0..2_000_u16 {
        let seconds = 0.1 * f32::from(tick);
        let (then_mps, then_m) = wave.at((seconds - late_s).max(0.0));
        let mut readings = vec![
            (Signal::GnssSpeed, then_mps + noise_mps * noise.draw()),
            (Signal::TractionForce, 4_000.0),
        ];
        if !pauses(tick) {
            readings.push((Signal::WheelSpeed, wheels * wave.at(seconds).0));
        }
        if tick % 10 == 3 {
            readings.push((Signal::Satellites, 9.0));
            readings.push((Signal::Altitude, 0.1 * then_m));
        }
        for sample in drive.on(0.1, &readings) {
            let end_m = sample.end.distance_m() as f32;
            if seconds < 150.0 {
                at_150_s = end_m;
            } else if let Some(fix) = sample.altitude {
                fixes.push(end_m - fix.behind_m - 10.0 * fix.altitude_m);
            }
        }
    }
    let end_m = drive.samples.last().unwrap().end.distance_m() as f32;
    let true_m = wave.at(200.0).1 - wave.at(150.0).1;
    (fixes, (end_m - at_150_s) / true_m)
}

#[test]
fn a_late_receiver_is_placed_where_its_fixes_were_taken() {
    for late_s in [1.0, 2.0, 5.0] {
        for noise_mps in [0.0, 0.1] {
            let (fixes, _) = driven(ROLLING, late_s, 1.0, noise_mps);
            assert!(fixes.len() > 45, "{}", fixes.len());
            // The way back is that at the speed of the moment, which changes by 0.8 m/s². Without
            // the latency, fixes are off by the way itself: 11 to 95 m.
            let bar_m = 1.0 + 0.5 * 0.8 * late_s * late_s;
            for off_m in fixes {
                assert!(off_m.abs() < bar_m, "{late_s} s late: {off_m} m");
            }
        }
    }
}

#[test]
fn a_receiver_of_the_assumed_latency_is_left_alone() {
    for wave in [ROLLING, CITY] {
        let (fixes, ratio) = driven(wave, 0.15, 1.0, 0.1);
        for off_m in fixes {
            assert!(off_m.abs() < 0.2, "{off_m} m");
        }
        assert!((ratio - 1.0).abs() < 0.01, "{ratio}");
    }
}

#[test]
fn a_wheel_speed_that_is_far_off_is_scaled_and_worn_tyres_are_not() {
    for wave in [ROLLING, CITY] {
        for (wheels, expected) in [(1.10, 1.0), (0.9, 1.0), (1.02, 1.02), (0.98, 0.98)] {
            let (_, ratio) = driven(wave, 0.15, wheels, 0.1);
            assert!((ratio / expected - 1.0).abs() < 0.01, "{wheels}: {ratio}");
        }
    }
}

#[test]
fn pauses_of_the_wheel_speed_show_no_latency() {
    // A second without a speed in each ten, which the sampler bridges.
    let (fixes, ratio) = driven_with_pauses(ROLLING, 0.15, 1.0, 0.1, |tick| tick % 100 >= 90);
    let worst_m = fixes
        .iter()
        .fold(0.0, |worst, off_m| off_m.abs().max(worst));
    // What is bridged in a straight line is off by as much as the speed bends.
    assert!(worst_m < 2.0, "{worst_m} m");
    assert!((ratio - 1.0).abs() < 0.01, "{ratio}");
}

#[test]
fn a_receiver_as_late_as_can_be_found_is_found() {
    let (fixes, _) = driven(ROLLING, 5.2, 1.0, 0.0);
    for off_m in fixes {
        // At the latency as assumed it is 5 s, or 50 m and more.
        assert!(off_m.abs() < 30.0, "{off_m} m");
    }
}

#[test]
fn a_wheel_speed_that_is_no_speed_of_the_vehicle_is_not_scaled() {
    // A tenth of the truth: another unit. What is learned from it would be no ratio of wheels.
    let (_, ratio) = driven(ROLLING, 0.15, 0.1, 0.1);
    assert!((ratio / 0.1 - 1.0).abs() < 0.03, "{ratio}");
}

#[test]
fn at_a_steady_speed_nothing_is_learned_of_the_latency() {
    let steady = Wave {
        mean_mps: 20.0,
        swing_mps: 0.0,
        per_s: 1.0,
    };
    let (fixes, ratio) = driven(steady, 0.15, 1.0, 0.0);
    for off_m in fixes {
        assert!(off_m.abs() < 0.2, "{off_m} m");
    }
    assert!((ratio - 1.0).abs() < 1e-3, "{ratio}");
}

#[test]
fn wheels_that_are_right_again_are_no_longer_scaled() {
    let mut drive = ReadingsDrive::of(by_force());
    let mut noise = Noise(7);
    let mut driven_over = |drive: &mut ReadingsDrive, from_tick: u16, wheels: f32| {
        let before_m = drive.samples.last().map_or(0.0, |of| of.end.distance_m());
        for tick in from_tick..from_tick + 3_000 {
            let (mps, _) = ROLLING.at(0.1 * f32::from(tick));
            let readings = [
                (Signal::GnssSpeed, mps + 0.1 * noise.draw()),
                (Signal::TractionForce, 4_000.0),
                (Signal::WheelSpeed, wheels * mps),
            ];
            drive.on(0.1, &readings);
        }
        let from_s = 0.1 * f32::from(from_tick);
        let true_m = ROLLING.at(from_s + 300.0).1 - ROLLING.at(from_s).1;
        (drive.samples.last().unwrap().end.distance_m() - before_m) as f32 / true_m
    };
    driven_over(&mut drive, 0, 1.1);
    let wrong = driven_over(&mut drive, 3_000, 1.1);
    assert!((wrong - 1.0).abs() < 0.01, "scaled: {wrong}");
    // What is known is forgotten over five minutes, four times as long for the last percent.
    for from_tick in (6_000..24_000).step_by(3_000) {
        driven_over(&mut drive, from_tick, 1.0);
    }
    let right = driven_over(&mut drive, 24_000, 1.0);
    assert!((right - 1.0).abs() < 1e-3, "{right}");
}

#[test]
fn a_scaled_wheel_speed_is_that_of_a_vehicle() {
    // Wheels of an unknown unit: a speed over ground of 18 times as much is believed.
    let mut drive = ReadingsDrive::of(by_force());
    let mut noise = Noise(7);
    let mut reading = |wheels_mps: f32| {
        [
            (Signal::GnssSpeed, 63.0 + 0.1 * noise.draw()),
            (Signal::TractionForce, 4_000.0),
            (Signal::WheelSpeed, wheels_mps),
        ]
    };
    for _ in 0..20_000 {
        drive.on(0.1, &reading(3.5));
    }
    let scaled_mps = drive.samples.last().unwrap().end.speed_mps;
    assert!((scaled_mps - 63.0).abs() < 1.0, "{scaled_mps} m/s");
    // The work of a reading follows from the fastest vehicle.
    for wheels_mps in [5.0, 20.0, 70.0, 70.0] {
        let driven = drive.on(2.4, &reading(wheels_mps));
        let fastest_mps = driven.iter().map(|of| of.end.speed_mps);
        let fastest_mps = fastest_mps.fold(0.0, f32::max);
        assert!(fastest_mps <= 70.0, "{fastest_mps} m/s");
    }
}

/// Drives so long with a receiver that is so late, on wheels that slip by 1 % at 20 kN. The force
/// accelerates the vehicle, as do hills. Returns how much too far the sampler places the fixes in the
/// last 50 s, m.
fn finely_driven(wave: Wave, late_s: f32, seconds: u16, slip: f32) -> f32 {
    let mut drive = ReadingsDrive::of(by_force());
    finely_driven_on(&mut drive, wave, |_| late_s, seconds, slip)
}

/// The same of a drive whose receiver is another one from a second on.
fn finely_driven_on(
    drive: &mut ReadingsDrive,
    wave: Wave,
    late_s: impl Fn(f32) -> f32,
    seconds: u16,
    slip: f32,
) -> f32 {
    let mut noise = Noise(7);
    let mut off_m = Vec::new();
    for tick in 0..10 * seconds {
        let now_s = 0.1 * f32::from(tick);
        let (then_mps, then_m) = wave.at((now_s - late_s(now_s)).max(0.0));
        // Half of the acceleration is that of the force, with hills of another length beside.
        let mps2 = wave.swing_mps * wave.per_s * (wave.per_s * now_s).cos();
        let force_n = 12_000.0 + 20_000.0 * mps2 + 8_000.0 * (0.23 * now_s).sin();
        let wheels = 1.0 + slip * force_n / 20_000.0;
        let mut readings = vec![
            (Signal::TractionForce, force_n),
            (
                Signal::WheelSpeed,
                wheels * wave.at(now_s).0 + 0.011 * noise.draw(),
            ),
        ];
        if tick % 2 == 1 {
            readings.push((Signal::GnssSpeed, then_mps + 0.05 * noise.draw()));
        }
        if tick % 10 == 3 {
            readings.push((Signal::Satellites, 9.0));
            readings.push((Signal::Altitude, 0.1 * then_m));
        }
        for sample in drive.on(0.1, &readings) {
            let end_m = sample.end.distance_m() as f32;
            if let Some(fix) = sample
                .altitude
                .filter(|_| now_s > f32::from(seconds) - 50.0)
            {
                // The odometer of slipping wheels is ahead by what they slipped so far.
                let end_s = sample.end.time.micros() as f32 * 1e-6;
                let ahead_m = end_m - wave.at(end_s).1;
                off_m.push(end_m - fix.behind_m - 10.0 * fix.altitude_m - ahead_m);
            }
        }
    }
    assert!(off_m.len() > 45, "{}", off_m.len());
    off_m.iter().sum::<f32>() / off_m.len() as f32
}

#[test]
fn a_latency_is_learned_to_a_few_hundredths_of_a_second() {
    for late_s in [0.0, 0.3, 0.4, 0.7] {
        // 22 m/s: 0.03 s are 0.7 m. Without it the fixes are off by 3.3, 3.3, 5.5 and 12 m.
        let mean_m = finely_driven(MOTORWAY, late_s, 1_200, 0.0);
        assert!(mean_m.abs() < 0.4, "{late_s} s late: {mean_m} m");
    }
}

#[test]
fn slip_is_no_latency() {
    for late_s in [0.15, 0.4] {
        let mean_m = finely_driven(MOTORWAY, late_s, 1_200, 0.01);
        assert!(mean_m.abs() < 0.6, "{late_s} s late: {mean_m} m");
    }
}

#[test]
fn a_latency_that_is_the_assumed_one_again_is_no_longer_carried() {
    let mut drive = ReadingsDrive::of(by_force());
    // A memory of five minutes instead of two hours.
    drive.context.tuning.detection.delay_memory_s = 300.0;
    let late_s = |now_s: f32| if now_s < 900.0 { 0.4 } else { 0.15 };
    let mean_m = finely_driven_on(&mut drive, MOTORWAY, late_s, 2_700, 0.0);
    assert!(mean_m.abs() < 0.4, "{mean_m} m");
}

#[test]
fn a_ferry_shows_nothing_of_the_wheels() {
    let mut drive = ReadingsDrive::of(by_force());
    let mut noise = Noise(7);
    let mut driven_m = |drive: &mut ReadingsDrive, seconds: u16, is_carried: bool| {
        let before_m = drive.samples.last().map_or(0.0, |of| of.end.distance_m());
        for tick in 0..10 * seconds {
            let mps = if is_carried {
                0.0
            } else {
                ROLLING.at(0.1 * f32::from(tick)).0
            };
            let ground_mps = if is_carried { 7.0 } else { mps };
            let readings = [
                (Signal::GnssSpeed, ground_mps + 0.1 * noise.draw()),
                (Signal::TractionForce, 4_000.0),
                (Signal::WheelSpeed, mps),
            ];
            drive.on(0.1, &readings);
        }
        (drive.samples.last().unwrap().end.distance_m() - before_m) as f32
    };
    driven_m(&mut drive, 200, false);
    let carried_m = driven_m(&mut drive, 900, true);
    assert!(carried_m < 15.0, "{carried_m} m");
    let after_m = driven_m(&mut drive, 200, false);
    assert!(
        (after_m / ROLLING.at(200.0).1 - 1.0).abs() < 0.01,
        "{after_m} m"
    );
}
