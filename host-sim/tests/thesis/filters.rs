//! The original filter, the modified method and the robust line.

use host_sim::comparison::modified::{self, Modified};
use host_sim::comparison::original::{self, NoiseSigmas};
use host_sim::comparison::{Profile, STEP_M, pointwise};
use host_sim::numeric::robust_line;
use host_sim::simulator::random::{Purpose, normal, stream};
use host_sim::simulator::road_generator::{RoadShape, generate};
use host_sim::simulator::truck::Preset;
use host_sim::study::distance_drive::{Belief, DistanceDrive, Disturbances, simulate};

/// Cells left out at either end, as in the thesis.
const EDGE: usize = 200;

fn hills(seed: u64) -> Vec<f64> {
    let road = generate(&RoadShape::default(), seed);
    (0..16_000)
        .map(|k| 100.0 * road.grade(f64::from(k) * STEP_M))
        .collect()
}

fn drive(preset: Preset, seed: u64, belief: &Belief, errors: &Disturbances<'_>) -> DistanceDrive {
    let mut rng = stream(seed, 0, Purpose::Sensors);
    simulate(&hills(seed), &preset.parameters(), belief, errors, &mut rng).unwrap()
}

fn white(sigma: f64, seed: u64) -> Vec<f64> {
    let mut rng = stream(seed, 0, Purpose::Gnss);
    (0..16_000).map(|_| sigma * normal(&mut rng)).collect()
}

fn rmse(run: &DistanceDrive, grade_percent: &[f64]) -> f64 {
    let cells = EDGE..grade_percent.len() - EDGE;
    let squares: Vec<f64> = cells
        .filter(|&k| run.drive.points[k].is_valid())
        .map(|k| (grade_percent[k] - run.true_grade_percent[k]).powi(2))
        .collect();
    (squares.iter().sum::<f64>() / squares.len() as f64).sqrt()
}

#[test]
fn the_filter_follows_data_without_noise() {
    let gps = vec![0.0; 16_000];
    let errors = Disturbances {
        gps_m: &gps,
        ..Disturbances::default()
    };
    let run = drive(Preset::B, 1, &Belief::TRUTH, &errors);
    let exact = NoiseSigmas {
        speed_mps: 1e-3,
        model_percent: 0.05,
        ..NoiseSigmas::ORIGINAL
    };
    let found = original::estimate(&run.drive, &exact);
    assert!(
        rmse(&run, &found.grade_percent) < 0.005,
        "{}",
        rmse(&run, &found.grade_percent)
    );
}

#[test]
fn smoothing_beats_filtering() {
    let gps = white(1.5, 2);
    let errors = Disturbances {
        gps_m: &gps,
        speed_mps: 0.013,
        ..Disturbances::default()
    };
    let run = drive(Preset::A, 2, &Belief::TRUTH, &errors);
    let smoothed = rmse(
        &run,
        &original::estimate(&run.drive, &NoiseSigmas::ORIGINAL).grade_percent,
    );
    let filtered = rmse(
        &run,
        &original::filtered(&run.drive, &NoiseSigmas::ORIGINAL).grade_percent,
    );
    assert!(
        smoothed < 0.8 * filtered,
        "{smoothed} % against {filtered} %"
    );
}

#[test]
fn on_its_own_model_the_filter_knows_its_error() {
    // The road is a random walk in grade and the errors are white, as in Q and R.
    let noise = NoiseSigmas {
        altitude_m: 1.5,
        model_percent: 0.5,
        climb_m: 1e-3,
        grade_percent: 0.03,
        ..NoiseSigmas::ORIGINAL
    };
    let (mut squares, mut count) = (0.0, 0);
    for seed in 0..6 {
        let mut rng = stream(seed, 1, Purpose::Road);
        let mut grade = 0.0;
        let road: Vec<f64> = (0..8_000)
            .map(|_| {
                grade += noise.grade_percent * normal(&mut rng);
                grade
            })
            .collect();
        let gps = white(noise.altitude_m, seed);
        let model = white(noise.model_percent, seed + 100);
        let errors = Disturbances {
            speed_mps: noise.speed_mps,
            gps_m: &gps,
            model_percent: &model,
        };
        let truck = Preset::B.parameters();
        let run = simulate(&road, &truck, &Belief::TRUTH, &errors, &mut rng).unwrap();
        let Profile {
            grade_percent,
            sigma_percent,
        } = original::estimate(&run.drive, &noise);
        for k in EDGE..road.len() - EDGE {
            if run.drive.points[k].is_valid() {
                squares += ((grade_percent[k] - road[k]) / sigma_percent[k]).powi(2);
                count += 1;
            }
        }
    }
    let mean = squares / f64::from(count);
    assert!(
        (0.8..1.25).contains(&mean),
        "normalised squared error {mean}"
    );
}

#[test]
fn without_satellites_the_filter_goes_on_and_is_less_sure() {
    let gps = white(1.5, 4);
    let all = Disturbances {
        gps_m: &gps,
        speed_mps: 0.009,
        ..Disturbances::default()
    };
    let half = Disturbances {
        gps_m: &gps[..8_000],
        ..all
    };
    let [all, half] = [all, half].map(|errors| {
        let run = drive(Preset::B, 4, &Belief::TRUTH, &errors);
        original::estimate(&run.drive, &NoiseSigmas::ORIGINAL)
    });
    let [with, without] = [all.sigma_percent[14_000], half.sigma_percent[14_000]];
    assert!(without > 1.05 * with, "{without} % against {with} %");
    assert!((half.sigma_percent[2_000] / all.sigma_percent[2_000] - 1.0).abs() < 1e-3);
    assert!(half.grade_percent.iter().all(|g| g.is_finite()));
}

fn modified(run: &DistanceDrive) -> Modified {
    modified::estimate(&run.drive)
}

/// Returns the share of a constant model error that the GPS-heavy filter keeps in its grade
/// (`tuning`).
fn share_left() -> f64 {
    let climb_percent = 100.0 * NoiseSigmas::GPS_HEAVY.climb_m / STEP_M;
    climb_percent.powi(2) / (climb_percent.powi(2) + NoiseSigmas::GPS_HEAVY.model_percent.powi(2))
}

#[test]
fn the_mass_correction_finds_a_planted_error() {
    // A false mass alone: with the assumed mass m/(1+k), α_p − α = k·(α + cr + acceleration/g)
    // and drag, so the slope on α is k, and m(1+k) is the truth.
    for k in [0.2, 0.1, -0.08, -0.15] {
        let gps = vec![0.0; 16_000];
        let errors = Disturbances {
            gps_m: &gps,
            ..Disturbances::default()
        };
        let belief = Belief {
            mass: 1.0 / (1.0 + k),
            ..Belief::TRUTH
        };
        let run = drive(Preset::B, 5, &belief, &errors);
        let found = modified(&run);
        let slope = found.mass_line.unwrap().slope;
        assert!(found.mass_corrected);
        // α_G itself keeps a share of the error.
        let expected = k * (1.0 - share_left()) / (1.0 + k * share_left());
        assert!(
            (slope - expected).abs() < 0.02,
            "planted {k}, expected {expected}, found {slope}"
        );
    }
}

#[test]
fn noise_in_the_gps_grade_pulls_the_slope_down_as_known() {
    // e = α_p − α_G against α_G = α + n: slope −σ_G²/(σ_α² + σ_G²) where the model is perfect.
    let (sigma_road, sigma_gps) = (1.2, 0.6);
    let mut rng = stream(9, 0, Purpose::Road);
    let line = robust_line::fit((0..50_000).map(|_| {
        let road = sigma_road * normal(&mut rng);
        let gps = road + sigma_gps * normal(&mut rng);
        (gps, road - gps)
    }))
    .unwrap();
    let known = -sigma_gps * sigma_gps / (sigma_road * sigma_road + sigma_gps * sigma_gps);
    assert!(
        (line.slope - known).abs() < 5.0 * line.slope_sigma,
        "{line:?}, known {known}"
    );
    assert!(line.slope_sigma < 0.01);
}

#[test]
fn the_method_itself_shows_that_bias() {
    // A random walk of altitude gives each segment's α_G an error of its own, far above all else.
    let mut slopes = Vec::new();
    let (mut road_squares, mut gps_squares, mut count) = (0.0, 0.0, 0.0);
    for seed in 20..60 {
        let mut rng = stream(seed, 2, Purpose::Gnss);
        let mut error_m = 0.0;
        let gps: Vec<f64> = (0..16_000)
            .map(|_| {
                error_m += 0.4 * normal(&mut rng);
                error_m
            })
            .collect();
        let errors = Disturbances {
            gps_m: &gps,
            ..Disturbances::default()
        };
        let run = drive(Preset::B, seed, &Belief::TRUTH, &errors);
        slopes.push(modified(&run).mass_line.unwrap().slope);
        let gps_heavy = original::estimate(&run.drive, &NoiseSigmas::GPS_HEAVY).grade_percent;
        for segment in 0..13 {
            let cells = segment * 1_200..(segment + 1) * 1_200;
            let mean = |values: &[f64]| values[cells.clone()].iter().sum::<f64>() / 1_200.0;
            let road = mean(&run.true_grade_percent);
            road_squares += road * road;
            gps_squares += (mean(&gps_heavy) - road).powi(2);
            count += 1.0;
        }
    }
    let known = -gps_squares / (road_squares + gps_squares);
    let mean = slopes.iter().sum::<f64>() / slopes.len() as f64;
    let spread = slopes.iter().map(|s| (s - mean).powi(2)).sum::<f64>() / slopes.len() as f64;
    let sigma = (spread / slopes.len() as f64).sqrt();
    assert!(count > 0.0 && known < -0.1, "{known}");
    assert!(mean < -5.0 * sigma, "{mean} ± {sigma}");
    assert!(
        (mean - known).abs() < 4.0 * sigma + 0.25 * known.abs(),
        "{mean} ± {sigma}, known {known}"
    );
}

#[test]
fn an_insignificant_slope_leaves_the_mass_alone() {
    let mut left_alone = 0;
    for seed in 60..80 {
        let gps = vec![0.0; 16_000];
        // Wind: a slow error that does not depend on grade.
        let mut rng = stream(seed, 3, Purpose::Gnss);
        let mut value = 0.0;
        let model: Vec<f64> = (0..16_000)
            .map(|_| {
                value = 0.999 * value + 0.01 * normal(&mut rng);
                value
            })
            .collect();
        let errors = Disturbances {
            gps_m: &gps,
            model_percent: &model,
            ..Disturbances::default()
        };
        let found = modified(&drive(Preset::B, seed, &Belief::TRUTH, &errors));
        let line = found.mass_line.unwrap();
        assert_eq!(
            found.mass_corrected,
            line.slope.abs() > 2.0 * line.slope_sigma
        );
        left_alone += usize::from(!found.mass_corrected);
    }
    assert!(left_alone >= 15, "{left_alone} of 20");
}

#[test]
fn the_bias_line_finds_a_planted_drift() {
    let gps = vec![0.0; 16_000];
    let model: Vec<f64> = (0..16_000)
        .map(|k| 0.4 - 1.5e-5 * f64::from(k) * STEP_M)
        .collect();
    let errors = Disturbances {
        gps_m: &gps,
        model_percent: &model,
        ..Disturbances::default()
    };
    let run = drive(Preset::B, 6, &Belief::TRUTH, &errors);
    let found = modified(&run);
    let line = found.bias_line.unwrap();
    let found_part = 1.0 - share_left();
    assert!(
        (line.slope / (-1.5e-5 * found_part) - 1.0).abs() < 0.03,
        "{line:?}"
    );
    assert!(
        (line.offset / (0.4 * found_part) - 1.0).abs() < 0.03,
        "{line:?}"
    );
    let original = original::estimate(&run.drive, &NoiseSigmas::ORIGINAL).grade_percent;
    assert!(rmse(&run, &found.profile.grade_percent) < 0.7 * rmse(&run, &original));
}

#[test]
fn smooth_speed_takes_the_noise_out_of_pointwise_grade() {
    let errors = Disturbances {
        speed_mps: 0.013,
        ..Disturbances::default()
    };
    let run = drive(Preset::A, 7, &Belief::TRUTH, &errors);
    let raw = rmse(&run, &pointwise::grade_percent(&run.drive));
    let smooth = pointwise::with_smooth_speed(&run.drive, 100.0);
    let low_pass = rmse(&run, &pointwise::grade_percent(&smooth));
    assert!(low_pass < 0.2 * raw, "{low_pass} % of {raw} %");
}

#[test]
fn outliers_do_not_turn_a_line() {
    let mut rng = stream(10, 0, Purpose::Sensors);
    let points: Vec<(f64, f64)> = (0..300)
        .map(|k| {
            let x = f64::from(k) / 100.0;
            let outlier = if k % 10 < 3 { 5.0 + x } else { 0.0 };
            (x, 0.7 * x - 0.2 + 0.05 * normal(&mut rng) + outlier)
        })
        .collect();
    let line = robust_line::fit(points.iter().copied()).unwrap();
    assert!(
        (line.slope - 0.7).abs() < 4.0 * line.slope_sigma,
        "{line:?}"
    );
    assert!((line.offset + 0.2).abs() < 0.03, "{line:?}");
    assert!(line.slope_sigma < 0.01, "{line:?}");
}

#[test]
fn a_line_needs_points_at_more_than_one_place() {
    assert!(robust_line::fit([]).is_none());
    assert!(robust_line::fit([(0.0, 1.0), (1.0, 2.0), (2.0, 3.0)]).is_none());
    assert!(robust_line::fit([(1.0, 1.0), (1.0, 2.0), (1.0, 3.0), (1.0, 4.0)]).is_none());
    let exact = robust_line::fit((0..5).map(|k| (f64::from(k), 3.0 * f64::from(k) - 1.0))).unwrap();
    assert!(
        (exact.slope - 3.0).abs() < 1e-9 && exact.slope_sigma < 1e-6,
        "{exact:?}"
    );
}

#[test]
fn no_points_no_estimate() {
    let mut run = drive(Preset::B, 1, &Belief::TRUTH, &Disturbances::default());
    run.drive.points.clear();
    assert!(
        original::estimate(&run.drive, &NoiseSigmas::ORIGINAL)
            .grade_percent
            .is_empty()
    );
    assert!(pointwise::grade_percent(&run.drive).is_empty());
    assert!(
        pointwise::with_smooth_speed(&run.drive, 100.0)
            .points
            .is_empty()
    );
    assert!(modified(&run).mass_line.is_none());
}
