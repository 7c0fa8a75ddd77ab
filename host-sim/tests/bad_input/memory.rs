//! Inputs that ask for more memory than there is: plain errors, within 10 s and 512 MB.

use crate::shell::{done, refused, runs};
use host_sim::files::limits::rows_in_memory;
use host_sim::files::parquet::{ParquetColumn, TableWriter};
use host_sim::files::run::{self, RunCell, RunRow};
use host_sim::files::truth::TruthRow;
use std::fmt::Write as _;
use std::fs::{self, File};
use std::io::Write as _;
use std::path::Path;

/// Rows of a row group.
const GROUP_ROWS: usize = 65_536;

fn write_groups(path: &Path, groups: usize, columns: impl Fn(usize) -> Vec<ParquetColumn>) {
    let mut table = TableWriter::begin(path, &columns(0), &[]).unwrap();
    for group in 0..groups {
        table.write(columns(group)).unwrap();
    }
    table.finish().unwrap().commit().unwrap();
}

/// A table of many rows that compress to almost nothing.
fn write_endless_run(path: &Path, groups: usize) {
    let nothing = || std::iter::repeat_n(None, GROUP_ROWS);
    write_groups(path, groups, |_| {
        vec![ParquetColumn::optional("distance_m", nothing())]
    });
}

/// A run over the last part of 50,000 km, with the columns that fusion reads.
fn write_long_run(path: &Path, groups: usize) {
    let names = [
        "latitude_deg",
        "longitude_deg",
        "altitude_m",
        "altitude_sigma_m",
        "grade_percent",
        "grade_sigma_percent",
    ];
    let first = 20_000_000 - groups * GROUP_ROWS;
    write_groups(path, groups, |group| {
        let rows = (0..GROUP_ROWS).map(|row| first + group * GROUP_ROWS + row);
        let distance = ParquetColumn::numbers("distance_m", rows.map(|row| 2.5 * row as f64));
        let column = |name| ParquetColumn::numbers(name, std::iter::repeat_n(1.0, GROUP_ROWS));
        let others = names.map(column);
        std::iter::once(distance).chain(others).collect()
    });
}

#[test]
fn a_run_of_many_thousand_km_is_read() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("long.parquet");
    write_long_run(&path, 40);
    let (cells, identity) = run::read_cells(&path).unwrap();
    assert_eq!(cells.len(), 40 * GROUP_ROWS);
    assert_eq!(cells[cells.len() - 1].distance_m, 49_999_997.5);
    let mut count = 0;
    let streamed = run::each_cell(&path, &mut |_| {
        count += 1;
        Ok(())
    });
    assert_eq!((streamed.unwrap(), count), (identity, cells.len()));
    // 40 million rows fit, each of them a cell of 2.5 m.
    assert!(rows_in_memory::<RunCell>() > 40_000_000);
    // So do 41,000 km with all columns, and their truth.
    assert!(rows_in_memory::<RunRow>() > 16_400_000);
    assert!(rows_in_memory::<TruthRow>() > 20_000_000);
}

#[test]
fn a_run_for_which_there_is_no_memory_is_an_error_of_the_machine() {
    let folder = runs(40, 1);
    let at = folder.path();
    fs::create_dir(at.join("runs")).unwrap();
    write_long_run(&at.join("runs/long.parquet"), 70);
    fs::copy(at.join("0.csv"), at.join("runs/0.csv")).unwrap();
    for input in ["runs/long.parquet", "runs"] {
        let arguments = ["fuse", "--road", "0.csv", "--out", "map.csv", input];
        let message = refused(at, &arguments);
        assert!(
            message.contains("rows, and no memory for them"),
            "{message}"
        );
        assert!(!message.contains("left out"), "{message}");
    }
}

#[test]
fn a_parquet_of_endless_rows_is_refused_and_takes_no_other_run_with_it() {
    let folder = runs(40, 1);
    let at = folder.path();
    fs::create_dir(at.join("runs")).unwrap();
    fs::rename(at.join("0.csv"), at.join("runs/0.csv")).unwrap();
    let most = rows_in_memory::<RunCell>();
    write_endless_run(&at.join("runs/endless.parquet"), most / GROUP_ROWS + 1);
    let expected = format!("endless.parquet: more than {most} rows; expected at most {most}");
    let message = refused(at, &["fuse", "--out", "map.csv", "runs/endless.parquet"]);
    assert!(message.contains(&expected), "{message}");
    let message = done(at, &["fuse", "--out", "map.csv", "runs"]);
    assert!(
        message.contains(&format!("{expected}: left out")),
        "{message}"
    );
    fs::copy(at.join("runs/endless.parquet"), at.join("map.parquet")).unwrap();
    refused(at, &["export", "map.parquet", "--out", "map.geojson"]);
    refused(
        at,
        &[
            "fuse",
            "--road",
            "map.parquet",
            "--out",
            "map.csv",
            "runs/0.csv",
        ],
    );
}

#[test]
fn pages_of_a_parquet_that_promise_gigabytes_are_refused() {
    let folder = runs(40, 1);
    let at = folder.path();
    crate::shell::write_parquet(&at.join("a.parquet"), "A", 1);
    let good = fs::read(at.join("a.parquet")).unwrap();
    let truth = "time_s,distance_m,grade_percent,altitude_m,shifting,braking\n0,0,1,4,0,0\n";
    fs::write(at.join("t.csv"), truth).unwrap();
    // Headers of dictionary pages begin with their type and the uncompressed size.
    let is_header = |at: &usize| good[*at..].starts_with(&[0x15, 0x04, 0x15]);
    let headers: Vec<usize> = (4..good.len() - 20).filter(is_header).collect();
    assert!(headers.len() > 6, "{headers:?}");
    for header in headers {
        let mut bytes = good.clone();
        // A varint of five bytes, 2 GB, takes the place of the sizes, whatever they were.
        bytes[header + 3..header + 8].copy_from_slice(&[0xfe, 0xff, 0xff, 0xff, 0x0f]);
        fs::write(at.join("a.parquet"), &bytes).unwrap();
        let message = refused(at, &["score", "--truth", "t.csv", "a.parquet"]);
        assert!(
            message.contains("a.parquet: damaged, or not a Parquet file"),
            "{message}"
        );
    }
}

#[test]
fn roads_beyond_reason_are_refused() {
    let folder = runs(40, 1);
    let at = folder.path();
    let fuse = |road: &str| {
        let message = refused(at, &["fuse", "--out", "m.csv", "--road", road, "0.csv"]);
        assert!(message.contains(&format!("{road}:")), "{message}");
        message
    };
    let header = "distance_m,latitude_deg,longitude_deg\n";
    let two = |end: &str| format!("{header}0,47.4,8.5\n{end},47.5,8.5\n");
    fs::write(at.join("long.csv"), two("1e9")).unwrap();
    fuse("long.csv");
    fs::write(at.join("long.csv"), two("9e6")).unwrap();
    assert!(fuse("long.csv").contains("9000 km long; expected at most 2500 km"));
    // Points so close that each has all others around it.
    let mut dense = header.to_owned();
    for i in 0..200_000 {
        let _ = writeln!(
            dense,
            "{},47.4,{}",
            f64::from(i) * 1e-5,
            8.5 + f64::from(i) * 1e-10
        );
    }
    fs::write(at.join("dense.csv"), dense).unwrap();
    assert!(fuse("dense.csv").contains("more than 1000 points within 40 m"));
}

fn geojson(lines: &[String]) -> String {
    let feature = |(i, line): (usize, &String)| {
        format!(
            "{{\"type\":\"Feature\",\"id\":\"w{i}\",\"properties\":{{}},\
             \"geometry\":{{\"type\":\"LineString\",\"coordinates\":[{line}]}}}}"
        )
    };
    let features: Vec<String> = lines.iter().enumerate().map(feature).collect();
    format!(
        "{{\"type\":\"FeatureCollection\",\"features\":[{}]}}",
        features.join(",")
    )
}

#[test]
fn zigzags_of_a_network_are_refused() {
    let folder = runs(40, 1);
    let at = folder.path();
    let zigzag = |from: f64, to: f64, count: usize| -> String {
        let points: Vec<String> = (0..count)
            .map(|i| format!("[{},47.4]", if i % 2 == 0 { from } else { to }))
            .collect();
        points.join(",")
    };
    let cases = [
        ("far", geojson(&[zigzag(8.5, 12.5, 20_000)])),
        ("near", geojson(&[zigzag(8.5, 8.500_1, 200_000)])),
        (
            "wide",
            geojson(&(0..60).map(|_| zigzag(8.5, 12.5, 8)).collect::<Vec<_>>()),
        ),
        (
            "many",
            geojson(
                &(0..3_000)
                    .map(|_| zigzag(8.5, 8.501, 2))
                    .collect::<Vec<_>>(),
            ),
        ),
        ("feature", geojson(&[zigzag(8.5, 8.6, 2_000_000)])),
        ("nested", "[".repeat(3_000_000)),
        ("deep", format!("{{\"a\":{}", "{\"a\":".repeat(1_000_000))),
    ];
    for (name, text) in cases {
        let road = format!("{name}.geojson");
        fs::write(at.join(&road), text).unwrap();
        let message = refused(at, &["fuse", "--out", "m.csv", "--road", &road, "0.csv"]);
        assert!(message.contains(&road), "{message}");
    }
}

fn write_gzip(path: &Path, content: impl Iterator<Item = Vec<u8>>) {
    let mut out = flate2::write::GzEncoder::new(File::create(path).unwrap(), Default::default());
    content.for_each(|block| out.write_all(&block).unwrap());
    out.finish().unwrap();
}

#[test]
fn a_table_in_one_field_and_a_bomb_are_refused() {
    let folder = runs(40, 1);
    let at = folder.path();
    let field = || std::iter::repeat_n(vec![b'7'; 1 << 20], 600);
    let begun = |text: &str| std::iter::once(text.as_bytes().to_vec());
    write_gzip(
        &at.join("a.csv.gz"),
        begun("time_s,wheel_speed_mps\n0,").chain(field()),
    );
    write_gzip(
        &at.join("b.csv.gz"),
        begun("time_s,wheel_speed_mps\n0,\"\n").chain(field()),
    );
    write_gzip(&at.join("c.csv.gz"), field());
    let blank = || std::iter::repeat_n(vec![b'\n'; 1 << 20], 600);
    write_gzip(
        &at.join("d.csv.gz"),
        begun("time_s,wheel_speed_mps\n").chain(blank()),
    );
    write_gzip(&at.join("e.log.gz"), blank());
    write_gzip(&at.join("f.log.gz"), field());
    for log in [
        "a.csv.gz", "b.csv.gz", "c.csv.gz", "d.csv.gz", "e.log.gz", "f.log.gz",
    ] {
        let message = refused(at, &["inspect", log]);
        assert!(message.contains(log), "{message}");
    }
    // The same for tables that are not compressed.
    let run = fs::read_to_string(at.join("0.csv")).unwrap();
    let field = format!("{run}\"{}", "7".repeat(8 << 20));
    fs::write(at.join("field.csv"), field).unwrap();
    let message = refused(at, &["fuse", "--out", "m.csv", "field.csv"]);
    assert!(
        message.contains("field.csv: a record of more than 1048576 bytes"),
        "{message}"
    );
}

#[test]
fn a_huge_road_or_text_of_a_scenario_is_refused() {
    let folder = runs(40, 1);
    let at = folder.path();
    let scenario = "[road]\nfile = \"r.csv\"\n[[runs]]\nname = \"a\"\ntruck = \"A\"\n";
    fs::write(at.join("s.toml"), scenario).unwrap();
    let simulate = ["simulate", "--scenario", "s.toml", "--out", "out"];
    let header = "distance_m,latitude_deg,longitude_deg,altitude_m,grade_percent\n";
    fs::write(
        at.join("r.csv"),
        format!("{header}0,47,8,400,0\n1e9,47,8,400,0\n"),
    )
    .unwrap();
    let message = refused(at, &simulate);
    assert!(
        message.contains("r.csv:3: distance_m = 1000000000"),
        "{message}"
    );
    fs::write(
        at.join("r.csv"),
        format!("{header}0,47,8,400,0\n9e5,47,8,400,0\n"),
    )
    .unwrap();
    let message = refused(at, &simulate);
    assert!(
        message.contains("s, for which there is no memory; expected a shorter one"),
        "{message}"
    );
    let mut road = header.to_owned();
    for i in 0..600_000 {
        let _ = writeln!(road, "{i},47,8,400,0");
    }
    fs::write(at.join("r.csv"), road).unwrap();
    assert!(refused(at, &simulate).contains("r.csv: more than 500000 rows"));
    assert!(!at.join("out").exists());
    fs::write(at.join("s.toml"), "#".repeat(3 << 20)).unwrap();
    assert!(refused(at, &simulate).contains("s.toml: more than 1048576 bytes"));
    let message = refused(
        at,
        &["estimate", "--vehicle", "/dev/zero", "--out", "r", "0.csv"],
    );
    assert!(message.contains("/dev/zero"), "{message}");
}

#[test]
fn a_run_of_rows_without_length_does_not_take_hours() {
    let folder = runs(40, 1);
    let at = folder.path();
    let run = fs::read_to_string(at.join("0.csv")).unwrap();
    let mut lines = run.lines();
    let mut dense = format!("{}\n", lines.next().unwrap());
    let row = lines
        .next()
        .unwrap()
        .split(',')
        .skip(2)
        .collect::<Vec<_>>()
        .join(",");
    for i in 0..100_000 {
        let _ = writeln!(dense, "{i},{},{row}", f64::from(i) * 1e-4);
    }
    fs::write(at.join("dense.csv"), dense).unwrap();
    let message = refused(at, &["fuse", "--out", "m.csv", "dense.csv"]);
    assert!(
        message.contains("dense.csv:1001: 1000 rows within 500 m"),
        "{message}"
    );
}
