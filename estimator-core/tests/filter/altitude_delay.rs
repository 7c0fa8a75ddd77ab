//! Altitudes that a receiver smooths, or gives late: the delay is found, and undone.

use estimator_core::filter::ModelMass;
use estimator_core::sample::Sample;
use estimator_core::{CELL_LENGTH_M, Counters, Tuning};
use test_kit::{FilterRun, Noise, altitude, sample, speed, truck};

const SPEED_MPS: f32 = 20.0;
/// Cells of a second.
const SECOND: u32 = 8;

/// Returns the altitude at a cell of a hilly road, m: 4 % at most.
fn hills_m(cell: f32) -> f32 {
    let way_m = cell * CELL_LENGTH_M;
    100.0 + 12.0 * (way_m / 300.0).sin() + 20.0 * (way_m / 1_100.0).sin()
}

/// What a receiver makes of altitudes, one a second.
trait Receiver {
    fn reported_m(&mut self, second: u32, true_m: f32) -> f32;
}

/// Low-pass of the first order with this time constant, s, between two seconds of the drive.
struct LowPass {
    time_constant_s: f32,
    between_s: (u32, u32),
    smoothed_m: Option<f32>,
}

impl LowPass {
    fn always(time_constant_s: f32) -> Self {
        Self {
            time_constant_s,
            between_s: (0, u32::MAX),
            smoothed_m: None,
        }
    }
}

impl Receiver for LowPass {
    fn reported_m(&mut self, second: u32, true_m: f32) -> f32 {
        let (from, to) = self.between_s;
        let before = self.smoothed_m.unwrap_or(true_m);
        let part = if (from..to).contains(&second) {
            1.0 - (-1.0 / self.time_constant_s).exp()
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

/// A drive over a road, with errors of the force, N, and samples that `change` changes.
struct Drive<'a> {
    road_m: fn(f32) -> f32,
    force_noise_n: f32,
    change: &'a dyn Fn(u32, &mut Sample),
}

impl Default for Drive<'_> {
    fn default() -> Self {
        Self {
            road_m: hills_m,
            force_noise_n: 0.0,
            change: &|_, _| (),
        }
    }
}

impl Drive<'_> {
    /// Returns the errors of the altitude, m, and the counters.
    fn driven(&self, cells: u32, receiver: &mut dyn Receiver) -> (Vec<f32>, Counters) {
        let vehicle = truck();
        let weight_n = vehicle.mass_kg * 9.806_65;
        let air_n = 0.5 * vehicle.drag_area_m2 * 1.2 * SPEED_MPS * SPEED_MPS;
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
            let mut sample = sample(cell, force_n, SPEED_MPS);
            sample.mass_is_reported = true;
            sample.speed = speed(SPEED_MPS + 0.01 * noise.draw());
            if cell % SECOND == 0 {
                let true_m = road_m(cell) + 0.2 * noise.draw();
                sample.altitude = altitude(receiver.reported_m(cell / SECOND, true_m));
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
        between_s: (0, 1_000),
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
    let (_, before) = used(stop);
    // Fixes come every second, and the rate is that between two.
    let (_, waiting) = used(stop + SECOND);
    let (off_m, after) = used(stop + 20 * SECOND);
    assert_eq!(waiting, before);
    assert!((18..=20).contains(&(after - before)), "{before} {after}");
    assert!(off_m < 3.0, "{off_m}");
}

#[test]
fn a_delay_counts_once_it_explains_much_of_what_differs() {
    for (force_noise_n, cells, is_found) in [
        (0.0, 4_000, true),
        (2_250.0, 4_000, false),
        (2_250.0, 24_000, true),
    ] {
        let drive = Drive {
            force_noise_n,
            ..Drive::default()
        };
        let (_, counters) = drive.driven(cells, &mut Late(Vec::new(), 5));
        assert_eq!(
            counters.altitude_resets > 1,
            is_found,
            "{force_noise_n} N, {cells} cells: {} resets",
            counters.altitude_resets
        );
    }
}
