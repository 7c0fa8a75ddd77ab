//! Maps of simulated trucks whose parameters are wrong in the same way all day: their errors and
//! their sigmas.

use host_sim::map::{FusedMap, PlacedRun};
use host_sim::score::ScoreRow;
use host_sim::simulator::truck::Preset;
use host_sim::study::fleet::road::{FleetRoad, as_if_independent};
use rayon::prelude::*;

/// Returns the map of these days, and its score.
fn map(road: &FleetRoad, days: &[&[PlacedRun]]) -> (FusedMap, ScoreRow) {
    let map = road.map(days);
    let score = road.score(&map.rows()).expect("scored");
    (map, score)
}

fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let values: Vec<f64> = values.collect();
    assert!(!values.is_empty());
    values.iter().sum::<f64>() / values.len() as f64
}

#[test]
fn sigmas_stay_consistent_as_runs_of_a_day_are_added() {
    let counts = [1, 3, 5, 12];
    let nees: Vec<Vec<[f64; 2]>> = (0..8_u64)
        .into_par_iter()
        .map(|seed| {
            let road = FleetRoad::new(300 + seed).expect("a road");
            let day = road.day(0, Preset::A, 12).expect("driven");
            let score = |count: &usize| {
                let runs = &day[..*count];
                let (map, score) = map(&road, &[runs]);
                let independent = as_if_independent(&map.rows(), runs.iter());
                [score.nees, road.score(&independent).expect("scored").nees]
            };
            counts.iter().map(score).collect()
        })
        .collect();
    for (i, count) in counts.iter().enumerate() {
        let mean_of = |which: usize| mean(nees.iter().map(|of_seed| of_seed[i][which]));
        let (honest, independent) = (mean_of(0), mean_of(1));
        assert!((0.3..1.5).contains(&honest), "{count} runs: {honest}");
        // A single run has no errors in common with another. What an error of its place costs is in
        // the sigma of the map alone.
        if *count == 1 {
            assert!(
                (1.0..1.05).contains(&(independent / honest)),
                "{independent}"
            );
        } else {
            assert!(independent > 1.4 * honest, "{count} runs: {independent}");
        }
    }
}

#[test]
fn a_light_truck_does_not_make_a_map_worse() {
    let maps: Vec<_> = (0..16_u64)
        .into_par_iter()
        .map(|seed| {
            let road = FleetRoad::new(500 + seed).expect("a road");
            let heavy = road.day(0, Preset::A, 3).expect("driven");
            let light = road.day(1, Preset::B, 2).expect("driven");
            let without = map(&road, &[&heavy]);
            let with = map(&road, &[&heavy, &light]);
            (without, with)
        })
        .collect();
    // A single case is random, as it is when a heavy truck is added.
    let squared = |score: &ScoreRow| score.rmse_percent.powi(2);
    let without = mean(maps.iter().map(|(without, _)| squared(&without.1))).sqrt();
    let with = mean(maps.iter().map(|(_, with)| squared(&with.1))).sqrt();
    assert!(with < without, "{with} with, {without} without");
    let ratio = mean(
        maps.iter()
            .map(|(without, with)| with.1.rmse_percent / without.1.rmse_percent),
    );
    assert!(ratio < 1.0, "{ratio}");
    let nees = mean(maps.iter().map(|(_, with)| with.1.nees));
    assert!((0.5..1.5).contains(&nees), "{nees}");
    // The sigma decreases with more runs, unless the trucks disagree.
    let sigma = |map: &FusedMap| mean(map.rows().iter().map(|row| row.grade_sigma_percent));
    let surer = maps
        .iter()
        .filter(|(a, b)| sigma(&b.0) < sigma(&a.0))
        .count();
    assert!(surer >= 13, "{surer} of 16");
}
