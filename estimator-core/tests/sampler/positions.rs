//! Positions of cells: on the line through the last two fixes, as far as they reach.

use estimator_core::{Signal, Value};
use test_kit::by_force;
use test_kit::readings_drive::ReadingsDrive;

/// 10⁻⁷ degrees of a metre along the equator.
const E7_PER_M: f64 = 89.83;
const TURN_E7: i64 = 3_600_000_000;
const SPEED_MPS: f32 = 20.0;

/// Returns the readings of a tenth of a second at the equator, with a fix if there is one.
fn tenth(longitude_e7: Option<i32>) -> Vec<(Signal, Value)> {
    let mut readings = Vec::new();
    if let Some(longitude_e7) = longitude_e7 {
        readings.push((Signal::Latitude, Value::DegreesE7(0)));
        readings.push((Signal::Longitude, Value::DegreesE7(longitude_e7)));
    }
    readings.push((Signal::TractionForce, Value::Real(4_000.0)));
    readings.push((Signal::WheelSpeed, Value::Real(SPEED_MPS)));
    readings
}

/// Drives so many seconds along the equator, with a fix every second. `way` is its sign towards the
/// east. Returns the drive and the longitude of its end.
fn driven(seconds: u32, from_e7: i64, way: f64) -> (ReadingsDrive, i32) {
    let mut drive = ReadingsDrive::of(by_force());
    let mut here_e7 = 0;
    for tick in 0..10 * seconds {
        let metres = 0.1 * f64::from(tick) * f64::from(SPEED_MPS);
        here_e7 = round_the_earth(from_e7 + (way * metres * E7_PER_M) as i64);
        drive.on_values(0.1, &tenth((tick % 10 == 0).then_some(here_e7)));
    }
    (drive, here_e7)
}

fn round_the_earth(longitude_e7: i64) -> i32 {
    ((longitude_e7 + TURN_E7 / 2).rem_euclid(TURN_E7) - TURN_E7 / 2) as i32
}

/// Returns the way between two longitudes, the short way round, m.
fn apart_m(a_e7: i32, b_e7: i32) -> f64 {
    f64::from(round_the_earth(i64::from(a_e7) - i64::from(b_e7))).abs() / E7_PER_M
}

#[test]
fn a_cell_has_no_position_far_behind_the_last_fix() {
    let (mut drive, _) = driven(10, 100_000_000, 1.0);
    let fixed_m = drive.samples.last().unwrap().end.distance_m();
    for sample in drive.on_values(20.0, &tenth(None)) {
        let behind_m = sample.end.distance_m() - fixed_m;
        // The last fix came some 20 m before.
        let is_known = sample.end.position_e7.is_some();
        if behind_m < 150.0 {
            assert!(is_known, "{behind_m} m");
        } else if behind_m > 210.0 {
            assert!(!is_known, "{behind_m} m");
        }
    }
}

#[test]
fn positions_go_on_over_the_date_line() {
    for (from_e7, way) in [(1_799_982_000, 1.0), (-1_799_982_000, -1.0)] {
        let (drive, _) = driven(20, from_e7, way);
        let mut signs = Vec::new();
        for sample in &drive.samples {
            let Some((latitude_e7, longitude_e7)) = sample.end.position_e7 else {
                continue;
            };
            let metres = way * sample.end.distance_m();
            let there_e7 = round_the_earth(from_e7 + (metres * E7_PER_M) as i64);
            assert_eq!(latitude_e7, 0);
            // Where the line lies between two fixes, the newer one stands for both.
            let off_m = apart_m(longitude_e7, there_e7);
            assert!(off_m < 25.0, "{off_m} m at {there_e7}");
            signs.push(longitude_e7.signum());
        }
        signs.dedup();
        assert_eq!(signs.len(), 2, "it crosses the line once: {signs:?}");
    }
}

/// Returns the number of cells that do not follow the last one, of a stand and the way behind it. The
/// vehicle is moved by so many metres while it stands.
fn gaps_after(carried_m: i32) -> usize {
    let (mut drive, here_e7) = driven(20, 100_000_000, 1.0);
    let at = |metres: f64, mps: f32| {
        let longitude_e7 = here_e7 + (metres * E7_PER_M) as i32;
        let mut readings = tenth(Some(longitude_e7));
        readings.retain(|(signal, _)| *signal != Signal::WheelSpeed);
        readings.push((Signal::WheelSpeed, Value::Real(mps)));
        readings
    };
    for second in 0..100 {
        let metres = f64::from(carried_m * second) / 100.0;
        drive.on_values(1.0, &at(metres, 0.0));
    }
    let before = drive.samples.len();
    for tick in 0..100 {
        let metres = f64::from(carried_m) + 0.2 * f64::from(tick);
        drive.on_values(0.1, &at(metres, 2.0));
    }
    let behind = &drive.samples[before..];
    assert!(behind.len() > 4, "{}", behind.len());
    behind.iter().filter(|sample| sample.gap_cells > 0).count()
}

#[test]
fn a_vehicle_that_is_carried_while_its_wheels_stand_begins_anew() {
    assert_eq!(gaps_after(0), 0);
    // Fixes of a vehicle that stands wander.
    assert_eq!(gaps_after(150), 0);
    assert_eq!(gaps_after(800), 1);
    assert_eq!(gaps_after(4_000), 1);
}
