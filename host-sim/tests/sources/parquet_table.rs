//! Signal tables as Parquet.

use estimator_core::{Signal, Value};
use host_sim::files::parquet::{ParquetColumn, stage};
use host_sim::source::parquet_table::ParquetTable;
use host_sim::source::read_options::ReadOptions;
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
    let mut table = ParquetTable::open(path, &ReadOptions::default()).map_err(|e| e.to_string())?;
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
    let table = ParquetTable::open(&path, &ReadOptions::default()).unwrap();
    assert_eq!(table.ignored_columns(), ["driver"]);
}

#[test]
fn wrong_tables_are_refused() {
    let folder = folder();
    let path = folder.path().join("table.parquet");
    for (times, speeds, problem) in [
        (
            &[1.0, 5e9][..],
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
    assert!(rows(&path).unwrap_err().contains("with no column time_s"));
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
    let mut table = ParquetTable::open(&path, &ReadOptions::default()).unwrap();
    let mut rows = 0;
    while table.next_row().unwrap().is_some() {
        rows += 1;
    }
    assert_eq!((rows, table.damage().lines), (397, 3));
    let first = &table.damage().first[0];
    assert!(first.contains("row 201: time_s comes again"), "{first}");
    let strict = program()
        .args(["inspect", "--strict"])
        .arg(&path)
        .assert()
        .code(1);
    strict.stderr(predicates::str::contains("row 201: time_s"));
    for time in &mut times[100..104] {
        *time = 30.0;
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

#[test]
fn every_codec_and_type_of_number_is_read() {
    use arrow_array::{ArrayRef, Float32Array, Float64Array, Int16Array, RecordBatch, UInt8Array};
    use parquet::arrow::ArrowWriter;
    use parquet::basic::{BrotliLevel, Compression, GzipLevel, ZstdLevel};
    use parquet::file::properties::WriterProperties;
    use std::sync::Arc;
    let count = 3000;
    let times = Float64Array::from_iter_values((0..count).map(|k| f64::from(k) / 10.0));
    let speeds =
        Float32Array::from_iter((0..count).map(|k| (k % 7 > 0).then_some(k as f32 / 256.0)));
    let gears = Int16Array::from_iter_values((0..count).map(|k| (k % 12) as i16));
    let brakes = UInt8Array::from_iter_values((0..count).map(|k| (k % 2) as u8));
    let columns: [(&str, ArrayRef); 4] = [
        ("time_s", Arc::new(times)),
        ("wheel_speed_mps", Arc::new(speeds)),
        ("gear", Arc::new(gears)),
        ("brake", Arc::new(brakes)),
    ];
    let batch = RecordBatch::try_from_iter(columns).unwrap();
    let folder = folder();
    let path = folder.path().join("table.parquet");
    let mut first = None;
    for codec in [
        Compression::UNCOMPRESSED,
        Compression::SNAPPY,
        Compression::GZIP(GzipLevel::default()),
        Compression::ZSTD(ZstdLevel::default()),
        Compression::LZ4,
        Compression::LZ4_RAW,
        Compression::BROTLI(BrotliLevel::default()),
    ] {
        let properties = WriterProperties::builder().set_compression(codec).build();
        let file = std::fs::File::create(&path).unwrap();
        let mut writer = ArrowWriter::try_new(file, batch.schema(), Some(properties)).unwrap();
        writer.write(&batch).unwrap();
        writer.close().unwrap();
        let found = rows(&path).expect("a table");
        assert_eq!(found.len(), count as usize, "{codec:?}");
        assert_eq!(
            &found,
            first.get_or_insert_with(|| found.clone()),
            "{codec:?}"
        );
    }
    let (time, readings) = &first.expect("rows")[257];
    assert_eq!(*time, 25_700_000);
    assert!(
        readings.contains(&(Signal::WheelSpeed, Value::Real(257.0 / 256.0))),
        "{readings:?}"
    );
    assert!(
        readings.contains(&(Signal::CurrentGear, Value::Real(5.0))),
        "{readings:?}"
    );
}

#[test]
fn negative_times_are_moved_to_begin_with_zero() {
    let folder = folder();
    let path = folder.path().join("table.parquet");
    write(&path, &[-1.5, -0.25, 1.0], &[Some(1.0), None, None]);
    let times: Vec<u64> = rows(&path).unwrap().iter().map(|row| row.0).collect();
    assert_eq!(times, [0, 1_250_000, 2_500_000]);
}
