//! The Markov chain of GNSS altitude errors.

use host_sim::comparison::markov::{
    CENTRE, Chain, LOW_PASS_M, STATES, centred, error_of, state_of,
};
use host_sim::comparison::moving_mean;
use host_sim::study::gps;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use std::path::Path;

fn rng(seed: u64) -> ChaCha8Rng {
    ChaCha8Rng::seed_from_u64(seed)
}

#[test]
fn errors_are_rounded_into_half_metres_and_saturate() {
    for (error_m, state) in [
        (0.0, 30),
        (0.24, 30),
        (0.26, 31),
        (-0.26, 29),
        (14.9, 60),
        (15.0, 60),
        (99.0, 60),
        (-15.0, 0),
        (-1e9, 0),
    ] {
        assert_eq!(state_of(error_m), state, "{error_m} m");
    }
    for state in 0..STATES {
        assert_eq!(state_of(error_of(state)), state);
    }
    assert_eq!((error_of(0), error_of(STATES - 1)), (-15.0, 15.0));
}

#[test]
fn transitions_are_counted_within_each_run_less_its_mean() {
    // Means 101 and -50: both runs become -1, 0, 1, and nothing leads from one to the other.
    let chain = Chain::train(&[vec![100.0, 101.0, 102.0], vec![-51.0, -50.0, -49.0]]);
    assert_eq!(chain.visits(state_of(-1.0)), 2);
    assert_eq!(chain.visits(state_of(0.0)), 2);
    assert_eq!(chain.visits(state_of(1.0)), 0);
    assert_eq!(chain.probability(state_of(-1.0), state_of(0.0)), 1.0);
    assert_eq!(chain.probability(state_of(0.0), state_of(1.0)), 1.0);
}

/// The counts of the rows differ, so that a normalisation over columns would not give
/// probabilities.
#[test]
fn rows_add_up_to_one_and_not_columns() {
    let chain = Chain::of_states([vec![30, 31, 30, 30, 30, 29, 30, 31, 31]]);
    for from in 0..STATES {
        let row: f64 = (0..STATES).map(|to| chain.probability(from, to)).sum();
        assert!((row - 1.0).abs() < 1e-12, "row {from}: {row}");
    }
    assert_eq!(chain.probability(30, 31), 0.4);
    assert_eq!(chain.probability(30, 30), 0.4);
    assert_eq!(chain.probability(31, 30), 0.5);
}

#[test]
fn a_state_without_data_goes_one_step_towards_no_error() {
    let chain = Chain::of_states([vec![CENTRE, CENTRE + 5]]);
    assert_eq!(chain.probability(CENTRE + 5, CENTRE + 4), 1.0);
    assert_eq!(chain.probability(0, 1), 1.0);
    let states = chain.generate_states(8, &mut rng(1));
    let relative: Vec<usize> = states.iter().map(|state| state - CENTRE).collect();
    assert_eq!(relative, [0, 5, 4, 3, 2, 1, 0, 5]);
    let untrained = Chain::of_states([]).generate_states(3, &mut rng(1));
    assert_eq!(untrained, [CENTRE; 3]);
}

/// Checks that each element is within five standard deviations, √(G (1 - G) / visits).
fn check_retrained(chain: &Chain, retrained: &Chain) {
    let mut checked = 0;
    for from in 0..STATES {
        let visits = f64::from(retrained.visits(from));
        if visits < 100.0 {
            continue;
        }
        for to in 0..STATES {
            let (g, found) = (chain.probability(from, to), retrained.probability(from, to));
            let sigma = (g * (1.0 - g) / visits).sqrt();
            assert!(
                (found - g).abs() <= 5.0 * sigma + 2.0 / visits,
                "{from} to {to}: {g} became {found} after {visits} visits"
            );
            checked += usize::from(g > 0.0);
        }
    }
    assert!(checked > 60, "{checked}");
}

#[test]
fn a_chain_retrained_on_its_own_states_is_the_same_within_sampling_error() {
    let chain = Chain::measured();
    let states = chain.generate_states(2_000_000, &mut rng(2));
    check_retrained(&chain, &Chain::of_states([states]));
}

#[test]
fn a_chain_retrained_on_its_own_errors_is_the_same_within_sampling_error() {
    let chain = Chain::train(&gps::errors::simulated(7));
    let states = chain.generate_states(2_000_000, &mut rng(2));
    let errors_m: Vec<f64> = states.into_iter().map(error_of).collect();
    // So small a mean shifts nothing into another bin.
    let mean = errors_m.iter().sum::<f64>() / errors_m.len() as f64;
    assert!(mean.abs() < 0.25, "{mean}");
    check_retrained(&chain, &Chain::train(&[errors_m]));
}

#[test]
fn the_same_seed_gives_the_same_series_and_another_another() {
    let chain = Chain::measured();
    assert_eq!(
        chain.generate(5_000, &mut rng(3)),
        chain.generate(5_000, &mut rng(3))
    );
    assert_ne!(
        chain.generate(5_000, &mut rng(3)),
        chain.generate(5_000, &mut rng(4))
    );
}

#[test]
fn the_low_pass_leaves_no_steps_and_keeps_what_is_long() {
    let chain = Chain::measured();
    let raw: Vec<f64> = chain
        .generate_states(40_000, &mut rng(5))
        .into_iter()
        .map(error_of)
        .collect();
    let smooth = chain.generate(40_000, &mut rng(5));
    assert_eq!(smooth.len(), raw.len());
    let largest_step = |series: &[f64]| {
        let steps = series.windows(2).map(|pair| (pair[1] - pair[0]).abs());
        steps.fold(0.0, f64::max)
    };
    assert!(largest_step(&raw) >= 0.5);
    // 5 % of grade.
    assert!(largest_step(&smooth) < 0.125, "{}", largest_step(&smooth));
    let wave: Vec<f64> = (0..4_000)
        .map(|k| (f64::from(k) * 2.5 / 2_000.0 * std::f64::consts::TAU).sin())
        .collect();
    let kept = moving_mean(&moving_mean(&wave, LOW_PASS_M), LOW_PASS_M);
    let error = kept[100..3_900]
        .iter()
        .zip(&wave[100..3_900])
        .map(|(a, b)| (a - b).abs())
        .fold(0.0, f64::max);
    assert!(error < 0.05, "{error}");
}

#[test]
fn a_series_less_its_mean_has_none() {
    assert_eq!(centred(&[1.0, 2.0, 6.0]), [-2.0, -1.0, 3.0]);
    assert!(centred(&[]).is_empty());
}

#[test]
fn the_chain_survives_its_file_and_a_bad_file_is_named() {
    let chain = Chain::measured();
    let path = Path::new("chain.csv");
    let text = chain.to_text("made for a test\nin two lines");
    assert!(text.starts_with("# made for a test\n# in two lines\nfrom_m,to_m,count\n"));
    assert_eq!(Chain::parse(path, &text).unwrap(), chain);
    for (bad, reported) in [
        ("from_m,to_m,count\n0,x,3\n", "chain.csv:2"),
        ("from_m,to_m,count\n0,0\n", "chain.csv:2"),
        ("from_m,to_m,count\n0,0,-1\n", "chain.csv:2"),
        ("from_m,to_m,count\n0,0.3,1\n", "multiples of 0.5 m"),
        ("from_m,to_m,count\n15.5,0,1\n", "multiples of 0.5 m"),
        ("from_m,to_m,count\nnan,0,1\n", "multiples of 0.5 m"),
    ] {
        let error = Chain::parse(path, bad).unwrap_err().to_string();
        assert!(error.contains(reported), "{bad:?}: {error}");
        assert!(error.contains("expected"), "{bad:?}: {error}");
    }
}

/// The committed chain is that of the measured data. After an intended change the message has the
/// path of the new file.
#[test]
fn the_committed_chain_is_that_of_the_measured_data() {
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/data");
    let Some(series) = gps::errors::of_data(&data).unwrap() else {
        eprintln!("SKIPPED: no measured mission at ../shared/data/ztbus");
        return;
    };
    assert_eq!(series.len(), 6);
    let text = Chain::train(&series).to_text(gps::ORIGIN);
    let committed = include_str!("../../data/gps_chain.csv");
    if text != committed {
        let fresh = Path::new(env!("CARGO_TARGET_TMPDIR")).join("gps_chain.csv");
        std::fs::write(&fresh, text).unwrap();
        panic!(
            "host-sim/data/gps_chain.csv differs from {}",
            fresh.display()
        );
    }
}
