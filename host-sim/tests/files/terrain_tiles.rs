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
