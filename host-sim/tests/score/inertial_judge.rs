//! The accelerometer as a judge, on drives made by hand.

use host_sim::inertial_judge::{InertialProfile, windows};

const GRAVITY_MPS2: f64 = 9.806_65;

/// A drive at 50 Hz on a constant slope: speed by `speed_mps`, acceleration as a sensor reads it.
struct Drive {
    times_s: Vec<f64>,
    speeds_mps: Vec<f64>,
    accelerations_mps2: Vec<f64>,
}

/// Speed that changes between 10 and 20 m/s, and its derivative.
fn wave(time_s: f64) -> (f64, f64) {
    let omega = 0.3;
    let (sine, cosine) = (omega * time_s).sin_cos();
    (15.0 + 5.0 * sine, 5.0 * omega * cosine)
}

fn drive(grade_percent: f64, offset_mps2: f64, speed: impl Fn(f64) -> (f64, f64)) -> Drive {
    let sine = (grade_percent / 100.0).atan().sin();
    let times_s: Vec<f64> = (0..10_000).map(|k| f64::from(k) * 0.02).collect();
    Drive {
        speeds_mps: times_s.iter().map(|t| speed(*t).0).collect(),
        accelerations_mps2: times_s
            .iter()
            .map(|t| speed(*t).1 + GRAVITY_MPS2 * sine + offset_mps2)
            .collect(),
        times_s,
    }
}

#[test]
fn grade_is_a_tangent_free_of_the_vehicles_own_acceleration() {
    let drive = drive(12.0, 0.0, wave);
    let found = windows(
        &drive.times_s,
        &drive.speeds_mps,
        &drive.accelerations_mps2,
        100.0,
    );
    assert!(found.len() > 25, "{}", found.len());
    for window in &found {
        assert!((window.grade_percent - 12.0).abs() < 0.01, "{window:?}");
        assert!((window.to_m - window.from_m - 100.0).abs() < 1e-6);
        assert!((0.1..0.5).contains(&window.sigma_percent), "{window:?}");
    }
}

#[test]
fn an_offset_is_a_constant_grade() {
    let drive = drive(0.0, 0.1, wave);
    let found = windows(
        &drive.times_s,
        &drive.speeds_mps,
        &drive.accelerations_mps2,
        300.0,
    );
    assert!(!found.is_empty());
    for window in &found {
        let expected = 100.0 * 0.1 / GRAVITY_MPS2;
        assert!((window.grade_percent - expected).abs() < 0.01, "{window:?}");
    }
}

#[test]
fn standstill_adds_nothing() {
    // The sensor's offset while it stands is another one, as on the slope of a car park.
    let mut stopped = drive(3.0, 0.0, |t| (10.0, 0.0 * t));
    for k in 4_000..6_000 {
        let phase = (k - 4_000) as f64 / 2_000.0 * std::f64::consts::TAU;
        // Down to 0 and up again.
        stopped.speeds_mps[k] = (10.0 * phase.cos()).max(0.0);
        stopped.accelerations_mps2[k] = if stopped.speeds_mps[k] > 0.0 {
            let rate = std::f64::consts::TAU / 40.0;
            GRAVITY_MPS2 * 0.03_f64.atan().sin() - 10.0 * rate * phase.sin()
        } else {
            2.0
        };
    }
    let found = windows(
        &stopped.times_s,
        &stopped.speeds_mps,
        &stopped.accelerations_mps2,
        100.0,
    );
    assert!(found.len() > 10);
    for window in found {
        assert!((window.grade_percent - 3.0).abs() < 0.05, "{window:?}");
    }
}

#[test]
fn what_is_missing_breaks_windows_and_nothing_else() {
    let mut drive = drive(2.0, 0.0, wave);
    // 40 s, about 600 m: windows that lie within the break are none, either.
    for k in 5_000..7_000 {
        drive.accelerations_mps2[k] = f64::NAN;
    }
    let all = windows(
        &drive.times_s,
        &drive.speeds_mps,
        &drive.accelerations_mps2,
        100.0,
    );
    assert!(all.iter().all(|w| (w.grade_percent - 2.0).abs() < 0.01));
    let apart: Vec<f64> = all
        .windows(2)
        .map(|pair| pair[1].from_m - pair[0].to_m)
        .filter(|apart_m| *apart_m > 1.0)
        .collect();
    assert_eq!(apart.len(), 1);
    assert!((500.0..800.0).contains(&apart[0]), "{apart:?}");
}

#[test]
fn nothing_comes_from_nothing() {
    assert!(windows(&[], &[], &[], 100.0).is_empty());
    assert!(windows(&[0.0, 1.0], &[10.0, 10.0], &[0.0, 0.0], 0.0).is_empty());
    assert!(windows(&[0.0, 1.0], &[10.0, 10.0], &[0.0, 0.0], f64::NAN).is_empty());
    let backwards = InertialProfile::new(&[1.0, 0.5, 2.0], &[1.0; 3], &[0.0; 3]);
    assert_eq!(backwards.points().len(), 2);
}
