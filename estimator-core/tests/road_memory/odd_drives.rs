//! Drives with gaps, with and without altitudes, over the date line, and over many roads within a
//! minute.

use super::flash::{Memory, TestFlash};
use super::journey::{Journey, Seen};
use super::tracks::{Drive, Road, check_right, driven, known};
use estimator_core::roadmap::{Block, MapMatch, PackedMap, Tile};

const ROAD: Road = Road::new(1, 1_500);

/// Returns a flash memory that knows these roads from a drive over each.
fn with(sectors: usize, roads: &[Road]) -> TestFlash {
    roads.iter().fold(TestFlash::blank(sectors), |flash, road| {
        driven(flash, Drive::over(*road, 1)).0
    })
}

/// Returns the altitudes of all cells.
fn altitudes(memory: &Memory) -> Vec<Option<f32>> {
    let map = PackedMap::of_memory(memory.view());
    let ways = map.ways().map(|way| way.expect("a way"));
    let blocks = ways.flat_map(|way| map.blocks(&way).map(|block| block.expect("a block")));
    blocks
        .flat_map(|block| block.cells().expect("cells").map(|cell| cell.altitude_m))
        .collect()
}

#[test]
fn altitudes_stay_where_a_drive_has_none() {
    let mut flash = TestFlash::blank(16);
    let mut found = Vec::new();
    for altitude_m in [None, Some(100.0), None] {
        let mut memory = flash.open();
        let mut journey = Journey::new(&mut memory);
        for cell in 0..ROAD.cells {
            journey.step(&Seen {
                altitude_m,
                ..Seen::on(&ROAD, cell)
            });
        }
        journey.finish();
        memory.close().expect("a write");
        found.push(altitudes(&memory));
        flash = memory.into_flash();
    }
    let count = |of: &[Option<f32>]| of.iter().filter(|altitude| altitude.is_some()).count();
    assert_eq!(count(&found[0]), 0);
    for found in &found[1..] {
        // Not where the place was not known yet, and in the last block, which is not driven to its end.
        assert!(count(found) + 300 > found.len(), "{}", count(found));
        let near = |of: &f32| (of - 100.0).abs() < 1.0;
        assert!(found.iter().flatten().all(near), "{found:?}");
    }
}

#[test]
fn blocks_that_no_longer_fit_their_page_stay_as_they_were() {
    let road = Road::new(1, 4_500);
    // A level road, and one whose grades change so much that its blocks are long.
    let grade_percent = |drive: u32, cell: u32| match (drive, cell % 2) {
        (0, _) => 0.0,
        (_, 0) => 9.0,
        _ => -9.0,
    };
    let mut flash = TestFlash::blank(16);
    for drive in 0..2 {
        let mut memory = flash.open();
        let mut journey = Journey::new(&mut memory);
        for cell in 0..road.cells {
            journey.step(&Seen {
                grade_percent: grade_percent(drive, cell),
                ..Seen::on(&road, cell)
            });
        }
        journey.finish();
        memory.close().expect("a write");
        flash = memory.into_flash();
    }
    let cells = known(&flash.open());
    assert!(cells.len() > 4_400, "{}", cells.len());
    let behind = cells.range((1, 500)..(1, 4_300));
    let is_level = |known: &super::tracks::Known| known.grade_percent.abs() < 0.01;
    let level = behind.clone().filter(|(_, known)| is_level(known)).count();
    let rough = behind.count() - level;
    // Two or three blocks of each page.
    assert!(
        level > 2_500 && (200..1_000).contains(&rough),
        "{level} {rough}"
    );
}

/// Ends the drive, and checks that all of the road is known as it is.
fn is_learned(mut memory: Memory) {
    memory.close().expect("a write");
    let cells = known(&memory);
    check_right(&cells, &[ROAD]);
    assert!(cells.len() as u32 > ROAD.cells - 20, "{}", cells.len());
}

#[test]
fn finished_cells_alone_are_learned_as_a_new_road() {
    let mut memory = TestFlash::blank(16).open();
    let drive = Drive::over(ROAD, 1);
    for cell in 0..ROAD.cells {
        let mut finished = drive.finished(cell);
        // No drive knows this little, or this much.
        match cell {
            700 => finished.lagged_grade_percent.sigma = f32::INFINITY,
            900 => finished.lagged_grade_percent.sigma = 0.0,
            _ => {}
        }
        memory.finish(&finished).expect("a write");
    }
    assert_eq!(memory.counters().cells_left_out, 2);
    is_learned(memory);
}

#[test]
fn cells_that_are_finished_late_are_learned_as_a_new_road() {
    let mut memory = TestFlash::blank(16).open();
    let mut journey = Journey::new(&mut memory);
    // Later than places are held.
    journey.lag = 300;
    journey.over(&ROAD, 0..ROAD.cells);
    journey.finish();
    is_learned(memory);
}

#[test]
fn a_gap_of_the_drive_ends_a_new_road() {
    let mut memory = TestFlash::blank(16).open();
    let mut journey = Journey::new(&mut memory);
    journey.over(&ROAD, 0..500);
    journey.skip(100);
    journey.over(&ROAD, 600..1_100);
    journey.finish();
    memory.close().expect("a write");
    let cells = known(&memory);
    check_right(&cells, &[ROAD]);
    assert_eq!(cells.range((1, 520)..(1, 580)).count(), 0);
    let map = PackedMap::of_memory(memory.view());
    let way_of = |at: i32| {
        map.ways().map(Result::unwrap).find(|way| {
            let block = map.blocks(way).next().unwrap().unwrap();
            let (latitude, _) = block.points().next().unwrap().position_deg();
            let (_, first) = Road::cell_of(latitude * 1e7, 0.0);
            (first - f64::from(at)).abs() < 5.0
        })
    };
    assert!(way_of(0).is_some() && way_of(600).is_some());
}

#[test]
fn a_gap_of_the_drive_leaves_the_place_on_a_known_road() {
    let mut memory = with(16, &[ROAD]).open();
    let mut journey = Journey::new(&mut memory);
    journey.over(&ROAD, 0..400);
    assert!(matches!(journey.memory.place(), MapMatch::On(_)));
    journey.skip(20);
    journey.over(&ROAD, 420..900);
    assert!(matches!(journey.memory.place(), MapMatch::On(_)));
    journey.finish();
    memory.close().expect("a write");
    let cells = known(&memory);
    check_right(&cells, &[ROAD]);
    // Driven again before and behind the gap, and not in it.
    let twice = |from: u32, to: u32| {
        let range = cells.range((1, from)..(1, to));
        range.filter(|(_, known)| known.runs == 2).count()
    };
    assert!(twice(150, 380) > 200 && twice(450, 880) > 400);
    assert!(twice(402, 418) <= 8, "{}", twice(402, 418));
}

#[test]
fn a_long_gap_of_the_drive_on_a_known_road_makes_no_second_road() {
    let flash = with(16, &[ROAD]);
    for gap in [60, 150, 300, 390] {
        let mut memory = flash.clone().open();
        let mut journey = Journey::new(&mut memory);
        journey.over(&ROAD, 0..400);
        journey.skip(gap);
        journey.over(&ROAD, 400 + gap..1_400);
        journey.finish();
        memory.close().expect("a write");
        let cells = known(&memory);
        check_right(&cells, &[ROAD]);
        assert!(cells.len() < 1_520, "{gap}: {}", cells.len());
    }
}

#[test]
fn a_road_along_the_date_line_is_learned() {
    // The road swings over it, 40 m to each side: to the east and back to the west.
    let there = |cell: u32| {
        let (latitude_e7, east_e7) = Road::new(0, 5_400).place_e7(cell, 0.0);
        let side = if east_e7 >= 0 {
            1_800_000_000
        } else {
            -1_800_000_000
        };
        Seen {
            position_e7: (latitude_e7, east_e7 - side),
            ..Seen::on(&ROAD, cell)
        }
    };
    let mut flash = TestFlash::blank(16);
    let mut fused = 0;
    for _ in 0..2 {
        let mut memory = flash.open();
        let mut journey = Journey::new(&mut memory);
        (0..5_400).for_each(|cell| journey.step(&there(cell)));
        journey.finish();
        fused = journey.memory.counters().cells_fused;
        memory.close().expect("a write");
        flash = memory.into_flash();
    }
    assert!(fused > 5_200, "{fused}");
    let memory = flash.open();
    let map = PackedMap::of_memory(memory.view());
    let mut sides = [0, 0];
    for way in map.ways() {
        for block in map.blocks(&way.unwrap()) {
            for point in block.unwrap().points() {
                assert!(point.longitude_e7.abs() > 1_799_990_000, "{point:?}");
                sides[usize::from(point.longitude_e7 > 0)] += 1;
            }
        }
    }
    assert!(sides[0] > 50 && sides[1] > 50, "{sides:?}");
}

#[test]
fn of_many_roads_within_a_minute_what_waits_has_no_more_room() {
    let roads = [1, 2, 3, 4].map(|number| Road::new(number, 1_900));
    let flash = with(24, &roads);
    let before = known(&flash.clone().open());
    let mut memory = flash.open();
    let mut journey = Journey::new(&mut memory);
    journey.has_time = false;
    for road in &roads {
        journey.over(road, 0..500);
        journey.skip(450);
    }
    // A road that is new.
    journey.over(&Road::new(9, 1_000), 0..400);
    journey.finish();
    let counters = memory.counters();
    assert_eq!(counters.writes, 0);
    assert!(counters.cells_fused > 1_000, "{counters:?}");
    assert!(counters.cells_left_out > 400, "{counters:?}");
    // All pages in RAM wait: none can be moved.
    assert_eq!(memory.level(), Ok(false));
    memory.close().expect("a write");
    let cells = known(&memory);
    check_right(&cells, &roads);
    assert!(cells.len() >= before.len());
}

#[test]
fn a_block_whose_page_is_no_longer_in_ram_stays_as_it_was() {
    let roads = [1, 2, 3, 4].map(|number| Road::new(number, 1_900));
    let mut memory = with(24, &roads).open();
    let mut journey = Journey::new(&mut memory);
    journey.has_time = false;
    // Two pages wait to be written. Of the third one a block is changed, and then a new road, which
    // goes to a fourth, takes its place.
    for road in &roads[..2] {
        journey.over(road, 0..500);
        journey.skip(450);
    }
    journey.over(&roads[2], 0..110);
    journey.skip(450);
    let new = Road::new(9, 1_000);
    journey.over(&new, 0..400);
    journey.finish();
    memory.close().expect("a write");
    let cells = known(&memory);
    check_right(&cells, &[roads[0], roads[1], roads[2], roads[3], new]);
    let twice = |number: i32| {
        let range = cells.range((number, 0)..(number + 1, 0));
        range.filter(|(_, known)| known.runs == 2).count()
    };
    assert!(twice(1) > 300 && twice(2) > 300);
    assert_eq!(twice(3), 0);
}

#[test]
fn a_road_whose_page_makes_room_is_not_changed_any_more() {
    // Six pages are all that eight sectors hold.
    let roads = [1, 2, 3, 4, 5, 6].map(|number| Road::new(number, 1_900));
    let mut memory = with(8, &roads).open();
    let oldest = known(&memory).keys().next().expect("a road").0;
    let first = roads.iter().find(|road| road.number == oldest).unwrap();
    let mut journey = Journey::new(&mut memory);
    journey.has_time = false;
    journey.over(&Road::new(9, 2_000), 0..1_500);
    let fused = journey.memory.counters().cells_fused;
    // Its page is still in flash, but another one has its slot.
    journey.skip(450);
    journey.over(first, 0..600);
    journey.finish();
    let counters = memory.counters();
    assert!(counters.cells_left_out > 100, "{counters:?}");
    assert!(counters.cells_fused < fused + 300, "{counters:?}");
    memory.close().expect("a write");
    let all: Vec<Road> = (1..10).map(|number| Road::new(number, 2_000)).collect();
    check_right(&known(&memory), &all);
}

#[test]
fn a_road_with_many_exits_keeps_the_newest_of_them() {
    const EXITS: u32 = 18;
    let road = Road::new(1, 1_900);
    let mut flash = with(24, &[road]);
    for exit in 0..EXITS {
        let at = 150 + exit * 90;
        let mut memory = flash.open();
        let mut journey = Journey::new(&mut memory);
        journey.over(&road, at - 150..at);
        // To the east, a right angle away from the road.
        let (latitude_e7, longitude_e7) = road.place_e7(at, 0.0);
        for cell in 0..80 {
            journey.step(&Seen {
                position_e7: (latitude_e7, longitude_e7 + 225 * cell),
                grade_percent: 1.0,
                altitude_m: Some(100.0),
            });
        }
        journey.finish();
        memory.close().expect("a write");
        flash = memory.into_flash();
    }
    let memory = flash.open();
    let map = PackedMap::of_memory(memory.view());
    let joins = map.ways().map(|way| map.joins(&way.unwrap()).count());
    let most = joins.max().unwrap();
    // Most joins of a page.
    assert!((12..=16).contains(&most), "{most}");
}

#[test]
fn a_memory_of_another_slope_is_left_out_and_counted() {
    let mut memory = with(16, &[ROAD]).open();
    let rebuilt = Road {
        rebuilt: (600, 1_500, 3.0),
        ..ROAD
    };
    let mut journey = Journey::new(&mut memory);
    journey.over(&rebuilt, 0..590);
    assert!(!journey.memory.is_left_out());
    let counters = *journey.memory.map_counters();
    assert_eq!((counters.cells_left_out, counters.times_left_out), (0, 0));
    assert!(counters.cells_on_map > 400, "{counters:?}");
    journey.over(&rebuilt, 590..900);
    assert!(journey.memory.is_left_out());
    assert_eq!(journey.memory.grade(), None);
    let counters = journey.memory.map_counters();
    assert_eq!(counters.times_left_out, 1);
    assert!(counters.cells_left_out > 200, "{counters:?}");
}

#[test]
fn a_place_that_moves_back_counts_no_cell_twice() {
    let mut memory = with(16, &[ROAD]).open();
    let mut journey = Journey::new(&mut memory);
    for cell in 0..1_400 {
        // The receiver is ahead by up to 40 m, and comes back while the vehicle goes on.
        let ahead = if cell < 700 { 16 } else { 0 };
        journey.step(&Seen {
            position_e7: ROAD.place_e7(cell + ahead, 0.0),
            ..Seen::on(&ROAD, cell)
        });
    }
    journey.finish();
    memory.close().expect("a write");
    let cells = known(&memory);
    let most = cells.values().map(|known| known.runs).max();
    assert_eq!(most, Some(2), "{:?}", memory.counters());
}

#[test]
fn many_drives_without_a_finished_cell_have_room() {
    let mut memory = with(16, &[ROAD]).open();
    let drive = Drive::over(ROAD, 1);
    // Each time another estimator begins, and finishes nothing.
    for _ in 0..100 {
        memory.advance(&drive.live(1));
        memory.advance(&drive.live(0));
    }
    assert!(!drive.with(&mut memory).has_failed);
    check_right(&known(&memory), &[ROAD]);
}

#[test]
fn a_memory_gives_the_blocks_of_a_tile() {
    let memory = with(16, &[ROAD]).open();
    let map = PackedMap::of_memory(memory.view());
    let ways = map.ways().map(|way| way.expect("a way"));
    let blocks: Vec<_> = ways
        .flat_map(|way| map.blocks(&way).map(|block| block.expect("a block")))
        .collect();
    let tile_of = |block: &Block<'_>| {
        let point = block.points().next().expect("a point");
        Tile::of(point.latitude_e7, point.longitude_e7)
    };
    assert!(blocks.len() > 5);
    for block in &blocks {
        let mut found = map.blocks_in(tile_of(block));
        assert!(found.any(|found| found == Ok(block.offset)));
    }
    let elsewhere = Tile::of(-300_000_000, -300_000_000);
    assert_eq!(map.blocks_in(elsewhere).count(), 0);
}

#[test]
fn a_place_that_moves_back_makes_no_second_road() {
    let flash = with(16, &[ROAD]);
    for late in [4, 8, 12, 20] {
        let mut memory = flash.clone().open();
        let mut journey = Journey::new(&mut memory);
        for cell in 0..1_000 {
            // The receiver falls behind by up to 50 m as soon as the place is known.
            let behind = if (60..600).contains(&cell) { late } else { 0 };
            journey.step(&Seen {
                position_e7: ROAD.place_e7(cell - behind, 0.0),
                ..Seen::on(&ROAD, cell)
            });
        }
        journey.finish();
        memory.close().expect("a write");
        let cells = known(&memory);
        assert!(cells.len() < 1_520, "{late}: {}", cells.len());
        check_right(&cells, &[ROAD]);
    }
}

#[test]
fn evening_out_the_wear_in_the_midst_of_a_drive_loses_nothing() {
    let mut memory = TestFlash::blank(16).open();
    let mut journey = Journey::new(&mut memory);
    for cell in 0..ROAD.cells {
        journey.step(&Seen::on(&ROAD, cell));
        journey.memory.level().expect("a write");
    }
    journey.finish();
    memory.close().expect("a write");
    let cells = known(&memory);
    assert!(cells.len() > 1_300, "{}", cells.len());
    check_right(&cells, &[ROAD]);
}

#[test]
fn a_vehicle_that_is_carried_back_spoils_a_few_cells_at_most() {
    let mut memory = with(16, &[ROAD]).open();
    let mut journey = Journey::new(&mut memory);
    // By 500 m, without a gap in the cells: the next ones seem to follow until positions differ.
    journey.over(&ROAD, 0..900);
    journey.over(&ROAD, 700..1_400);
    journey.finish();
    memory.close().expect("a write");
    let mut cells = known(&memory);
    cells.retain(|(_, cell), _| !(900..910).contains(cell));
    assert!(cells.len() > 1_400);
    check_right(&cells, &[ROAD]);
}
