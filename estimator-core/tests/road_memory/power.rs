//! Power that is lost at any write or erase.

use super::flash::TestFlash;
use super::tracks::{Drive, MINUTE_CELLS, Road, check_right, driven, known};

const OLD: Road = Road::new(1, 1_700);
const NEW: Road = Road::new(2, 1_700);

/// Drives until the power is lost at an operation, and checks what is left. Returns false if the drive
/// ended before.
fn survives(before: &TestFlash, drive: Drive, operation: usize, part: u8) -> bool {
    let mut flash = before.clone();
    flash.operations = 0;
    flash.cut = Some((operation, part));
    let mut memory = flash.open();
    let driven = drive.with(&mut memory);
    let torn = TestFlash::of(memory.into_flash().bytes);
    let memory = torn.open();
    let cells = known(&memory);
    check_right(&cells, &[OLD, NEW]);
    // The road of before is whole.
    let old = cells.range((1, 0)..(2, 0)).count();
    assert!(old + 30 > OLD.cells as usize, "{old} cells of the old road");
    // Of this one, no more than the last minute is lost, and what is on the way to a place.
    if drive.road.number == NEW.number {
        let new = cells.range((2, 0)..(3, 0)).count() as u32;
        let written = driven.finished.saturating_sub(MINUTE_CELLS);
        assert!(new + 20 >= written, "{new} of {} cells", driven.finished);
    }
    // And it goes on.
    let mut memory = memory;
    assert!(!drive.with(&mut memory).has_failed);
    check_right(&known(&memory), &[OLD, NEW]);
    driven.has_failed
}

fn cut_everywhere(drive: Drive) {
    let (before, _) = driven(TestFlash::blank(12), Drive::over(OLD, 1));
    let mut operation = 0;
    loop {
        let parts = [0, (operation * 37 % 253 + 1) as u8, 255];
        let has_failed = parts.map(|part| survives(&before, drive, operation, part));
        if has_failed.iter().all(|has_failed| !has_failed) {
            break;
        }
        operation += 1;
    }
    assert!(operation > 20, "{operation} operations");
}

#[test]
fn a_new_road_loses_the_last_minute_at_most() {
    cut_everywhere(Drive::over(NEW, 2));
}

#[test]
fn a_known_road_stays_known() {
    cut_everywhere(Drive::over(OLD, 2));
}

#[test]
fn a_write_comes_once_a_minute() {
    let (flash, drive) = driven(TestFlash::blank(12), Drive::over(Road::new(1, 9_000), 1));
    let (_, again) = driven(flash, Drive::over(Road::new(1, 9_000), 2));
    for drive in [drive, again] {
        // A page has 17: it is written in shares, so that no cell waits for it.
        assert!(
            (1..=4).contains(&drive.most_operations),
            "{}",
            drive.most_operations
        );
        assert!(drive.writes.len() >= 12, "{:?}", drive.writes);
        for pair in drive.writes.windows(2) {
            assert!(pair[1] - pair[0] >= MINUTE_CELLS, "{:?}", drive.writes);
        }
    }
}
