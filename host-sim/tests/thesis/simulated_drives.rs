//! Simulated drives in the distance domain, and grade from the vehicle model alone.

use host_sim::comparison::{STEP_M, pointwise};
use host_sim::simulator::random::{Purpose, stream};
use host_sim::simulator::road_generator::{RoadShape, generate};
use host_sim::simulator::truck::Preset;
use host_sim::study::distance_drive::{Belief, DistanceDrive, Disturbances, simulate};

fn hills(length_m: f64) -> Vec<f64> {
    let shape = RoadShape {
        length_m,
        ..RoadShape::default()
    };
    let road = generate(&shape, 7);
    (0..(length_m / STEP_M) as usize)
        .map(|k| 100.0 * road.grade(k as f64 * STEP_M))
        .collect()
}

fn drive(preset: Preset, belief: &Belief, errors: &Disturbances<'_>) -> DistanceDrive {
    let mut rng = stream(3, 0, Purpose::Sensors);
    simulate(
        &hills(40_000.0),
        &preset.parameters(),
        belief,
        errors,
        &mut rng,
    )
    .unwrap()
}

/// Returns the pointwise less the true grade where the model is valid, %.
fn errors_percent(run: &DistanceDrive) -> Vec<f64> {
    pointwise::grade_percent(&run.drive)
        .iter()
        .zip(&run.true_grade_percent)
        .zip(&run.drive.points)
        .take(run.drive.points.len() - 1)
        .filter(|(_, point)| point.is_valid())
        .map(|((found, truth), _)| found - truth)
        .collect()
}

#[test]
fn without_disturbances_the_model_gives_the_road() {
    for preset in [Preset::A, Preset::B] {
        let run = drive(preset, &Belief::TRUTH, &Disturbances::default());
        let worst = errors_percent(&run)
            .into_iter()
            .map(f64::abs)
            .fold(0.0, f64::max);
        assert!(worst < 1e-6, "{preset:?}: {worst} %");
    }
}

#[test]
fn the_heavy_truck_shifts_and_brakes_and_the_light_one_keeps_its_gear() {
    let heavy = drive(Preset::A, &Belief::TRUTH, &Disturbances::default())
        .drive
        .points;
    let light = drive(Preset::B, &Belief::TRUTH, &Disturbances::default())
        .drive
        .points;
    assert!(heavy.iter().any(|point| point.shifting));
    assert!(heavy.iter().any(|point| point.braking));
    assert!(!light.iter().any(|point| point.shifting));
    // About a second each, so tens of metres.
    let shifts = heavy
        .windows(2)
        .filter(|p| !p[0].shifting && p[1].shifting)
        .count();
    let driven_m = STEP_M * heavy.iter().filter(|p| p.shifting).count() as f64;
    let mean_m = driven_m / shifts as f64;
    assert!(
        (10.0..30.0).contains(&mean_m),
        "{mean_m} m over {shifts} shifts"
    );
    for point in heavy.iter().chain(&light) {
        let kmh = 3.6 * point.speed_mps;
        assert!(
            (25.0..90.0).contains(&kmh),
            "{kmh} km/h at {} m",
            point.distance_m
        );
        assert!(!point.braking || kmh > 84.5, "{kmh} km/h");
    }
    let steady = light
        .iter()
        .filter(|p| (p.speed_mps * 3.6 - 80.0).abs() < 2.0)
        .count();
    assert!(steady > light.len() * 3 / 4, "{steady} of {}", light.len());
}

#[test]
fn during_shifts_and_braking_the_model_is_wrong() {
    let run = drive(Preset::A, &Belief::TRUTH, &Disturbances::default());
    let grade = pointwise::grade_percent(&run.drive);
    let mean = |wanted: fn(&host_sim::comparison::MeasuredPoint) -> bool| {
        let errors: Vec<f64> = (0..grade.len() - 1)
            .filter(|&k| wanted(&run.drive.points[k]))
            .map(|k| grade[k] - run.true_grade_percent[k])
            .collect();
        errors.iter().sum::<f64>() / errors.len() as f64
    };
    assert!(mean(|p| p.shifting) > 0.5);
    // 0.5 m/s² of g.
    assert!((mean(|p| p.braking) - 5.1).abs() < 0.2);
}

#[test]
fn a_model_error_is_read_as_grade() {
    let model = vec![-0.3; 16_000];
    let errors = Disturbances {
        model_percent: &model,
        ..Disturbances::default()
    };
    for error in errors_percent(&drive(Preset::B, &Belief::TRUTH, &errors)) {
        assert!((error + 0.3).abs() < 1e-3, "{error}");
    }
}

#[test]
fn noise_on_speed_gives_the_pointwise_width_of_the_thesis() {
    for (preset, speed_mps, width) in [(Preset::A, 0.013, 1.65), (Preset::B, 0.009, 1.17)] {
        let errors = Disturbances {
            speed_mps,
            ..Disturbances::default()
        };
        let found = errors_percent(&drive(preset, &Belief::TRUTH, &errors));
        let rms = (found.iter().map(|e| e * e).sum::<f64>() / found.len() as f64).sqrt();
        assert!((rms / width - 1.0).abs() < 0.05, "{preset:?}: {rms} %");
        let mean = found.iter().sum::<f64>() / found.len() as f64;
        assert!(mean.abs() < 0.02, "{preset:?}: {mean} %");
    }
}

#[test]
fn a_false_torque_follows_the_grade_and_altitude_is_the_road_plus_the_error() {
    let gps = vec![4.0; 100];
    let belief = Belief {
        torque: 1.1,
        ..Belief::TRUTH
    };
    let errors = Disturbances {
        gps_m: &gps,
        ..Disturbances::default()
    };
    let run = drive(Preset::B, &belief, &errors);
    let truth = drive(Preset::B, &Belief::TRUTH, &errors);
    for (reported, real) in run.drive.points.iter().zip(&truth.drive.points) {
        assert!((reported.traction_n - 1.1 * real.traction_n).abs() < 1e-6);
    }
    let mut altitude_m = 4.0;
    for (k, point) in run.drive.points.iter().enumerate() {
        assert_eq!(point.altitude_m.is_some(), k < 100);
        if let Some(reported) = point.altitude_m {
            assert!((reported - altitude_m).abs() < 1e-9);
        }
        let grade = run.true_grade_percent[k];
        altitude_m += STEP_M * grade / grade.hypot(100.0);
    }
}

#[test]
fn the_same_stream_gives_the_same_drive() {
    let errors = Disturbances {
        speed_mps: 0.013,
        ..Disturbances::default()
    };
    let [a, b] = [0, 1].map(|_| drive(Preset::A, &Belief::TRUTH, &errors).drive.points);
    assert!(a == b);
}
