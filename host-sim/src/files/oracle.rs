//! `oracle.toml`: the true vehicle parameters and the true noise levels of a run, but not the noise
//! itself. A filter with these values shows the limit of better parameters and tuning.
//!
//! The file has the tables of vehicle.toml with the true values, and `[noise]`. Optional keys may
//! be left out; the effect is then absent. Unknown keys and values out of range are errors that
//! name the key.
//!
//! ```toml
//! [vehicle]                      # as in vehicle.toml
//! [powertrain]
//!
//! [noise]                        # true levels, 1 sigma
//! speed_sigma_mps = 0.011        # white, each wheel-speed reading
//! gnss_white_sigma_m = 0.3       # white, each GNSS altitude
//! gnss_slow = { sigma_m = 3.0, time_s = 250.0 }   # slow altitude error and its correlation time
//! gnss_latency_s = 0.15          # age of a fix when it arrives
//! force_white_sigma_n = 5.0      # optional: traction force, mean over a cell of 2.5 m
//! force_slow = { sigma_n = 40.0, time_s = 300.0 }      # optional: auxiliaries and the like
//! headwind = { sigma_mps = 1.4, time_s = 4000.0 }      # optional: along the road, zero mean; if
//!                                                      # steady, longer than the run
//! cold_tyres = { amount = 0.3, time_s = 1500.0 }       # optional: rolling resistance is (1 + amount)
//!                                                      # times as large at first, and decays
//! ```

use super::kind::{self, Kind};
use super::limits::read_text;
use super::output::write_whole;
use super::run::RunRow;
use super::vehicle::VehicleFile;
use crate::error::{Error, Result};
use estimator_core::vehicle::STANDARD_AIR_DENSITY;
use estimator_core::{Duration, Tuning};
use serde::{Deserialize, Serialize};
use std::path::Path;

/// Lower limits of the levels, so that no variance is zero.
mod least {
    /// Wheel speed, m/s: a step of SPN 84 is 0.001.
    pub const SPEED_MPS: f64 = 3e-4;
    /// GNSS altitude, m.
    pub const ALTITUDE_M: f64 = 0.01;
    /// Force, N.
    pub const FORCE_N: f64 = 1.0;
    /// Air density times drag area, kg/m.
    pub const AIR: f64 = 0.1;
    /// Wind, m/s.
    pub const WIND_MPS: f64 = 0.01;
    /// Traction scale, 1.
    pub const SCALE: f32 = 1e-3;
    /// Random walk of the scale, per square root of a km.
    pub const SCALE_WALK: f32 = 1e-5;
}

/// Longest correlation time, s.
pub const LONGEST_TIME_S: f64 = 1e6;

/// The true parameters and noise levels of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct OracleFile {
    /// The true vehicle.
    pub vehicle: VehicleFile,
    /// True levels of the noise.
    pub noise: OracleNoise,
}

/// `[noise]`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct OracleNoise {
    /// White noise of one wheel-speed reading, m/s.
    pub speed_sigma_mps: f64,
    /// White noise of one GNSS altitude, m.
    pub gnss_white_sigma_m: f64,
    /// Age of a GNSS fix when it arrives, s.
    pub gnss_latency_s: f64,
    /// White noise of the traction force, mean over a cell, N.
    #[serde(default)]
    pub force_white_sigma_n: f64,
    /// Slow error of GNSS altitude.
    pub gnss_slow: SlowAltitude,
    /// Slow force that the vehicle model lacks.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub force_slow: Option<SlowForce>,
    /// Wind against the direction of travel.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub headwind: Option<Headwind>,
    /// Tyres that are cold at the start.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub cold_tyres: Option<ColdTyres>,
}

/// A correlated altitude error.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SlowAltitude {
    /// 1 sigma, m.
    pub sigma_m: f64,
    /// Correlation time, s.
    pub time_s: f64,
}

/// A correlated force.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SlowForce {
    /// 1 sigma, N.
    pub sigma_n: f64,
    /// Correlation time, s.
    pub time_s: f64,
}

/// Wind along the road.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Headwind {
    /// 1 sigma about no wind, m/s.
    pub sigma_mps: f64,
    /// Correlation time, s.
    pub time_s: f64,
}

/// Rolling resistance above that of warm tyres, at the start.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ColdTyres {
    /// At the start, as a part of that of warm tyres.
    pub amount: f64,
    /// Time in which it falls to 1/e, s.
    pub time_s: f64,
}

/// Returns the mean speed of a run, m/s; at least 1 m/s.
#[must_use]
pub fn mean_speed_mps(rows: &[RunRow]) -> f64 {
    let sum: f64 = rows.iter().map(|row| row.speed_mps).sum();
    (sum / rows.len().max(1) as f64).max(1.0)
}

impl OracleFile {
    /// Reads and checks an oracle file.
    ///
    /// # Errors
    /// Returns an error that names each unknown key, missing key and value out of range.
    pub fn read(path: &Path) -> Result<Self> {
        Self::read_content(path)
            .map_err(|e| kind::explained(e, path, &[Kind::Oracle, Kind::Vehicle]))
    }

    fn read_content(path: &Path) -> Result<Self> {
        let text = read_text(path)?;
        let key = |problem: String| Error::Key {
            path: path.to_owned(),
            problem,
        };
        let toml_error = |e: toml::de::Error| key(e.to_string().trim_end().to_owned());
        let mut document: toml::Table = toml::from_str(&text).map_err(toml_error)?;
        let noise: OracleNoise = document
            .remove("noise")
            .ok_or_else(|| key("missing [noise]; expected the true noise levels".to_owned()))?
            .try_into()
            .map_err(|e: toml::de::Error| key(format!("[noise]: {}", e.to_string().trim_end())))?;
        noise.check().map_err(key)?;
        let vehicle = VehicleFile::from_table(document, path)?;
        Ok(Self { vehicle, noise })
    }

    /// Writes the file.
    ///
    /// # Errors
    /// Returns the error of the file system.
    pub fn write(&self, path: &Path) -> Result<()> {
        #[derive(Serialize)]
        struct NoiseTable {
            noise: OracleNoise,
        }
        let noise =
            toml::to_string(&NoiseTable { noise: self.noise }).expect("plain numbers are TOML");
        write_whole(path, |out| {
            write!(out, "{}\n{noise}", self.vehicle.to_toml())
        })
    }

    /// Returns the tuning of the oracle for a run of this mean speed: no uncertainty of the vehicle
    /// parameters, and the true noise levels. Road, hold times and other settings that no simulator
    /// decides keep their defaults.
    ///
    /// The filter models wind and other slow forces as one process. Its variance is the sum of
    /// theirs. Its correlation time is such that each step adds as much variance as they do
    /// together. Cold tyres are the slow bias, which starts with their error and decays as they
    /// warm up.
    #[must_use]
    pub fn tuning(&self, run_mps: f64) -> Tuning {
        let noise = &self.noise;
        let vehicle = &self.vehicle.model.vehicle;
        let at_least = |value: f64, least: f64| value.max(least) as f32;

        let air = f64::from(STANDARD_AIR_DENSITY * vehicle.drag_area_m2).max(least::AIR);
        let force = noise.force_slow.map(|force| (force.sigma_n, force.time_s));
        // d(ρ/2 cd A (v + w)²)/dw at w = 0.
        let wind = noise
            .headwind
            .map(|wind| (air * run_mps * wind.sigma_mps, wind.time_s));
        let (variance, per_s) = [force, wind]
            .into_iter()
            .flatten()
            .map(|(sigma_n, time_s)| (sigma_n * sigma_n, sigma_n * sigma_n / time_s))
            .fold((0.0, 0.0), |sum, one| (sum.0 + one.0, sum.1 + one.1));
        let mut tuning = Tuning::default();
        let numbers = &mut tuning.estimation;
        numbers.speed_noise_mps = at_least(noise.speed_sigma_mps, least::SPEED_MPS);
        numbers.altitude_noise_m = at_least(noise.gnss_white_sigma_m, least::ALTITUDE_M);
        numbers.slow_gnss_noise_m = at_least(noise.gnss_slow.sigma_m, least::ALTITUDE_M);
        numbers.slow_gnss_time_s = noise.gnss_slow.time_s as f32;
        numbers.fast_gnss_noise_m = least::ALTITUDE_M as f32;
        numbers.force_noise_n = at_least(noise.force_white_sigma_n, least::FORCE_N);
        numbers.bias_force_n = least::FORCE_N as f32;
        numbers.bias_resistance = 0.0;
        if let Some(tyres) = noise.cold_tyres {
            numbers.bias_length_m = (run_mps * tyres.time_s) as f32;
        }
        numbers.wind_noise_mps = at_least(variance.sqrt() / (air * run_mps), least::WIND_MPS);
        if per_s > 0.0 {
            numbers.wind_length_m = (run_mps * variance / per_s) as f32;
        }
        numbers.traction_noise = 0.0;
        numbers.scale_walk_per_sqrt_km = least::SCALE_WALK;
        numbers.prior_cold_tyre = noise.cold_tyres.map_or(0.0, |tyres| tyres.amount) as f32;
        numbers.prior_scale = least::SCALE;
        numbers.prior_tyre_slip = 0.0;
        // The load does not change, nothing steps, and the levels of the noise are known.
        numbers.load_shock = least::SCALE;
        numbers.any_load = least::SCALE;
        numbers.bias_shock_most_percent = 0.0;
        numbers.inertia_noise = 0.0;
        for level in [
            &mut numbers.slow_gnss_level_low,
            &mut numbers.level_low,
            &mut numbers.level_high,
        ] {
            *level = 1.0;
        }
        tuning.hold_times.gnss_latency = Duration::from_micros((noise.gnss_latency_s * 1e6) as u64);
        tuning
    }
}

impl OracleNoise {
    fn check(&self) -> std::result::Result<(), String> {
        let within = |name: &str, value: f64, least: f64, most: f64| {
            if (least..=most).contains(&value) {
                Ok(())
            } else {
                Err(format!(
                    "noise.{name} = {value}: expected {least} to {most}"
                ))
            }
        };
        let time = |name: &str, time_s: f64| {
            within(&format!("{name}.time_s"), time_s, 0.1, LONGEST_TIME_S)
        };
        within("speed_sigma_mps", self.speed_sigma_mps, 0.0, 5.0)?;
        within("gnss_white_sigma_m", self.gnss_white_sigma_m, 0.0, 100.0)?;
        within("gnss_slow.sigma_m", self.gnss_slow.sigma_m, 0.0, 100.0)?;
        time("gnss_slow", self.gnss_slow.time_s)?;
        within("gnss_latency_s", self.gnss_latency_s, 0.0, 5.0)?;
        within("force_white_sigma_n", self.force_white_sigma_n, 0.0, 1e5)?;
        if let Some(force) = self.force_slow {
            within("force_slow.sigma_n", force.sigma_n, 0.0, 1e5)?;
            time("force_slow", force.time_s)?;
        }
        if let Some(wind) = self.headwind {
            within("headwind.sigma_mps", wind.sigma_mps, 0.0, 40.0)?;
            time("headwind", wind.time_s)?;
        }
        if let Some(tyres) = self.cold_tyres {
            within("cold_tyres.amount", tyres.amount, 0.0, 5.0)?;
            time("cold_tyres", tyres.time_s)?;
        }
        Ok(())
    }
}
