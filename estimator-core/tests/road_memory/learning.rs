//! What the memory learns.

use super::flash::TestFlash;
use super::tracks::{Drive, Road, SIGMA, driven, known};
use estimator_core::roadmap::{Horizon, MapMatch, PackedMap};

const ROAD: Road = Road::new(1, 5_000);

#[test]
fn a_road_is_known_the_second_time_and_better_known_each_time() {
    let mut flash = TestFlash::blank(32);
    let mut errors = Vec::new();
    for seed in 0..6 {
        let (after, drive) = driven(flash, Drive::over(ROAD, seed));
        flash = after;
        if seed == 0 {
            assert!(drive.errors.is_empty());
        } else {
            let part = drive.errors.len() as f32 / ROAD.cells as f32;
            assert!(part > 0.97, "{part} of the road is known");
            let normalised = drive.normalised();
            assert!((0.3..2.0).contains(&normalised), "{normalised}");
            errors.push(drive.rms());
        }
    }
    assert!(errors[0] < 1.3 * SIGMA, "{errors:?}");
    // Five independent drives, and the error of the place.
    assert!(errors[4] < 0.65 * SIGMA, "{errors:?}");
    let cells = known(&flash.open());
    let runs: u32 = cells.values().map(|cell| cell.runs).sum();
    assert!(f64::from(runs) / cells.len() as f64 > 5.8);
    assert!(
        cells.len() as f64 / f64::from(ROAD.cells) < 1.01,
        "no road is there twice"
    );
}

#[test]
fn the_other_direction_is_another_road() {
    let (flash, _) = driven(TestFlash::blank(32), Drive::over(ROAD, 1));
    let back = Drive {
        is_reversed: true,
        ..Drive::over(ROAD, 2)
    };
    let (flash, drive) = driven(flash, back);
    assert!(drive.errors.is_empty());
    let (_, drive) = driven(flash, back);
    assert!(drive.errors.len() > 4_800);
}

#[test]
fn a_rebuilt_road_is_learned_again() {
    let mut flash = TestFlash::blank(32);
    for seed in 0..5 {
        flash = driven(flash, Drive::over(ROAD, seed)).0;
    }
    let rebuilt = Road {
        rebuilt: (2_000, 2_320, 1.0),
        ..ROAD
    };
    let mut errors = Vec::new();
    for seed in 5..8 {
        let (after, drive) = driven(flash, Drive::over(rebuilt, seed));
        flash = after;
        // Where it is left out, it does no harm.
        errors.push(drive.rms());
    }
    assert!(errors[0] < 0.4 && errors[2] < 2.0 * SIGMA, "{errors:?}");
    let cells = known(&flash.open());
    let there = cells.range((1, 2_080)..(1, 2_320));
    let squares: f32 = there
        .clone()
        .map(|((_, cell), known)| (known.grade_percent - rebuilt.grade_percent(*cell)).powi(2))
        .sum();
    let error = (squares / there.count() as f32).sqrt();
    assert!(error < 2.0 * SIGMA, "{error} % where the road was rebuilt");
}

#[test]
fn the_road_ahead_goes_on_over_the_ends_of_pages() {
    let road = Road::new(1, 8_000);
    let (flash, _) = driven(TestFlash::blank(32), Drive::over(road, 1));
    let mut memory = flash.open();
    let map_errors = Drive::over(Road::new(1, 1_000), 2).with(&mut memory).errors;
    assert!(!map_errors.is_empty());
    let MapMatch::On(place) = memory.place() else {
        panic!("{:?}", memory.place())
    };
    let map = PackedMap::of_memory(memory.view());
    let horizon = Horizon::new(map, &place, 15_000.0).expect("a horizon");
    let branch = &horizon.branches()[0];
    let mut count = 0;
    for point in horizon.points(branch, 25.0) {
        let cell = 999 + (point.ahead_m / 2.5) as u32;
        if let Some(grade) = point.grade_percent.filter(|_| cell < road.cells) {
            let error = grade.value - road.grade_percent(cell);
            assert!(error.abs() < 0.5, "{error} % {} m ahead", point.ahead_m);
            count += 1;
        }
    }
    assert!(count > 15_000 / 25 - 20, "{count} points");
    assert!(branch.probability > 0.9);
}

#[test]
fn rough_input_changes_nothing_for_the_worse() {
    let mut flash = TestFlash::blank(32);
    for seed in 0..6 {
        let drive = Drive {
            is_rough: true,
            ..Drive::over(ROAD, seed)
        };
        flash = driven(flash, drive).0;
    }
    let cells = known(&flash.open());
    super::tracks::check_right(&cells, &[ROAD]);
    assert!(cells.len() > 4_000);
}
