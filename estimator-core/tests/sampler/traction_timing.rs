//! How late the force is beside the motion.

use estimator_core::Signal;
use test_kit::readings_drive::ReadingsDrive;
use test_kit::{Noise, by_force};

/// Mass of the vehicle in the drives below, kg. The sampler does not know it.
const MASS_KG: f32 = 30_000.0;

/// Drives with a force that a driver or a gearbox changes, `changes_per_min` times a minute, on a road
/// whose slope follows a wave of 2 %. The force is reported so much later. Returns by how much the
/// sampler finds the force late, s, at the end of each of so many minutes.
fn found(minutes: u16, changes_per_min: f32, late_s: f32, speed_noise_mps: f32) -> Vec<f32> {
    let mut drive = ReadingsDrive::of(by_force());
    let mut noise = Noise(3);
    let (mut mps, mut force_n, mut until_s) = (15.0_f32, 0.0_f32, 0.0_f32);
    let late_ticks = (10.0 * late_s).round() as usize;
    let mut forces = vec![0.0; late_ticks + 1];
    let mut found = Vec::new();
    for tick in 0..600 * minutes {
        let seconds = 0.1 * f32::from(tick);
        if seconds >= until_s {
            until_s = seconds + 60.0 / changes_per_min * (0.5 + noise.draw().abs());
            // Back to 15 m/s in the mean.
            force_n = 3_000.0 * (15.0 - mps) + 8_000.0 * noise.draw();
        }
        let slope_n = 0.02 * 9.81 * MASS_KG * (0.05 * seconds).sin();
        mps = (mps + 0.1 * (force_n - slope_n) / MASS_KG).clamp(5.0, 25.0);
        forces.push(force_n);
        let reported_n = forces[forces.len() - 1 - late_ticks];
        drive.on(
            0.1,
            &[
                (Signal::TractionForce, reported_n),
                (Signal::WheelSpeed, mps + speed_noise_mps * noise.draw()),
            ],
        );
        if tick % 600 == 599 {
            found.push(drive.samples.last().unwrap().traction_late_s);
        }
    }
    found
}

#[test]
fn a_force_that_is_late_is_found_within_minutes() {
    for late_s in [1.0_f32, 2.0, 3.0] {
        let found = found(6, 12.0, late_s, 0.02);
        for (minute, found_s) in found.iter().enumerate().skip(4) {
            let off_s = found_s - late_s;
            assert!(
                off_s.abs() < 0.2,
                "{late_s} s late, minute {minute}: {off_s} s off"
            );
        }
    }
}

#[test]
fn a_force_that_comes_at_once_is_not_late() {
    for (changes_per_min, noise_mps) in [(12.0, 0.02), (12.0, 0.1), (3.0, 0.02), (0.2, 0.05)] {
        let found = found(10, changes_per_min, 0.0, noise_mps);
        let what = format!("{changes_per_min} changes a minute, {noise_mps} m/s of noise");
        assert!(
            found.iter().all(|late_s| *late_s == 0.0),
            "{what}: {found:?}"
        );
    }
}

/// What only the road changes comes too slowly.
#[test]
fn without_changes_of_the_force_nothing_is_found() {
    let found = found(10, 0.1, 2.0, 0.1);
    assert!(found.iter().all(|late_s| *late_s == 0.0), "{found:?}");
}
