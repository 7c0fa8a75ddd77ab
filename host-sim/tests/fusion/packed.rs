//! `roadgrade pack`: maps in the form that the vehicle reads, and back.

use super::save;
use estimator_core::roadmap::format::{HEADER, INDEX_PAGE, JOIN, checksum};
use estimator_core::roadmap::{MapError, PackedMap, Tile, WayDirection};
use host_sim::map::{GRID_M, MapRow, WayRows, packed_map, read_map_ways};
use predicates::str::contains;
use proptest::prelude::*;
use std::ops::Range;
use std::sync::LazyLock;
use test_kit::command::{folder, roadgrade};
use test_kit::roads::network::{map, network, way};
use test_kit::roads::{hills, reversed, run};

/// Returns three ways of the hills, the second in both directions, with a hole in the first.
fn ways() -> Vec<WayRows> {
    let spots = hills();
    let network = network(&[
        way("a", "yes", &spots[..=800]),
        way("way/7", "no", &spots[800..=1600]),
        way("c", "yes", &spots[1600..]),
    ]);
    let mut ways = map(&network, &[&run(&spots), &run(&reversed(&spots))]);
    ways[0].rows.drain(300..400);
    ways
}

fn length_km(ways: &[WayRows]) -> f64 {
    ways.iter().map(|way| way.rows.len()).sum::<usize>() as f64 * GRID_M * 1e-3
}

/// Returns the distance of two positions, m.
fn apart_m(a: &MapRow, b: &MapRow) -> f64 {
    let north = (a.latitude_deg - b.latitude_deg) * 111_200.0;
    let east = (a.longitude_deg - b.longitude_deg) * 111_200.0;
    north.hypot(east * a.latitude_deg.to_radians().cos())
}

#[test]
fn a_packed_map_is_the_map() {
    let folder = folder();
    let ways = ways();
    save(folder.path(), "map.parquet", &ways);
    roadgrade(
        folder.path(),
        &["pack", "map.parquet", "--out", "map.grade"],
    )
    .success()
    .stderr(contains("ways: 4"));
    let bytes = std::fs::metadata(folder.path().join("map.grade")).expect("file");
    assert!(bytes.len() as f64 <= 900.0 * length_km(&ways));
    roadgrade(folder.path(), &["export", "map.grade", "--out", "back.csv"]).success();
    for name in ["map.grade", "back.csv"] {
        let back = read_map_ways(&folder.path().join(name)).expect("read");
        assert_eq!(back.len(), ways.len());
        for (way, back) in ways.iter().zip(&back) {
            assert_eq!(
                (way.name.as_ref(), way.rows.len()),
                (back.name.as_ref(), back.rows.len())
            );
            for (row, back) in way.rows.iter().zip(&back.rows) {
                assert_eq!((row.distance_m, row.runs), (back.distance_m, back.runs));
                assert!((row.grade_percent - back.grade_percent).abs() < 0.003);
                let ratio = back.grade_sigma_percent / row.grade_sigma_percent;
                assert!((ratio - 1.0).abs() < 0.1, "sigma {ratio}");
                let altitudes = row.altitude_m.zip(back.altitude_m).expect("altitudes");
                assert!((altitudes.0 - altitudes.1).abs() < 0.1, "{altitudes:?}");
                assert!(apart_m(row, back) < 0.4);
            }
        }
    }
}

#[test]
fn the_index_finds_every_cell_and_joins_lead_on() {
    let ways = ways();
    let bytes = packed_map(&ways).expect("packed");
    let map = PackedMap::open(&bytes).expect("a map");
    let e7 = |degrees: f64| (degrees * 1e6).round() as i32 * 10;
    let offsets: Vec<u32> = map.ways().map(|way| way.expect("a way").offset).collect();
    for (way, &offset) in ways.iter().zip(&offsets) {
        for row in &way.rows {
            let cell = (row.distance_m / GRID_M) as i32;
            let tile = Tile::of(e7(row.latitude_deg), e7(row.longitude_deg));
            let found = map.blocks_in(tile).any(|block| {
                let block = map.block(block.expect("intact")).expect("a block");
                block.way == offset && (block.first_cell..=block.last_cell()).contains(&cell)
            });
            assert!(found, "{row:?}");
        }
    }
    assert_eq!(map.blocks_in(Tile::of(0, 0)).count(), 0);

    let first = map.way(offsets[0]).expect("a way");
    assert_eq!(
        (first.name().expect("a name"), first.direction),
        ("a", WayDirection::Forward)
    );
    let last = ways[0].rows.last().expect("rows");
    let joins: Vec<_> = map
        .joins(&first)
        .map(|join| join.expect("intact"))
        .collect();
    let [join] = joins[..] else {
        panic!("one join: {joins:?}")
    };
    let entered = map.way(join.to_way).expect("a way");
    assert_eq!(
        (entered.name().expect("a name"), entered.direction),
        ("way/7", WayDirection::Forward)
    );
    assert_eq!(f64::from(join.at_cell) * GRID_M, last.distance_m);
    let block = map.block(join.to_block).expect("a block");
    assert!(block.way == join.to_way && join.to_cell <= block.last_cell());
}

#[test]
fn damage_is_found_where_it_is_read() {
    let whole = packed_map(&ways()[..1]).expect("packed");
    let cells = |bytes: &[u8]| -> Result<Vec<_>, MapError> {
        let map = PackedMap::open(bytes)?;
        let mut cells = Vec::new();
        for way in map.ways() {
            let way = way?;
            let name = way.name()?;
            for block in map.blocks(&way) {
                let block = block?;
                cells.extend(block.cells()?.map(|cell| (name.to_owned(), cell)));
                cells.extend(block.points().map(|point| {
                    let cell = block.cells().ok().and_then(|mut cells| cells.next());
                    (format!("{point:?}"), cell.expect("a cell"))
                }));
            }
        }
        Ok(cells)
    };
    let expected = cells(&whole).expect("intact");
    for at in 0..whole.len() {
        let mut damaged = whole.clone();
        damaged[at] ^= 1 << (at % 8);
        match cells(&damaged) {
            Ok(read) => assert!(read == expected, "byte {at}"),
            Err(error) => assert!(at < 8 || error != MapError::Magic, "byte {at}: {error}"),
        }
        assert!(cells(&whole[..at]).is_err(), "cut off at {at}");
        let map = PackedMap::open(&damaged);
        for tile in [Tile::of(590_049_140, 172_694_200), Tile::of(0, 0)] {
            if let Ok(map) = &map {
                // No block that a damaged page names is read as another one.
                let _ = map
                    .blocks_in(tile)
                    .filter_map(|block| map.block(block.ok()?).ok())
                    .count();
            }
        }
    }
    let mut later = whole.clone();
    later[4] = 2;
    assert_eq!(PackedMap::open(&later).err(), Some(MapError::Version(2)));
    // Flash behind the map is erased, not missing.
    let mut in_flash = whole.clone();
    in_flash.resize(whole.len() + 4096, 0xff);
    assert_eq!(cells(&in_flash).expect("intact"), expected);
}

#[test]
fn ways_of_several_maps_have_one_name_each() {
    let folder = folder();
    let mut rows = ways().remove(0);
    rows.name = None;
    save(folder.path(), "north.csv", &[rows.clone()]);
    save(folder.path(), "south.csv", &[rows]);
    let pack = |arguments: &[&str]| roadgrade(folder.path(), &[&["pack"][..], arguments].concat());
    pack(&["north.csv", "south.csv", "--out", "both.grade"]).success();
    let both = read_map_ways(&folder.path().join("both.grade")).expect("read");
    let names: Vec<_> = both
        .iter()
        .map(|way| way.name.as_ref().expect("name").to_string())
        .collect();
    assert_eq!(names, ["north forward", "south forward"]);
    pack(&["north.csv", "--out", "one.grade"]).success();
    let one = read_map_ways(&folder.path().join("one.grade")).expect("read");
    assert_eq!(one[0].name, None);
    pack(&["both.grade", "both.grade", "--out", "twice.grade"])
        .code(1)
        .stderr(contains("two maps have the way north forward"));
    assert!(!folder.path().join("twice.grade").exists());
}

#[test]
fn what_is_no_map_is_named() {
    let folder = folder();
    std::fs::write(
        folder.path().join("noise.csv"),
        "time_s,wheel_speed_mps\n0,1\n",
    )
    .expect("written");
    let bytes = packed_map(&ways()[..1]).expect("packed");
    std::fs::write(folder.path().join("cut.grade"), &bytes[..bytes.len() / 2]).expect("written");
    for (file, message) in [
        ("noise.csv", "is a signal table; expected a map"),
        ("cut.grade", "a packed map that is cut off"),
    ] {
        roadgrade(folder.path(), &["pack", file, "--out", "map.grade"])
            .code(1)
            .stderr(contains(message));
    }
    roadgrade(folder.path(), &["fuse", "--out", "m.csv", "cut.grade"])
        .code(1)
        .stderr(contains("is a packed map"));
}

/// A packed map, and the ranges of its records.
static RECORDS: LazyLock<(Vec<u8>, Vec<Range<usize>>)> = LazyLock::new(|| {
    let bytes = packed_map(&ways()).expect("packed");
    let map = PackedMap::open(&bytes).expect("a map");
    let mut records: Vec<Range<usize>> = std::iter::once(0..HEADER).collect();
    let sized = |at: u32| {
        let at = at as usize;
        at..at + usize::from(u16::from_le_bytes([bytes[at], bytes[at + 1]]))
    };
    let mut ends = Vec::new();
    for way in map.ways().map(|way| way.expect("a way")) {
        records.push(sized(way.offset));
        let mut at = way.first_block;
        while at < way.blocks_end {
            records.push(sized(at));
            at = sized(at).end as u32;
        }
        ends.push((sized(way.offset).end, way.first_block as usize, at as usize));
    }
    let (joins, blocks) = (ends[ends.len() - 1].0, ends[0].1);
    records.extend((joins..blocks).step_by(JOIN).map(|at| at..at + JOIN));
    let index = ends[ends.len() - 1].2;
    records.extend(
        (index..bytes.len())
            .step_by(INDEX_PAGE)
            .map(|at| at..at + INDEX_PAGE),
    );
    (bytes, records)
});

/// Reads all that can be read. Returns the number of cells, points, joins and entries.
fn read_all(bytes: &[u8]) -> usize {
    let Ok(map) = PackedMap::open(bytes) else {
        return 0;
    };
    let mut count = 0;
    for way in map.ways().take(20).flatten() {
        count += map
            .joins(&way)
            .take(100)
            .flatten()
            .filter(|join| map.way(join.to_way).is_ok())
            .count();
        for block in map.blocks(&way).take(1000).flatten() {
            count += block.points().count();
            count += block.cells().map_or(0, Iterator::count);
        }
    }
    let tiles = (0..4).map(|i| Tile::of(590_000_000 + 65_536 * i, 172_000_000));
    count
        + tiles
            .map(|tile| map.blocks_in(tile).take(1000).flatten().count())
            .sum::<usize>()
}

proptest! {
    /// Checksums do not protect from those who compute them.
    #[test]
    fn content_that_cannot_be_is_read_without_panic(
        edits in prop::collection::vec((any::<prop::sample::Index>(), any::<prop::sample::Index>(), any::<u8>()), 1..8)
    ) {
        let (bytes, records) = &*RECORDS;
        let mut bytes = bytes.clone();
        for (record, at, value) in edits {
            let range = records[record.index(records.len())].clone();
            let content = range.start..range.end - 4;
            bytes[content.start + at.index(content.len())] = value;
            let sum = checksum(&bytes[content.clone()]);
            bytes[content.end..range.end].copy_from_slice(&sum.to_le_bytes());
        }
        prop_assert!(read_all(&bytes) < 1_000_000);
    }

    #[test]
    fn any_bytes_are_read_without_panic(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
        prop_assert_eq!(read_all(&bytes), 0);
    }
}
