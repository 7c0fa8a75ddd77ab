//! The image on the emulated board computes what the host computes, bit for bit.

use cross_tests::drive::{drive, truck, truck_with_every_effect};
use cross_tests::emulator::{drive_file, missing, on_host, replay};
use estimator_core::packed_vehicle::VEHICLE_BYTES;
use estimator_core::{Cell, Model};
use firmware::exchange::cell::{self, CELL_BYTES};
use firmware::exchange::frame::FRAME_BYTES;

/// Returns whether the board cannot be emulated here, and reports it.
fn board_is_missing() -> bool {
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
    let ended = replay(Some(&drive_file(model, &frames)));
    assert_eq!(ended.status, Some(0), "{}", ended.stderr);

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
    for start in ["altitude: SetAnew", "Live {", "Counters {"] {
        assert!(is_logged(start), "no {start} in {:?}", ended.log);
    }
    println!("bit-identical on board and host: {summary}");
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
    assert!(count(|cell| cell.altitude_m.is_none()) > 5);
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
        let ended = replay(drive);
        assert_eq!(ended.status, Some(1), "{}", ended.stderr);
        assert!(ended.stderr.contains(reason), "{:?}", ended.stderr);
        assert_eq!(ended.log, Vec::<String>::new());
    }
}
