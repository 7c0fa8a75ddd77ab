//! Matching at knots places a run as matching each of its cells does.

use host_sim::files::run::RunCell;
use host_sim::map::{Network, PlacedRun, RoadLine, place, place_every_cell};
use std::collections::BTreeMap;
use test_kit::roads::network::{network, way};
use test_kit::roads::{Spot, drive, hills, moved, points, reversed, run, with_position_noise};

/// Returns the cells of a run over these spots. Their grade is the driven distance: that of a placed
/// cell then says where in the run it was taken from.
fn cells(spots: &[Spot]) -> Vec<RunCell> {
    let rows = run(spots);
    let cells = rows.iter().map(RunCell::from);
    cells
        .map(|cell| RunCell {
            grade_percent: cell.distance_m,
            ..cell
        })
        .collect()
}

/// How far apart two placements of a run are.
#[derive(Debug)]
struct Apart {
    /// Root of the mean square along the road, m.
    rms_m: f64,
    /// Largest distance along the road, m.
    most_m: f64,
    /// Cells of the road that only one of them has.
    others: usize,
    /// Cells that both have.
    same: usize,
}

fn by_cell(run: &PlacedRun) -> BTreeMap<(usize, i64), f64> {
    let cells = run.cells.iter();
    cells
        .map(|cell| ((cell.way, cell.number), cell.grade_percent))
        .collect()
}

fn apart(network: &Network, cells: &[RunCell]) -> Apart {
    let (at_knots, of_cells) = (place(network, cells), place_every_cell(network, cells));
    let (a, b) = (by_cell(&at_knots), by_cell(&of_cells));
    let apart_m: Vec<f64> = a
        .iter()
        .filter_map(|(cell, at_m)| Some((at_m - b.get(cell)?).abs()))
        .collect();
    let same = apart_m.len();
    Apart {
        rms_m: (apart_m.iter().map(|m| m * m).sum::<f64>() / same.max(1) as f64).sqrt(),
        most_m: apart_m.iter().copied().fold(0.0, f64::max),
        others: a.len() + b.len() - 2 * same,
        same,
    }
}

fn line(spots: &[Spot]) -> Network {
    RoadLine::new(points(spots)).expect("a road").into()
}

/// Asserts that both place the run on the same cells, and returns how far apart they are.
#[track_caller]
fn assert_same(network: &Network, cells: &[RunCell], least: usize, most_m: f64) -> Apart {
    let apart = apart(network, cells);
    assert!(apart.same >= least, "{apart:?}");
    assert!(apart.most_m <= most_m, "{apart:?}");
    assert!(apart.others <= 2, "{apart:?}");
    apart
}

#[test]
fn knots_place_as_cells_do_whatever_the_noise() {
    let spots = hills();
    let road = line(&spots);
    // Without noise; that of a receiver at ten a second and at one; and none alike.
    for (sigma_m, fade_m) in [(0.0, 80.0), (3.0, 80.0), (3.0, 20.0), (1.5, 0.1)] {
        for seed in 0..4 {
            let noisy = with_position_noise(&spots, sigma_m, fade_m, seed);
            let apart = assert_same(&road, &cells(&noisy), 2380, 0.25);
            assert!(apart.rms_m <= 0.04, "{sigma_m} {fade_m}: {apart:?}");
        }
    }
}

#[test]
fn knots_place_as_cells_do_in_bends() {
    // Hairpins of 20 m radius, 200 m apart.
    let turns = |s: f64| {
        let (lap, m) = ((s / 262.0).floor(), s.rem_euclid(262.0));
        let turned = ((m - 200.0).max(0.0) / 20.0).to_degrees();
        if lap.rem_euclid(2.0) == 0.0 {
            turned
        } else {
            180.0 - turned
        }
    };
    let spots = drive((0.0, 0.0), 6000.0, turns, |_| 0.0);
    let road = line(&spots);
    for seed in 0..4 {
        let noisy = with_position_noise(&spots, 2.0, 80.0, seed);
        let apart = assert_same(&road, &cells(&noisy), 2380, 0.6);
        assert!(apart.rms_m <= 0.1, "{apart:?}");
    }
}

#[test]
fn a_run_enters_and_leaves_at_the_same_cell() {
    let spots = hills();
    let road = line(&spots[300..1500]);
    let onto = [
        &spots[..900],
        &moved(&spots[900..1200], 60.0, -60.0),
        &spots[1200..],
    ]
    .concat();
    for seed in 0..6 {
        let noisy = with_position_noise(&spots, 2.0, 80.0, seed);
        assert_same(&road, &cells(&noisy), 1195, 0.15);
        // Off the road for 750 m, to where the rows go on.
        let noisy = with_position_noise(&onto, 2.0, 80.0, seed);
        assert_same(&road, &cells(&noisy), 880, 0.15);
    }
    let back = cells(&reversed(&spots));
    let placed = (place(&road, &back), place_every_cell(&road, &back));
    assert_eq!(placed.0.coverage, placed.1.coverage);
}

#[test]
fn gaps_and_glitches_are_matched_cell_by_cell() {
    let spots = with_position_noise(&hills(), 2.0, 80.0, 7);
    let road = line(&hills());
    let whole = cells(&spots);
    // Positions at every twelfth cell, as at one fix a second; in three of four; a tunnel.
    for has_position in [
        (|i| i % 12 == 0) as fn(usize) -> bool,
        |i| i % 4 != 0,
        |i| !(800..1300).contains(&i),
    ] {
        let mut cells = whole.clone();
        for (i, cell) in cells.iter_mut().enumerate() {
            cell.position = cell.position.filter(|_| has_position(i));
        }
        assert_same(&road, &cells, 2370, 0.15);
    }
    // Missing rows, and odometers that are wrong by 2 %.
    let mut cells = [&whole[..700], &whole[731..1500], &whole[1504..]].concat();
    assert_same(&road, &cells, 2330, 0.15);
    for cell in &mut cells {
        cell.distance_m *= 1.02;
    }
    assert_same(&road, &cells, 2330, 0.15);
    // Positions far away.
    let mut cells = whole;
    for i in [500, 501, 1203, 1800] {
        cells[i].position = Some((0.0, 0.0));
    }
    assert_same(&road, &cells, 2370, 0.15);
}

#[test]
fn knots_turn_where_cells_do() {
    // Streets of a town, 150 m apart, in both directions; a drive in a staircase.
    let streets = |course: f64| {
        (0..9).map(move |k| {
            let beside_m = -600.0 + 150.0 * f64::from(k);
            let from = if course == 0.0 {
                (beside_m, -700.0)
            } else {
                (-700.0, beside_m)
            };
            let spots = drive(from, 1400.0, |_| course, |_| 0.0);
            way(&format!("{course}-{k}"), "no", &spots)
        })
    };
    let network = network(&streets(0.0).chain(streets(90.0)).collect::<Vec<_>>());
    let course = |s: f64| {
        if (s / 150.0).floor().rem_euclid(2.0) == 0.0 {
            0.0
        } else {
            90.0
        }
    };
    let driven = drive((-600.0, -600.0), 2100.0, course, |_| 0.0);
    for seed in 0..4 {
        let noisy = with_position_noise(&driven, 2.0, 80.0, seed);
        let cells = cells(&noisy);
        let apart = apart(&network, &cells);
        assert!(apart.same > 810, "{apart:?}");
        assert!(apart.rms_m < 0.3 && apart.most_m < 1.5, "{apart:?}");
        assert!(apart.others < 20, "{apart:?}");
    }
}

#[test]
fn a_run_across_the_date_line_is_placed() {
    let spots = hills();
    let east = |(latitude_deg, longitude_deg): (f64, f64)| {
        let moved = longitude_deg - 8.5 + 179.98;
        let wrapped = (moved + 180.0).rem_euclid(360.0) - 180.0;
        (latitude_deg, wrapped)
    };
    let mut road = points(&spots);
    for point in &mut road {
        (point.latitude_deg, point.longitude_deg) = east((point.latitude_deg, point.longitude_deg));
    }
    let mut cells = cells(&with_position_noise(&spots, 2.0, 80.0, 3));
    for cell in &mut cells {
        cell.position = cell.position.map(east);
    }
    assert!(
        cells
            .iter()
            .any(|cell| cell.position.is_some_and(|at| at.1 < 0.0))
    );
    let road = RoadLine::new(road).expect("a road").into();
    assert_same(&road, &cells, 2380, 0.15);
}
