//! The estimate on the bus, as another listener receives it.

use crate::bus::{Vcan, wait_until};
use crate::drive::{VcanDrive, replay};
use crate::listener::Listener;
use crate::peers::candump;
use host_sim::files::run::{self, RunRow};
use host_sim::map::{MapRow, WayRows, packed_map};
use std::fs;
use std::path::Path;

/// Filter of candump: the estimate in `grade.dbc`, from address 254.
const FILTER: &str = ",18FF46FE:1FFFFEFF,18FF49FE:1FFFFFFF";
const LIVE: &str = "18FF46FE";
const CELL: &str = "18FF47FE";
const STATUS: &str = "18FF49FE";

const PCC1: &str = "18F0D3FE";
const AHEAD: &str = "18FF4AFE";

/// Returns the payloads of one message in a recording.
fn payloads(recording: &Path, id: &str) -> Vec<[u8; 8]> {
    let text = fs::read_to_string(recording).unwrap();
    // The last line of candump may be incomplete.
    let whole = text.rsplit_once('\n').map_or("", |(whole, _)| whole);
    whole
        .lines()
        .filter_map(|line| line.split(' ').nth(2)?.strip_prefix(id)?.strip_prefix('#'))
        .map(|data| u64::from_str_radix(data, 16).unwrap().to_be_bytes())
        .collect()
}

fn word(data: &[u8; 8], at: usize) -> f64 {
    f64::from(u16::from_le_bytes([data[at], data[at + 1]]))
}

fn check_cell(data: &[u8; 8], rows: &[RunRow]) {
    let number = u32::from_le_bytes([data[0], data[1], data[2], 0]);
    let distance_m = 2.5 * f64::from(number);
    let is_it = |row: &&RunRow| (row.distance_m - distance_m).abs() < 0.1;
    let row = rows.iter().find(is_it).unwrap();
    let grade = word(data, 3) * 0.002 - 64.0;
    assert!(
        (grade - row.lagged_grade_percent).abs() < 0.002,
        "at {distance_m} m"
    );
    let sigma = 0.02 * f64::from(data[5]);
    assert!((sigma - row.lagged_grade_sigma_percent).abs() < 0.011);
}

/// A drive of 3 s without a fault has a status each second, which says so.
fn check_statuses(statuses: &[[u8; 8]], rows: &[RunRow]) {
    let known: Vec<_> = statuses.iter().filter(|data| **data != [0xff; 8]).collect();
    assert!(known.len() >= 2, "{} statuses", statuses.len());
    let suspect = rows.iter().any(|row| row.lagged_consistent == 0);
    for data in &known {
        let (mass_kg, sigma_kg) = (10.0 * word(data, 2), 10.0 * word(data, 4));
        let end_kg = rows.last().and_then(|row| row.mass_kg).unwrap();
        assert!((mass_kg - end_kg).abs() < 3.0 * sigma_kg, "{mass_kg} kg");
        assert!(suspect || word(data, 6) == 0.0);
    }
    // Consistent, and nothing disagrees.
    assert_eq!(known[0][0], 1);
}

#[test]
#[ignore = "needs a CAN interface: tests/run vcan"]
fn the_estimate_is_sent_with_each_finished_cell_and_not_read_back() {
    let vcan = Vcan::new("rgpub");
    let drive = VcanDrive::new("A", 1_200.0);
    let recording = drive.file("candump.log");
    let candump = candump(&vcan, FILTER, &recording);
    let options = [
        "--log-time",
        "--out",
        "live.csv",
        "--publish",
        "--address",
        "254",
    ];
    let listener = Listener::start(&drive, &[vcan.0], &options);
    replay(vcan.0, &drive.log(), &["--log-time", "--speed", "20"]);
    let output = listener.finish();
    assert_eq!(output.frames(0), drive.frames.len() as u64);

    // The cells that had the full lag when the log ended.
    let finished = output.lines.last().unwrap()["cells"].as_u64().unwrap() as usize;
    assert!(finished > 100);
    wait_until("candump has all", || {
        payloads(&recording, CELL).len() >= finished
    });
    drop(candump);
    let rows = run::read(&drive.file("live.csv")).unwrap();
    let cells = payloads(&recording, CELL);
    assert_eq!(cells.len(), finished);
    for cell in &cells {
        check_cell(cell, &rows);
    }

    let lives = payloads(&recording, LIVE);
    let known: Vec<_> = lives.iter().filter(|data| **data != [0xff; 8]).collect();
    assert!(known.len() > 5);
    for data in known {
        assert!((word(data, 0) * 0.002 - 64.0).abs() < 20.0);
    }
    check_statuses(&payloads(&recording, STATUS), &rows);
    println!(
        "{} estimates and {} cells on the bus",
        lives.len(),
        cells.len()
    );
    // `tests/vcan/decode.py` decodes this with the layout file.
    print!("{}", fs::read_to_string(&recording).unwrap());
}

/// Writes the map of the drive, made of its own run.
fn write_map(drive: &VcanDrive) {
    drive.estimate(&drive.log());
    let rows = run::read(&drive.file("estimated.csv")).unwrap();
    let rows = rows.iter().filter_map(|row| {
        Some(MapRow {
            distance_m: row.distance_m,
            latitude_deg: row.latitude_deg?,
            longitude_deg: row.longitude_deg?,
            altitude_m: row.altitude_m,
            grade_percent: row.grade_percent,
            grade_sigma_percent: 0.04,
            runs: 1,
        })
    });
    let way = WayRows {
        name: None,
        rows: rows.collect(),
    };
    fs::write(drive.file("map.grade"), packed_map(&[way]).unwrap()).unwrap();
}

#[test]
#[ignore = "needs a CAN interface: tests/run vcan"]
fn with_a_map_the_road_ahead_is_sent() {
    let vcan = Vcan::new("rgahead");
    let drive = VcanDrive::new("A", 1_200.0);
    write_map(&drive);
    let recording = drive.file("candump.log");
    let candump = candump(&vcan, ",18F0D3FE:1FFFFFFF,18FF4AFE:1FFFFFFF", &recording);
    let map = drive.file("map.grade");
    let map = map.to_str().unwrap();
    let options = ["--log-time", "--map", map, "--publish", "--address", "254"];
    let listener = Listener::start(&drive, &[vcan.0], &options);
    replay(vcan.0, &drive.log(), &["--log-time", "--speed", "20"]);
    let output = listener.finish();
    assert_eq!(output.frames(0), drive.frames.len() as u64);
    assert!(output.lines.iter().any(|line| line["map"]["state"] == "on"));
    wait_until("candump has some", || {
        payloads(&recording, AHEAD).len() >= 20
    });
    drop(candump);
    // `tests/vcan/decode.py` decodes this with the layout file.
    print!("{}", fs::read_to_string(&recording).unwrap());
    let ahead = payloads(&recording, AHEAD);
    // A branch begins, and its grades follow.
    assert_eq!(ahead[0][0] & 0xF, 0);
    let grades = ahead.iter().filter(|data| data[0] & 3 == 1);
    assert!(grades.clone().count() > 10);
    for data in grades {
        let grade = word(data, 2) * 0.002 - 64.0;
        assert!(data[2..4] == [0xFF; 2] || grade.abs() < 10.0, "{grade} %");
    }
    let next = payloads(&recording, PCC1);
    assert!(
        next.iter()
            .any(|data| data[3] != 0xFF && data[4] != 0xFF && data[6] != 0xFF)
    );
}
