//! A trip's file: semicolons, Latin-1, plain or packed.

use super::elevation::{Points, points};
use super::gaps::gaps;
use super::header::{Places, Quantity, name_of};
use super::trip::{Trip, TripRow};
use crate::error::{Error, Result};
use crate::files::limits::{self, Budget};
use crate::source::log_file::{LogFile, is_standard_input};
use csv::ByteRecord;
use std::path::Path;

/// Rows of a trip: a day.
const MOST_ROWS: usize = 1_000_000;
/// Ratio of km/h to m/s.
const KMH_PER_MPS: f64 = 3.6;

impl Trip {
    /// Reads a trip.
    ///
    /// # Errors
    /// Returns an error, with file, line and expected value, for missing columns (time and velocity
    /// are needed), another unit, lines with too few or too many fields, values that are not numbers
    /// or out of range, time that does not increase, and packed data that are cut off.
    pub fn read(path: &Path) -> Result<Self> {
        let name = name(path)?;
        let (file_rows, places) = rows(path)?;
        let mut notes: Vec<String> = places.missing().collect();
        let gaps = gaps(&file_rows);
        notes.extend(gaps.iter().map(|gap| {
            let [from_s, to_s] = [gap.start, gap.end].map(|k| file_rows[k].time_s);
            format!(
                "{from_s} to {to_s} s: all signals run straight over a gap of the recording; left out"
            )
        }));
        let points = points(&file_rows, &gaps);
        notes.extend(points.note());
        let mut rows = file_rows;
        measured_only(&mut rows, &points);
        let mut index = 0;
        rows.retain(|_| {
            let is_kept = gaps
                .iter()
                .all(|gap| index <= gap.start || index >= gap.end);
            index += 1;
            is_kept
        });
        Ok(Self { name, rows, notes })
    }
}

/// Leaves the altitudes that were measured.
fn measured_only(rows: &mut [TripRow], points: &Points) {
    for row in rows.iter_mut() {
        row.altitude_m = None;
    }
    for point in points.points() {
        rows[point.row].altitude_m = Some(point.altitude_m);
    }
}

/// Returns the file's name without endings.
fn name(path: &Path) -> Result<String> {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let name = name.split('.').next().unwrap_or_default();
    if is_standard_input(path) || name.is_empty() {
        let problem = "has no name; expected a file named as its trip, such as TripA01.csv.gz";
        return Err(Error::content(path, problem));
    }
    Ok(name.to_owned())
}

/// Reads all rows as they stand.
fn rows(path: &Path) -> Result<(Vec<TripRow>, Places)> {
    let mut reader = csv::ReaderBuilder::new()
        .delimiter(b';')
        // With a terminator of one byte, the lines of records are exact; the carriage return of
        // CR LF is trimmed.
        .terminator(csv::Terminator::Any(b'\n'))
        .has_headers(false)
        .flexible(true)
        .from_reader(Budget::new(
            LogFile::open(path)?,
            limits::RECORD_BYTES,
            "row",
        ));
    let mut record = ByteRecord::new();
    if !next(path, &mut reader, &mut record)? {
        let problem = "the file is empty; expected the header of a trip of the i3";
        return Err(Error::content(path, problem));
    }
    let places = Places::find(path, &record)?;
    let fields = record.len();
    let mut rows: Vec<TripRow> = Vec::new();
    while next(path, &mut reader, &mut record)? {
        let line = TripLine {
            path,
            record: &record,
            places: &places,
        };
        if record.len() != fields {
            let problem = format!("{} fields", record.len());
            return Err(line.error(problem, &format!("{fields} as in the header")));
        }
        let row = line.row()?;
        if let Some(last) = rows.last()
            && row.time_s <= last.time_s
        {
            let problem = format!("Time goes from {} to {} s", last.time_s, row.time_s);
            return Err(line.error(problem, "times that increase"));
        }
        limits::push(&mut rows, row, MOST_ROWS, path)?;
    }
    let file = reader.get_ref().inner();
    if file.is_cut_off() {
        return Err(file.cut_off_error());
    }
    if let Some((problem, _)) = file.packed_damage().into_iter().next() {
        return Err(problem);
    }
    if rows.iter().all(|row| row.speed_mps.is_none()) {
        let problem = "no row has a velocity; expected rows of a trip below the header";
        return Err(Error::content(path, problem));
    }
    Ok((rows, places))
}

/// Reads the next record that is not blank. Returns false at the end.
fn next(
    path: &Path,
    reader: &mut csv::Reader<Budget<LogFile>>,
    record: &mut ByteRecord,
) -> Result<bool> {
    loop {
        reader.get_mut().renew();
        let line = reader.position().line();
        let is_read = reader
            .read_byte_record(record)
            .map_err(|error| match error.into_kind() {
                csv::ErrorKind::Io(error) => reader.get_ref().inner().read_error(line, error),
                kind => Error::line(path, line, format!("{kind:?}"), "lines of a trip"),
            })?;
        let is_blank = record.len() == 1 && record[0].trim_ascii().is_empty();
        if !is_read || !is_blank {
            return Ok(is_read);
        }
    }
}

/// One line with the places of its columns.
struct TripLine<'a> {
    path: &'a Path,
    record: &'a ByteRecord,
    places: &'a Places,
}

impl TripLine<'_> {
    fn error(&self, problem: String, expected: &str) -> Error {
        let line = self.record.position().map_or(1, csv::Position::line);
        Error::line(self.path, line, problem, expected)
    }

    /// Reads a value within a range, which detects another unit; `None` if the cell is empty.
    fn value(&self, quantity: Quantity, low: f64, high: f64) -> Result<Option<f64>> {
        let Some(field) = self.places.of(quantity).and_then(|at| self.record.get(at)) else {
            return Ok(None);
        };
        let field = field.trim_ascii();
        if field.is_empty() || field.eq_ignore_ascii_case(b"nan") {
            return Ok(None);
        }
        let number = str::from_utf8(field)
            .ok()
            .and_then(|text| text.parse().ok());
        match number.filter(|number| (low..=high).contains(number)) {
            Some(number) => Ok(Some(number)),
            None => {
                let problem = format!("{} is `{}`", name_of(quantity), field.escape_ascii());
                let expected = format!("a number from {low} to {high}, or an empty cell");
                Err(self.error(problem, &expected))
            }
        }
    }

    fn row(&self) -> Result<TripRow> {
        let time_s = self.value(Quantity::Time, 0.0, 1e6)?;
        let velocity_kmh = self.value(Quantity::Velocity, -5.0, 300.0)?;
        Ok(TripRow {
            time_s: time_s.ok_or_else(|| {
                self.error("Time is missing".to_owned(), "seconds since the start")
            })?,
            // The car may roll back by a little when it stops; distance counts forward only.
            speed_mps: velocity_kmh.map(|kmh| kmh.max(0.0) / KMH_PER_MPS),
            motor_torque_nm: self.value(Quantity::MotorTorque, -1e3, 1e3)?,
            acceleration_mps2: self.value(Quantity::Acceleration, -50.0, 50.0)?,
            altitude_m: self.value(Quantity::Elevation, -1e3, 1e4)?,
            ambient_celsius: self.value(Quantity::Ambient, -60.0, 80.0)?,
        })
    }
}
