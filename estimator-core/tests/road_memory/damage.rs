//! Damaged flash, and flash of another release.

use super::flash::{InPieces, TestFlash};
use super::tracks::{Drive, Road, check_right, driven, known};
use estimator_core::roadmap::memory::{MAGIC, RoadMemory, SECTOR_BYTES, Sector};
use proptest::prelude::*;

const ROAD: Road = Road::new(1, 1_500);

fn image() -> TestFlash {
    let mut flash = TestFlash::blank(8);
    for seed in 0..2 {
        flash = driven(flash, Drive::over(ROAD, seed)).0;
    }
    flash
}

#[test]
fn each_flipped_byte_is_found() {
    let flash = image();
    let mut found = 0;
    for at in 0..flash.bytes.len() {
        let mut damaged = flash.clone();
        damaged.bytes[at] ^= 1 << (at % 8);
        let memory = damaged.open();
        if memory.opened().damaged + memory.opened().other_version == 0 {
            // An erased byte, or one of a copy that is free.
            continue;
        }
        let cells = known(&memory);
        check_right(&cells, &[ROAD]);
        assert!(memory.opened().pages > 0 || cells.is_empty());
        found += 1;
    }
    assert!(found > 2_000, "{found}");
}

#[test]
fn damage_while_the_memory_is_open_is_no_panic() {
    let flash = image();
    for at in (0..flash.bytes.len()).step_by(61) {
        let mut memory = flash.clone().open();
        memory.flash_mut().bytes[at] ^= 0x55;
        let short = Road::new(1, 400);
        Drive::over(short, 3).with(&mut memory);
    }
}

#[test]
fn pages_of_another_release_are_kept_and_not_read() {
    let (mut other, _) = driven(TestFlash::blank(16), Drive::over(ROAD, 1));
    let mut count = 0;
    for sector in other.bytes.chunks_mut(SECTOR_BYTES) {
        if sector.starts_with(&MAGIC) {
            sector[4] += 1;
            count += 1;
        }
    }
    let memory = other.clone().open();
    assert_eq!(memory.opened().pages, 0);
    assert_eq!(memory.opened().other_version, count);
    assert!(known(&memory).is_empty());
    // A drive writes beside them as long as there is room.
    let (after, drive) = driven(other.clone(), Drive::over(Road::new(2, 600), 5));
    assert!(drive.errors.is_empty());
    let is_kept = |sector: usize| {
        let range = sector * SECTOR_BYTES..(sector + 1) * SECTOR_BYTES;
        after.bytes[range.clone()] == other.bytes[range]
    };
    let foreign = (0..16).filter(|sector| other.bytes[sector * SECTOR_BYTES..].starts_with(&MAGIC));
    assert!(foreign.clone().count() > 1 && foreign.clone().all(is_kept));
    // Then they make room, before any road does.
    let (after, _) = driven(after, Drive::over(Road::new(3, 34_000), 6));
    let memory = after.open();
    assert_eq!(memory.opened().other_version, 0);
    assert!(known(&memory).len() > 20_000);
}

#[test]
fn a_flash_full_of_pages_of_another_release_is_used_again() {
    let (mut full, _) = driven(TestFlash::blank(16), Drive::over(Road::new(1, 34_000), 1));
    let (page, free) = {
        let sectors = full.bytes.chunks(SECTOR_BYTES);
        let (pages, free): (Vec<_>, Vec<_>) =
            sectors.partition(|sector| sector.starts_with(&MAGIC));
        (pages[0].to_vec(), free.len())
    };
    assert!(free <= 3, "{free}");
    for sector in full.bytes.chunks_mut(SECTOR_BYTES) {
        sector.copy_from_slice(&page);
        sector[4] += 1;
    }
    assert_eq!(full.clone().open().opened().other_version, 16);
    let (after, drive) = driven(full, Drive::over(ROAD, 1));
    assert!(!drive.has_failed, "{:?}", drive.errors);
    let memory = after.open();
    assert!(memory.opened().other_version >= 12);
    assert!(known(&memory).len() > 1_400);
}

#[test]
fn a_worn_sector_is_left_alone() {
    let mut flash = TestFlash::blank(8);
    flash.worn = Some(0);
    let mut memory = flash.open();
    let drive = Drive::over(ROAD, 1);
    // A write fails, and is tried again elsewhere.
    assert!(drive.with(&mut memory).has_failed);
    assert_eq!(memory.counters().write_failures, 1);
    assert!(!drive.with(&mut memory).has_failed);
    assert!(known(&memory).len() > 1_400);
}

#[test]
fn other_sizes_are_refused() {
    for (sectors, ram) in [(7, 7), (4097, 4097), (16, 15)] {
        let flash = TestFlash::blank(sectors);
        assert!(RoadMemory::open(flash, vec![Sector::default(); ram]).is_err());
    }
    // Sectors are erased one by one, and written 256 bytes at once.
    let sectors = || vec![Sector::default(); 16];
    let flash = || TestFlash::blank(16);
    assert!(RoadMemory::open(InPieces::<4_096, 256>(flash()), sectors()).is_ok());
    assert!(RoadMemory::open(InPieces::<1_024, 4>(flash()), sectors()).is_ok());
    assert!(RoadMemory::open(InPieces::<8_192, 256>(flash()), sectors()).is_err());
    assert!(RoadMemory::open(InPieces::<4_096, 512>(flash()), sectors()).is_err());
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn any_bytes_are_a_memory(
        bytes in prop::collection::vec(any::<u8>(), 200),
        at in 0_usize..8 * SECTOR_BYTES - 200,
    ) {
        let mut flash = image_once().clone();
        flash.bytes[at..at + 200].copy_from_slice(&bytes);
        // What is free may hold anything.
        let memory = flash.open();
        check_right(&known(&memory), &[ROAD]);
    }

    #[test]
    fn any_drives_leave_a_sound_memory(
        drives in prop::collection::vec((1_i32..6, 100_u32..3_000, any::<bool>()), 1..8),
    ) {
        let mut flash = TestFlash::blank(10);
        let roads: Vec<Road> = (1..6).map(|number| Road::new(number, 3_000)).collect();
        for (seed, (number, cells, is_rough)) in drives.into_iter().enumerate() {
            let drive = Drive {
                is_rough,
                ..Drive::over(Road::new(number, cells), seed as u32)
            };
            flash = driven(flash, drive).0;
        }
        check_right(&known(&flash.open()), &roads);
    }
}

fn image_once() -> &'static TestFlash {
    static IMAGE: std::sync::OnceLock<TestFlash> = std::sync::OnceLock::new();
    IMAGE.get_or_init(image)
}
