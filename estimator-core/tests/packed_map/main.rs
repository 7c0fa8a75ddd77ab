//! The packed map: read as it is specified, refused where it is damaged, and driven on.

mod ahead;
mod change_indicator;
mod file;
mod odd_roads;
mod refused;

use estimator_core::roadmap::{
    Horizon, MapError, MapLive, MapMatch, PackedMap, Tile, WayDirection,
};
use estimator_core::{Cell, CellEnd, Condition, Disagreement, Estimate, Instant, Live, Uncertain};
use file::{TestWay, crc32, packed};

/// A road to the north with an exit on its way, and a fork at its end.
const WAYS: [TestWay; 4] = [
    TestWay {
        name: "road",
        cells: 400,
        grade: 400,
        begin_e7: [1_000_000, 20_000_000],
        heading: [10, 0],
        joins: &[(200, 1), (399, 2), (399, 3)],
        gap: None,
    },
    TestWay {
        name: "exit",
        cells: 300,
        grade: 100,
        begin_e7: [1_045_000, 20_000_000],
        heading: [8, 6],
        joins: &[],
        gap: None,
    },
    TestWay {
        name: "east",
        cells: 300,
        grade: -300,
        begin_e7: [1_090_000, 20_000_000],
        heading: [0, 10],
        joins: &[],
        gap: None,
    },
    TestWay {
        name: "on",
        cells: 900,
        grade: -200,
        begin_e7: [1_090_000, 20_000_000],
        heading: [10, 0],
        joins: &[],
        gap: None,
    },
];

/// Reads every record of a map.
fn read_all(bytes: &[u8]) -> Result<Vec<(&str, Vec<f32>)>, MapError> {
    let map = PackedMap::open(bytes)?;
    let mut ways = Vec::new();
    for way in map.ways() {
        let way = way?;
        let mut grades = Vec::new();
        for block in map.blocks(&way) {
            let block = block?;
            assert_eq!(block.way, way.offset);
            grades.extend(block.cells()?.map(|cell| cell.grade_percent));
        }
        for join in map.joins(&way) {
            let join = join?;
            assert!(way.contains(join.at_cell));
            assert_eq!(map.block(join.to_block)?.way, map.way(join.to_way)?.offset);
        }
        ways.push((way.name()?, grades));
    }
    Ok(ways)
}

#[test]
fn what_was_packed_is_read() {
    let bytes = packed(&WAYS);
    let map = PackedMap::open(&bytes).unwrap();
    assert!(!map.is_empty());
    assert_eq!(map.len(), bytes.len());
    let ways = read_all(&bytes).unwrap();
    assert_eq!(ways.len(), WAYS.len());
    for ((name, grades), way) in ways.iter().zip(WAYS) {
        assert_eq!((*name, grades.len()), (way.name, way.cells as usize));
        let grade = way.grade as f32 * 0.005;
        assert!(
            grades.iter().all(|of| (of - grade).abs() < 1e-4),
            "{name}: {grades:?}"
        );
    }
    let directions: Vec<WayDirection> = map.ways().map(|way| way.unwrap().direction).collect();
    let expected = [
        WayDirection::Forward,
        WayDirection::Backward,
        WayDirection::SingleRoad,
    ];
    assert_eq!(directions[..3], expected);
    let road = map.ways().next().unwrap().unwrap();
    let first = map.blocks(&road).next().unwrap().unwrap();
    let cell = first.cells().unwrap().next().unwrap();
    assert_eq!((cell.runs, cell.altitude_m), (3, None));
    assert!((cell.grade_sigma_percent - 0.076_1).abs() < 1e-4);
    let (latitude, longitude) = first.points().next().unwrap().position_deg();
    assert!((latitude - 0.1).abs() < 1e-9 && (longitude - 2.0).abs() < 1e-9);
    assert!(!road.contains(-1) && road.contains(0) && road.contains(399) && !road.contains(400));
    // Nothing is where no road is.
    assert_eq!(map.blocks_in(Tile::of(-500_000_000, 0)).count(), 0);
    assert_eq!(map.blocks_in(Tile::of(500_000_000, 0)).count(), 0);
}

/// Returns the blocks that the index has for each tile of the ways.
fn indexed(bytes: &[u8]) -> Vec<Result<Vec<u32>, MapError>> {
    let map = PackedMap::open(bytes).unwrap();
    let cells = WAYS
        .iter()
        .flat_map(|way| (0..way.cells).map(|cell| way.place_e7(cell)));
    let mut tiles: Vec<Tile> = cells
        .map(|(latitude, longitude)| Tile::of(latitude, longitude))
        .collect();
    tiles.dedup();
    tiles
        .into_iter()
        .map(|tile| map.blocks_in(tile).collect())
        .collect()
}

#[test]
fn each_flipped_bit_is_found() {
    let bytes = packed(&WAYS);
    let sound = indexed(&bytes);
    assert!(
        sound
            .iter()
            .all(|found| !found.as_ref().unwrap().is_empty())
    );
    let index = u32::from_le_bytes(bytes[32..36].try_into().unwrap()) as usize;
    for at in 0..bytes.len() {
        let mut damaged = bytes.clone();
        damaged[at] ^= 1 << (at % 8);
        if at < index {
            assert!(read_all(&damaged).is_err(), "byte {at}");
            continue;
        }
        // What is damaged in the index is an error or a place without a road, never another road.
        let found = indexed(&damaged);
        for (found, sound) in found.iter().zip(&sound) {
            let is_right = |found: &Vec<u32>| found.is_empty() || Ok(found) == sound.as_ref();
            assert!(found.as_ref().map_or(true, is_right), "byte {at}");
        }
        assert_ne!(found, sound, "byte {at}");
    }
}

#[test]
fn what_is_no_map_is_refused_in_words() {
    let bytes = packed(&WAYS);
    let refusal = |bytes: &[u8]| PackedMap::open(bytes).unwrap_err();
    for length in 0..bytes.len() {
        let refused = refusal(&bytes[..length]);
        let expected = if length < 4 {
            MapError::Magic
        } else {
            MapError::CutOff
        };
        assert_eq!(refused, expected, "{length} bytes");
    }
    let with_number = |at: usize, number: u32| {
        let mut bytes = bytes.clone();
        bytes[at..at + 4].copy_from_slice(&number.to_le_bytes());
        let checksum = crc32(&bytes[..60]).to_le_bytes();
        bytes[60..64].copy_from_slice(&checksum);
        bytes
    };
    assert_eq!(refusal(&with_number(4, 2)), MapError::Version(2));
    assert_eq!(refusal(&with_number(12, 5_000)), MapError::Content);
    let mut damaged = bytes.clone();
    damaged[16] ^= 1;
    assert_eq!(refusal(&damaged), MapError::Checksum);
    for (error, words) in [
        (MapError::Magic, "not a packed map"),
        (
            MapError::Version(2),
            "a packed map of version 2, which this release does not read",
        ),
        (MapError::CutOff, "a packed map that is cut off"),
        (MapError::Checksum, "a packed map that is damaged"),
        (MapError::Content, "a packed map with impossible content"),
    ] {
        assert_eq!(error.to_string(), words);
    }
}

/// Returns a map that knows the vehicle on the road, some 250 m before the exit.
fn before_the_exit(bytes: &[u8]) -> MapLive<'_> {
    let mut on_map = MapLive::new(PackedMap::open(bytes).unwrap());
    (0..100).for_each(|cell| on_map.advance(&live(&WAYS[0], cell, cell as u32)));
    on_map
}

/// Returns the cell of the way where the vehicle is known to be.
fn known_cell(on_map: &MapLive<'_>, name: &str) -> Option<f32> {
    let MapMatch::On(place) = on_map.matcher().place() else {
        return None;
    };
    let way = on_map.matcher().map().way(place.way).unwrap();
    assert_eq!(way.name().unwrap(), name);
    Some(place.cell)
}

/// Returns the live estimate at a cell of a way, with a count of driven cells.
fn live(way: &TestWay, cell: i32, driven: u32) -> Live {
    Live {
        end: CellEnd {
            cell: driven,
            time: Instant::from_micros(u64::from(driven) * 100_000),
            position_e7: Some(way.place_e7(cell)),
            speed_mps: 25.0,
            condition: Condition::default(),
        },
        estimate: Estimate {
            grade_percent: Uncertain {
                value: way.grade as f32 * 0.005 + 0.05,
                sigma: 0.1,
            },
            ..Estimate::default()
        },
        disagreement: Disagreement::default(),
    }
}

/// Returns a cell as it is finished, with its live grade.
const fn finished(live: &Live) -> Cell {
    Cell {
        end: live.end,
        live_grade_percent: live.estimate.grade_percent,
        lagged_grade_percent: live.estimate.grade_percent,
        altitude_m: None,
        live_consistent: true,
        lagged_consistent: true,
    }
}

#[test]
fn the_horizon_has_the_exit_and_the_fork() {
    let bytes = packed(&WAYS);
    let map = PackedMap::open(&bytes).unwrap();
    let mut on_map = MapLive::new(map);
    (0..100).for_each(|cell| on_map.advance(&live(&WAYS[0], cell, cell as u32)));
    let MapMatch::On(place) = on_map.matcher().place() else {
        panic!("{:?}", on_map.matcher().place());
    };
    assert!((place.cell - 99.0).abs() < 8.0, "{place:?}");
    let own = live(&WAYS[0], 99, 99).estimate.grade_percent;
    let combined = on_map.combined_percent().unwrap();
    assert!(combined.sigma < own.sigma && (combined.value - 2.0).abs() < 0.05);
    let horizon = Horizon::new(map, &place, 2_000.0).unwrap();
    let branches = horizon.branches();
    assert_eq!(branches.len(), 3);
    let sum: f32 = branches.iter().map(|branch| branch.probability).sum();
    assert!((sum - 1.0).abs() < 1e-5, "{sum}");
    assert!(branches[0].probability > 0.7);
    let mut forks: Vec<f32> = branches[1..].iter().map(|branch| branch.from_m).collect();
    forks.sort_by(f32::total_cmp);
    assert!(
        (forks[0] - 250.0).abs() < 20.0 && (forks[1] - 750.0).abs() < 20.0,
        "{forks:?}"
    );
    // Straight on, although the way to the east is the first that the map names.
    for point in horizon.points(&branches[0], 25.0) {
        let Some(grade) = point.grade_percent else {
            continue;
        };
        let expected = match point.ahead_m {
            ahead if ahead < 700.0 => 2.0,
            ahead if ahead > 800.0 => -1.0,
            _ => continue,
        };
        assert!(
            (grade.value - expected).abs() < 0.05,
            "{} m: {grade:?}",
            point.ahead_m
        );
    }
}

#[test]
fn a_vehicle_that_takes_the_exit_is_on_it() {
    let bytes = packed(&WAYS);
    let map = PackedMap::open(&bytes).unwrap();
    for taken in [1, 3] {
        let mut on_map = MapLive::new(map);
        let leaves = if taken == 1 { 200 } else { 399 };
        let mut most_hypotheses = 0;
        let cells = (0..leaves).map(|cell| (&WAYS[0], cell));
        let behind = (0..250).map(|cell| (&WAYS[taken], cell));
        for (driven, (way, cell)) in (0..).zip(cells.chain(behind)) {
            let live = live(way, cell, driven);
            on_map.advance(&live);
            on_map.finish(&finished(&live));
            most_hypotheses = most_hypotheses.max(on_map.matcher().hypotheses().count());
        }
        let MapMatch::On(place) = on_map.matcher().place() else {
            panic!("{:?}", on_map.matcher().place());
        };
        assert_eq!(
            map.way(place.way).unwrap().name().unwrap(),
            WAYS[taken].name
        );
        assert!((place.cell - 249.0).abs() < 8.0, "{place:?}");
        assert!(most_hypotheses > 1, "both ways were followed at the fork");
    }
}

#[test]
fn a_damaged_block_is_a_gap_in_the_grade() {
    let bytes = packed(&WAYS);
    let map = PackedMap::open(&bytes).unwrap();
    let road = map.ways().last().unwrap().unwrap();
    let second = map.blocks(&road).nth(1).unwrap().unwrap().offset as usize;
    let mut damaged = bytes.clone();
    damaged[second + 40] ^= 1;
    let mut on_map = MapLive::new(PackedMap::open(&damaged).unwrap());
    let mut known = Vec::new();
    for cell in 0..900 {
        on_map.advance(&live(&WAYS[3], cell, cell as u32));
        known.push(on_map.map_grade_percent().is_some());
    }
    let count = |cells: std::ops::Range<usize>| known[cells].iter().filter(|is| **is).count();
    assert!(count(80..120) > 30, "before the damaged block");
    assert_eq!(count(140..240), 0, "in it");
    assert!(count(500..900) > 300, "behind it: {}", count(500..900));
}
