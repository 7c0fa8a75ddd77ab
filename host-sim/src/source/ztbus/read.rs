//! A mission's CSV file.

use super::mission::{Mission, MissionRow};
use crate::error::{Error, Result};
use crate::files::kind::{self, Kind};
use crate::files::limits::{self, Budget};
use csv::StringRecord;
use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::fs::File;
use std::path::Path;

/// Upper limit of the offset of a brake-pressure sensor, Pa; the core's sampler uses the same
/// limit.
const BRAKE_PRESSURE_PA: f64 = 20_000.0;
/// Below this speed, m/s, the receiver repeats an old course.
const COURSE_SPEED_MPS: f64 = 0.5;

/// Columns that are read, of the 26 of the data set.
const COLUMNS: [&str; 12] = [
    "time_unix",
    "gnss_altitude",
    "gnss_course",
    "gnss_latitude",
    "gnss_longitude",
    "itcs_numberOfPassengers",
    "odometry_vehicleSpeed",
    "status_haltBrakeIsActive",
    "status_parkBrakeIsActive",
    "temperature_ambient",
    "traction_brakePressure",
    "traction_tractionForce",
];

/// Rows of a mission: eleven days, one row a second.
const MOST_ROWS: usize = 1_000_000;

/// One line with the indices of its columns.
struct MissionLine<'a> {
    path: &'a Path,
    record: &'a StringRecord,
    places: &'a [usize; COLUMNS.len()],
}

impl Mission {
    /// Reads a mission.
    ///
    /// # Errors
    /// Returns an error, with file, line and expected value, for missing columns, lines with too
    /// few or too many fields, values that are not numbers, time that does not increase, or a
    /// mission without a GNSS fix.
    pub fn read(path: &Path) -> Result<Self> {
        mission(path).map_err(|e| kind::explained(e, path, &[Kind::Mission]))
    }
}

fn mission(path: &Path) -> Result<Mission> {
    let file = File::open(path).map_err(Error::io(path))?;
    let mut reader = csv::Reader::from_reader(Budget::new(file, limits::RECORD_BYTES, "record"));
    let places = places(path, reader.headers().map_err(|e| csv_error(path, e))?)?;
    let mut record = StringRecord::new();
    let mut rows: Vec<MissionRow> = Vec::new();
    let mut odometer_m = Vec::new();
    let mut first_unix_s = None;
    let mut passengers = None;
    loop {
        reader.get_mut().renew();
        if !reader
            .read_record(&mut record)
            .map_err(|e| csv_error(path, e))?
        {
            break;
        }
        if rows.len() == MOST_ROWS {
            return Err(limits::too_many_rows(path, MOST_ROWS));
        }
        let line = MissionLine {
            path,
            record: &record,
            places: &places,
        };
        let unix_s = line.time_unix_s()?;
        let time_s = unix_s - *first_unix_s.get_or_insert(unix_s);
        if let Some(last) = rows.last()
            && time_s <= last.time_s
        {
            return Err(line.error("time_unix does not increase", "one row a second"));
        }
        let row = line.row(time_s, passengers)?;
        passengers = row.passengers;
        odometer_m.push(match (rows.last(), odometer_m.last()) {
            (Some(last), Some(driven_m)) => driven_m + distance_between_m(last, &row),
            _ => 0.0,
        });
        rows.push(row);
    }
    let first_fix = rows
        .iter()
        .position(|row| row.position_deg().is_some())
        .ok_or_else(|| {
            Error::content(
                path,
                "no row has gnss_latitude and gnss_longitude; expected a mission with GNSS",
            )
        })?;
    Ok(Mission {
        rows,
        odometer_m,
        first_fix,
        bus: bus_of(path),
    })
}

/// Returns the distance between two rows; if only one speed is known, it is used for both.
fn distance_between_m(from: &MissionRow, to: &MissionRow) -> f64 {
    let mean_mps = match (from.speed_mps, to.speed_mps) {
        (Some(a), Some(b)) => 0.5 * (a + b),
        (one, other) => one.or(other).unwrap_or(0.0),
    };
    mean_mps * (to.time_s - from.time_s)
}

/// Returns the bus from the name of the file; the paper names files `B183_2019-10-16_…`.
fn bus_of(path: &Path) -> Option<String> {
    let (bus, _) = path.file_stem()?.to_str()?.split_once('_')?;
    let number = bus.strip_prefix('B')?;
    let is_number = !number.is_empty() && number.bytes().all(|b| b.is_ascii_digit());
    is_number.then(|| bus.to_owned())
}

fn places(path: &Path, header: &StringRecord) -> Result<[usize; COLUMNS.len()]> {
    let mut places = [0; COLUMNS.len()];
    for (place, column) in places.iter_mut().zip(COLUMNS) {
        *place = header
            .iter()
            .position(|name| name == column)
            .ok_or_else(|| {
                Error::line(
                    path,
                    1,
                    format!("no column {column}"),
                    format!("a ZTBus mission with the columns {}", COLUMNS.join(", ")),
                )
            })?;
    }
    Ok(places)
}

impl MissionLine<'_> {
    fn error(&self, problem: impl Into<String>, expected: &str) -> Error {
        let line = self.record.position().map_or(1, csv::Position::line);
        Error::line(self.path, line, problem, expected)
    }

    /// Reads a measurement; `-` and `NaN` mean missing.
    fn number(&self, column: &str) -> Result<Option<f64>> {
        let field = COLUMNS
            .iter()
            .position(|name| *name == column)
            .and_then(|index| self.record.get(self.places[index]))
            .unwrap_or("");
        match field {
            "-" | "NaN" => Ok(None),
            text => match text.parse::<f64>() {
                Ok(value) if value.is_finite() => Ok(Some(value)),
                _ => Err(self.error(
                    format!("{column} is {text:?}"),
                    "a number, or - or NaN where there is none",
                )),
            },
        }
    }

    /// Reads a measurement and checks its range, which detects another unit or another file.
    fn within(&self, column: &str, low: f64, high: f64, expected: &str) -> Result<Option<f64>> {
        let value = self.number(column)?;
        match value {
            Some(value) if !(low..=high).contains(&value) => {
                Err(self.error(format!("{column} is {value}"), expected))
            }
            _ => Ok(value),
        }
    }

    fn time_unix_s(&self) -> Result<f64> {
        self.within("time_unix", 0.0, 4e9, "seconds since 1970")?
            .ok_or_else(|| self.error("time_unix is missing", "seconds since 1970"))
    }

    fn row(&self, time_s: f64, passengers_before: Option<f64>) -> Result<MissionRow> {
        let speed = self.within("odometry_vehicleSpeed", -50.0, 100.0, "m/s from -50 to 100")?;
        let brake_pressure_pa =
            self.within("traction_brakePressure", -1e7, 1e8, "Pa from -1e7 to 1e8")?;
        let holds = |column| -> Result<Option<bool>> {
            let switch = self.within(column, 0.0, 1.0, "0 or 1")?;
            Ok(switch.map(|on| on > 0.5))
        };
        let brakes = [
            brake_pressure_pa.map(|pa| pa > BRAKE_PRESSURE_PA),
            holds("status_haltBrakeIsActive")?,
            holds("status_parkBrakeIsActive")?,
        ];
        let course = self.within("gnss_course", -7.0, 7.0, "a course in rad")?;
        let ambient_kelvin =
            self.within("temperature_ambient", 0.0, 500.0, "kelvin from 0 to 500")?;
        let passengers = self.within(
            "itcs_numberOfPassengers",
            -1.0,
            1000.0,
            "a number from 0 to 1000",
        )?;
        Ok(MissionRow {
            time_s,
            // The motor shaft swings back by some cm/s when the bus stops; distance counts forward
            // only.
            speed_mps: speed.map(|mps| mps.max(0.0)),
            traction_force_n: self.within(
                "traction_tractionForce",
                -1e7,
                1e7,
                "N from -1e7 to 1e7",
            )?,
            brake_pressure_pa,
            braking: brakes.into_iter().flatten().reduce(|a, b| a || b),
            latitude_deg: self
                .within("gnss_latitude", -FRAC_PI_2, FRAC_PI_2, "a latitude in rad")?
                .map(f64::to_degrees),
            longitude_deg: self
                .within("gnss_longitude", -PI, PI, "a longitude in rad")?
                .map(f64::to_degrees),
            altitude_m: self.within("gnss_altitude", -20e3, 20e3, "m from -20000 to 20000")?,
            course_deg: course
                .filter(|_| speed.is_some_and(|mps| mps > COURSE_SPEED_MPS))
                .map(|rad| rad.rem_euclid(TAU).to_degrees()),
            ambient_celsius: ambient_kelvin.map(|kelvin| kelvin - 273.15),
            passengers: passengers.or(passengers_before),
        })
    }
}

fn csv_error(path: &Path, error: csv::Error) -> Error {
    let line = error.position().map_or(1, csv::Position::line);
    match error.into_kind() {
        csv::ErrorKind::Io(source) => Error::io(path)(source),
        csv::ErrorKind::UnequalLengths {
            expected_len, len, ..
        } => Error::line(
            path,
            line,
            format!("{len} fields"),
            format!("{expected_len} as in the header"),
        ),
        _ => Error::line(path, line, "not text", "CSV in UTF-8"),
    }
}
