//! Pages that no drive leaves, with checksums that fit them: the flash memory of another program.

use super::flash::TestFlash;
use super::journey::{Journey, Seen};
use super::tracks::{Drive, Road, driven, known};
use estimator_core::roadmap::format::checksum;
use estimator_core::roadmap::memory::{MAGIC, MemoryError, PageKey, SECTOR_BYTES};
use estimator_core::roadmap::{MapError, MapMatch, PackedMap};
use test_kit::varint::{signed, unsigned};

/// Places in a page, from the table in docs/road-memory.md.
const LENGTH: usize = 6;
const ERASES: usize = 8;
const SEQUENCE: usize = 12;
const SLOT: usize = 16;
const BLOCKS: usize = 27;
const FIRST: usize = 40;
/// Step to the north from one cell to the next: 2.5 m in 10⁻⁷ degrees.
const CELL_E7: i32 = 225;
const CELLS: u32 = 128;

const ROAD: Road = Road::new(1, 1_500);

fn image() -> TestFlash {
    (0..2).fold(TestFlash::blank(8), |flash, seed| {
        driven(flash, Drive::over(ROAD, seed)).0
    })
}

fn number(page: &[u8], at: usize) -> u32 {
    u32::from_le_bytes(page[at..at + 4].try_into().expect("four bytes"))
}

/// Writes bytes to a page, and the checksum that belongs to it then.
fn change(page: &mut [u8], at: usize, bytes: &[u8]) {
    page[at..at + bytes.len()].copy_from_slice(bytes);
    let length = usize::from(u16::from_le_bytes([page[LENGTH], page[LENGTH + 1]]));
    let sum = checksum(&page[..length]).to_le_bytes();
    page[length..length + 4].copy_from_slice(&sum);
}

fn pages(flash: &mut TestFlash) -> impl Iterator<Item = &mut [u8]> {
    let sectors = flash.bytes.chunks_mut(SECTOR_BYTES);
    sectors.filter(|sector| sector.starts_with(&MAGIC))
}

#[test]
fn a_memory_without_a_free_sector_says_so() {
    let mut source = image();
    let page = pages(&mut source).next().expect("a page").to_vec();
    let mut flash = TestFlash::blank(8);
    for (slot, sector) in (0_u16..).zip(flash.bytes.chunks_mut(SECTOR_BYTES)) {
        sector.copy_from_slice(&page);
        change(sector, SLOT, &slot.to_le_bytes());
    }
    let mut memory = flash.open();
    assert_eq!(memory.opened().pages, 8);
    assert_eq!(memory.level(), Ok(false));
    assert!(
        Drive::over(Road::new(2, 1_000), 3)
            .with(&mut memory)
            .has_failed
    );
    assert_eq!(memory.close(), Err(MemoryError::Size));
    assert_eq!(memory.counters().writes, 0);
}

#[test]
fn a_page_that_was_damaged_since_is_not_moved_to_a_worn_sector() {
    let mut flash = image();
    // The older copy of a page: its sector is free, and worn.
    let older = pages(&mut flash)
        .min_by_key(|page| number(page, SEQUENCE))
        .expect("a page");
    let sequence = number(older, SEQUENCE);
    change(older, ERASES, &1_000_u32.to_le_bytes());
    for is_damaged in [false, true] {
        let mut memory = flash.clone().open();
        assert!(memory.erases().any(|erases| erases == 1_000));
        if is_damaged {
            for page in pages(memory.flash_mut()).filter(|page| number(page, SEQUENCE) != sequence)
            {
                page[100] ^= 1;
            }
        }
        assert_eq!(memory.level(), Ok(!is_damaged));
        assert_eq!(memory.erases().any(|erases| erases == 1_001), !is_damaged);
    }
}

#[test]
fn a_page_whose_length_was_damaged_since_is_not_taken_into_ram() {
    let road = Road::new(1, 1_000);
    let mut memory = driven(TestFlash::blank(8), Drive::over(road, 1)).0.open();
    for page in pages(memory.flash_mut()) {
        // Without joins, and up to the end of the sector: more than a page holds.
        assert_eq!(page[26], 0);
        page[LENGTH..LENGTH + 2].copy_from_slice(&4_096_u16.to_le_bytes());
    }
    let drive = Drive::over(road, 2).with(&mut memory);
    assert!(
        drive.errors.len() > 800,
        "its blocks are whole: they are read"
    );
    assert_eq!(memory.counters().cells_fused, 0);
    assert!(memory.counters().cells_left_out > 800);
}

#[test]
fn a_page_of_a_slot_that_the_memory_does_not_have_is_damaged() {
    let mut flash = image();
    let count = pages(&mut flash).count() as u32;
    pages(&mut flash).for_each(|page| change(page, SLOT, &8_u16.to_le_bytes()));
    let memory = flash.open();
    assert_eq!((memory.opened().pages, memory.opened().damaged), (0, count));
    assert!(known(&memory).is_empty());
}

#[test]
fn a_page_with_fewer_blocks_than_bytes_ends_with_its_blocks() {
    let road = Road::new(1, 1_000);
    let (mut flash, _) = driven(TestFlash::blank(8), Drive::over(road, 1));
    let whole = known(&flash.clone().open()).len();
    for page in pages(&mut flash) {
        let blocks = page[BLOCKS] - 1;
        change(page, BLOCKS, &[blocks]);
    }
    let memory = flash.open();
    let left = known(&memory).len();
    assert!(left < whole && left + 128 >= whole, "{left} of {whole}");
    let map = PackedMap::of_memory(memory.view());
    let way = map.ways().next().expect("a way").expect("a way");
    assert_eq!(memory.view().block_at(way.offset, way.last_cell + 1), None);
    assert!(memory.view().block_at(way.offset, way.last_cell).is_some());
}

#[test]
fn blocks_of_any_length_are_no_panic() {
    let mut source = image();
    let page = pages(&mut source).next().expect("a page").to_vec();
    let joins = usize::from(page[BLOCKS - 1]);
    let mut at = FIRST + 16 * joins;
    for _ in 0..page[BLOCKS] {
        let length = u16::from_le_bytes([page[at], page[at + 1]]);
        for wrong in [0, 1, length - 1, length + 1, 2_000, u16::MAX] {
            let mut flash = image();
            for page in pages(&mut flash) {
                change(page, at, &wrong.to_le_bytes());
            }
            let mut memory = flash.open();
            Drive::over(ROAD, 4).with(&mut memory);
        }
        at += usize::from(length);
    }
}

#[test]
fn a_page_that_is_damaged_under_the_vehicle_is_passed_over() {
    let mut memory = image().open();
    let mut journey = Journey::new(&mut memory);
    journey.over(&ROAD, 0..20);
    for page in pages(journey.memory.flash_mut()) {
        page[LENGTH + 1] = 0xff;
    }
    journey.over(&ROAD, 20..500);
    assert_eq!(journey.memory.place(), MapMatch::Off);
}

#[test]
fn a_road_that_vanishes_under_the_vehicle_is_lost_and_no_more() {
    let road = Road::new(1, 1_000);
    let mut memory = driven(TestFlash::blank(8), Drive::over(road, 1)).0.open();
    let mut journey = Journey::new(&mut memory);
    journey.over(&road, 0..400);
    assert!(matches!(journey.memory.place(), MapMatch::On(_)));
    for page in pages(journey.memory.flash_mut()) {
        page[SLOT] ^= 1;
    }
    journey.over(&road, 400..401);
    assert_eq!(journey.memory.place(), MapMatch::Off);
    assert_eq!(journey.memory.grade(), None);
    journey.over(&road, 401..700);
    assert_eq!(journey.memory.place(), MapMatch::Off);
}

#[test]
fn a_way_is_named_by_its_first_block() {
    let memory = image().open();
    let view = memory.view();
    let (mut ways, mut others) = (0, 0);
    for page in view.pages() {
        for block in page.blocks() {
            if block.way == block.offset {
                assert_eq!(view.way(block.offset).expect("a way").address, block.way);
                ways += 1;
            } else {
                assert_eq!(view.way(block.offset), Err(MapError::Content));
                others += 1;
            }
        }
    }
    assert!(ways > 0 && others > 5, "{ways} {others}");
}

fn with_checksum(mut record: Vec<u8>) -> Vec<u8> {
    let length = (record.len() as u16 + 4).to_le_bytes();
    record[..2].copy_from_slice(&length);
    let sum = checksum(&record).to_le_bytes();
    record.extend(sum);
    record
}

/// Returns a block of a road to the north with a point in each `point_cells`, with or without grades.
fn block(key: PageKey, point_cells: u32, has_grades: bool) -> Vec<u8> {
    let mut block = vec![0, 0, CELLS as u8, 0];
    block.extend(key.block(0).to_le_bytes());
    for number in [0_i32, 1_000_000, 20_000_000] {
        block.extend(number.to_le_bytes());
    }
    let points = (CELLS - 1) / point_cells;
    block.extend((points as u16).to_le_bytes());
    for _ in 0..points {
        unsigned(&mut block, point_cells);
        signed(&mut block, CELL_E7 * point_cells as i32 / 10);
        signed(&mut block, 0);
    }
    if has_grades {
        unsigned(&mut block, 3_u32);
        unsigned(&mut block, CELLS);
        block.extend([100; 8]);
        signed(&mut block, 400);
        (1..CELLS).for_each(|_| signed(&mut block, 0));
    }
    with_checksum(block)
}

/// Returns a flash memory with a page of one block.
fn flash_of(key: PageKey, block: &[u8]) -> TestFlash {
    let mut page = MAGIC.to_vec();
    let length = 40 + block.len() as u16;
    page.extend(1_u16.to_le_bytes());
    page.extend(length.to_le_bytes());
    for number in [1_u32, 1] {
        page.extend(number.to_le_bytes());
    }
    page.extend(key.slot.to_le_bytes());
    page.extend(key.generation.to_le_bytes());
    page.extend(1_u32.to_le_bytes());
    page.extend([1, 0, 0, 1]);
    // All tiles.
    page.extend([0, 0, 0, 0, 0xff, 0xff, 0xff, 0xff]);
    page.extend([0; 4]);
    page.extend(block);
    let sum = checksum(&page).to_le_bytes();
    page.extend(sum);
    let mut flash = TestFlash::blank(8);
    flash.bytes[..page.len()].copy_from_slice(&page);
    flash
}

#[test]
fn a_block_that_does_not_fit_the_ram_is_read_and_not_changed() {
    let key = PageKey {
        slot: 0,
        generation: 1,
    };
    // As this program writes it; with more points; without grades.
    for (point_cells, has_grades, is_changed) in
        [(8, true, true), (2, true, false), (8, false, false)]
    {
        let flash = flash_of(key, &block(key, point_cells, has_grades));
        let mut memory = flash.open();
        assert_eq!(memory.opened().pages, 1, "{:?}", memory.opened());
        let mut journey = Journey::new(&mut memory);
        let (mut is_on, mut is_known) = (false, false);
        for cell in 0..120 {
            journey.step(&Seen {
                position_e7: (1_000_000 + cell * CELL_E7, 20_000_000),
                grade_percent: 2.0,
                altitude_m: None,
            });
            is_on |= matches!(journey.memory.place(), MapMatch::On(_));
            is_known |= journey.memory.grade().is_some();
        }
        assert!(is_on);
        assert_eq!(is_known, has_grades);
        journey.finish();
        let counters = memory.counters();
        let (fused, left_out) = (counters.cells_fused, counters.cells_left_out);
        assert_eq!(fused > 80, is_changed, "{counters:?}");
        assert_eq!(left_out > 80, !is_changed, "{counters:?}");
        memory.close().expect("a write");
        if has_grades {
            let runs: Vec<u32> = known(&memory).values().map(|known| known.runs).collect();
            assert_eq!(runs.contains(&4), is_changed);
        }
    }
}
