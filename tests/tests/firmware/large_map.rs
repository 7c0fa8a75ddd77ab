//! The map of a country takes the same bounded work as that of a road.

use crate::matches_host::board_is_missing;
use cross_tests::budgets::{CORTEX_M4F, counts_with_map};
use cross_tests::drive::{drive, truck};
use cross_tests::drive_map::drive_map;
use cross_tests::emulator::on_host_with_map;
use cross_tests::large_map::repeated;
use estimator_core::roadmap::{PackedMap, Tile};
use firmware::exchange::on_map::ON_MAP_BYTES;

/// Least length of the ways of two maps of the drive, km.
const OF_TWO_KM: u32 = 14;
/// Memory of the emulated board for a map, bytes.
const BOARD_BYTES: usize = 16 << 20;

/// Returns what the map gave at each step, without the offset of the way.
fn steps(map: &PackedMap<'_>) -> Vec<Vec<u8>> {
    let steps = on_host_with_map(&truck(), &drive(), *map);
    let without_offset = |step: &[u8]| [&step[..8], &step[12..]].concat();
    steps.chunks(ON_MAP_BYTES).map(without_offset).collect()
}

#[test]
fn a_drive_on_100_000_km_is_matched_as_on_its_own_map() {
    let small = drive_map();
    let large = repeated(&small, 2 * 100_000 / OF_TWO_KM);
    let (small, large) = (
        PackedMap::open(&small).unwrap(),
        PackedMap::open(&large).unwrap(),
    );
    let ways = large.ways().map(|way| way.expect("a sound way"));
    let cells: i64 = ways
        .map(|way| i64::from(way.last_cell - way.first_cell))
        .sum();
    println!("{} km in {} MB", cells / 400, large.len() / 1_000_000);
    assert!(cells / 400 > 100_000 && large.len() < 90_000_000);
    assert_eq!(steps(&large), steps(&small));
    // As many blocks are found in each tile of the road, and none between the copies.
    let blocks = |map: &PackedMap<'_>, north: i32, east: i32| {
        let tile = Tile::of(557_000_000 + north, 131_000_000 + east);
        let found = map.blocks_in(tile).collect::<Result<Vec<_>, _>>();
        found.expect("sound pages").len()
    };
    for north in (0..400_000).step_by(65_536) {
        assert_eq!(blocks(&large, north, 0), blocks(&small, north, 0));
        assert!(blocks(&small, north, 0) > 0);
        assert_eq!(blocks(&large, north, 7 << 16), 0);
    }
}

/// Instructions are counted, on the largest map that the emulated board has memory for.
#[test]
fn a_large_map_takes_the_instructions_of_a_small_one() {
    if board_is_missing() {
        return;
    }
    let small = drive_map();
    let copies = (BOARD_BYTES - 200_000) / small.len();
    let large = repeated(&small, copies as u32);
    assert!((BOARD_BYTES / 2..BOARD_BYTES).contains(&large.len()));
    let [few, many] = [&small, &large].map(|map| counts_with_map(&CORTEX_M4F, map).unwrap());
    let km = copies as u32 * OF_TWO_KM / 2;
    for figure in [
        "map_step_mean",
        "map_step_worst",
        "ahead_mean",
        "ahead_worst",
    ] {
        let (few, many) = (few[figure], many[figure]);
        println!("{figure}: {few} on its own, {many} among {km} km");
        // Neighbouring tiles lie in one page of a small index, and in several of a large one. Each
        // page is checked: some 60 instructions a cell.
        assert!(
            few > 0 && many * 100 < few * 108,
            "{figure}: {few} and {many}"
        );
    }
}
