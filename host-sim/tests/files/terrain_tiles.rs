//! Elevation: SRTM tiles and GeoTIFF, interpolation, voids, and files that cannot be used.

use host_sim::source::terrain::Terrain;
use std::fs;
use std::path::Path;
use test_kit::archive;
use tiff::encoder::colortype::{ColorType, Gray32Float, GrayI16};
use tiff::encoder::{TiffEncoder, TiffValue};
use tiff::tags::Tag;

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
    use flate2::write::GzEncoder;
    use std::io::Write;
    let plain = tempfile::tempdir().unwrap();
    let tile = plain.path().join("N47E008.hgt");
    write_tile(&tile, |row, column| (row + column) as i16);
    let bytes = fs::read(&tile).unwrap();
    let mut gzip = GzEncoder::new(Vec::new(), Compression::fast());
    gzip.write_all(&bytes).unwrap();
    let gzip = gzip.finish().unwrap();
    let readme = ("readme.txt", &b"words"[..]);
    let zip = archive::zip(&[readme, ("N47E008.hgt", &bytes)], true, true);
    let stored = archive::zip(&[("N47E008.hgt", &bytes)], false, true);
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
        ("N47E008.hgt.zip", &archive::zip(&[readme], false, true)[..]),
    ] {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join(name), content).unwrap();
        let error = Terrain::new(folder.path()).altitude_m(47.5, 8.5);
        let error = error.unwrap_err().to_string();
        assert!(
            error.contains(name) && error.contains("expected"),
            "{error}"
        );
    }
}

/// Writes a GeoTIFF of 90 rows and 60 columns with a plane, from 60 degrees north and 17 degrees east
/// on. The keys are pairs of a number and its value.
fn write_geo_tiff<T>(path: &Path, keys: &[(u16, u16)], posts: &[T::Inner])
where
    T: ColorType,
    [T::Inner]: TiffValue,
{
    let mut file = TiffEncoder::new(fs::File::create(path).unwrap()).unwrap();
    let mut file = file.new_image::<T>(60, 90).unwrap();
    let mut directory = vec![1_u16, 1, 0, keys.len() as u16];
    for (key, value) in keys {
        directory.extend([*key, 0, 1, *value]);
    }
    let tags = file.encoder();
    tags.write_tag(Tag::ModelPixelScaleTag, &[0.02, 0.01, 0.0][..])
        .unwrap();
    let tie = [0.0, 0.0, 0.0, 17.0, 60.0, 0.0];
    tags.write_tag(Tag::ModelTiepointTag, &tie[..]).unwrap();
    tags.write_tag(Tag::GeoKeyDirectoryTag, &directory[..])
        .unwrap();
    tags.write_tag(Tag::GdalNodata, "77").unwrap();
    file.write_data(posts).unwrap();
}

fn plane_m(row: f64, column: f64) -> f64 {
    100.0 + 2.0 * row + 3.0 * column
}

fn plane() -> Vec<f32> {
    (0..90 * 60)
        .map(|at| plane_m(f64::from(at / 60), f64::from(at % 60)) as f32)
        .collect()
}

const DEGREES: (u16, u16) = (1024, 2);

#[test]
fn geo_tiff_is_found_by_its_place_and_read_between_its_posts() {
    for (raster_type, centre) in [(1, 0.5), (2, 0.0)] {
        for is_whole in [false, true] {
            let folder = tempfile::tempdir().unwrap();
            let path = folder.path().join("a/Ground.TIF");
            fs::create_dir(path.parent().unwrap()).unwrap();
            let keys = [DEGREES, (1025, raster_type)];
            if is_whole {
                let posts: Vec<i16> = plane().into_iter().map(|m| m as i16).collect();
                write_geo_tiff::<GrayI16>(&path, &keys, &posts);
            } else {
                write_geo_tiff::<Gray32Float>(&path, &keys, &plane());
            }
            let mut terrain = Terrain::new(folder.path());
            for (row, column) in [(0.0, 0.0), (44.5, 30.25), (89.0, 59.0), (12.75, 3.5)] {
                let latitude = 60.0 - (row + centre) * 0.01;
                let longitude = 17.0 + (column + centre) * 0.02;
                let found = terrain.altitude_m(latitude, longitude).unwrap().unwrap();
                let expected = plane_m(row, column);
                assert!((found - expected).abs() < 1e-4, "{found}, not {expected}");
            }
            // A step beyond the last post.
            let beyond = terrain.altitude_m(60.0 - (89.9 + centre) * 0.01, 17.5);
            assert!(beyond.unwrap().is_some());
            let beyond = terrain.altitude_m(60.0 - (90.1 + centre) * 0.01, 17.5);
            assert!(beyond.unwrap_err().to_string().contains("N59E017.hgt"));
        }
    }
}

#[test]
fn posts_without_elevation_in_a_geo_tiff_are_void() {
    let folder = tempfile::tempdir().unwrap();
    let mut posts = plane();
    for (row, value) in [(10, f32::NAN), (20, 77.0), (30, -32767.0), (40, 3.4e38)] {
        posts[row * 60 + 5] = value;
    }
    let path = folder.path().join("ground.tif");
    write_geo_tiff::<Gray32Float>(&path, &[DEGREES, (1025, 2)], &posts);
    let mut terrain = Terrain::new(folder.path());
    for row in [10.0, 20.0, 30.0, 40.0] {
        let at = |row: f64| terrain.altitude_m(60.0 - row * 0.01, 17.1).unwrap();
        let found = [row - 0.5, row, row + 1.0].map(at);
        assert!(matches!(found, [None, None, Some(_)]), "{found:?}");
    }
}

#[test]
fn a_geo_tiff_that_cannot_be_used_costs_itself_and_is_told() {
    let folder = tempfile::tempdir().unwrap();
    // In metres of a projection.
    let projected = folder.path().join("projected.tif");
    write_geo_tiff::<Gray32Float>(&projected, &[(1024, 1)], &plane());
    let mut terrain = Terrain::new(folder.path());
    let error = terrain.altitude_m(59.5, 17.5).unwrap_err().to_string();
    assert!(
        error.contains("projected.tif") && error.contains("gdalwarp"),
        "{error}"
    );
    fs::write(folder.path().join("cut.tif"), b"II*\0").unwrap();
    write_tile(&folder.path().join("N59E017.hgt"), |_, _| 12);
    let mut terrain = Terrain::new(folder.path());
    assert_eq!(terrain.altitude_m(59.5, 17.5).unwrap(), Some(12.0));
}
