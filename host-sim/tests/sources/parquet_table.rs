//! Signal tables as Parquet.

use estimator_core::{Signal, Value};
use host_sim::files::parquet::{ParquetColumn, stage};
use host_sim::source::parquet_table::ParquetTable;
use std::path::Path;
use test_kit::command::{folder, program};

fn write(path: &Path, times: &[f64], speeds: &[Option<f64>]) {
    let columns = vec![
        ParquetColumn::optional("wheel_speed_mps", speeds.iter().copied()),
        ParquetColumn::numbers("time_s", times.iter().copied()),
        ParquetColumn::text("driver", Some("x"), times.len()),
        ParquetColumn::whole("gear", times.iter().map(|_| 3)),
        ParquetColumn::numbers("longitude_deg", times.iter().map(|_| -8.5417)),
    ];
    stage(path, columns, &[]).unwrap().commit().unwrap();
}

type Row = (u64, Vec<(Signal, Value)>);

fn rows(path: &Path) -> Result<Vec<Row>, String> {
    let mut table = ParquetTable::open(path, &[], false).map_err(|e| e.to_string())?;
    let mut rows = Vec::new();
    while let Some(row) = table.next_row().map_err(|e| e.to_string())? {
        let readings = row.readings.iter().map(|r| (r.signal, r.value)).collect();
        rows.push((row.time.micros(), readings));
    }
    Ok(rows)
}

#[test]
fn rows_are_those_of_the_file_in_the_order_of_signals() {
    let folder = folder();
    let path = folder.path().join("table.parquet");
    write(&path, &[1.0, 1.5, 2.0], &[Some(20.5), None, Some(f64::NAN)]);
    let others = [
        (Signal::CurrentGear, Value::Real(3.0)),
        (Signal::Longitude, Value::DegreesE7(-85_417_000)),
    ];
    let with_speed = [&others[..], &[(Signal::WheelSpeed, Value::Real(20.5))]].concat();
    assert_eq!(
        rows(&path).unwrap(),
        [
            (1_000_000, with_speed),
            (1_500_000, others.to_vec()),
            (2_000_000, others.to_vec()),
        ]
    );
    let table = ParquetTable::open(&path, &[], false).unwrap();
    assert_eq!(table.ignored_columns(), ["driver"]);
}

#[test]
fn wrong_tables_are_refused() {
    let folder = folder();
    let path = folder.path().join("table.parquet");
    for (times, speeds, problem) in [
        (
            &[1.0, 0.5][..],
            [Some(1.0), None],
            "row 2: time_s, which runs backwards, is wrong",
        ),
        (
            &[1.0, -1.0],
            [None, None],
            "row 2: time_s is wrong; expected seconds",
        ),
        (
            &[1.0, 2.0],
            [None, Some(1e5)],
            "row 2: wheel_speed_mps is wrong; expected a finite",
        ),
    ] {
        write(&path, times, &speeds);
        let message = rows(&path).unwrap_err();
        assert!(message.contains(problem), "{message}");
    }
    write(&path, &[], &[]);
    assert!(rows(&path).unwrap_err().contains("no rows"));
    let columns = vec![ParquetColumn::numbers("time_s", [1.0].into_iter())];
    stage(&path, columns, &[]).unwrap().commit().unwrap();
    assert!(rows(&path).unwrap_err().contains("no column with a signal"));
    let columns = vec![ParquetColumn::numbers("gear", [1.0].into_iter())];
    stage(&path, columns, &[]).unwrap().commit().unwrap();
    assert!(rows(&path).unwrap_err().contains("without a column time_s"));
    std::fs::write(&path, b"PAR1 and no more").unwrap();
    assert!(
        rows(&path)
            .unwrap_err()
            .contains("damaged, or not a Parquet file")
    );
}

#[test]
fn a_few_wrong_rows_are_left_out_and_counted() {
    let folder = folder();
    let path = folder.path().join("table.parquet");
    let mut times: Vec<f64> = (0..400).map(f64::from).collect();
    let mut speeds = vec![Some(20.0); times.len()];
    times[200] = 3.0;
    times[300] = f64::NAN;
    speeds[350] = Some(1e5);
    write(&path, &times, &speeds);
    let mut table = ParquetTable::open(&path, &[], false).unwrap();
    let mut rows = 0;
    while table.next_row().unwrap().is_some() {
        rows += 1;
    }
    assert_eq!((rows, table.damage().lines), (397, 3));
    let first = &table.damage().first[0];
    assert!(first.contains("row 201: time_s, which runs"), "{first}");
    let strict = program()
        .args(["inspect", "--strict"])
        .arg(&path)
        .assert()
        .code(1);
    strict.stderr(predicates::str::contains("row 201: time_s"));
    for time in &mut times[100..104] {
        *time = -1.0;
    }
    write(&path, &times, &speeds);
    let message = self::rows(&path).unwrap_err();
    assert!(
        message.contains("7 of 400 lines are damaged, more than 1 %"),
        "{message}"
    );
}

#[test]
fn a_log_in_parquet_is_known_by_its_content() {
    let folder = folder();
    let path = folder.path().join("table.log");
    let times: Vec<f64> = (0..20_000).map(f64::from).collect();
    write(&path, &times, &vec![Some(20.0); times.len()]);
    let run = program().arg("inspect").arg(&path).assert().success();
    let output = run.get_output();
    let (text, notes) = (output.stdout.clone(), output.stderr.clone());
    let text = String::from_utf8(text).unwrap();
    for words in ["signal table, 20,000 rows", "wheel_speed_mps"] {
        assert!(text.contains(words), "{words}\n{text}");
    }
    let notes = String::from_utf8(notes).unwrap();
    assert!(notes.contains("ignored columns: driver"), "{notes}");
}
