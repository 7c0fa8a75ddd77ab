//! Convergence of maps (figures 10 and 11).

use host_sim::study::convergence::curve::{PowerLaw, floor_percent};
use host_sim::study::convergence::{Conditions, Extent, POINTWISE_SIGMA_PERCENT, Set};
use std::sync::atomic::{AtomicUsize, Ordering};

/// 10 km of hills.
fn hills() -> Vec<f64> {
    (0..4_000)
        .map(|k| 1.5 * (f64::from(k) * 2.5 / 200.0).sin())
        .collect()
}

fn converge(threads: usize, seed: u64, extent: Extent) -> Vec<Set> {
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .unwrap();
    let conditions = Conditions::calibrated(hills(), seed);
    pool.install(|| conditions.converge(extent, || ()))
}

#[test]
fn one_thread_and_two_give_the_same_bits() {
    let extent = Extent { sets: 4, runs: 3 };
    let bits = |sets: Vec<Set>| -> Vec<u64> {
        sets.iter()
            .flat_map(|set| set.rmse_percent.iter().chain(&set.pointwise_sigma_percent))
            .map(|value| value.to_bits())
            .collect()
    };
    let one = bits(converge(1, 5, extent));
    assert_eq!(one.len(), 24);
    assert_eq!(one, bits(converge(2, 5, extent)));
    assert_ne!(one, bits(converge(2, 6, extent)));
}

#[test]
fn every_run_differs_and_each_is_reported() {
    let done = AtomicUsize::new(0);
    let conditions = Conditions::calibrated(hills(), 5);
    let sets = conditions.converge(Extent { sets: 3, runs: 2 }, || {
        done.fetch_add(1, Ordering::Relaxed);
    });
    assert_eq!(done.into_inner(), 6);
    let mut widths: Vec<f64> = sets
        .iter()
        .flat_map(|set| set.pointwise_sigma_percent.clone())
        .collect();
    widths.sort_by(f64::total_cmp);
    widths.dedup();
    assert_eq!(widths.len(), 6);
}

#[test]
fn the_pointwise_error_is_as_wide_as_the_thesis_measured() {
    let sets = converge(2, 5, Extent { sets: 4, runs: 5 });
    let widths: Vec<f64> = sets
        .into_iter()
        .flat_map(|set| set.pointwise_sigma_percent)
        .collect();
    let mean = widths.iter().sum::<f64>() / widths.len() as f64;
    // False masses widen one run and narrow another.
    assert!(
        (mean / POINTWISE_SIGMA_PERCENT - 1.0).abs() < 0.08,
        "{mean}"
    );
}

#[test]
fn a_map_of_many_runs_is_better_than_one_run_but_not_than_the_filter() {
    let conditions = Conditions::calibrated(hills(), 5);
    let sets = conditions.converge(Extent { sets: 4, runs: 12 }, || ());
    let mean = |n: usize| sets.iter().map(|set| set.rmse_percent[n]).sum::<f64>() / 4.0;
    assert!(mean(11) < 0.8 * mean(0), "{} after {}", mean(11), mean(0));
    assert!(mean(11) > conditions.undisturbed_rmse());
}

#[test]
fn a_planted_exponent_is_found() {
    let curve: Vec<f64> = (1..=10).map(|n| 0.3 * f64::from(n).powf(-0.42)).collect();
    let law = PowerLaw::fit(&curve);
    assert!((law.exponent - 0.42).abs() < 1e-12, "{law:?}");
    assert!((law.first_percent - 0.3).abs() < 1e-12, "{law:?}");
    assert!((law.at(7) - curve[6]).abs() < 1e-12, "{law:?}");
}

#[test]
fn a_planted_floor_is_found_under_what_the_runs_do_not_share() {
    let curve: Vec<f64> = (1..=40)
        .map(|n| (0.06_f64.powi(2) + 0.3_f64.powi(2) / f64::from(n)).sqrt())
        .collect();
    assert!((floor_percent(&curve, 10) - 0.06).abs() < 1e-9);
    // Without common errors there is no floor. A curve below zero is cut at zero.
    let free: Vec<f64> = (1..=40).map(|n| 0.3 / f64::from(n).sqrt()).collect();
    assert!(floor_percent(&free, 10) < 1e-6);
    let faster: Vec<f64> = (1..=40).map(|n| 0.3 / f64::from(n)).collect();
    assert_eq!(floor_percent(&faster, 10), 0.0);
}
