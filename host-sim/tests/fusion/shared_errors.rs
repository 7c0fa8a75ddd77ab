//! Campaigns whose runs have errors in common.

use host_sim::study::convergence::curve::floor_and_slope;
use host_sim::study::shared_errors::drives::{Conditions, RUNS, Shared, Without, groups};

/// Returns the errors of each run: those of a truck on a day, one after the other.
fn errors(shared: Shared) -> Vec<String> {
    let groups = groups(7, Conditions::of(shared, Without::Nothing));
    groups.into_iter().flat_map(|group| group.runs).collect()
}

#[test]
fn runs_have_the_errors_of_their_level_in_common() {
    for (shared, alike) in [
        (Shared::Run, 1),
        (Shared::Day, 3),
        (Shared::Truck, RUNS / 2),
        (Shared::Fleet, RUNS),
        (Shared::Mixed, 1),
    ] {
        let errors = errors(shared);
        assert_eq!(errors.len(), RUNS);
        let of_levels: Vec<&[String]> = errors.chunks(alike).collect();
        for level in &of_levels {
            assert!(level.iter().all(|run| run == &level[0]), "{shared:?}");
        }
        for (number, level) in of_levels.iter().enumerate() {
            let others = &of_levels[number + 1..];
            assert!(others.iter().all(|of| of[0] != level[0]), "{shared:?}");
        }
    }
}

#[test]
fn an_absent_cause_leaves_all_others_as_they_are() {
    let all = groups(7, Conditions::of(Shared::Mixed, Without::Nothing));
    let no_tyres = groups(7, Conditions::of(Shared::Mixed, Without::Tyres));
    let exact = groups(7, Conditions::of(Shared::Mixed, Without::Parameters));
    for ((with, without), exact) in all.iter().zip(&no_tyres).zip(&exact) {
        assert_eq!(with.runs, without.runs);
        let tyres = "[tyres]\ncold_amount = 0.3\n";
        assert!(with.sections.contains(tyres));
        assert_eq!(with.sections.replace(tyres, ""), without.sections);
        assert_eq!(with.sections, exact.sections);
        for run in &exact.runs {
            assert_eq!(run.matches("_factor = 1.0").count(), 4, "{run}");
        }
    }
}

#[test]
fn the_floor_is_what_stays_with_any_number_of_runs() {
    let points = [2.0, 4.0, 8.0, 24.0].map(|runs| (runs, 0.0004 + 0.0036 / runs));
    let (floor, slope) = floor_and_slope(&points);
    assert!((floor - 0.0004).abs() < 1e-12 && (slope - 0.0036).abs() < 1e-12);
}
