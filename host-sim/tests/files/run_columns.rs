//! The columns of a run that later versions appended, and files without them.

use host_sim::files::parquet::{ParquetColumn, stage};
use host_sim::files::run::{self, RunRow};
use std::fs;
use std::path::Path;
use test_kit::roads::{hills, run};

const NEWER: &str = ",mass_kg,mass_sigma_kg,consistent,lagged_consistent,live_consistent,\
                     map_grade_percent,map_grade_sigma_percent";

/// A short run with each flag at 0 in one cell.
fn rows() -> Vec<RunRow> {
    let mut rows = run(&hills()[..40]);
    rows[3].consistent = 0;
    rows[4].lagged_consistent = 0;
    rows[5].live_consistent = 0;
    rows[6].mass_kg = Some(38_123.4);
    rows[6].mass_sigma_kg = Some(1_500.6);
    rows
}

fn rows_as_an_older_file_tells_them() -> Vec<RunRow> {
    let mut rows = rows();
    for row in &mut rows {
        (row.mass_kg, row.mass_sigma_kg) = (None, None);
        (row.consistent, row.lagged_consistent, row.live_consistent) = (1, 1, 1);
    }
    rows
}

/// Returns the lines of a CSV file with so many fields less.
fn without_last_columns(path: &Path, count: usize) -> String {
    let text = fs::read_to_string(path).unwrap();
    let lines = text.lines().map(|line| {
        let fields: Vec<&str> = line.split(',').collect();
        fields[..fields.len() - count].join(",") + "\n"
    });
    lines.collect()
}

#[test]
fn the_columns_come_last_and_read_back() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["run.csv", "run.parquet"] {
        let path = folder.path().join(name);
        run::write(&path, &rows()).unwrap();
        let read = run::read(&path).unwrap();
        for (read, wrote) in read.iter().zip(rows()) {
            assert_eq!(read.mass_kg, wrote.mass_kg);
            assert_eq!(read.mass_sigma_kg, wrote.mass_sigma_kg);
            assert_eq!(
                [
                    read.consistent,
                    read.lagged_consistent,
                    read.live_consistent
                ],
                [
                    wrote.consistent,
                    wrote.lagged_consistent,
                    wrote.live_consistent
                ]
            );
        }
        let (cells, _) = run::read_cells(&path).unwrap();
        let suspect: Vec<usize> = (0..cells.len())
            .filter(|k| !cells[*k].is_consistent)
            .collect();
        assert_eq!(suspect, [3], "{name}");
    }
    let text = fs::read_to_string(folder.path().join("run.csv")).unwrap();
    let header = text.lines().next().unwrap();
    assert!(
        header.ends_with(&format!(",scale,valid{NEWER}")),
        "{header}"
    );
    assert!(
        text.lines()
            .nth(4)
            .unwrap()
            .ends_with(",12000.0,500.0,0,1,1,,")
    );
}

#[test]
fn an_older_file_has_no_mass_and_nothing_that_disagrees() {
    let folder = tempfile::tempdir().unwrap();
    let (new, old) = (folder.path().join("new.csv"), folder.path().join("old.csv"));
    run::write(&new, &rows()).unwrap();
    fs::write(&old, without_last_columns(&new, 7)).unwrap();
    let wrote = folder.path().join("expected.csv");
    run::write(&wrote, &rows_as_an_older_file_tells_them()).unwrap();
    assert_eq!(run::read(&old).unwrap(), run::read(&wrote).unwrap());
    // A run without a mark has the identity that it had before. Marks are part of it.
    let identity = |path: &Path| run::read_cells(path).unwrap().1;
    assert_eq!(identity(&old), identity(&wrote));
    assert_ne!(identity(&old), identity(&new));
}

#[test]
fn what_is_no_flag_and_no_mass_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.csv");
    run::write(&path, &rows()).unwrap();
    let good = fs::read_to_string(&path).unwrap();
    for (tail, problem) in [
        (",12000.0,500.0,2,1,1,,", "consistent is 2; expected 0 or 1"),
        (",12000.0,500.0,1,1,7,,", "live_consistent is 7"),
        (",-1.0,500.0,1,1,1,,", "mass_kg is -1"),
        (",inf,500.0,1,1,1,,", "mass_kg is inf"),
        (",12000.0,0.0,1,1,1,,", "mass_sigma_kg is 0"),
        (",,500.0,1,1,1,,", "incomplete mass"),
        (",12000.0,500.0,1,1,1,0.5,", "incomplete grade of a map"),
        (
            ",12000.0,500.0,1,1,1,0.5,0.0",
            "map_grade_sigma_percent is 0",
        ),
    ] {
        let bad = good.replacen(",12000.0,500.0,1,1,1,,", tail, 1);
        assert_ne!(bad, good);
        fs::write(&path, bad).unwrap();
        let error = run::read(&path).unwrap_err().to_string();
        assert!(error.contains(problem), "{error}");
        assert!(error.contains("run.csv:2"), "{error}");
    }
}

/// Writes the columns of a Parquet run that are wanted, with other numbers in some of them.
fn write_parquet(path: &Path, with: &[(&'static str, f64)], without: &[&str]) {
    let rows = rows();
    let number = |name: &'static str, value: fn(&RunRow) -> Option<f64>| {
        let other = with.iter().find(|(column, _)| *column == name);
        let values = rows
            .iter()
            .map(|row| other.map_or_else(|| value(row), |o| Some(o.1)));
        (!without.contains(&name)).then(|| ParquetColumn::optional(name, values))
    };
    let columns: Vec<ParquetColumn> = [
        number("time_s", |row| Some(row.time_s)),
        number("distance_m", |row| Some(row.distance_m)),
        number("latitude_deg", |row| row.latitude_deg),
        number("longitude_deg", |row| row.longitude_deg),
        number("altitude_m", |row| row.altitude_m),
        number("altitude_sigma_m", |row| row.altitude_sigma_m),
        number("grade_percent", |row| Some(row.grade_percent)),
        number("grade_sigma_percent", |row| Some(row.grade_sigma_percent)),
        number("lagged_grade_percent", |row| Some(row.lagged_grade_percent)),
        number("lagged_grade_sigma_percent", |row| {
            Some(row.lagged_grade_sigma_percent)
        }),
        number("live_grade_percent", |row| Some(row.live_grade_percent)),
        number("live_grade_sigma_percent", |row| {
            Some(row.live_grade_sigma_percent)
        }),
        number("speed_mps", |row| Some(row.speed_mps)),
        number("bias_percent", |row| Some(row.bias_percent)),
        number("scale", |row| Some(row.scale)),
        number("valid", |row| Some(row.valid.into())),
        number("mass_kg", |row| row.mass_kg),
        number("mass_sigma_kg", |row| row.mass_sigma_kg),
        number("consistent", |row| Some(row.consistent.into())),
        number("lagged_consistent", |row| {
            Some(row.lagged_consistent.into())
        }),
        number("live_consistent", |row| Some(row.live_consistent.into())),
    ]
    .into_iter()
    .flatten()
    .collect();
    stage(path, columns, &[]).unwrap().commit().unwrap();
}

#[test]
fn an_older_parquet_is_read_and_a_wrong_number_in_a_newer_column_is_not() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.parquet");
    let newer: Vec<&str> = NEWER.split(',').skip(1).collect();
    write_parquet(&path, &[], &[]);
    assert_eq!(run::read(&path).unwrap(), rows());
    write_parquet(&path, &[], &newer);
    assert_eq!(
        run::read(&path).unwrap(),
        rows_as_an_older_file_tells_them()
    );
    let (cells, _) = run::read_cells(&path).unwrap();
    assert!(cells.iter().all(|cell| cell.is_consistent));
    for (column, value, problem) in [
        (
            "mass_kg",
            1.1e6,
            "mass_kg is 1100000; expected a finite number from 0",
        ),
        ("mass_sigma_kg", 0.0, "mass_sigma_kg is 0;"),
        ("consistent", 7.0, "consistent is 7; expected 0 or 1"),
        ("lagged_consistent", 0.5, "lagged_consistent is 0.5;"),
        ("live_consistent", f64::NAN, "live_consistent is NaN;"),
        ("valid", -1.0, "valid is -1;"),
    ] {
        write_parquet(&path, &[(column, value)], &[]);
        let error = run::read(&path).unwrap_err().to_string();
        assert!(
            error.contains(&format!("run.parquet:1: {problem}")),
            "{error}"
        );
        // Fusion reads one of them.
        assert_eq!(run::read_cells(&path).is_err(), column == "consistent");
    }
}
