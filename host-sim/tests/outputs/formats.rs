//! Absolute time, metadata of Parquet files, GeoParquet, KML, GPX, pages.

use crate::drive::{done, drive, estimate};
use arrow_array::{Array, BinaryArray, Float64Array};
use parquet::arrow::arrow_reader::ParquetRecordBatchReaderBuilder;
use parquet::file::metadata::ParquetMetaData;
use serde_json::Value as Json;
use std::fs::{self, File};
use std::path::Path;

const START: &str = "2026-01-02T03:04:";

fn opened(path: &Path) -> ParquetRecordBatchReaderBuilder<File> {
    ParquetRecordBatchReaderBuilder::try_new(File::open(path).unwrap()).unwrap()
}

fn value(metadata: &ParquetMetaData, key: &str) -> String {
    let pairs = metadata.file_metadata().key_value_metadata().unwrap();
    let pair = pairs.iter().find(|pair| pair.key == key);
    pair.and_then(|pair| pair.value.clone()).unwrap_or_default()
}

#[test]
fn the_absolute_time_of_the_first_frame_is_kept() {
    let folder = drive();
    let at = folder.path();
    let mut arguments = vec!["estimate", "--json", "--vehicle", "v.toml"];
    arguments.extend(["--out", "r.parquet"]);
    let with = |log| done(at, &[&arguments[..], &[log]].concat()).stdout;
    let json: Json = serde_json::from_slice(&with("d.log")).unwrap();
    let start = json["start_utc"].as_str().unwrap();
    assert!(start.starts_with(START) && start.ends_with('Z'), "{start}");
    let file = opened(&at.join("r.parquet"));
    assert_eq!(value(file.metadata(), "roadgrade.start_utc"), start);
    let datum = value(file.metadata(), "roadgrade.vertical_datum");
    assert!(datum.starts_with("mean sea level"), "{datum}");
    // Times that count from any start are not absolute.
    let json: Json = serde_json::from_slice(&with("a.log")).unwrap();
    assert!(json.get("start_utc").is_none(), "{json}");
    let file = opened(&at.join("r.parquet"));
    assert_eq!(value(file.metadata(), "roadgrade.start_utc"), "");
}

#[test]
fn a_map_as_parquet_has_statistics_and_is_geoparquet() {
    let folder = drive();
    let at = folder.path();
    estimate(at, "r.csv");
    done(at, &["fuse", "--out", "map.parquet", "r.csv"]);
    let file = opened(&at.join("map.parquet"));
    let group = file.metadata().row_group(0);
    for column in group.columns() {
        let name = column.column_path().string();
        let statistics = column.statistics().unwrap_or_else(|| panic!("{name}"));
        if name != "geometry" {
            assert!(statistics.min_bytes_opt().is_some(), "{name}");
        }
        // The first cells have no altitude.
        let nulls = statistics.null_count_opt().unwrap();
        assert!(nulls == 0 || name == "altitude_m" && nulls < 20, "{name}");
    }
    let geo: Json = serde_json::from_str(&value(file.metadata(), "geo")).unwrap();
    assert_eq!(geo["version"], "1.1.0");
    assert_eq!(geo["primary_column"], "geometry");
    let column = &geo["columns"]["geometry"];
    assert_eq!(column["encoding"], "WKB");
    assert_eq!(column["geometry_types"], serde_json::json!(["Point"]));
    let bounds: Vec<f64> = serde_json::from_value(column["bbox"].clone()).unwrap();
    let mut rows = 0;
    for batch in file.build().unwrap() {
        let batch = batch.unwrap();
        let numbers = |name: &str| -> Float64Array {
            let column = batch.column_by_name(name).unwrap().as_any();
            column.downcast_ref::<Float64Array>().unwrap().clone()
        };
        let (latitudes, longitudes) = (numbers("latitude_deg"), numbers("longitude_deg"));
        let points = batch.column_by_name("geometry").unwrap().as_any();
        let points = points.downcast_ref::<BinaryArray>().unwrap();
        for row in 0..batch.num_rows() {
            let point = points.value(row);
            let number = |at: usize| f64::from_le_bytes(point[at..at + 8].try_into().unwrap());
            assert_eq!(point.len(), 21);
            assert_eq!(point[..5], [1, 1, 0, 0, 0]);
            assert_eq!(number(5), longitudes.value(row));
            assert_eq!(number(13), latitudes.value(row));
            assert!((bounds[0]..=bounds[2]).contains(&number(5)));
            assert!((bounds[1]..=bounds[3]).contains(&number(13)));
            rows += 1;
        }
    }
    assert!(rows > 700, "{rows}");
    // The program still reads its own maps.
    done(at, &["export", "map.parquet", "--out", "map.geojson"]);
}

#[test]
fn maps_as_kml_and_gpx_have_every_cell() {
    let folder = drive();
    let at = folder.path();
    estimate(at, "r.csv");
    done(at, &["fuse", "--out", "map.csv", "r.csv"]);
    let cells = fs::read_to_string(at.join("map.csv"))
        .unwrap()
        .lines()
        .count()
        - 1;
    done(at, &["export", "map.csv", "--out", "map.gpx"]);
    let read = gpx::read(File::open(at.join("map.gpx")).unwrap()).unwrap();
    let points = &read.tracks[0].segments[0].points;
    assert_eq!(points.len(), cells);
    // The first cells have no altitude.
    let known = points.iter().filter(|point| point.elevation.is_some());
    assert!(known.count() > cells - 20);
    done(at, &["export", "map.csv", "--out", "map.kml"]);
    let whole = fs::read_to_string(at.join("map.kml")).unwrap();
    assert_eq!(whole.matches("<Placemark>").count(), 1);
    assert!(
        whole.contains("grade ") && whole.starts_with("<?xml"),
        "{}",
        &whole[..400]
    );
    let coordinates = whole.split("<coordinates>").nth(1).unwrap();
    let coordinates = coordinates.split("</coordinates>").next().unwrap();
    assert_eq!(coordinates.split_whitespace().count(), cells);
    whole.parse::<kml::Kml>().unwrap();
    let mut pieces = vec!["export", "map.csv", "--out", "map.kml"];
    pieces.extend(["--pieces", "100"]);
    done(at, &pieces);
    let pieces = fs::read_to_string(at.join("map.kml")).unwrap();
    assert!(pieces.matches("<Placemark>").count() >= 15);
}

/// Estimates the drive with a page. Returns the page.
fn page_of_drive(at: &Path, options: &[&str]) -> String {
    let mut arguments = vec!["estimate", "--vehicle", "v.toml", "--out", "r.csv"];
    arguments.extend(["--page", "r.html", "d.log"]);
    arguments.extend(options);
    done(at, &arguments);
    fs::read_to_string(at.join("r.html")).unwrap()
}

#[test]
fn a_page_draws_a_single_run() {
    let folder = drive();
    let page = page_of_drive(folder.path(), &[]);
    assert!(
        page.contains("<svg") || page.contains("<script"),
        "no figure"
    );
    assert!(page.trim_end().ends_with("</html>"));
}

/// Without a position there is a profile, and no plan; and the run is written.
#[test]
fn a_page_draws_a_run_without_positions() {
    let folder = drive();
    let at = folder.path();
    let options = ["--ignore", "latitude_deg", "--ignore", "longitude_deg"];
    let page = page_of_drive(at, &options);
    assert!(page.contains("Along the road") && !page.contains("\"kind\":\"plan\""));
    assert!(
        fs::read_to_string(at.join("r.csv"))
            .unwrap()
            .lines()
            .count()
            > 100
    );
}
