//! SRTM tiles: interpolation, voids, and tiles that cannot be used.

use host_sim::source::terrain::Terrain;
use std::fs;
use std::path::Path;

const SIDE: usize = 1201;

/// Writes a tile of 3 arc seconds. `post` returns the altitude for row (from north) and column.
fn write_tile(path: &Path, post: impl Fn(usize, usize) -> i16) {
    let mut bytes = Vec::with_capacity(2 * SIDE * SIDE);
    for row in 0..SIDE {
        for column in 0..SIDE {
            bytes.extend(post(row, column).to_be_bytes());
        }
    }
    fs::write(path, bytes).unwrap();
}

/// Returns the position of a (fractional) post of the tile with this south-west corner.
fn position(corner: (f64, f64), row: f64, column: f64) -> (f64, f64) {
    (corner.0 + 1.0 - row / 1200.0, corner.1 + column / 1200.0)
}

#[test]
fn a_plane_is_read_back_between_its_posts() {
    let folder = tempfile::tempdir().unwrap();
    write_tile(&folder.path().join("N47E008.hgt"), |row, column| {
        (2 * row + 3 * column) as i16
    });
    let mut terrain = Terrain::new(folder.path());
    for (row, column) in [
        (0.5, 0.5),
        (600.25, 17.75),
        (1199.9, 1199.9),
        (1200.0, 0.0),
        (33.0, 44.0),
    ] {
        let (lat, lon) = position((47.0, 8.0), row, column);
        let altitude_m = terrain.altitude_m(lat, lon).unwrap().unwrap();
        let expected_m = 2.0 * row + 3.0 * column;
        assert!(
            (altitude_m - expected_m).abs() < 1e-6,
            "{row} {column}: {altitude_m} instead of {expected_m}"
        );
    }
}

#[test]
fn south_and_west_have_their_own_tiles() {
    let folder = tempfile::tempdir().unwrap();
    write_tile(&folder.path().join("S34W071.hgt"), |row, _| row as i16);
    let mut terrain = Terrain::new(folder.path());
    let (lat, lon) = position((-34.0, -71.0), 300.5, 20.0);
    let altitude_m = terrain.altitude_m(lat, lon).unwrap().unwrap();
    assert!((altitude_m - 300.5).abs() < 1e-6, "{altitude_m}");
}

#[test]
fn voids_give_no_altitude_and_spoil_only_their_neighbours() {
    let folder = tempfile::tempdir().unwrap();
    write_tile(&folder.path().join("N47E008.hgt"), |row, column| {
        match (row, column) {
            (100, 100) => i16::MIN,
            (200, 200) => -9999,
            _ => 500,
        }
    });
    let mut terrain = Terrain::new(folder.path());
    let mut at = |row, column| {
        let (lat, lon) = position((47.0, 8.0), row, column);
        terrain.altitude_m(lat, lon).unwrap()
    };
    assert_eq!(at(100.5, 100.5), None);
    assert_eq!(at(99.5, 99.5), None);
    assert_eq!(at(199.5, 200.5), None);
    assert_eq!(at(101.5, 100.5), Some(500.0));
    assert_eq!(at(98.5, 98.5), Some(500.0));
}

#[test]
fn impossible_positions_have_no_altitude() {
    let folder = tempfile::tempdir().unwrap();
    let mut terrain = Terrain::new(folder.path());
    for (lat, lon) in [(f64::NAN, 8.0), (91.0, 8.0), (47.0, 200.0)] {
        assert_eq!(terrain.altitude_m(lat, lon).unwrap(), None);
    }
}

#[test]
fn a_missing_tile_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let error = Terrain::new(folder.path())
        .altitude_m(12.5, -3.5)
        .unwrap_err()
        .to_string();
    assert!(error.contains("N12W004.hgt"), "{error}");
}

#[test]
fn a_tile_of_another_size_is_named() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("N47E008.hgt"), [0; 1000]).unwrap();
    let error = Terrain::new(folder.path())
        .altitude_m(47.5, 8.5)
        .unwrap_err()
        .to_string();
    assert!(
        error.contains("N47E008.hgt") && error.contains("1000 bytes") && error.contains("1201"),
        "{error}"
    );
}

#[test]
fn tiles_are_found_in_folders_under_other_names_and_packed() {
    use flate2::Compression;
    use flate2::write::{DeflateEncoder, GzEncoder};
    use std::io::Write;
    let plain = tempfile::tempdir().unwrap();
    let tile = plain.path().join("N47E008.hgt");
    write_tile(&tile, |row, column| (row + column) as i16);
    let bytes = fs::read(&tile).unwrap();
    let mut gzip = GzEncoder::new(Vec::new(), Compression::fast());
    gzip.write_all(&bytes).unwrap();
    let gzip = gzip.finish().unwrap();
    let mut deflated = DeflateEncoder::new(Vec::new(), Compression::fast());
    deflated.write_all(&bytes).unwrap();
    let deflated = deflated.finish().unwrap();
    let entry = |name: &str, method: u16, content: &[u8]| {
        let mut header = b"PK\x03\x04".to_vec();
        header.extend([20, 0, 0, 0]);
        header.extend(method.to_le_bytes());
        header.extend([0; 8]);
        header.extend((content.len() as u32).to_le_bytes());
        header.extend((bytes.len() as u32).to_le_bytes());
        header.extend((name.len() as u16).to_le_bytes());
        header.extend([0; 2]);
        [&header[..], name.as_bytes(), content].concat()
    };
    let zip = [
        entry("readme.txt", 0, b"words"),
        entry("N47E008.hgt", 8, &deflated),
    ]
    .concat();
    let stored = entry("N47E008.hgt", 0, &bytes);
    for (name, content) in [
        ("N47/N47E008.hgt", &bytes),
        ("a/b/N47E008.hgt", &bytes),
        ("n47e008.hgt", &bytes),
        ("N47E008.HGT", &bytes),
        ("N47E008.SRTMGL1.hgt", &bytes),
        ("N47E008.hgt.gz", &gzip),
        ("N47/N47E008.hgt.gz", &gzip),
        ("N47E008.SRTMGL1.hgt.zip", &zip),
        ("N47E008.hgt.zip", &stored),
    ] {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(&path, content).unwrap();
        // Not the tile.
        fs::write(folder.path().join("N47E008.hgt.aux.xml"), "x").unwrap();
        let (lat, lon) = position((47.0, 8.0), 600.5, 17.25);
        let altitude_m = Terrain::new(folder.path()).altitude_m(lat, lon).unwrap();
        assert!(
            altitude_m.is_some_and(|m| (m - 617.75).abs() < 1e-6),
            "{name}"
        );
    }
    for (name, content) in [
        ("N47E008.hgt.gz", &gzip[..gzip.len() / 2]),
        ("N47E008.hgt.zip", &zip[..100]),
        ("N47E008.hgt.zip", &entry("readme.txt", 0, b"words")[..]),
    ] {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join(name), content).unwrap();
        let error = Terrain::new(folder.path()).altitude_m(47.5, 8.5);
        let error = error.unwrap_err().to_string();
        assert!(
            error.contains(name) && error.contains("is damaged"),
            "{error}"
        );
    }
}
