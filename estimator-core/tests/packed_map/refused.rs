//! Content that no map has, below a checksum that fits it.

use super::file::{TestWay, length_of, packed, with_bytes};
use super::{WAYS, before_the_exit, known_cell, live, read_all};
use estimator_core::roadmap::{MapError, MapLive, PackedMap};

/// Bytes of a join.
const JOIN: usize = 20;

#[test]
fn impossible_numbers_are_refused() {
    let bytes = packed(&WAYS);
    let map = PackedMap::open(&bytes).unwrap();
    let road = map.ways().next().unwrap().unwrap();
    let (way, block) = (road.offset as usize, road.first_block as usize);
    let number = |number: i32| number.to_le_bytes().to_vec();
    let cases = [
        ("the direction of a way", way, 2, vec![3]),
        ("a name that is no text", way, 28, vec![0xff]),
        ("a block without cells", block, 2, vec![0]),
        ("a block of too many cells", block, 2, vec![129]),
        ("a flag of altitudes", block, 3, vec![2]),
        ("cells beyond all numbers", block, 8, number(i32::MAX)),
        ("a latitude to the north", block, 12, number(900_000_001)),
        ("a latitude to the south", block, 12, number(-900_000_001)),
        (
            "a latitude without a magnitude",
            block,
            12,
            number(i32::MIN),
        ),
        ("a longitude to the east", block, 16, number(1_800_000_001)),
        ("a longitude to the west", block, 16, number(-1_800_000_001)),
    ];
    for (what, record, at, wrong) in cases {
        let length = length_of(&bytes, record);
        let damaged = with_bytes(&bytes, record, length, at, &wrong);
        assert_eq!(read_all(&damaged), Err(MapError::Content), "{what}");
    }
    // The same bytes with the same checksum are a map.
    let same = with_bytes(&bytes, block, length_of(&bytes, block), 3, &[0]);
    assert_eq!(same, bytes);
}

#[test]
fn an_offset_outside_of_the_blocks_is_no_block() {
    let bytes = packed(&WAYS);
    let map = PackedMap::open(&bytes).unwrap();
    for offset in [0, 64, bytes.len() as u32, u32::MAX] {
        assert_eq!(map.block(offset).err(), Some(MapError::Content), "{offset}");
    }
}

#[test]
fn a_block_whose_plan_ends_before_its_cells_is_passed() {
    let road = TestWay {
        cells: 900,
        joins: &[],
        ..WAYS[0]
    };
    let bytes = packed(&[road]);
    let map = PackedMap::open(&bytes).unwrap();
    let way = map.ways().next().unwrap().unwrap();
    let second = map.blocks(&way).nth(1).unwrap().unwrap().offset as usize;
    // Its only point besides the first one is 64 cells away, in as many bytes as 128 take.
    let length = length_of(&bytes, second);
    let short = with_bytes(&bytes, second, length, 22, &[0xc0, 0]);
    let mut on_map = MapLive::new(PackedMap::open(&short).unwrap());
    (0..900).for_each(|cell| on_map.advance(&live(&road, cell, cell as u32)));
    let cell = known_cell(&on_map, "road").expect("a place");
    assert!((cell - 899.0).abs() < 8.0, "{cell}");
}

#[test]
fn a_join_that_leads_into_nothing_is_not_followed() {
    let bytes = packed(&WAYS);
    let map = PackedMap::open(&bytes).unwrap();
    let road = map.ways().next().unwrap().unwrap();
    let exit = map.joins(&road).next().unwrap().unwrap();
    let other_block = map.ways().last().unwrap().unwrap().first_block;
    // A block of another way, and one that is damaged.
    let first_join = bytes[road.offset as usize + 20..][..4].try_into().unwrap();
    let at = u32::from_le_bytes(first_join) as usize;
    let misled = with_bytes(&bytes, at, JOIN, 12, &other_block.to_le_bytes());
    let mut broken = bytes.clone();
    broken[exit.to_block as usize + 30] ^= 1;
    for (bytes, possible) in [(misled, &["road", "exit"][..]), (broken, &["road"])] {
        let mut on_map = before_the_exit(&bytes);
        for cell in 100..380 {
            on_map.advance(&live(&WAYS[0], cell, cell as u32));
            let matcher = on_map.matcher();
            for place in matcher.hypotheses().collect::<Vec<_>>() {
                let way = matcher.map().way(place.way).unwrap();
                let name = way.name().unwrap();
                assert!(possible.contains(&name), "{name} at {cell}");
            }
        }
        let cell = known_cell(&on_map, "road").expect("a place");
        assert!((cell - 379.0).abs() < 8.0, "{cell}");
    }
}
