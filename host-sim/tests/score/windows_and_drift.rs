//! Scores of a pass: errors over windows, and the drift of the vehicle model alone.

use estimator_core::{Traction, VehicleParameters};
use host_sim::study::drift::{ForceSample, vehicle_model_drift};
use host_sim::study::windows::{GradeProfile, window_errors};

fn profile(grade_percent: impl Fn(f64) -> f64) -> GradeProfile {
    GradeProfile::new((0..=1200).map(|i| {
        let at_m = 2.5 * f64::from(i);
        (at_m, grade_percent(at_m))
    }))
}

#[test]
fn a_constant_offset_is_bias_and_rmse() {
    let estimate = profile(|at_m| (at_m / 300.0).sin() + 0.25);
    let reference = profile(|at_m| (at_m / 300.0).sin());
    let errors = window_errors(&estimate, &reference, 600.0).unwrap();
    assert_eq!(errors.windows, 5);
    assert!((errors.bias_percent - 0.25).abs() < 1e-9, "{errors:?}");
    assert!((errors.rmse_percent - 0.25).abs() < 1e-9, "{errors:?}");
}

#[test]
fn errors_within_a_window_average_out_and_errors_of_windows_do_not() {
    let flat = profile(|_| 0.0);
    let fast = profile(|at_m| (at_m * std::f64::consts::TAU / 100.0).sin());
    let errors = window_errors(&fast, &flat, 600.0).unwrap();
    assert!(errors.rmse_percent < 1e-3, "{errors:?}");
    // Alternating by window: no bias, but an error.
    let slow = profile(|at_m| {
        if ((at_m / 600.0) as u32).is_multiple_of(2) {
            0.5
        } else {
            -0.5
        }
    });
    let errors = window_errors(&slow, &flat, 600.0).unwrap();
    assert!((errors.rmse_percent - 0.5).abs() < 0.01, "{errors:?}");
    assert!((errors.bias_percent - 0.1).abs() < 0.01, "{errors:?}");
}

#[test]
fn only_the_common_road_counts() {
    let reference = GradeProfile::new([(1000.0, 1.0), (2300.0, 1.0)]);
    let estimate = profile(|at_m| if at_m < 990.0 { 99.0 } else { 1.5 });
    let errors = window_errors(&estimate, &reference, 600.0).unwrap();
    assert_eq!(errors.windows, 2);
    assert!((errors.bias_percent - 0.5).abs() < 1e-9, "{errors:?}");
    let short = GradeProfile::new([(1000.0, 1.0), (1500.0, 1.0)]);
    assert_eq!(window_errors(&estimate, &short, 600.0), None);
    assert_eq!(
        window_errors(&estimate, &GradeProfile::default(), 600.0),
        None
    );
}

#[test]
fn altitudes_become_grades_and_stray_points_are_left_out() {
    let points = [
        (0.0, 100.0),
        (100.0, 102.0),
        (50.0, 999.0),
        (150.0, f64::NAN),
        (200.0, 104.0),
        (300.0, 106.0),
    ];
    let profile = GradeProfile::from_altitudes(points, 200.0);
    for at_m in [0.0, 60.0, 100.0, 250.0, 300.0] {
        let grade_percent = profile.grade_percent(at_m).unwrap();
        assert!(
            (grade_percent - 2.0).abs() < 1e-9,
            "{at_m}: {grade_percent}"
        );
    }
    assert_eq!(profile.grade_percent(300.1), None);
    assert_eq!(profile.grade_percent(-0.1), None);
}

fn bus() -> VehicleParameters {
    VehicleParameters {
        mass_kg: 19_000.0,
        drag_area_m2: 5.2,
        rolling_resistance: 0.008,
        wheel_radius_m: 0.48,
        wheel_inertia_kgm2: 100.0,
        traction: Traction::Force,
    }
}

/// Simulates a drive with stops over hills, by the textbook force balance. Returns the samples and
/// the altitude gained by the same integral.
fn drive(rolling_resistance: f64) -> (Vec<ForceSample>, f64) {
    let (mass_kg, step_s) = (21_000.0, 0.1);
    let accelerated_kg = mass_kg + 100.0 / 0.48_f64.powi(2);
    let speed_mps = |time_s: f64| 5.0 * (1.0 - (time_s * std::f64::consts::TAU / 60.0).cos());
    let mut driven_m = 0.0;
    let mut climb_m = 0.0;
    let samples = (0..6000)
        .map(|i| {
            let time_s = f64::from(i) * step_s;
            let v = speed_mps(time_s);
            let a = (speed_mps(time_s + 1e-4) - speed_mps(time_s - 1e-4)) / 2e-4;
            let slope = 0.05 * (driven_m / 400.0_f64).sin() + 0.01;
            driven_m += v * step_s;
            climb_m += slope * v * step_s;
            ForceSample {
                time_s,
                speed_mps: v,
                traction_force_n: accelerated_kg * a
                    + 0.5 * 1.2 * 5.2 * v * v
                    + mass_kg * 9.80665 * (rolling_resistance + slope),
                mass_kg: Some(mass_kg),
                ambient_celsius: None,
                air_pressure_pa: None,
            }
        })
        .collect();
    (samples, climb_m)
}

#[test]
fn a_right_model_does_not_drift() {
    let (samples, climb_m) = drive(0.008);
    let drift = vehicle_model_drift(&samples, &bus(), climb_m).unwrap();
    assert!((drift.length_m - 3000.0).abs() < 5.0, "{drift:?}");
    assert!(drift.modelled_climb_m.abs() > 20.0, "{drift:?}");
    assert!(drift.drift_m_per_km.abs() < 0.02, "{drift:?}");
}

#[test]
fn missing_rolling_resistance_is_read_as_climb() {
    let (samples, climb_m) = drive(0.012);
    let drift = vehicle_model_drift(&samples, &bus(), climb_m).unwrap();
    assert!((drift.drift_m_per_km - 4.0).abs() < 0.02, "{drift:?}");
    assert!((drift.grade_error_percent - 0.4).abs() < 0.002, "{drift:?}");
}

#[test]
fn a_vehicle_that_stands_has_no_drift() {
    let (mut samples, _) = drive(0.008);
    for sample in &mut samples {
        sample.speed_mps = 0.0;
    }
    assert_eq!(vehicle_model_drift(&samples, &bus(), 0.0), None);
    assert_eq!(vehicle_model_drift(&[], &bus(), 0.0), None);
}
