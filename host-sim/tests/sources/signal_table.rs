//! Signal tables: reading, errors, and writing.

use crate::packed::gzip;
use estimator_core::{Instant, Reading, Signal, Value};
use host_sim::source::log::Log;
use host_sim::source::read_options::ReadOptions;
use host_sim::source::signal_table::{SignalTableReader, write};
use proptest::prelude::*;
use std::fmt::Write as _;
use std::path::Path;

type TableRow = (u64, Vec<(Signal, Value)>);

fn read_path(path: &Path) -> Result<Vec<TableRow>, String> {
    read_path_with(path, &ReadOptions::default())
}

fn read_path_with(path: &Path, options: &ReadOptions) -> Result<Vec<TableRow>, String> {
    let Log::Table(mut table) = Log::open(path, options).map_err(|e| e.to_string())? else {
        return Err("no table".to_owned());
    };
    let mut rows = Vec::new();
    while let Some(row) = table.next_row().map_err(|e| e.to_string())? {
        let pair = |r: &Reading| (r.signal, r.value);
        rows.push((row.time.micros(), row.readings.iter().map(pair).collect()));
    }
    Ok(rows)
}

pub fn read(content: &[u8]) -> Result<Vec<TableRow>, String> {
    read_with(content, &ReadOptions::default())
}

pub fn read_with(content: &[u8], options: &ReadOptions) -> Result<Vec<TableRow>, String> {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("table.csv");
    std::fs::write(&path, content).expect("a temporary file");
    let prefix = format!("{}/", folder.path().display());
    read_path_with(&path, options).map_err(|message| message.replace(&prefix, ""))
}

fn error(content: &str) -> String {
    read(content.as_bytes()).expect_err("a bad table is refused")
}

const TABLE: &str = "altitude_m,wheel_speed_mps,time_s,traction_force_n,latitude_deg,longitude_deg\n\
    ,10.5,100.1,-2e3,,\n\
    431.25,,100.2000004,,47.3769123,-8.5417\n\
    ,,100.2000004,,,\n";

fn table_rows() -> Vec<TableRow> {
    use Signal::{Altitude, Latitude, Longitude, TractionForce, WheelSpeed};
    vec![
        (
            100_100_000,
            vec![
                (TractionForce, Value::Real(-2_000.0)),
                (WheelSpeed, Value::Real(10.5)),
            ],
        ),
        (
            100_200_000,
            vec![
                (Latitude, Value::DegreesE7(473_769_123)),
                (Longitude, Value::DegreesE7(-85_417_000)),
                (Altitude, Value::Real(431.25)),
            ],
        ),
        (100_200_000, vec![]),
    ]
}

#[test]
fn rows_give_readings_in_the_order_of_signals() {
    assert_eq!(read(TABLE.as_bytes()), Ok(table_rows()));
}

#[test]
fn changes_by_spreadsheets_are_tolerated() {
    let spaced = TABLE.replace(',', " , ").replace('\n', "\r\n\r\n");
    assert_eq!(
        read(format!("\n{spaced}\n  \n").as_bytes()),
        Ok(table_rows())
    );
    assert_eq!(
        read(format!("\u{feff}{TABLE}").as_bytes()),
        Ok(table_rows())
    );
    assert_eq!(read(TABLE.trim_end().as_bytes()), Ok(table_rows()));
    let quoted = "\"time_s\",\"gear\"\n\"0\",\"3\"\n";
    assert_eq!(
        read(quoted.as_bytes()),
        Ok(vec![(0, vec![(Signal::CurrentGear, Value::Real(3.0))])])
    );
}

#[test]
fn gzip_is_read_and_one_with_a_wrong_checksum_too() {
    let packed = gzip(TABLE.as_bytes());
    assert_eq!(read(&packed), Ok(table_rows()));
    assert_eq!(read(&packed[..packed.len() - 4]), Ok(table_rows()));
    let mut damaged = packed.clone();
    let checksum = damaged.len() - 8;
    damaged[checksum] ^= 1;
    assert_eq!(read(&damaged), Ok(table_rows()));
}

#[test]
fn damaged_rows_are_left_out_up_to_one_percent() {
    let table = |damaged: &[usize], end: &str| {
        let row = |k: usize| match damaged.contains(&k) {
            true => format!("{k},x\n"),
            false => format!("{k},{}\n", k % 7),
        };
        let rows: Vec<String> = (0..300).map(row).collect();
        format!("time_s,gear\n{}{end}", rows.concat())
    };
    let rows = read(table(&[0, 7, 299], "").as_bytes()).expect("a table");
    assert_eq!(rows.len(), 297);
    let message = error(&table(&[0, 7, 8, 9], ""));
    let words = "table.csv:2: gear is `x`; expected a finite number from -1e6 to 1e6, or an empty \
                 cell (4 of 300 lines are damaged, more than 1 %)";
    assert!(message.starts_with("table.csv:2: gear is `x`"), "{message}");
    assert!(message.ends_with(&words[words.len() - 47..]), "{message}");
    // A last row that is cut off is no damage.
    assert_eq!(
        read(table(&[1, 2, 3], "300").as_bytes())
            .expect("a table")
            .len(),
        297
    );
    // A row before the one above.
    assert_eq!(
        read(table(&[], "2,1\n").as_bytes()).expect("a table").len(),
        300
    );
}

#[test]
fn every_signal_has_a_column() {
    for signal in Signal::ALL {
        let rows = read(format!("time_s,{}\n0,1\n", signal.column()).as_bytes()).expect("a table");
        let value = match signal {
            Signal::Latitude | Signal::Longitude => Value::DegreesE7(10_000_000),
            _ => Value::Real(1.0),
        };
        assert_eq!(rows, [(0, vec![(*signal, value)])]);
    }
}

#[test]
fn headers_are_checked() {
    for (table, problem) in [
        ("", "table.csv: the file is empty; expected a header"),
        (
            "\n\n  \n",
            "table.csv: the file is empty; expected a header",
        ),
        ("time_s,gear\n", "table.csv: no rows; expected"),
        ("time_s,gear\n\n\n", "table.csv: no rows; expected"),
        ("gear\n1\n", "table.csv:1: no column time_s; expected"),
        (
            "time_s\n1\n",
            "table.csv:1: no column with a signal; expected any that `roadgrade columns` lists",
        ),
        (
            "\ntime_s,geer\n1,2\n",
            "table.csv:2: no column with a signal; expected any that `roadgrade columns` lists, such as \
             `gear`, ",
        ),
        (
            "time_s,gear,gear\n1,2,3\n",
            "table.csv:1: column `gear` is repeated; expected",
        ),
        (
            "time_s,gear,time_s\n1,2,3\n",
            "table.csv:1: column `time_s` is repeated; expected",
        ),
        (
            "\u{1}\u{2}\u{3}\n",
            "table.csv:1: no column time_s; expected",
        ),
    ] {
        let message = error(table);
        assert!(message.starts_with(problem), "{table:?}: {message}");
    }
}

#[test]
fn cells_are_checked_with_line_and_column() {
    for (rows, problem) in [
        (
            "1,2,x",
            "table.csv:2: latitude_deg is `x`; expected degrees",
        ),
        (
            "1,2,90.1",
            "table.csv:2: latitude_deg is `90.1`; expected degrees",
        ),
        (
            "1,2,\n\n\n2,abc,",
            "table.csv:5: gear is `abc`; expected a finite number, or an empty cell",
        ),
        (
            "1,2,\n2,inf,\n",
            "table.csv:3: gear is `inf`; expected a finite number",
        ),
        (
            "1,1e39,",
            "table.csv:2: gear is `1e39`; expected a finite number",
        ),
        (
            "1,1;2,",
            "table.csv:2: gear is `1;2`; expected a finite number",
        ),
        (
            "1,\u{e9},",
            "table.csv:2: gear is `\\xc3\\xa9`; expected a finite number",
        ),
        (",2,", "table.csv:2: time_s is ``; expected seconds"),
        ("-5e9,2,", "table.csv:2: time_s is `-5e9`; expected seconds"),
        (
            "12:00,2,",
            "table.csv:2: time_s is `12:00`; expected seconds",
        ),
        (
            "1e300,2,",
            "table.csv:2: time_s is `1e300`; expected seconds",
        ),
        (
            "1,2,3,4",
            "table.csv:2: 4 fields; expected 3, as many as the header has",
        ),
        (
            "1,2,\n2,2\n",
            "table.csv:3: 2 fields; expected 3, as many as the header has",
        ),
    ] {
        let message = error(&format!("time_s,gear,latitude_deg\n{rows}\n"));
        assert!(message.starts_with(problem), "{rows:?}: {message}");
    }
}

#[test]
fn a_row_that_does_not_fit_its_columns_leaves_no_file() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("table.csv");
    let rows = [(Instant::ZERO, vec![Some(1.0)]), (Instant::ZERO, vec![])];
    let message = write(&path, &[Signal::CurrentGear], rows)
        .expect_err("a short row")
        .to_string();
    assert!(message.contains("0 values for 1 columns"), "{message}");
    assert_eq!(folder.path().read_dir().expect("a folder").count(), 0);
}

#[test]
fn the_writer_keeps_the_digits_that_count() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("table.csv");
    let columns = [Signal::WheelSpeed, Signal::Latitude];
    let rows = [
        (
            Instant::from_micros(50_000),
            [Some(f64::from(0.1_f32)), Some(47.376_912_34)],
        ),
        (
            Instant::from_micros(1_700_000_000_123_456),
            [None, Some(f64::NAN)],
        ),
    ];
    write(&path, &columns, rows).expect("a table");
    assert_eq!(
        std::fs::read_to_string(&path).expect("a file"),
        "time_s,wheel_speed_mps,latitude_deg\n0.05,0.1,47.3769123\n1700000000.123456,,\n"
    );
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn written_tables_are_read_back(
        columns in prop::sample::subsequence(Signal::ALL.to_vec(), 1..=Signal::ALL.len()).prop_shuffle(),
        rows in prop::collection::vec(
            (0..100_000_000_u64, prop::collection::vec(prop::option::of(-85.0_f32..85.0), Signal::ALL.len())),
            1..20,
        ),
        start in 0..2_000_000_000_000_000_u64,
    ) {
        let mut micros = start;
        let mut expected: Vec<TableRow> = Vec::new();
        let mut written = Vec::new();
        for (step, values) in rows {
            micros += step;
            let values: Vec<_> = values[..columns.len()].iter().map(|v| v.map(f64::from)).collect();
            let mut readings: Vec<_> = columns
                .iter()
                .zip(&values)
                .filter_map(|(signal, value)| {
                    let value = (*value)?;
                    Some((*signal, match signal {
                        Signal::Latitude | Signal::Longitude => {
                            Value::DegreesE7((value * 1e7).round() as i32)
                        }
                        _ => Value::Real(value as f32),
                    }))
                })
                .collect();
            readings.sort_by_key(|(signal, _)| *signal);
            expected.push((micros, readings));
            written.push((Instant::from_micros(micros), values));
        }
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("table.csv");
        write(&path, &columns, written).unwrap();
        prop_assert_eq!(read_path(&path), Ok(expected));
    }

    #[test]
    fn any_content_is_read_or_refused(content in prop::collection::vec(any::<u8>(), 0..300)) {
        let _ = read(&content);
        let _ = read(&[b"time_s,gear\n", &content[..]].concat());
    }
}

#[test]
fn nan_is_missing_and_other_columns_are_ignored() {
    let table = b"time_s,gear,driver,wheel_speed_mps,geer\n1,NaN,x,20,1\n2,3,y,nan,\n";
    let rows = read(table).expect("a table");
    assert_eq!(
        rows,
        [
            (1_000_000, vec![(Signal::WheelSpeed, Value::Real(20.0))]),
            (2_000_000, vec![(Signal::CurrentGear, Value::Real(3.0))]),
        ]
    );
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("table.csv");
    std::fs::write(&path, table).expect("a temporary file");
    let reader = SignalTableReader::open(&path).expect("a table");
    assert_eq!(reader.ignored_columns(), ["driver", "geer"]);
}

#[test]
fn negative_times_are_moved_to_begin_with_zero() {
    let rows = read(b"time_s,gear\n-1.5,1\n-0.25,2\n1,3\n").expect("a table");
    let times: Vec<u64> = rows.iter().map(|row| row.0).collect();
    assert_eq!(times, [0, 1_250_000, 2_500_000]);
    let rows = read(b"time_s,gear\n-1.5,1\n-2.5,2\n").expect("a table");
    let times: Vec<u64> = rows.iter().map(|row| row.0).collect();
    assert_eq!(times, [0, 1_000_000]);
}

/// Returns the times of a table with these, s, and its gears; or the message.
fn ordered(times_s: impl IntoIterator<Item = f64>) -> Result<Vec<(u64, Value)>, String> {
    let mut table = "time_s,gear\n".to_owned();
    for time_s in times_s {
        writeln!(table, "{time_s},{}", time_s.rem_euclid(100.0).round()).expect("text");
    }
    let rows = read(table.as_bytes())?;
    Ok(rows
        .iter()
        .map(|(time, readings)| (*time, readings[0].1))
        .collect())
}

#[test]
fn rows_come_in_the_order_of_time() {
    let times = || (0..3_000).map(f64::from);
    let in_order = ordered(times()).expect("a table");
    assert!(in_order.is_sorted_by_key(|row| row.0));
    let swapped = times().map(|time| time + 1.0 - 2.0 * (time % 2.0));
    let newest_first = times().map(|time| 2_999.0 - time);
    // The second part before the first one, as files are put together in the wrong order.
    let parts = (1_000..3_000).chain(0..1_000).map(f64::from);
    for (name, table) in [
        ("swapped", swapped.collect::<Vec<f64>>()),
        ("newest first", newest_first.collect()),
        ("parts", parts.collect()),
    ] {
        assert_eq!(ordered(table).as_ref(), Ok(&in_order), "{name}");
    }
}

#[test]
fn rows_of_different_signals_may_stand_apart() {
    let mut table = "time_s,gear,latitude_deg\n".to_owned();
    for time in 0..400 {
        writeln!(table, "{time},{},", time % 10).expect("text");
    }
    for time in 0..400 {
        writeln!(table, "{time},,{}", 47.0 + f64::from(time) * 1e-4).expect("text");
    }
    let rows = read(table.as_bytes()).expect("a table");
    assert_eq!(rows.len(), 800);
    assert!(rows.is_sorted_by_key(|row| row.0));
}

#[test]
fn times_that_begin_again_are_refused() {
    let twice = (0..3_000).chain(0..3_000).map(f64::from);
    let message = ordered(twice).expect_err("two drives");
    for words in ["time_s comes again: 2.000000 s is within", "cut the table"] {
        assert!(message.contains(words), "{message}");
    }
}

#[test]
fn one_wrong_time_costs_its_row() {
    for wrong_s in [500.0, 0.0, -1e6, 4_000.0, 1.7e9] {
        let times = (0..3_000).map(|time| {
            if time == 2_000 {
                wrong_s
            } else {
                f64::from(time)
            }
        });
        let rows = ordered(times).expect("a table");
        assert_eq!(rows.len(), 2_999, "{wrong_s}");
        assert_eq!(
            rows.last().map(|row| row.0),
            Some(2_999_000_000),
            "{wrong_s}"
        );
    }
    // A stop, and rows that are far apart, are none.
    let stopped = (0..3_000).map(|time| f64::from(time + if time < 2_000 { 0 } else { 36_000 }));
    assert_eq!(ordered(stopped).expect("a table").len(), 3_000);
    let rare = (0..300).map(|time| f64::from(60 * time));
    assert_eq!(ordered(rare).expect("a table").len(), 300);
}

#[test]
fn a_row_of_units_may_have_brackets_and_any_spelling() {
    for units in [
        "[s],[km/h],[ft]",
        "(s),(km/h),(ft)",
        "sec,kmph,feet",
        "s,Unit_KiloMeterPerHour,feet",
    ] {
        let table = format!("time_s,wheel_speed_mps,altitude_m\n{units}\n0.0,36.0,1000\n");
        let rows = read(table.as_bytes()).expect(units);
        let expected = vec![
            (Signal::Altitude, Value::Real(304.8)),
            (Signal::WheelSpeed, Value::Real(10.0)),
        ];
        let mut found = rows[0].1.clone();
        found.sort_by_key(|reading| reading.0.column());
        assert_eq!(found, expected, "{units}");
    }
    // A unit that nobody knows: the column counts for nothing.
    let table = "time_s,wheel_speed_mps,altitude_m\ns,furlong,m\n0.0,36.0,1000\n";
    let rows = read(table.as_bytes()).expect("a table");
    assert_eq!(rows[0].1, [(Signal::Altitude, Value::Real(1000.0))]);
}
