//! Where runs lie along the road: receivers that are late by a time that nobody knows, what an error
//! of the place does to a sigma, and altitudes of two datums.

use estimator_core::Tuning;
use host_sim::files::run::RunRow;
use host_sim::map::{Network, RoadLine};
use host_sim::simulator::truck::Preset;
use host_sim::study::alignment::campaign::{Campaign, CampaignRun, Stretch, Vehicle};
use std::path::Path;
use test_kit::roads::{Spot, drive, fuse, points, run, with_position_noise};

/// Returns a part of the measured profile of the E4, or of a generated road where that is missing.
fn stretch() -> Stretch {
    let measured = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/data/e4/road.csv");
    Stretch {
        road: measured.exists().then_some(measured),
        from_m: 20_000.0,
        length_m: 20_000.0,
    }
}

fn network(spots: &[Spot]) -> Network {
    RoadLine::new(points(spots)).unwrap().into()
}

#[test]
fn a_late_receiver_moves_no_map() {
    let campaign = Campaign::new(17, stretch()).unwrap();
    let driven = |gnss_late_ms: f64| {
        let vehicle = Vehicle {
            truck: Preset::A,
            runs: 3,
            gnss_late_ms: Some(gnss_late_ms),
        };
        campaign
            .drive(&[vehicle], &Tuning::default(), || ())
            .unwrap()
    };
    let score = |runs: &[CampaignRun]| {
        let map = campaign.map(&runs.iter().collect::<Vec<_>>());
        campaign.score(&map).unwrap()
    };
    // Of the assumed latency: nothing is learned.
    let prompt = driven(150.0);
    let expected = score(&prompt);
    for late_ms in [0.0, 400.0] {
        let late = driven(late_ms);
        for (late, prompt) in late.iter().zip(&prompt) {
            // The receivers' own errors are the same. Unlearned, runs are off by 3 and 5 m.
            let apart_m = campaign.misplaced_m(late).0 - campaign.misplaced_m(prompt).0;
            assert!(apart_m.abs() < 1.6, "{late_ms} ms late: {apart_m} m");
        }
        let found = score(&late);
        let ratio = found.rmse_percent / expected.rmse_percent;
        assert!(ratio < 1.08, "{late_ms} ms late: {ratio}");
        assert!((0.3..1.6).contains(&found.nees), "{late_ms}: {found:?}");
    }
}

#[test]
fn the_sigma_knows_what_an_error_of_the_place_costs() {
    let sigma_at = |grade_percent: fn(f64) -> f64, at_m: f64| {
        let spots = drive((0.0, 0.0), 6_000.0, |_| 40.0, grade_percent);
        let road = network(&spots);
        let rows = fuse(&road, &[&run(&spots)]).map.fused().rows();
        let row = rows.iter().find(|row| row.distance_m >= at_m);
        row.expect("covered").grade_sigma_percent
    };
    let wave: fn(f64) -> f64 = |s| 3.0 * (s / 300.0).sin();
    // 3 % within 300 m, and 1.5 and 0.4 m along the road, beside the run's own 0.1 %.
    let steepest = 0.1_f64.hypot(1.5_f64.hypot(0.4) * 3.0 / 300.0);
    let halfway = sigma_at(wave, 300.0 * std::f64::consts::TAU);
    assert!((halfway / steepest - 1.0).abs() < 2e-3, "{halfway}");
    let crest = sigma_at(wave, 300.0 * 2.5 * std::f64::consts::PI);
    assert!((crest / 0.1 - 1.0).abs() < 2e-3, "{crest}");
    let even = sigma_at(|_| 2.0, 3_000.0);
    assert!((even - 0.1).abs() < 1e-9, "{even}");
}

#[test]
fn runs_on_a_flat_road_stay_where_their_positions_are() {
    // Grades of pure noise must not move a run: nothing on a flat road says where it lies.
    let spots = drive(
        (0.0, 0.0),
        10_000.0,
        |s| 40.0 + 20.0 * (s / 900.0).sin(),
        |_| 0.0,
    );
    let road = network(&spots);
    let noisy = |seed: u64| -> Vec<RunRow> {
        let mut rows = run(&with_position_noise(&spots, 2.0, 80.0, seed));
        for (i, row) in rows.iter_mut().enumerate() {
            let phase = seed as f64 + i as f64 * 2.5 / 170.0;
            row.grade_percent = 0.1 * phase.sin() + 0.05 * (2.7 * phase).sin();
        }
        rows
    };
    let runs: Vec<Vec<RunRow>> = (1..=4).map(noisy).collect();
    let all: Vec<&[RunRow]> = runs.iter().map(Vec::as_slice).collect();
    let map = fuse(&road, &all).map.fused().rows();
    let mut largest = 0.0_f64;
    // At the ends not all of them have begun.
    let covered = map.iter().filter(|row| row.runs == 4);
    assert!(covered.clone().count() > 3_950);
    for row in covered {
        // The mean of what the runs say at this very place.
        let index = (row.distance_m / 2.5).round() as usize;
        let of_runs = all.iter().map(|rows| rows[index].grade_percent);
        let mean = of_runs.sum::<f64>() / all.len() as f64;
        largest = largest.max((row.grade_percent - mean).abs());
    }
    // Position noise of 2 m, smoothed, moves waves of 0.0014 % per metre.
    assert!(largest < 1e-2, "{largest}");
}

#[test]
fn altitudes_of_two_datums_join() {
    let spots = drive((0.0, 0.0), 6_000.0, |_| 40.0, |s| 2.0 * (s / 400.0).sin());
    let road = network(&spots);
    let whole = run(&spots);
    // The second run covers the middle, and counts from the ellipsoid.
    let mut part: Vec<RunRow> = whole[800..1_600].to_vec();
    for row in &mut part {
        row.altitude_m = row.altitude_m.map(|altitude_m| altitude_m + 30.0);
    }
    let map = fuse(&road, &[&whole, &part]).map.fused().rows();
    assert!(map.len() > 2_300);
    let mut steepest_m = 0.0_f64;
    for pair in map.windows(2) {
        let climb_m = pair[1].altitude_m.unwrap() - pair[0].altitude_m.unwrap();
        let by_grade_m = 0.025 * 0.5 * (pair[0].grade_percent + pair[1].grade_percent);
        steepest_m = steepest_m.max((climb_m - by_grade_m).abs());
    }
    assert!(steepest_m < 0.05, "{steepest_m}");
}
