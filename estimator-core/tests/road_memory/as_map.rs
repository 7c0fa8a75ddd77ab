//! What a vehicle has learned, read as a map is: the live grade with it, and the grade ahead.

use super::flash::TestFlash;
use super::tracks::{Drive, Road, driven};
use estimator_core::roadmap::memory::MemoryGrade;
use estimator_core::roadmap::{
    HorizonPart, HorizonParts, MapLive, MapMatch, MapPlace, PackedMap, combined_with_roads,
};
use estimator_core::{CELL_LENGTH_M, Live, Uncertain};

const ROAD: Road = Road::new(1, 3_000);

/// Returns the flash memory of a vehicle that has driven the road three times.
fn learned() -> TestFlash {
    (0..3).fold(TestFlash::blank(32), |flash, seed| {
        driven(flash, Drive::over(ROAD, seed)).0
    })
}

fn rms(errors: &[f32]) -> f32 {
    (errors.iter().map(|error| error * error).sum::<f32>() / errors.len() as f32).sqrt()
}

#[test]
fn a_map_makes_the_live_grade_better_and_is_told_where_it_counts() {
    let flash = learned();
    let memory = flash.open();
    let mut map = MapLive::new(PackedMap::of_memory(memory.view()));
    let drive = Drive::over(ROAD, 9);
    let (mut own, mut combined) = (Vec::new(), Vec::new());
    for cell in 0..ROAD.cells {
        let live = drive.live(cell);
        map.advance(&live);
        if let Some(lagged) = cell.checked_sub(200) {
            map.finish(&drive.finished(lagged));
        }
        let Some(with_map) = map.combined_percent() else {
            assert_eq!(map.applied(&live), live);
            assert_eq!(map.counted_percent(), None);
            continue;
        };
        assert_eq!(map.counted_percent(), map.map_grade_percent());
        assert_eq!(map.applied(&live).estimate.grade_percent, with_map);
        assert!(with_map.sigma < live.estimate.grade_percent.sigma);
        own.push(live.estimate.grade_percent.value - drive.true_percent(cell));
        combined.push(with_map.value - drive.true_percent(cell));
    }
    assert!(combined.len() > 2_500, "{} cells", combined.len());
    assert!(
        rms(&combined) < 0.8 * rms(&own),
        "{} {}",
        rms(&combined),
        rms(&own)
    );
    assert!(!map.is_left_out());
    assert!(matches!(map.matcher().place(), MapMatch::On(_)));
    assert!(map.shift_m().value.abs() < 10.0, "{:?}", map.shift_m());
}

#[test]
fn a_map_of_another_slope_is_left_out() {
    let flash = learned();
    let memory = flash.open();
    let mut map = MapLive::new(PackedMap::of_memory(memory.view()));
    // From a place on, the road is not the learned one.
    let rebuilt = Road {
        rebuilt: (1_000, 3_000, 3.0),
        ..ROAD
    };
    let drive = Drive::over(rebuilt, 9);
    let mut parts = HorizonParts::new();
    let mut is_unknown = false;
    for cell in 0..2_000 {
        let live = drive.live(cell);
        map.advance(&live);
        let part = parts.next_part(&map, &live);
        is_unknown |= part.is_some_and(|part| part.part == HorizonPart::Unknown);
        assert_eq!(is_unknown, cell > 900 && map.is_left_out(), "cell {cell}");
    }
    assert!(map.is_left_out());
    assert_eq!(map.combined_percent(), None);
    assert_eq!(map.trusted_place(), None);
    assert!(is_unknown, "what was told ahead no longer holds");
    assert_eq!(parts.next_grade(&drive.live(2_000)), None);
}

#[test]
fn the_road_ahead_is_told_in_parts() {
    let flash = learned();
    let memory = flash.open();
    let mut map = MapLive::new(PackedMap::of_memory(memory.view()));
    let mut parts = HorizonParts::new();
    let drive = Drive::over(ROAD, 9);
    let (mut horizons, mut grades, mut nexts) = (Vec::new(), 0, 0);
    for cell in 0..1_800 {
        let live = drive.live(cell);
        map.advance(&live);
        if let Some(part) = parts.next_part(&map, &live) {
            match part.part {
                HorizonPart::Branch {
                    branch,
                    from_m,
                    to_m,
                    probability,
                } => {
                    assert_eq!((branch, from_m, to_m), (0, 0.0, 2_200.0));
                    assert!(probability > 0.9);
                    horizons.push((part.sequence, part.cell));
                }
                HorizonPart::Grades {
                    ahead_m,
                    grades_percent,
                    ..
                } => {
                    for (index, grade) in (0_u8..).zip(grades_percent) {
                        let Some(grade) = grade else { continue };
                        let metres = ahead_m + 25.0 * f32::from(index);
                        let there = part.cell + (metres / CELL_LENGTH_M) as u32;
                        let error = grade.value - ROAD.grade_percent(there);
                        assert!(
                            error.abs() < 0.5,
                            "{error} % {metres} m ahead of {}",
                            part.cell
                        );
                        grades += 1;
                    }
                }
                HorizonPart::Unknown => assert!(horizons.is_empty(), "cell {cell}"),
            }
        }
        if let Some(next) = parts.next_grade(&live) {
            let there = cell + (next.ahead_m / CELL_LENGTH_M) as u32;
            assert!((next.grade_percent - ROAD.grade_percent(there)).abs() < 0.5);
            nexts += 1;
        }
    }
    assert!(grades > 500, "{grades}");
    assert!(nexts > 1_000, "{nexts}");
    // A new one after 200 m, with the next number of fifteen.
    assert!(horizons.len() > 16, "{horizons:?}");
    for pair in horizons.windows(2) {
        assert!(pair[1].1 >= pair[0].1 + 80, "{pair:?}");
        assert_eq!(pair[1].0, (pair[0].0 + 1) % 15, "{pair:?}");
    }
}

#[test]
fn a_place_that_is_lost_ends_the_road_ahead() {
    let flash = learned();
    let memory = flash.open();
    let mut map = MapLive::new(PackedMap::of_memory(memory.view()));
    let mut parts = HorizonParts::new();
    let (known, elsewhere) = (Drive::over(ROAD, 9), Drive::over(Road::new(9, 3_000), 9));
    let mut told: Vec<HorizonPart> = Vec::new();
    let mut drive = |live: &Live| {
        map.advance(live);
        told.extend(parts.next_part(&map, live).map(|part| part.part));
    };
    (0..600).for_each(|cell| drive(&known.live(cell)));
    (600..1_200).for_each(|cell| drive(&elsewhere.live(cell)));
    let unknown = told.iter().filter(|part| **part == HorizonPart::Unknown);
    assert_eq!(unknown.count(), 1, "once is enough");
    assert_eq!(told.last(), Some(&HorizonPart::Unknown));
}

#[test]
fn grades_are_combined_by_their_variances() {
    let grade = |value, sigma| Uncertain { value, sigma };
    let live = grade(2.0, 0.3);
    assert_eq!(combined_with_roads(live, None, None), None);
    // Nine times the weight for a third of the sigma.
    let map = combined_with_roads(live, Some(grade(3.0, 0.1)), None).unwrap();
    assert_eq!(map.road_percent, grade(3.0, 0.1));
    assert!((map.combined_percent.value - 2.9).abs() < 1e-5);
    assert!((map.combined_percent.sigma - 0.3 / 10_f32.sqrt()).abs() < 1e-6);
    // Two that are certain: the first.
    let certain = combined_with_roads(grade(1.0, 0.0), Some(grade(2.0, 0.0)), None).unwrap();
    assert_eq!(certain.combined_percent, grade(1.0, 0.0));
    // What memory and estimate have in common counts once: with all of it, the better one stays.
    let memory = |common_variance| {
        Some(MemoryGrade {
            grade_percent: grade(3.0, 0.1),
            common_variance,
        })
    };
    let independent = combined_with_roads(live, None, memory(0.0)).unwrap();
    let [one, other] = [independent, map].map(|grade| grade.combined_percent);
    assert!((one.value - other.value).abs() < 1e-5);
    assert!((one.sigma - other.sigma).abs() < 1e-6);
    let dependent = combined_with_roads(live, None, memory(0.01)).unwrap();
    assert_eq!(dependent.combined_percent.value, 3.0);
    assert!((dependent.combined_percent.sigma - 0.1).abs() < 1e-6);
    for (live, kept) in [(grade(2.0, 0.1), 2.0), (grade(2.0, 0.1001), 3.0)] {
        let same = combined_with_roads(live, None, memory(0.0101)).unwrap();
        assert_eq!(same.combined_percent.value, kept);
    }
    // With a map besides, both stand beside the estimate.
    let both = combined_with_roads(live, Some(grade(3.0, 0.1)), memory(0.0)).unwrap();
    assert!(both.combined_percent.sigma < map.combined_percent.sigma);
    assert!((both.road_percent.sigma - 0.1 / 2_f32.sqrt()).abs() < 1e-6);
}

#[test]
fn a_map_that_is_shifted_along_the_road_is_left_out() {
    const SHIFT_CELLS: u32 = 12;
    let flash = learned();
    let memory = flash.open();
    let mut map = MapLive::new(PackedMap::of_memory(memory.view()));
    let drive = Drive::over(ROAD, 9);
    let grade = |cell: u32| ROAD.grade_percent(cell + SHIFT_CELLS);
    for cell in 0..2_500 {
        let mut live = drive.live(cell);
        live.estimate.grade_percent.value = grade(cell);
        map.advance(&live);
        if let Some(lagged) = cell.checked_sub(200) {
            let mut finished = drive.finished(lagged);
            finished.lagged_grade_percent.value = grade(lagged);
            map.finish(&finished);
        }
    }
    let shift = map.shift_m();
    // Maps are seldom shifted: half of it passes for chance.
    let true_m = SHIFT_CELLS as f32 * CELL_LENGTH_M;
    assert!((0.4 * true_m..true_m).contains(&shift.value), "{shift:?}");
    assert!(shift.value > 4.0 * shift.sigma, "{shift:?}");
    assert!(map.is_left_out());
    assert_eq!(map.combined_percent(), None);
}

/// Returns the grade between two cells of a block, read from its begin.
fn grade_in_block(map: &PackedMap<'_>, place: &MapPlace) -> Option<f32> {
    let cells: Vec<_> = map.block(place.block).ok()?.cells().ok()?.collect();
    let next = cells.partition_point(|cell| (cell.cell as f32) < place.cell);
    let (before, here) = (cells.get(next.saturating_sub(1))?, cells.get(next)?);
    let part = match here.cell - before.cell {
        0 => 1.0,
        cells => (place.cell - before.cell as f32) / cells as f32,
    };
    Some(before.grade_percent + part * (here.grade_percent - before.grade_percent))
}

#[test]
fn the_grade_is_that_of_the_block_as_it_is_now() {
    let mut memory = learned().open();
    let drive = Drive::over(ROAD, 7);
    let mut count = 0;
    for cell in 0..ROAD.cells {
        memory.advance(&drive.live(cell));
        if let (Some(grade), MapMatch::On(place)) = (memory.grade(), memory.place()) {
            let expected = grade_in_block(&PackedMap::of_memory(memory.view()), &place);
            assert_eq!(Some(grade.grade_percent.value), expected, "cell {cell}");
            count += 1;
        }
        // Without a lag, a write changes the block in which the vehicle is.
        if let Some(finished) = cell.checked_sub(1) {
            memory.finish(&drive.finished(finished)).expect("a write");
        }
    }
    assert!(count > 2_800, "{count} cells");
    assert!(memory.counters().writes > 3);
}

#[test]
fn grades_that_no_road_has_do_not_move_the_map() {
    let flash = learned();
    let memory = flash.open();
    let broken = [
        (f32::NAN, 0.1),
        (1e9, 0.1),
        (1.0, f32::NAN),
        (1.0, f32::INFINITY),
        (-1.0, 0.0),
    ];
    let shift_m = |is_broken: bool| {
        let mut map = MapLive::new(PackedMap::of_memory(memory.view()));
        let drive = Drive::over(ROAD, 9);
        for cell in 0..ROAD.cells {
            let mut live = drive.live(cell);
            let mut finished = cell.checked_sub(200).map(|lagged| drive.finished(lagged));
            if is_broken && cell % 50 == 7 {
                let (value, sigma) = broken[(cell / 50) as usize % broken.len()];
                live.estimate.grade_percent = Uncertain { value, sigma };
                if let Some(finished) = &mut finished {
                    finished.lagged_grade_percent = Uncertain { value, sigma };
                }
            }
            map.advance(&live);
            if let Some(finished) = finished {
                map.finish(&finished);
            }
        }
        assert!(!map.is_left_out());
        map.shift_m().value
    };
    assert!((shift_m(true) - shift_m(false)).abs() < 0.3);
}
