//! A scenario: the checked file, with its road built and its vehicles drawn. The keys of the file
//! are documented in [`scenario_file`](super::scenario_file).

use super::inertial_file::{AccelerometerTable, PitchTable};
use super::manoeuvre_file::{Section, Stop, check_manoeuvres};
use super::planted_file::PlantedTable;
use super::random::{Purpose, normal, stream};
use super::range_check::check;
use super::road::Road;
use super::scenario_check::{TEMPERATURES_CELSIUS, check_document, check_shape, check_steady_wind};
use super::scenario_file::{
    DrivingDirection, ParameterErrors, RoadSource, RunTable, ScenarioDocument, Start,
};
use super::sensor_file::{GnssErrors, Latencies, Rates, SensorNoiseLevels};
use super::surroundings_file::{Air, Tyres, Wind};
use super::truck::Truck;
use super::{road_file, road_generator};
use crate::error::{Error, Result};
use crate::files::kind::{self, Kind};
use crate::files::limits::read_text;
use crate::files::vehicle::VehicleFile;
use estimator_core::{Traction, VehicleParameters};
use rand_chacha::ChaCha8Rng;
use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};

/// Range of a factor, and limits of a random factor.
const FACTOR_RANGE: RangeInclusive<f64> = 0.2..=3.0;
const DRAWN_RANGE: RangeInclusive<f64> = 0.3..=1.7;

/// The built-in scenario of the demonstration.
const BUILTIN: &str = include_str!("../../scenarios/demo.toml");

/// A checked scenario.
#[derive(Clone, Debug)]
pub struct Scenario {
    /// Path of the file, for error messages.
    pub origin: PathBuf,
    /// The vehicle files that it names.
    pub files: Vec<PathBuf>,
    /// Seed of all random numbers.
    pub seed: u64,
    /// The road in its forward direction.
    pub road: Road,
    /// Noise of the vehicle's sensors.
    pub noise: SensorNoiseLevels,
    /// The accelerometer, if there is one.
    pub accelerometer: Option<AccelerometerTable>,
    /// The slope sensor, if there is one.
    pub pitch: Option<PitchTable>,
    /// Errors of the GNSS receiver.
    pub gnss: GnssErrors,
    /// Latencies of the messages, ms.
    pub latency_ms: Latencies,
    /// Message rates.
    pub rates: Rates,
    /// Warming of the tyres.
    pub tyres: Tyres,
    /// Planted effects.
    pub planted: PlantedTable,
    /// The traversals.
    pub runs: Vec<ScenarioRun>,
}

/// One traversal by one vehicle.
#[derive(Clone, Debug)]
pub struct ScenarioRun {
    /// Name of the run and its files.
    pub name: String,
    /// The vehicle as the estimator assumes it.
    pub vehicle: VehicleFile,
    /// The true vehicle. A wrong torque signal is modelled as a reference torque that differs from
    /// the assumed one.
    pub true_parameters: VehicleParameters,
    /// The true vehicle, ready to be simulated.
    pub truck: Truck,
    /// True if the run goes against the direction of the road.
    pub backward: bool,
    /// Start, m in the direction of travel.
    pub start_distance_m: f64,
    /// Length, m.
    pub length_m: f64,
    /// Time of the log clock at the start, s.
    pub start_time_s: f64,
    /// True if the run starts from standstill, else at the set speed.
    pub from_standstill: bool,
    /// Time that the tyres have already rolled, s.
    pub tyres_driven_s: f64,
    /// Air pressure and temperature.
    pub air: Air,
    /// The wind.
    pub wind: Wind,
    /// Stops on the way, in order.
    pub stops: Vec<Stop>,
    /// Sections in which something is different.
    pub sections: Vec<Section>,
}

impl ScenarioRun {
    /// Returns true over assumed traction per kilogram, the true value of the estimator's scale.
    #[must_use]
    pub fn true_scale(&self) -> f64 {
        let per_kg = |parameters: &VehicleParameters| {
            let torque = match &parameters.traction {
                Traction::Powertrain(powertrain) => f64::from(powertrain.reference_torque_nm),
                Traction::Force => 1.0,
            };
            torque / f64::from(parameters.mass_kg)
        };
        per_kg(&self.true_parameters) / per_kg(&self.vehicle.model.vehicle)
    }
}

impl Scenario {
    /// Reads a scenario and the files that it names.
    ///
    /// # Errors
    /// Returns an error that names each unknown key, missing key and value out of range.
    pub fn read(path: &Path) -> Result<Self> {
        let text = read_text(path)?;
        Self::parse(&text, path).map_err(|e| kind::explained(e, path, &[Kind::Scenario]))
    }

    /// Returns the built-in scenario: 10 km, truck A three times and B twice, all parameters wrong.
    ///
    /// # Panics
    /// Never: a test reads it.
    #[must_use]
    pub fn builtin() -> Self {
        Self::parse(BUILTIN, Path::new("built-in scenario")).expect("it is tested")
    }

    /// Parses the text of a scenario file. `origin` names it in messages; file names are relative
    /// to it.
    ///
    /// # Errors
    /// Returns the errors of [`read`](Self::read).
    pub fn parse(text: &str, origin: &Path) -> Result<Self> {
        let key = |problem: String| Error::Key {
            path: origin.to_owned(),
            problem,
        };
        let toml_error = |e: toml::de::Error| key(e.to_string().trim_end().to_owned());
        let document: ScenarioDocument = toml::from_str(text).map_err(toml_error)?;
        check_document(&document).map_err(key)?;
        let folder = origin.parent().unwrap_or(Path::new(""));
        let vehicles = document.runs.iter().filter_map(|run| run.vehicle.as_ref());
        let files: Vec<PathBuf> = vehicles.map(|file| folder.join(file)).collect();
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
        let mut runs: Vec<ScenarioRun> = Vec::new();
        for (index, table) in document.runs.iter().enumerate() {
            let place = format!("runs[{index}]");
            let named = |problem: String| key(format!("{place}.{problem}"));
            if runs.iter().any(|run| run.name == table.name) {
                return Err(named(format!(
                    "name = \"{}\": expected a unique name",
                    table.name
                )));
            }
            let vehicle = nominal(table, folder, &named)?;
            let mut rng = stream(document.seed, index, Purpose::Parameters);
            runs.push(run(table, &document, &road, vehicle, &mut rng).map_err(named)?);
        }
        Ok(Self {
            origin: origin.to_owned(),
            files,
            seed: document.seed,
            road,
            noise: document.noise,
            accelerometer: document.accelerometer,
            pitch: document.pitch,
            gnss: document.gnss,
            latency_ms: document.latency_ms,
            rates: document.rates,
            tyres: document.tyres,
            planted: document.planted,
            runs,
        })
    }

    /// Returns the assumed vehicle of all runs, if they share one.
    #[must_use]
    pub fn common_vehicle(&self) -> Option<&VehicleFile> {
        let first = &self.runs.first()?.vehicle;
        self.runs
            .iter()
            .all(|run| run.vehicle == *first)
            .then_some(first)
    }
}

/// Returns the assumed vehicle of a run.
fn nominal(
    table: &RunTable,
    folder: &Path,
    named: &impl Fn(String) -> Error,
) -> Result<VehicleFile> {
    let mut vehicle = match (table.truck, &table.vehicle) {
        (Some(preset), None) => VehicleFile {
            name: preset.name().to_owned(),
            model: preset.parameters().into(),
        },
        (None, Some(file)) => VehicleFile::read(&folder.join(file))?,
        (Some(_), Some(_)) => {
            return Err(named(
                "truck: vehicle is given as well; expected one of them".to_owned(),
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
        vehicle.model.vehicle.mass_kg = mass_kg as f32;
    }
    Ok(vehicle)
}

/// Creates a run with its true vehicle. The error begins with the name of the key.
fn run(
    table: &RunTable,
    document: &ScenarioDocument,
    road: &Road,
    vehicle: VehicleFile,
    rng: &mut ChaCha8Rng,
) -> std::result::Result<ScenarioRun, String> {
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
    check("tyres_driven_s", table.tyres_driven_s, 0.0..=1e6)?;
    let mut wind = document.wind;
    if let Some(steady) = table.wind {
        check_steady_wind(steady.speed_mps, steady.from_deg)?;
        (wind.speed_mps, wind.from_deg) = (steady.speed_mps, steady.from_deg);
    }
    let mut air = document.air;
    if let Some(celsius) = table.temperature_celsius {
        check("temperature_celsius", celsius, TEMPERATURES_CELSIUS)?;
        air.temperature_celsius = celsius;
    }
    check_manoeuvres(&table.stops, &table.sections)?;
    let errors = table.errors.unwrap_or(document.errors);
    let mut true_parameters = vehicle.model.vehicle.clone();
    true_parameters.wheel_radius_m *= document.planted.wheel_radius_factor as f32;
    let true_parameters = disturbed(true_parameters, &errors, rng)?;
    let truck = Truck::new(&true_parameters)
        .ok_or("vehicle: it has [traction]; expected a vehicle with a [powertrain]".to_owned())?;
    Ok(ScenarioRun {
        name: table.name.clone(),
        vehicle,
        true_parameters,
        truck,
        backward: table.direction == DrivingDirection::Backward,
        start_distance_m: table.start_distance_m,
        length_m,
        start_time_s: table.start_time_s,
        from_standstill: table.start == Start::Standstill,
        tyres_driven_s: table.tyres_driven_s,
        air,
        wind,
        stops: table.stops.clone(),
        sections: table.sections.clone(),
    })
}

/// Returns the vehicle with its parameter errors.
fn disturbed(
    mut parameters: VehicleParameters,
    errors: &ParameterErrors,
    rng: &mut ChaCha8Rng,
) -> std::result::Result<VehicleParameters, String> {
    // All four factors are drawn, used or not, so another key does not change the others.
    let mut factor = |name: &str, factor: Option<f64>, sigma: Option<f64>| {
        let draw = normal(rng);
        match (factor, sigma) {
            (Some(_), Some(_)) => Err(format!(
                "errors.{name}_factor: {name}_sigma is given as well; expected one of them"
            )),
            (Some(factor), None) => {
                check(&format!("errors.{name}_factor"), factor, FACTOR_RANGE)?;
                Ok(factor as f32)
            }
            (None, Some(sigma)) => {
                check(&format!("errors.{name}_sigma"), sigma, 0.0..=0.5)?;
                let factor = 1.0 + sigma * draw;
                Ok(factor.clamp(*DRAWN_RANGE.start(), *DRAWN_RANGE.end()) as f32)
            }
            (None, None) => Ok(1.0),
        }
    };
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
