//! Altitudes that a receiver smooths, or gives late: the delay is found, and undone.

use estimator_core::filter::ModelMass;
use estimator_core::sample::Sample;
use estimator_core::{CELL_LENGTH_M, Counters, Tuning};
use test_kit::{FilterRun, Noise, altitude, sample, speed, truck};

const SPEED_MPS: f32 = 20.0;
/// Cells of a second at this speed.
const SECOND: u32 = 8;

/// Returns the altitude at a cell of a hilly road, m: 4 % at most.
fn hills_m(cell: f32) -> f32 {
    let way_m = cell * CELL_LENGTH_M;
    100.0 + 12.0 * (way_m / 300.0).sin() + 20.0 * (way_m / 1_100.0).sin()
}

/// Returns the altitude at a cell of a flat road with a crest of 15 % behind hills, m.
fn crest_m(cell: f32) -> f32 {
    let from_crest_m = cell * CELL_LENGTH_M - 12_000.0;
    hills_m(cell) + 33.0 * (-(from_crest_m / 200.0).powi(2)).exp()
}

/// What a receiver makes of altitudes.
trait Receiver {
    fn reported_m(&mut self, fix: u32, true_m: f32) -> f32;
}

/// Low-pass of the first order with this time constant, in fixes, between two fixes of the drive.
struct LowPass {
    time_constant_fixes: f32,
    between_fixes: (u32, u32),
    smoothed_m: Option<f32>,
}

impl LowPass {
    fn always(time_constant_fixes: f32) -> Self {
        Self {
            time_constant_fixes,
            between_fixes: (0, u32::MAX),
            smoothed_m: None,
        }
    }
}

impl Receiver for LowPass {
    fn reported_m(&mut self, fix: u32, true_m: f32) -> f32 {
        let (from, to) = self.between_fixes;
        let before = self.smoothed_m.unwrap_or(true_m);
        let part = if (from..to).contains(&fix) {
            1.0 - (-1.0 / self.time_constant_fixes).exp()
        } else {
            1.0
        };
        *self.smoothed_m.insert(before + part * (true_m - before))
    }
}

/// Altitudes of so many seconds before.
struct Late(Vec<f32>, usize);

impl Receiver for Late {
    fn reported_m(&mut self, _: u32, true_m: f32) -> f32 {
        self.0.push(true_m);
        self.0[self.0.len().saturating_sub(1 + self.1)]
    }
}

/// A drive over a road, with errors of the force, N, altitudes that are so many metres apart, and
/// samples that `change` changes.
struct Drive<'a> {
    road_m: fn(f32) -> f32,
    speed_mps: f32,
    force_noise_n: f32,
    fixes_apart_m: f32,
    change: &'a dyn Fn(u32, &mut Sample),
}

impl Default for Drive<'_> {
    fn default() -> Self {
        Self {
            road_m: hills_m,
            speed_mps: SPEED_MPS,
            force_noise_n: 0.0,
            fixes_apart_m: SPEED_MPS,
            change: &|_, _| (),
        }
    }
}

impl Drive<'_> {
    /// Returns the errors of the altitude, m, and the counters.
    fn driven(&self, cells: u32, receiver: &mut dyn Receiver) -> (Vec<f32>, Counters) {
        let vehicle = truck();
        let weight_n = vehicle.mass_kg * 9.806_65;
        let speed_mps = self.speed_mps;
        let air_n = 0.5 * vehicle.drag_area_m2 * 1.2 * speed_mps * speed_mps;
        let mut run = FilterRun::<f64>::new(vehicle.clone(), Tuning::default());
        let mut noise = Noise(9);
        let mut force_error_n = 0.0;
        let errors = (1..=cells).map(|cell| {
            let road_m = |cell: u32| (self.road_m)(cell as f32);
            let sine = (road_m(cell) - road_m(cell - 1)) / CELL_LENGTH_M;
            if cell % (4 * SECOND) == 0 {
                force_error_n = self.force_noise_n * noise.draw();
            }
            let force_n = air_n + weight_n * (vehicle.rolling_resistance + sine) + force_error_n;
            let mut sample = sample(cell, force_n, speed_mps);
            sample.mass_is_reported = true;
            sample.speed = speed(speed_mps + 0.01 * noise.draw());
            let end_m = sample.end.distance_m() as f32;
            let fix = (end_m / self.fixes_apart_m).floor();
            let at_m = fix * self.fixes_apart_m;
            if at_m > end_m - CELL_LENGTH_M {
                let true_m = (self.road_m)(at_m / CELL_LENGTH_M) + 0.2 * noise.draw();
                sample.altitude = altitude(receiver.reported_m(fix as u32, true_m));
                sample.altitude.as_mut().expect("an altitude").behind_m = end_m - at_m;
            }
            (self.change)(cell, &mut sample);
            let step = run.step(&sample).expect("a speed");
            let found = step.state.estimate(&ModelMass::default()).altitude_m;
            found.map_or(0.0, |found| found.value - road_m(cell))
        });
        let errors = errors.collect();
        (errors, run.context.counters)
    }
}

fn rms(errors: &[f32]) -> f32 {
    (errors.iter().map(|error| error * error).sum::<f32>() / errors.len() as f32).sqrt()
}

#[test]
fn altitudes_that_are_not_late_are_left_as_they_are() {
    let (errors, counters) = Drive::default().driven(16_000, &mut Late(Vec::new(), 0));
    assert!(rms(&errors[14_000..]) < 1.0, "{}", rms(&errors[14_000..]));
    assert_eq!(counters.altitude_resets, 1);
}

#[test]
fn what_a_receiver_smooths_away_is_put_back() {
    for time_constant_s in [5.0, 12.0, 30.0] {
        let (errors, counters) =
            Drive::default().driven(16_000, &mut LowPass::always(time_constant_s));
        // As they are, they are off by up to 0.5 m a second of the time constant.
        let off_m = rms(&errors[14_000..]);
        assert!(off_m < 1.5, "{time_constant_s} s: {off_m} m");
        // Once at the start, and as often as the time constant is found or found better.
        assert!(
            (2..=6).contains(&counters.altitude_resets),
            "{time_constant_s} s: {}",
            counters.altitude_resets
        );
    }
}

#[test]
fn altitudes_taken_within_cells_are_put_back_as_well() {
    // 19 m/s are 7.6 cells a second.
    for (speed_mps, a_second) in [(19.0, 1.0), (19.0, 2.0), (SPEED_MPS, 8.0)] {
        let drive = Drive {
            speed_mps,
            fixes_apart_m: speed_mps / a_second,
            ..Drive::default()
        };
        let (errors, _) = drive.driven(16_000, &mut LowPass::always(12.0 * a_second));
        let off_m = rms(&errors[12_000..]);
        assert!(off_m < 0.5, "{speed_mps} m/s, {a_second} Hz: {off_m} m");
    }
}

#[test]
fn a_sharp_crest_behind_a_receiver_that_smooths_is_no_outlier() {
    let drive = Drive {
        road_m: crest_m,
        ..Drive::default()
    };
    let (errors, _) = drive.driven(16_000, &mut LowPass::always(28.0));
    for (behind, most_m) in [(8_000, 2.5), (12_000, 1.3)] {
        let off_m = rms(&errors[behind..behind + 1_000]);
        assert!(off_m < most_m, "cell {behind}: {off_m} m");
    }
}

#[test]
fn a_plain_delay_is_taken_for_the_low_pass_that_is_most_like_it() {
    let (errors, counters) = Drive::default().driven(16_000, &mut Late(Vec::new(), 9));
    // Without it the altitudes are off by 6 m.
    assert!(rms(&errors[14_000..]) < 2.0, "{}", rms(&errors[14_000..]));
    assert!(counters.altitude_resets > 1);
}

#[test]
fn noise_of_the_forces_is_no_delay_of_the_altitudes() {
    // A low-pass takes noise away, so the forces behind one fit altitudes better than as they are.
    let nearly_flat: fn(f32) -> f32 = |cell| 100.0 + 2.0 * (cell * CELL_LENGTH_M / 300.0).sin();
    for road_m in [hills_m, nearly_flat] {
        for force_noise_n in [5_000.0, 20_000.0] {
            let drive = Drive {
                road_m,
                force_noise_n,
                ..Drive::default()
            };
            let (_, counters) = drive.driven(24_000, &mut Late(Vec::new(), 0));
            assert_eq!(counters.altitude_resets, 1, "{force_noise_n} N");
        }
    }
}

#[test]
fn a_receiver_that_ceases_to_smooth_is_believed_as_it_is() {
    let mut receiver = LowPass {
        between_fixes: (0, 1_000),
        ..LowPass::always(12.0)
    };
    let (errors, counters) = Drive::default().driven(24_000, &mut receiver);
    assert!(rms(&errors[22_000..]) < 1.0, "{}", rms(&errors[22_000..]));
    assert!(counters.altitude_resets >= 3);
}

#[test]
fn after_a_stop_smoothed_altitudes_wait_until_two_show_how_fast_they_change() {
    let stop = 15_000;
    let used = |until: u32| {
        let drive = Drive {
            change: &|cell, sample| {
                if cell == stop {
                    sample.duration_s = 20.0;
                }
            },
            ..Drive::default()
        };
        let (errors, counters) = drive.driven(until, &mut LowPass::always(9.0));
        (rms(&errors[until as usize - 8..]), counters.altitudes_used)
    };
    let (_, before) = used(stop - SECOND);
    // Fixes come every second, and the rate is that between two.
    let (_, waiting) = used(stop);
    let (off_m, after) = used(stop + 20 * SECOND);
    assert_eq!(waiting, before);
    assert!((18..=20).contains(&(after - before)), "{before} {after}");
    assert!(off_m < 3.0, "{off_m}");
}

#[test]
fn a_delay_counts_where_it_explains_much_of_what_differs() {
    for (force_noise_n, is_found) in [(0.0, true), (3_000.0, true), (10_000.0, false)] {
        let drive = Drive {
            force_noise_n,
            ..Drive::default()
        };
        let (_, counters) = drive.driven(24_000, &mut Late(Vec::new(), 4));
        assert_eq!(
            counters.altitude_resets > 1,
            is_found,
            "{force_noise_n} N: {} resets",
            counters.altitude_resets
        );
    }
}
