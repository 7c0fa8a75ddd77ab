//! A scenario: the file made sure of, its road built and its vehicles drawn. The keys of the
//! file are documented in [`scenario_file`](super::scenario_file).

use super::random::{Purpose, normal, stream};
use super::road::Road;
use super::scenario_file::{
    Air, Direction, Document, GnssErrors, Latencies, NoiseLevels, ParameterErrors, Rates,
    RoadSource, RunTable, Start, Tyres, Wind,
};
use super::truck::Truck;
use super::{road_file, road_generator};
use crate::error::{Error, Result};
use crate::vehicle_file::VehicleFile;
use estimator_core::{Traction, VehicleParameters};
use rand_chacha::ChaCha8Rng;
use std::fs;
use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};

/// Specific gas constant of dry air, J/(kg K).
const GAS_CONSTANT: f64 = 287.05;
/// What a random factor is kept within.
const FACTOR_RANGE: RangeInclusive<f64> = 0.3..=1.7;

/// The embedded default of the main job.
const BUILTIN: &str = include_str!("../../scenarios/demo.toml");

/// What is to be simulated.
#[derive(Clone, Debug)]
pub struct Scenario {
    /// The file, for messages.
    pub origin: PathBuf,
    /// Every random number follows from it.
    pub seed: u64,
    /// The road in its forward direction.
    pub road: Road,
    /// Noise of the vehicle's sensors.
    pub noise: NoiseLevels,
    /// Errors of the GNSS receiver.
    pub gnss: GnssErrors,
    /// Ages of the values when sent, ms.
    pub latency_ms: Latencies,
    /// Message rates.
    pub rates: Rates,
    /// The air.
    pub air: Air,
    /// Its movement.
    pub wind: Wind,
    /// How the tyres warm up.
    pub tyres: Tyres,
    /// The traversals.
    pub runs: Vec<Run>,
}

/// One traversal by one vehicle.
#[derive(Clone, Debug)]
pub struct Run {
    /// What its files are called.
    pub name: String,
    /// The vehicle as the estimator is to believe it.
    pub vehicle: VehicleFile,
    /// The vehicle as it is. A wrong torque signal shows as a reference torque unlike the
    /// believed one.
    pub true_parameters: VehicleParameters,
    /// The same, ready to be driven.
    pub truck: Truck,
    /// Against the road's direction.
    pub backward: bool,
    /// Where it starts, in the direction of travel, m.
    pub start_distance_m: f64,
    /// How far it goes, m.
    pub length_m: f64,
    /// What the log's clock shows at the start, s.
    pub start_time_s: f64,
    /// Starts from standstill, else at the set speed.
    pub from_standstill: bool,
}

impl Run {
    /// True over believed traction per kilogram: what an estimator's scale should find.
    #[must_use]
    pub fn true_scale(&self) -> f64 {
        let per_kg = |parameters: &VehicleParameters| {
            let torque = match &parameters.traction {
                Traction::Powertrain(powertrain) => f64::from(powertrain.reference_torque_nm),
                Traction::Force => 1.0,
            };
            torque / f64::from(parameters.mass_kg)
        };
        per_kg(&self.true_parameters) / per_kg(&self.vehicle.parameters)
    }
}

impl Scenario {
    /// Reads a scenario and everything it names.
    ///
    /// # Errors
    /// Unknown keys, missing keys and impossible values, each named.
    pub fn read(path: &Path) -> Result<Self> {
        let text = fs::read_to_string(path).map_err(Error::io(path))?;
        Self::parse(&text, path)
    }

    /// The scenario that is built in: 10 km, truck A three times and B twice, all parameters
    /// wrong.
    ///
    /// # Panics
    /// Never: a test reads it.
    #[must_use]
    pub fn builtin() -> Self {
        Self::parse(BUILTIN, Path::new("built-in scenario")).expect("it is tested")
    }

    /// From the text of a scenario file; `origin` stands for it in messages, and the files it
    /// names are looked for beside it.
    ///
    /// # Errors
    /// As [`read`](Self::read).
    pub fn parse(text: &str, origin: &Path) -> Result<Self> {
        let key = |problem: String| Error::Key {
            path: origin.to_owned(),
            problem,
        };
        let toml_error = |e: toml::de::Error| key(e.to_string().trim_end().to_owned());
        let document: Document = toml::from_str(text).map_err(toml_error)?;
        check_document(&document).map_err(key)?;
        let folder = origin.parent().unwrap_or(Path::new(""));
        let road = match document
            .road_source()
            .map_err(|e| key(format!("road: {}", e.to_string().trim_end())))?
        {
            RoadSource::File(file) => road_file::read(&folder.join(file))?,
            RoadSource::Shape(shape) => {
                check_shape(&shape).map_err(key)?;
                road_generator::generate(&shape, document.seed)
            }
        };
        let mut runs: Vec<Run> = Vec::new();
        for (index, table) in document.runs.iter().enumerate() {
            let place = format!("runs[{index}]");
            let named = |problem: String| key(format!("{place}.{problem}"));
            if runs.iter().any(|run| run.name == table.name) {
                return Err(named(format!(
                    "name = \"{}\": expected a name that no other run has",
                    table.name
                )));
            }
            let vehicle = nominal(table, folder, &named)?;
            let mut rng = stream(document.seed, index, Purpose::Parameters);
            let errors = table.errors.unwrap_or(document.errors);
            runs.push(run(table, &road, vehicle, &errors, &mut rng).map_err(named)?);
        }
        Ok(Self {
            origin: origin.to_owned(),
            seed: document.seed,
            road,
            noise: document.noise,
            gnss: document.gnss,
            latency_ms: document.latency_ms,
            rates: document.rates,
            air: document.air,
            wind: document.wind,
            tyres: document.tyres,
            runs,
        })
    }

    /// Density of dry air, kg/m³.
    #[must_use]
    pub fn air_density(&self) -> f64 {
        self.air.pressure_pa / (GAS_CONSTANT * (self.air.temperature_celsius + 273.15))
    }

    /// The vehicle that all runs are believed to have, if they share one.
    #[must_use]
    pub fn common_vehicle(&self) -> Option<&VehicleFile> {
        let first = &self.runs.first()?.vehicle;
        self.runs
            .iter()
            .all(|run| run.vehicle == *first)
            .then_some(first)
    }
}

/// The believed vehicle of a run.
fn nominal(
    table: &RunTable,
    folder: &Path,
    named: &impl Fn(String) -> Error,
) -> Result<VehicleFile> {
    let mut vehicle = match (table.truck, &table.vehicle) {
        (Some(preset), None) => VehicleFile {
            name: preset.name().to_owned(),
            parameters: preset.parameters(),
        },
        (None, Some(file)) => VehicleFile::read(&folder.join(file))?,
        (Some(_), Some(_)) => {
            return Err(named(
                "truck: there is a vehicle as well; expected one of them".to_owned(),
            ));
        }
        (None, None) => {
            return Err(named(
                "truck: missing; expected truck = \"A\" or \"B\", or vehicle = \"FILE\"".to_owned(),
            ));
        }
    };
    if let Some(mass_kg) = table.mass_kg {
        check("mass_kg", mass_kg, 500.0..=200_000.0).map_err(named)?;
        vehicle.parameters.mass_kg = mass_kg as f32;
    }
    Ok(vehicle)
}

/// A run with its true vehicle; the error is a problem that starts with the key's name.
fn run(
    table: &RunTable,
    road: &Road,
    vehicle: VehicleFile,
    errors: &ParameterErrors,
    rng: &mut ChaCha8Rng,
) -> std::result::Result<Run, String> {
    let plain = |c: char| c.is_ascii_alphanumeric() || "_-.".contains(c);
    if !table.name.starts_with(|c: char| c.is_ascii_alphanumeric())
        || !table.name.chars().all(plain)
    {
        return Err(format!(
            "name = \"{}\": expected letters, digits, '_', '-' and '.', the first a letter or digit",
            table.name
        ));
    }
    let road_m = road.length_m();
    check(
        "start_distance_m",
        table.start_distance_m,
        0.0..=road_m - 1.0,
    )?;
    let rest_m = road_m - table.start_distance_m;
    let length_m = table.length_m.unwrap_or(rest_m);
    check("length_m", length_m, 1.0..=rest_m)?;
    check("start_time_s", table.start_time_s, 0.0..=1e12)?;
    let true_parameters = disturbed(&vehicle.parameters, errors, rng)?;
    let truck = Truck::new(&true_parameters).ok_or(
        "vehicle: has a measured traction force; expected one with a [powertrain]".to_owned(),
    )?;
    Ok(Run {
        name: table.name.clone(),
        vehicle,
        true_parameters,
        truck,
        backward: table.direction == Direction::Backward,
        start_distance_m: table.start_distance_m,
        length_m,
        start_time_s: table.start_time_s,
        from_standstill: table.start == Start::Standstill,
    })
}

/// The true vehicle.
fn disturbed(
    nominal: &VehicleParameters,
    errors: &ParameterErrors,
    rng: &mut ChaCha8Rng,
) -> std::result::Result<VehicleParameters, String> {
    // All four are drawn whether they are used or not: one more key leaves the others as they were.
    let mut factor = |name: &str, factor: Option<f64>, sigma: Option<f64>| {
        let draw = normal(rng);
        match (factor, sigma) {
            (Some(_), Some(_)) => Err(format!(
                "errors.{name}_factor: there is {name}_sigma as well; expected one of them"
            )),
            (Some(factor), None) => {
                check(&format!("errors.{name}_factor"), factor, FACTOR_RANGE)?;
                Ok(factor as f32)
            }
            (None, Some(sigma)) => {
                check(&format!("errors.{name}_sigma"), sigma, 0.0..=0.5)?;
                let factor = 1.0 + sigma * draw;
                Ok(factor.clamp(*FACTOR_RANGE.start(), *FACTOR_RANGE.end()) as f32)
            }
            (None, None) => Ok(1.0),
        }
    };
    let mut parameters = nominal.clone();
    parameters.mass_kg *= factor("mass", errors.mass_factor, errors.mass_sigma)?;
    parameters.drag_area_m2 *= factor("drag", errors.drag_factor, errors.drag_sigma)?;
    parameters.rolling_resistance *=
        factor("rolling", errors.rolling_factor, errors.rolling_sigma)?;
    let torque = factor("torque", errors.torque_factor, errors.torque_sigma)?;
    if let Traction::Powertrain(powertrain) = &mut parameters.traction {
        powertrain.reference_torque_nm *= torque;
    }
    parameters
        .check()
        .map_err(|e| format!("errors: the true {e}"))?;
    Ok(parameters)
}

/// A number within a range, or a problem that names the key.
fn check(name: &str, value: f64, range: RangeInclusive<f64>) -> std::result::Result<(), String> {
    if range.contains(&value) {
        Ok(())
    } else {
        Err(format!(
            "{name} = {value}: expected {} to {}",
            range.start(),
            range.end()
        ))
    }
}

fn check_document(document: &Document) -> std::result::Result<(), String> {
    if document.runs.is_empty() {
        return Err("runs: there are none; expected at least one [[runs]]".to_owned());
    }
    let Document {
        noise,
        gnss,
        latency_ms,
        rates,
        air,
        wind,
        tyres,
        ..
    } = document;
    check("wind.speed_mps", wind.speed_mps, 0.0..=40.0)?;
    check("wind.from_deg", wind.from_deg, 0.0..=360.0)?;
    check("wind.gust_sigma_mps", wind.gust_sigma_mps, 0.0..=20.0)?;
    check("wind.gust_time_s", wind.gust_time_s, 0.1..=1e6)?;
    check("tyres.cold_amount", tyres.cold_amount, 0.0..=5.0)?;
    check("tyres.cold_time_s", tyres.cold_time_s, 1.0..=1e6)?;
    check("noise.speed_sigma_mps", noise.speed_sigma_mps, 0.0..=5.0)?;
    check(
        "noise.yaw_rate_sigma_radps",
        noise.yaw_rate_sigma_radps,
        0.0..=1.0,
    )?;
    check("gnss.altitude_sigma_m", gnss.altitude_sigma_m, 0.0..=100.0)?;
    check("gnss.altitude_time_s", gnss.altitude_time_s, 0.1..=1e6)?;
    check(
        "gnss.altitude_white_sigma_m",
        gnss.altitude_white_sigma_m,
        0.0..=100.0,
    )?;
    check("gnss.position_sigma_m", gnss.position_sigma_m, 0.0..=1000.0)?;
    check("gnss.position_time_s", gnss.position_time_s, 0.1..=1e6)?;
    check("gnss.speed_sigma_mps", gnss.speed_sigma_mps, 0.0..=10.0)?;
    check("gnss.course_sigma_deg", gnss.course_sigma_deg, 0.0..=180.0)?;
    for (name, faults) in [("gnss.steps", &gnss.steps), ("gnss.ramps", &gnss.ramps)] {
        for &(from_m, to_m, metres) in faults {
            check(&format!("{name} (start)"), from_m, 0.0..=1e9)?;
            check(&format!("{name} (end)"), to_m, from_m..=1e9)?;
            check(&format!("{name} (metres)"), metres, -1e4..=1e4)?;
        }
    }
    for outage in &gnss.outages_m {
        check("gnss.outages_m (start)", outage.0, 0.0..=1e9)?;
        check("gnss.outages_m (end)", outage.1, outage.0..=1e9)?;
    }
    for (name, value) in [
        ("torque", latency_ms.torque),
        ("speed", latency_ms.speed),
        ("gearbox", latency_ms.gearbox),
        ("chassis", latency_ms.chassis),
        ("gnss", latency_ms.gnss),
    ] {
        check(&format!("latency_ms.{name}"), value, 0.0..=5_000.0)?;
    }
    check("rates.fast_ms", rates.fast_ms, 10.0..=1_000.0)?;
    check("air.pressure_pa", air.pressure_pa, 50_000.0..=110_000.0)?;
    check(
        "air.temperature_celsius",
        air.temperature_celsius,
        -60.0..=60.0,
    )
}

fn check_shape(shape: &road_generator::RoadShape) -> std::result::Result<(), String> {
    check("road.length_m", shape.length_m, 100.0..=1e6)?;
    check(
        "road.grade_sigma_percent",
        shape.grade_sigma_percent,
        0.0..=10.0,
    )?;
    check(
        "road.largest_grade_percent",
        shape.largest_grade_percent,
        0.0..=15.0,
    )?;
    check(
        "road.largest_change_percent_per_m",
        shape.largest_change_percent_per_m,
        1e-4..=0.2,
    )?;
    check(
        "road.smallest_radius_m",
        shape.smallest_radius_m,
        100.0..=1e6,
    )?;
    check(
        "road.start_latitude_deg",
        shape.start_latitude_deg,
        -80.0..=80.0,
    )?;
    check(
        "road.start_longitude_deg",
        shape.start_longitude_deg,
        -170.0..=170.0,
    )?;
    check(
        "road.start_altitude_m",
        shape.start_altitude_m,
        -400.0..=6_000.0,
    )?;
    check(
        "road.start_course_deg",
        shape.start_course_deg,
        -360.0..=360.0,
    )
}
