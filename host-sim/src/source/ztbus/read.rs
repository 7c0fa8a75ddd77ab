//! A mission's CSV file.

use super::mission::{Mission, MissionRow};
use crate::error::{Error, Result};
use csv::StringRecord;
use std::f64::consts::{FRAC_PI_2, PI, TAU};
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
        mission(path)
    }
}

fn mission(path: &Path) -> Result<Mission> {
    let mut reader = csv::Reader::from_path(path).map_err(|e| csv_error(path, e))?;
    let places = places(path, reader.headers().map_err(|e| csv_error(path, e))?)?;
    let mut record = StringRecord::new();
    let mut rows: Vec<MissionRow> = Vec::new();
    let mut odometer_m = Vec::new();
    let mut first_unix_s = None;
    let mut passengers = None;
    while reader
        .read_record(&mut record)
        .map_err(|e| csv_error(path, e))?
    {
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
        self.number("time_unix")?
            .ok_or_else(|| self.error("time_unix is missing", "seconds since 1970"))
    }

    fn row(&self, time_s: f64, passengers_before: Option<f64>) -> Result<MissionRow> {
        let speed = self.number("odometry_vehicleSpeed")?;
        let brake_pressure_pa = self.number("traction_brakePressure")?;
        let holds = |column| -> Result<Option<bool>> {
            let switch = self.within(column, 0.0, 1.0, "0 or 1")?;
            Ok(switch.map(|on| on > 0.5))
        };
        let brakes = [
            brake_pressure_pa.map(|pa| pa > BRAKE_PRESSURE_PA),
            holds("status_haltBrakeIsActive")?,
            holds("status_parkBrakeIsActive")?,
        ];
        let course = self.number("gnss_course")?;
        let ambient_kelvin = self.number("temperature_ambient")?;
        let passengers = self.number("itcs_numberOfPassengers")?;
        Ok(MissionRow {
            time_s,
            // The motor shaft swings back by some cm/s when the bus stops; distance counts forward
            // only.
            speed_mps: speed.map(|mps| mps.max(0.0)),
            traction_force_n: self.number("traction_tractionForce")?,
            brake_pressure_pa,
            braking: brakes.into_iter().flatten().reduce(|a, b| a || b),
            latitude_deg: self
                .within("gnss_latitude", -FRAC_PI_2, FRAC_PI_2, "a latitude in rad")?
                .map(f64::to_degrees),
            longitude_deg: self
                .within("gnss_longitude", -PI, PI, "a longitude in rad")?
                .map(f64::to_degrees),
            altitude_m: self.number("gnss_altitude")?,
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
