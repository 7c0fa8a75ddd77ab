//! The scenario file: TOML, every key of it.
//!
//! Only `[[runs]]` with `name` and a vehicle must be there; every other key has the default shown.
//! Unknown keys and impossible values are errors that name the key.
//!
//! ```toml
//! seed = 1                       # every random number follows from it
//!
//! [road]                         # a generated road …
//! length_m = 40000.0
//! grade_sigma_percent = 1.4      # standard deviation of the tangents' grade
//! largest_grade_percent = 5.0
//! largest_change_percent_per_m = 0.0135   # sharpest vertical curve: 1 / (K in m per %)
//! smallest_radius_m = 1500.0     # tightest horizontal curve
//! # largest_radius_m = 10000.0   # widest, at least 1.01 times the tightest; left out: 6.7 times
//! start_latitude_deg = 59.14
//! start_longitude_deg = 17.62
//! start_altitude_m = 40.0
//! start_course_deg = 225.0
//! # file = "road.csv"            # … or one from a file, then without any other key of [road]:
//! #                              # distance_m,latitude_deg,longitude_deg,altitude_m,grade_percent
//!
//! [noise]
//! speed_sigma_mps = 0.011        # white, each reading (thesis 4.3.7)
//! yaw_rate_sigma_radps = 0.002
//!
//! [gnss]
//! altitude_sigma_m = 3.0         # slow error of the altitude …
//! altitude_time_s = 250.0        # … and the time over which it keeps its value
//! altitude_white_sigma_m = 0.3   # error of each single altitude
//! position_sigma_m = 1.5         # slow error to the north and to the east
//! position_time_s = 250.0
//! speed_sigma_mps = 0.05
//! course_sigma_deg = 0.3
//! outages_m = []                 # tunnels, e.g. [[5000.0, 5800.0]]; along the road as it is stored
//! steps = []                     # [from_m, to_m, metres]: the altitude is off by so much in between
//! ramps = []                     # [from_m, to_m, metres]: it drifts off to so much, and is right again
//!
//! [latency_ms]                   # age of a value when its message is sent
//! torque = 10.0                  # engine: 61444, 65247
//! speed = 30.0                   # wheels: 65265, 65215
//! gearbox = 10.0                 # 61442, 61445
//! chassis = 20.0                 # brakes and yaw rate: 65265 (597), 61440, 61441, 61449
//! gnss = 150.0
//!
//! [rates]
//! fast_ms = 10.0                 # period of ETC1 and VDC2; larger makes smaller logs
//!
//! [air]
//! pressure_pa = 101000.0
//! temperature_celsius = 20.0
//!
//! [wind]
//! speed_mps = 0.0                # steady part …
//! from_deg = 270.0               # … and where it comes from, clockwise from north
//! gust_sigma_mps = 0.0           # slow part along the road …
//! gust_time_s = 60.0             # … and the time over which it keeps its value
//!
//! [tyres]                        # cold at the start: rolling resistance is (1 + amount) times as
//! cold_amount = 0.0              # large and goes down exponentially
//! cold_time_s = 1500.0
//!
//! [planted]                      # what no vehicle file tells; units and ranges: planted_file
//! cornering_compliance_rad = 0.0
//! driveline_loss = 0.0
//! auxiliary_w = 0.0
//! fan_w = 0.0                    # told as SPN 975 …
//! fan_period_s = 120.0           # … on for 0.4 of the time
//! brake_drag_n = 0.0
//! wheel_radius_factor = 1.0
//! rough = []                     # [from_m, to_m, rolling resistance more]: in both directions
//! side_resistance = []           # likewise, in the forward direction only
//! torque_hysteresis = 0.0        # % of the reference torque
//! thermostat_w = 0.0             # told by nobody …
//! thermostat_period_s = 90.0     # … on in the first half of each period
//!
//! [errors]                       # of every run that has no [runs.errors] of its own
//!
//! [[runs]]
//! name = "a1"                    # of its files: letters, digits, '_', '-', '.'
//! truck = "A"                    # or "B"; or a vehicle.toml with vehicle = "FILE"
//! mass_kg = 39000.0              # another load than the vehicle's own; left out: the vehicle's
//! direction = "forward"          # or "backward"
//! start_distance_m = 0.0         # in the direction of travel
//! length_m = 40000.0             # left out: to the end of the road
//! start_time_s = 0.0             # of the log's clock
//! start = "set_speed"            # or "standstill"
//! tyres_driven_s = 0.0           # time already driven: tyres that are warm, among cold ones
//! # wind = { speed_mps = 3.0, from_deg = 90.0 }   # another steady wind than that of [wind]
//!
//! [runs.errors]                  # true over believed value; each either as a factor …
//! mass_factor = 1.0
//! drag_factor = 1.0
//! rolling_factor = 1.0
//! torque_factor = 1.0            # true torque over reported percent times reference torque
//! # mass_sigma = 0.1             # … or drawn from 1 ± sigma (thesis 4.3: 0.2)
//! # drag_sigma, rolling_sigma, torque_sigma likewise
//! ```
//!
//! Files are looked for beside the scenario.

use super::planted_file::PlantedTable;
use super::road_generator::RoadShape;
use super::truck::Preset;
use serde::Deserialize;
use std::path::PathBuf;

/// The document.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Document {
    #[serde(default = "one")]
    pub seed: u64,
    #[serde(default)]
    pub road: toml::Table,
    #[serde(default)]
    pub noise: NoiseLevels,
    #[serde(default)]
    pub gnss: GnssErrors,
    #[serde(default)]
    pub latency_ms: Latencies,
    #[serde(default)]
    pub rates: Rates,
    #[serde(default)]
    pub air: Air,
    #[serde(default)]
    pub wind: Wind,
    #[serde(default)]
    pub tyres: Tyres,
    #[serde(default)]
    pub planted: PlantedTable,
    #[serde(default)]
    pub errors: ParameterErrors,
    #[serde(default)]
    pub runs: Vec<RunTable>,
}

const fn one() -> u64 {
    1
}

/// Where the road comes from.
#[derive(Clone, Debug)]
pub enum RoadSource {
    /// Generated.
    Shape(RoadShape),
    /// Read from this file.
    File(PathBuf),
}

/// `[road]` with a file.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct RoadFile {
    file: PathBuf,
}

impl Document {
    /// Where the road comes from.
    ///
    /// # Errors
    /// Keys that do not belong to that source, named.
    pub fn road_source(&self) -> Result<RoadSource, toml::de::Error> {
        if self.road.contains_key("file") {
            let RoadFile { file } = self.road.clone().try_into()?;
            Ok(RoadSource::File(file))
        } else {
            Ok(RoadSource::Shape(self.road.clone().try_into()?))
        }
    }
}

/// `[noise]`: the vehicle's own sensors.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct NoiseLevels {
    pub speed_sigma_mps: f64,
    pub yaw_rate_sigma_radps: f64,
}

impl Default for NoiseLevels {
    fn default() -> Self {
        Self {
            speed_sigma_mps: 0.011,
            yaw_rate_sigma_radps: 0.002,
        }
    }
}

/// `[gnss]`: errors of the receiver.
#[derive(Clone, Debug, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct GnssErrors {
    pub altitude_sigma_m: f64,
    pub altitude_time_s: f64,
    pub altitude_white_sigma_m: f64,
    pub position_sigma_m: f64,
    pub position_time_s: f64,
    pub speed_sigma_mps: f64,
    pub course_sigma_deg: f64,
    pub outages_m: Vec<(f64, f64)>,
    pub steps: Vec<(f64, f64, f64)>,
    pub ramps: Vec<(f64, f64, f64)>,
}

impl Default for GnssErrors {
    fn default() -> Self {
        Self {
            altitude_sigma_m: 3.0,
            altitude_time_s: 250.0,
            altitude_white_sigma_m: 0.3,
            position_sigma_m: 1.5,
            position_time_s: 250.0,
            speed_sigma_mps: 0.05,
            course_sigma_deg: 0.3,
            outages_m: Vec::new(),
            steps: Vec::new(),
            ramps: Vec::new(),
        }
    }
}

/// `[latency_ms]`: age of a value when its message is sent.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Latencies {
    pub torque: f64,
    pub speed: f64,
    pub gearbox: f64,
    pub chassis: f64,
    pub gnss: f64,
}

impl Default for Latencies {
    fn default() -> Self {
        Self {
            torque: 10.0,
            speed: 30.0,
            gearbox: 10.0,
            chassis: 20.0,
            gnss: 150.0,
        }
    }
}

/// `[rates]`.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Rates {
    pub fast_ms: f64,
}

impl Default for Rates {
    fn default() -> Self {
        Self { fast_ms: 10.0 }
    }
}

/// `[air]`, as it is and as the bus tells it.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Air {
    pub pressure_pa: f64,
    pub temperature_celsius: f64,
}

impl Default for Air {
    fn default() -> Self {
        Self {
            pressure_pa: 101_000.0,
            temperature_celsius: 20.0,
        }
    }
}

/// `[wind]`, which nobody tells the estimator of.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Wind {
    pub speed_mps: f64,
    pub from_deg: f64,
    pub gust_sigma_mps: f64,
    pub gust_time_s: f64,
}

impl Default for Wind {
    fn default() -> Self {
        Self {
            speed_mps: 0.0,
            from_deg: 270.0,
            gust_sigma_mps: 0.0,
            gust_time_s: 60.0,
        }
    }
}

/// `[[runs]]`, `wind`: the steady part on another day.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SteadyWind {
    pub speed_mps: f64,
    pub from_deg: f64,
}

/// `[tyres]`, cold at the start of each run that has not driven before.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Tyres {
    pub cold_amount: f64,
    pub cold_time_s: f64,
}

impl Default for Tyres {
    fn default() -> Self {
        Self {
            cold_amount: 0.0,
            cold_time_s: 1_500.0,
        }
    }
}

/// `[errors]`: how the true vehicle differs from the believed one.
#[derive(Clone, Copy, Debug, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ParameterErrors {
    pub mass_factor: Option<f64>,
    pub mass_sigma: Option<f64>,
    pub drag_factor: Option<f64>,
    pub drag_sigma: Option<f64>,
    pub rolling_factor: Option<f64>,
    pub rolling_sigma: Option<f64>,
    pub torque_factor: Option<f64>,
    pub torque_sigma: Option<f64>,
}

/// Which way.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Direction {
    #[default]
    Forward,
    Backward,
}

/// How a run begins.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Start {
    #[default]
    SetSpeed,
    Standstill,
}

/// `[[runs]]`.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RunTable {
    pub name: String,
    pub truck: Option<Preset>,
    pub vehicle: Option<PathBuf>,
    pub mass_kg: Option<f64>,
    #[serde(default)]
    pub direction: Direction,
    #[serde(default)]
    pub start_distance_m: f64,
    pub length_m: Option<f64>,
    #[serde(default)]
    pub start_time_s: f64,
    #[serde(default)]
    pub start: Start,
    #[serde(default)]
    pub tyres_driven_s: f64,
    pub wind: Option<SteadyWind>,
    pub errors: Option<ParameterErrors>,
}
