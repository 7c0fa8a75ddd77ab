//! The scenario file (TOML) and all its keys.
//!
//! Only `[[runs]]` with `name` and a vehicle is required; every other key has the default shown.
//! Unknown keys and values out of range are errors that name the key.
//!
//! ```toml
//! seed = 1                       # seed of all random numbers
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
//! # [accelerometer]              # units and ranges: inertial_file; without the table no such sensor
//! # message = "ACCS"             # or "VDC2", with the period of [rates]
//! # period_ms = 20.0
//! # offset_mps2 = 0.1            # at the start …
//! # drift_mps2 = 0.02            # … and its random walk: 1 sigma after an hour
//! # scale_factor = 1.01
//! # mounting_deg = 0.2           # against the road, nose up
//! # body_pitch_deg_per_mps2 = 0.3  # by acceleration and slope
//! # roughness_mps2 = 0.3         # vibration at 20 m/s
//!
//! # [pitch]                      # likewise; a slope sensor, compensated for acceleration
//! # message = "SSI"              # or "SSI2"
//! # period_ms = 20.0
//! # offset_deg = 0.2
//! # drift_deg = 0.05
//! # body_pitch_deg_per_mps2 = 0.3
//! # noise_sigma_deg = 0.1
//!
//! [gnss]
//! altitude_sigma_m = 3.0         # slow error of the altitude …
//! altitude_time_s = 250.0        # … and its correlation time
//! altitude_white_sigma_m = 0.3   # error of each single altitude
//! position_sigma_m = 1.5         # slow error to the north and to the east
//! position_time_s = 250.0
//! speed_sigma_mps = 0.05
//! course_sigma_deg = 0.3
//! outages_m = []                 # tunnels, e.g. [[5000.0, 5800.0]]; along the road as stored
//! steps = []                     # [from_m, to_m, metres]: the altitude is wrong by this
//! ramps = []                     # [from_m, to_m, metres]: the error grows to this, then ends
//!
//! [latency_ms]                   # age of a value when its message is sent
//! torque = 10.0                  # engine: 61444, 65247
//! speed = 30.0                   # wheels: 65265, 65215
//! gearbox = 10.0                 # 61442, 61445
//! chassis = 20.0                 # brakes, yaw rate, inertial: 65265 (597), 61440, 61441, 61449
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
//! gust_time_s = 60.0             # … and its correlation time
//!
//! [tyres]                        # cold at the start: rolling resistance is (1 + amount) times as
//! cold_amount = 0.0              # large and decays exponentially
//! cold_time_s = 1500.0
//!
//! [planted]                      # effects in no vehicle file; units and ranges: planted_file
//! cornering_compliance_rad = 0.0
//! driveline_loss = 0.0
//! auxiliary_w = 0.0
//! fan_w = 0.0                    # reported as SPN 975 …
//! fan_period_s = 120.0           # … on for 0.4 of the time
//! brake_drag_n = 0.0
//! wheel_radius_factor = 1.0
//! rough = []                     # [from_m, to_m, added rolling resistance]: in both directions
//! side_resistance = []           # likewise, in the forward direction only
//! tyre_temperature_per_k = 0.0   # added part of the rolling resistance a kelvin below 25 °C
//! torque_hysteresis = 0.0        # % of the reference torque
//! thermostat_w = 0.0             # reported by no signal …
//! thermostat_period_s = 90.0     # … on in the first half of each period
//!
//! [errors]                       # for every run that has no [runs.errors]
//!
//! [[runs]]
//! name = "a1"                    # of its files: letters, digits, '_', '-', '.'
//! truck = "A"                    # or "B"; or a vehicle.toml with vehicle = "FILE"
//! mass_kg = 39000.0              # another mass; default: that of the vehicle
//! direction = "forward"          # or "backward"
//! start_distance_m = 0.0         # in the direction of travel
//! length_m = 40000.0             # default: to the end of the road
//! start_time_s = 0.0             # of the log clock
//! start = "set_speed"            # or "standstill"
//! tyres_driven_s = 0.0           # time already driven: warm tyres
//! # temperature_celsius = 5.0    # other air than that of [air]
//! # wind = { speed_mps = 3.0, from_deg = 90.0 }   # another steady wind than that of [wind]
//!
//! [runs.errors]                  # true over assumed value; each either as a factor …
//! mass_factor = 1.0
//! drag_factor = 1.0
//! rolling_factor = 1.0
//! torque_factor = 1.0            # true torque over reported percent times reference torque
//! # mass_sigma = 0.1             # … or drawn from 1 ± sigma (thesis 4.3: 0.2)
//! # drag_sigma, rolling_sigma, torque_sigma likewise
//!
//! # [[runs.stops]]               # units and ranges: manoeuvre_file
//! # at_m = 15000.0               # in the direction of travel, as start_distance_m
//! # seconds = 60.0
//! # mass_kg = 15000.0            # true mass from then on, which nothing reports
//! # reverse_m = 0.0              # way driven backwards before the time at standstill
//! # carried_m = 0.0              # way that a ferry carries the standing vehicle
//!
//! # [[runs.sections]]
//! # from_m = 15000.0
//! # to_m = 20000.0
//! # rolling_factor = 1.0         # snow, gravel, a lifted axle
//! # headwind_mps = 0.0           # besides that of [wind]
//! # pto_nm = 0.0                 # power take-off; the reported torque includes it
//! # range_ratio = 1.0            # transfer case between gearbox and axle
//! # set_speed_mps = 22.2
//! # retarder = false             # keeps the set speed downhill; SPN 520 reports it
//! ```
//!
//! File names are relative to the scenario. `sensor_file` has the tables of the sensors,
//! `surroundings_file` those of air, wind and tyres.

use super::inertial_file::{AccelerometerTable, PitchTable};
use super::manoeuvre_file::{Section, Stop};
use super::planted_file::PlantedTable;
use super::road_generator::RoadShape;
use super::sensor_file::{GnssErrors, Latencies, Rates, SensorNoiseLevels};
use super::surroundings_file::{Air, SteadyWind, Tyres, Wind};
use super::truck::Preset;
use serde::Deserialize;
use std::path::PathBuf;

/// The scenario document.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ScenarioDocument {
    /// `seed`: seed of all random numbers, default 1.
    #[serde(default = "one")]
    pub seed: u64,
    /// `[road]`: a generated road or a file; see [`road_source`](Self::road_source).
    #[serde(default)]
    pub road: toml::Table,
    /// `[noise]`: noise of the vehicle sensors.
    #[serde(default)]
    pub noise: SensorNoiseLevels,
    /// `[accelerometer]`: a longitudinal accelerometer; without it there is none.
    pub accelerometer: Option<AccelerometerTable>,
    /// `[pitch]`: a slope sensor; without it there is none.
    pub pitch: Option<PitchTable>,
    /// `[gnss]`: errors of the GNSS receiver.
    #[serde(default)]
    pub gnss: GnssErrors,
    /// `[latency_ms]`: latencies of the messages.
    #[serde(default)]
    pub latency_ms: Latencies,
    /// `[rates]`: message rates.
    #[serde(default)]
    pub rates: Rates,
    /// `[air]`: pressure and temperature.
    #[serde(default)]
    pub air: Air,
    /// `[wind]`: steady wind and gusts.
    #[serde(default)]
    pub wind: Wind,
    /// `[tyres]`: cold tyres.
    #[serde(default)]
    pub tyres: Tyres,
    /// `[planted]`: effects that no vehicle file describes.
    #[serde(default)]
    pub planted: PlantedTable,
    /// `[errors]`: parameter errors of every run without `[runs.errors]`.
    #[serde(default)]
    pub errors: ParameterErrors,
    /// `[[runs]]`: the traversals, at least one.
    #[serde(default)]
    pub runs: Vec<RunTable>,
}

const fn one() -> u64 {
    1
}

/// The source of the road.
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

impl ScenarioDocument {
    /// Returns the source of the road.
    ///
    /// # Errors
    /// Returns an error that names each key that does not belong to that source.
    pub fn road_source(&self) -> Result<RoadSource, toml::de::Error> {
        if self.road.contains_key("file") {
            let RoadFile { file } = self.road.clone().try_into()?;
            Ok(RoadSource::File(file))
        } else {
            Ok(RoadSource::Shape(self.road.clone().try_into()?))
        }
    }
}

/// `[errors]`: true over assumed vehicle parameters.
#[derive(Clone, Copy, Debug, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ParameterErrors {
    /// True over assumed mass, 0.2 to 3, default 1. Excludes `mass_sigma`.
    pub mass_factor: Option<f64>,
    /// Standard deviation of a random factor about 1 for the mass, 0 to 0.5; factors are limited to
    /// 0.3 to 1.7. Excludes `mass_factor`.
    pub mass_sigma: Option<f64>,
    /// True over assumed drag area, 0.2 to 3, default 1. Excludes `drag_sigma`.
    pub drag_factor: Option<f64>,
    /// Standard deviation of a random factor about 1 for the drag area, 0 to 0.5; factors are
    /// limited to 0.3 to 1.7. Excludes `drag_factor`.
    pub drag_sigma: Option<f64>,
    /// True over assumed rolling resistance coefficient, 0.2 to 3, default 1. Excludes
    /// `rolling_sigma`.
    pub rolling_factor: Option<f64>,
    /// Standard deviation of a random factor about 1 for the rolling resistance coefficient, 0 to
    /// 0.5; factors are limited to 0.3 to 1.7. Excludes `rolling_factor`.
    pub rolling_sigma: Option<f64>,
    /// True over assumed torque (true torque over reported percent times reference torque), 0.2 to
    /// 3, default 1. Excludes `torque_sigma`.
    pub torque_factor: Option<f64>,
    /// Standard deviation of a random factor about 1 for the torque, 0 to 0.5; factors are limited
    /// to 0.3 to 1.7. Excludes `torque_factor`.
    pub torque_sigma: Option<f64>,
}

/// Direction of travel on the road.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum DrivingDirection {
    /// In the direction of the stored road (default).
    #[default]
    Forward,
    /// Against it.
    Backward,
}

/// Initial state of a run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Start {
    /// At the set speed of the cruise control (default).
    #[default]
    SetSpeed,
    /// From standstill.
    Standstill,
}

/// `[[runs]]`: one traversal.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RunTable {
    /// Name of the run and of its files: letters, digits, `_`, `-` and `.`, the first a letter or
    /// digit. Required and unique.
    pub name: String,
    /// Preset of the vehicle, `A` or `B`. Excludes `vehicle`.
    pub truck: Option<Preset>,
    /// Vehicle file with a `[powertrain]`, relative to the scenario. Excludes `truck`.
    pub vehicle: Option<PathBuf>,
    /// Mass, kg, 500 to 200 000, default that of the vehicle.
    pub mass_kg: Option<f64>,
    /// Direction of travel, default `forward`.
    #[serde(default)]
    pub direction: DrivingDirection,
    /// Start, m in the direction of travel, 0 to 1 m before the end of the road, default 0.
    #[serde(default)]
    pub start_distance_m: f64,
    /// Length, m, 1 to the rest of the road, default the rest of the road.
    pub length_m: Option<f64>,
    /// Time of the log clock at the start, s, 0 to 1e12, default 0.
    #[serde(default)]
    pub start_time_s: f64,
    /// Initial state, default `set_speed`.
    #[serde(default)]
    pub start: Start,
    /// Time that the tyres have already rolled, s, 0 to 1e6, default 0.
    #[serde(default)]
    pub tyres_driven_s: f64,
    /// Air temperature of this run, °C, -60 to 60, default that of `[air]`.
    pub temperature_celsius: Option<f64>,
    /// Steady wind of this run, default that of `[wind]`.
    pub wind: Option<SteadyWind>,
    /// Parameter errors of this run, default those of `[errors]`.
    pub errors: Option<ParameterErrors>,
    /// `[[runs.stops]]`: stops on the way, in order, default none.
    #[serde(default)]
    pub stops: Vec<Stop>,
    /// `[[runs.sections]]`: sections in which something is different, default none.
    #[serde(default)]
    pub sections: Vec<Section>,
}
