//! Whether a map on board gives what it gave, bit by bit, on ways that fork, cross and lie side by side.
//!
//! `digests.txt` has what each drive gave. A change of behaviour that is wanted is accepted by
//! `CHANGE_INDICATOR=write cargo test -p estimator-core --test packed_map change_indicator`.

use super::file::{CELL_E7, TestWay, packed};
use super::{WAYS, finished, live};
use estimator_core::roadmap::PackedMap;
use test_kit::{Noise, check_digests, finished_late, line_on_map};

/// A way beside the road, one that crosses it, one that comes back from the exit, and one that is longer
/// than a horizon.
const MORE: [TestWay; 4] = [
    TestWay {
        name: "beside",
        cells: 500,
        grade: 150,
        begin_e7: [1_000_000, 20_001_200],
        heading: [10, 0],
        joins: &[(420, 3)],
        gap: Some((210, 230)),
    },
    TestWay {
        name: "crossing",
        cells: 400,
        grade: -50,
        begin_e7: [1_030_000, 19_970_000],
        heading: [3, 9],
        joins: &[],
        gap: None,
    },
    TestWay {
        name: "back",
        cells: 400,
        grade: 250,
        begin_e7: [1_100_000, 20_050_000],
        heading: [-7, -7],
        joins: &[(150, 0), (399, 1)],
        gap: None,
    },
    TestWay {
        name: "long",
        cells: 2_000,
        grade: 320,
        begin_e7: [900_000, 20_100_000],
        heading: [9, -4],
        joins: &[(500, 1), (850, 2), (1_400, 6)],
        gap: Some((1_100, 1_104)),
    },
];

/// A part of a drive: a way, its first cell, and how many.
type Leg = (usize, i32, i32);

/// A drive: where it goes, how far aside of the way, by how much its positions are off, and what its
/// grades are too large by.
struct Drive {
    name: &'static str,
    legs: &'static [Leg],
    aside_m: f32,
    noise_m: f32,
    error_percent: f32,
    /// Cells from one place to the next; the others have none.
    place_cells: u32,
}

const PLAIN: Drive = Drive {
    name: "along the road",
    legs: &[(0, 0, 400), (3, 0, 500)],
    aside_m: 0.0,
    noise_m: 1.0,
    error_percent: 0.0,
    place_cells: 1,
};

fn drives() -> Vec<Drive> {
    vec![
        PLAIN,
        Drive {
            name: "the exit, and back",
            legs: &[(0, 0, 200), (1, 0, 300), (6, 0, 300)],
            noise_m: 2.0,
            ..PLAIN
        },
        Drive {
            name: "to the east",
            legs: &[(0, 50, 350), (2, 0, 300)],
            noise_m: 4.0,
            ..PLAIN
        },
        Drive {
            name: "between two ways",
            legs: &[(0, 0, 400), (3, 0, 100)],
            aside_m: 7.0,
            noise_m: 5.0,
            ..PLAIN
        },
        Drive {
            name: "the way beside, with its gap",
            legs: &[(4, 0, 420), (3, 0, 300)],
            ..PLAIN
        },
        Drive {
            name: "across",
            legs: &[(5, 0, 400)],
            ..PLAIN
        },
        Drive {
            name: "another slope",
            legs: &[(0, 0, 400), (3, 0, 300), (0, 0, 300)],
            error_percent: 0.5,
            ..PLAIN
        },
        Drive {
            name: "few places",
            legs: &[(0, 0, 400), (3, 0, 300)],
            noise_m: 0.3,
            place_cells: 3,
            ..PLAIN
        },
        Drive {
            name: "a long way",
            legs: &[(7, 0, 2_000)],
            ..PLAIN
        },
        Drive {
            name: "off the road and on",
            legs: &[(0, 0, 150), (5, 300, 60), (0, 200, 200), (3, 600, 200)],
            ..PLAIN
        },
    ]
}

/// Drives on a map of these ways, and returns the line of the drive.
fn line(ways: &[TestWay], bytes: &[u8], seed: u64, drive: &Drive) -> String {
    let mut noise = Noise(seed);
    let mut aside = [0.0_f32; 2];
    let mut cells = Vec::new();
    let places = drive.legs.iter();
    let places = places.flat_map(|(way, from, count)| (*from..from + count).map(|at| (*way, at)));
    for (driven, (way, at)) in (0..).zip(places) {
        let mut live = live(&ways[way], at, driven);
        // Smooth over some ten cells.
        aside = aside.map(|of| 0.95 * of + 0.3 * drive.noise_m * noise.draw());
        let [north, east] = aside.map(|metres| (metres / 2.5 * CELL_E7 as f32) as i32);
        let beside = (drive.aside_m / 2.5 * CELL_E7 as f32) as i32;
        let is_placed = driven.is_multiple_of(drive.place_cells);
        live.end.position_e7 = live
            .end
            .position_e7
            .filter(|_| is_placed)
            .map(|(latitude, longitude)| (latitude + north, longitude + east + beside));
        let grade = &mut live.estimate.grade_percent;
        grade.value += drive.error_percent + 0.1 * noise.draw();
        cells.push((live, finished(&live)));
    }
    let map = PackedMap::open(bytes).expect("a map");
    line_on_map(map, drive.name, &finished_late(&cells))
}

#[test]
fn every_drive_gives_what_is_committed() {
    let mut ways = [&WAYS[..], &MORE].concat();
    // Three ways lead on at its end.
    ways[0].joins = &[(200, 1), (399, 2), (399, 3), (399, 5)];
    let bytes = packed(&ways);
    let drives = drives();
    let lines = (1..).zip(&drives);
    let found: Vec<_> = lines
        .map(|(seed, drive)| line(&ways, &bytes, seed, drive))
        .collect();
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/packed_map/digests.txt");
    check_digests(&found, include_str!("digests.txt"), path);
}
