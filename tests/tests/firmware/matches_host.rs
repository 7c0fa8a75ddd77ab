//! The image on the emulated board computes what the host computes, bit for bit.

use cross_tests::drive::{drive, truck, truck_with_every_effect};
use cross_tests::drive_map::drive_map;
use cross_tests::emulator::{drive_file, missing, on_host, on_host_with_map, replay};
use estimator_core::packed_vehicle::VEHICLE_BYTES;
use estimator_core::roadmap::PackedMap;
use estimator_core::{Cell, Model};
use firmware::exchange::cell::{self, CELL_BYTES};
use firmware::exchange::frame::FRAME_BYTES;
use firmware::exchange::on_map::ON_MAP_BYTES;

/// Returns whether the board cannot be emulated here, and reports it.
pub fn board_is_missing() -> bool {
    let missing = missing();
    if let Some(what) = &missing {
        eprintln!("SKIPPED: the firmware was not run: {what}");
    }
    missing.is_some()
}

#[test]
fn every_cell_is_that_of_the_host() {
    if board_is_missing() {
        return;
    }
    for vehicle in [truck(), truck_with_every_effect()] {
        compare(&vehicle);
    }
}

fn compare(model: &Model) {
    let frames = drive();
    let expected = on_host(model, &frames);
    let ended = replay(Some(&drive_file(model, &frames)), None);
    assert_eq!(ended.status, Some(0), "{}", ended.stderr);

    assert_eq!(ended.on_map, None, "there is no map in flash");
    let found = ended.cells.expect("an image that ends well wrote cells");
    assert_eq!(found.len(), expected.len() * CELL_BYTES);
    for (expected, found) in expected.iter().zip(found.chunks(CELL_BYTES)) {
        assert_eq!(
            cell::encode(expected),
            found,
            "host {expected:?}\nboard {:?}",
            cell::decode(found)
        );
    }
    let last = expected.last().unwrap().lagged_grade_percent;
    let summary = format!(
        "{} frames, {} cells, last grade {} ± {} %",
        frames.len(),
        expected.len(),
        last.value,
        last.sigma
    );
    assert_eq!(ended.log.last(), Some(&summary));
    let is_logged = |start: &str| ended.log.iter().any(|line| line.starts_with(start));
    for start in ["Live {", "Counters {"] {
        assert!(is_logged(start), "no {start} in {:?}", ended.log);
    }
    println!("bit-identical on board and host: {summary}");
}

/// Flags of a record of a step.
fn flags(record: &[u8]) -> u32 {
    u32::from_le_bytes(record[4..8].try_into().unwrap())
}

#[test]
fn with_a_map_each_step_is_that_of_the_host() {
    if board_is_missing() {
        return;
    }
    let (model, frames, map) = (truck(), drive(), drive_map());
    let expected = on_host_with_map(&model, &frames, PackedMap::open(&map).unwrap());
    let ended = replay(Some(&drive_file(&model, &frames)), Some(&map));
    assert_eq!(ended.status, Some(0), "{}", ended.stderr);
    let found = ended.on_map.expect("an image with a map writes its part");
    assert_eq!(found.len(), expected.len());
    let (expected, found) = (expected.chunks(ON_MAP_BYTES), found.chunks(ON_MAP_BYTES));
    for (step, (expected, found)) in expected.zip(found).enumerate() {
        assert_eq!(expected, found, "step {step}");
    }
    // The map changes no cell.
    let cells: Vec<u8> = on_host(&model, &frames)
        .iter()
        .flat_map(cell::encode)
        .collect();
    assert_eq!(ended.cells, Some(cells));
    let is_logged = |start: &str| ended.log.iter().any(|line| line.starts_with(start));
    assert!(is_logged("a map of ") && is_logged("MapCounters {"));
}

/// The compared steps must reach every kind of match and frame.
#[test]
fn the_drive_with_a_map_reaches_every_kind_of_step() {
    let map = drive_map();
    let steps = on_host_with_map(&truck(), &drive(), PackedMap::open(&map).unwrap());
    let steps: Vec<&[u8]> = steps.chunks(ON_MAP_BYTES).collect();
    let count = |what: &dyn Fn(&[u8]) -> bool| steps.iter().filter(|step| what(step)).count();
    let has = |bit: u32| count(&|step| flags(step) >> bit & 1 == 1);
    println!(
        "{} steps: {} placed, {} perhaps, {} with a grade, {} combined, {} frames",
        steps.len(),
        has(0),
        has(1),
        has(2),
        has(3),
        count(&|step| step[48..] != [0; 8])
    );
    assert!(has(0) > 500 && has(1) > 5 && has(2) > 500 && has(3) > 500);
    assert_eq!(has(4), 0, "the map fits");
    // A branch begins: 0 and another one; grades of both; the next grade.
    for (content, branch) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
        let head = |step: &[u8]| step[48..] != [0; 8] && step[48] & 0xF == content | branch << 2;
        assert!(count(&head) >= 1, "content {content} of branch {branch}");
    }
    let next = count(&|step| step[40..48] != [0; 8]);
    assert!(next > 100, "{next} steps with a next grade");
    let ways: std::collections::BTreeSet<_> = steps.iter().map(|step| &step[8..12]).collect();
    assert_eq!(
        ways.len(),
        3,
        "none, and the ways before and behind the fork"
    );
}

/// The compared drive must exercise all kinds of cells.
#[test]
fn the_drive_reaches_every_kind_of_cell() {
    let cells = on_host(&truck(), &drive());
    let count = |what: fn(&Cell) -> bool| cells.iter().filter(|cell| what(cell)).count();
    assert!(cells.len() > 800, "{} cells", cells.len());
    assert!(count(|cell| cell.end.condition.shifting) > 5);
    assert!(count(|cell| cell.end.condition.braking) > 5);
    assert!(count(|cell| cell.end.condition.is_valid()) > 600);
    assert!(count(|cell| cell.end.position_e7.is_none()) > 5);
    assert!(count(|cell| cell.end.position_e7.is_some()) > 500);
    assert!(count(|cell| cell.altitude_m.is_some()) > 500);
    assert!(count(|cell| cell.lagged_grade_percent.value > 1.0) > 100);
    assert!(count(|cell| cell.lagged_grade_percent.value < -1.0) > 100);
}

#[test]
fn an_unusable_drive_ends_with_status_1_and_its_reason() {
    if board_is_missing() {
        return;
    }
    let good = drive_file(&truck(), &drive()[..10]);
    let mut weightless = truck();
    weightless.vehicle.mass_kg = -1.0;
    let mut long_frame = good.clone();
    long_frame[VEHICLE_BYTES + 2 * FRAME_BYTES + 12] = 9;
    let cut_short = "\"drive.bin\": expected 1008 bytes";
    let no_header = "\"drive.bin\": expected a packed vehicle";
    let cases: [(Option<&[u8]>, &str); 6] = [
        (None, "\"drive.bin\": "),
        (Some(&[]), cut_short),
        (Some(&good[1..]), no_header),
        (
            Some(&good[..good.len() - 1]),
            "\"drive.bin\": frame 10 is malformed",
        ),
        (Some(&long_frame), "\"drive.bin\": frame 3 is malformed"),
        (
            Some(&drive_file(&weightless, &[])),
            "\"drive.bin\": vehicle.mass_kg = -1: expected 500 to 200000 kg",
        ),
    ];
    for (drive, reason) in cases {
        let ended = replay(drive, None);
        assert_eq!(ended.status, Some(1), "{}", ended.stderr);
        assert!(ended.stderr.contains(reason), "{:?}", ended.stderr);
        assert_eq!(ended.log, Vec::<String>::new());
    }
}
