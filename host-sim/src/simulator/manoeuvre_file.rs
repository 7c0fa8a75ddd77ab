//! `[[runs.stops]]` and `[[runs.sections]]`: what happens to one run on its way.
//!
//! A run without them drives from its start to its end, as fast as the cruise control and the
//! engine allow. Distances count in the direction of travel, like `start_distance_m`.
//!
//! | key of `[[runs.stops]]` | unit | range | meaning |
//! |---|---|---|---|
//! | `at_m` | m | 0 to 1e9 | where the driver wants to stop; required |
//! | `seconds` | s | 1 to 1e5 | time at standstill, parking brake set; default 60 |
//! | `mass_kg` | kg | 500 to 200 000 | true mass from then on; no signal reports it |
//! | `reverse_m` | m | 0 to 1000 | way driven backwards, before the time at standstill; default 0 |
//! | `carried_m` | m | 0 to 1e6 | way along the road that the standing vehicle is carried, as by a
//! ferry; default 0 |
//!
//! | key of `[[runs.sections]]` | unit | range | meaning from `from_m` to `to_m` |
//! |---|---|---|---|
//! | `from_m` | m | 0 to 1e9 | start of the section; required |
//! | `to_m` | m | `from_m` to 1e9 | end of the section; required |
//! | `rolling_factor` | 1 | 0.1 to 20 | factor on the rolling resistance, such as of snow |
//! | `headwind_mps` | m/s | −40 to 40 | headwind besides that of `[wind]` |
//! | `pto_nm` | Nm | 0 to 2000 | engine torque that a power take-off uses while a gear is engaged;
//! the reported torque includes it |
//! | `range_ratio` | 1 | 0.2 to 10 | ratio of a transfer case between gearbox and axle |
//! | `set_speed_mps` | m/s | 1 to 40 | set speed of the cruise control |
//! | `retarder` | | | true: a retarder, reported as SPN 520, keeps the set speed downhill |
//!
//! Sections may overlap: factors multiply, forces and winds add, the lowest set speed counts.

use super::range_check::check;
use serde::Deserialize;

/// `[[runs.stops]]`: a stop; the module lists units and ranges.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Stop {
    /// Place at which the driver wants to stop, m, 0 to 1e9.
    pub at_m: f64,
    /// Time at standstill, s, 1 to 1e5, default 60.
    #[serde(default = "minute")]
    pub seconds: f64,
    /// True mass from then on, kg, 500 to 200 000, default unchanged.
    pub mass_kg: Option<f64>,
    /// Way driven backwards before the time at standstill, m, 0 to 1000, default 0.
    #[serde(default)]
    pub reverse_m: f64,
    /// Way that the standing vehicle is carried along the road, m, 0 to 1e6, default 0.
    #[serde(default)]
    pub carried_m: f64,
}

const fn minute() -> f64 {
    60.0
}

impl Stop {
    /// Creates a stop at a place, m, for some time, s.
    #[must_use]
    pub const fn new(at_m: f64, seconds: f64) -> Self {
        Self {
            at_m,
            seconds,
            mass_kg: None,
            reverse_m: 0.0,
            carried_m: 0.0,
        }
    }

    fn check(&self) -> Result<(), String> {
        check("at_m", self.at_m, 0.0..=1e9)?;
        check("seconds", self.seconds, 1.0..=1e5)?;
        if let Some(mass_kg) = self.mass_kg {
            check("mass_kg", mass_kg, 500.0..=200_000.0)?;
        }
        check("reverse_m", self.reverse_m, 0.0..=1e3)?;
        check("carried_m", self.carried_m, 0.0..=1e6)
    }
}

/// `[[runs.sections]]`: a section of the way; the module lists units and ranges.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Section {
    /// Start, m, 0 to 1e9.
    pub from_m: f64,
    /// End, m, `from_m` to 1e9.
    pub to_m: f64,
    /// Factor on the rolling resistance, 0.1 to 20, default 1.
    #[serde(default = "one")]
    pub rolling_factor: f64,
    /// Additional headwind, m/s, -40 to 40, default 0.
    #[serde(default)]
    pub headwind_mps: f64,
    /// Engine torque that a power take-off uses, Nm, 0 to 2000, default 0.
    #[serde(default)]
    pub pto_nm: f64,
    /// Ratio of a transfer case between gearbox and axle, 0.2 to 10, default 1.
    #[serde(default = "one")]
    pub range_ratio: f64,
    /// Set speed of the cruise control, m/s, 1 to 40, default 22.2 (80 km/h).
    pub set_speed_mps: Option<f64>,
    /// True if a retarder keeps the set speed downhill, default false.
    #[serde(default)]
    pub retarder: bool,
}

const fn one() -> f64 {
    1.0
}

impl Section {
    /// Creates a section, from and to, m, in which nothing is special.
    #[must_use]
    pub const fn new(from_m: f64, to_m: f64) -> Self {
        Self {
            from_m,
            to_m,
            rolling_factor: 1.0,
            headwind_mps: 0.0,
            pto_nm: 0.0,
            range_ratio: 1.0,
            set_speed_mps: None,
            retarder: false,
        }
    }

    fn check(&self) -> Result<(), String> {
        check("from_m", self.from_m, 0.0..=1e9)?;
        check("to_m", self.to_m, self.from_m..=1e9)?;
        check("rolling_factor", self.rolling_factor, 0.1..=20.0)?;
        check("headwind_mps", self.headwind_mps, -40.0..=40.0)?;
        check("pto_nm", self.pto_nm, 0.0..=2e3)?;
        check("range_ratio", self.range_ratio, 0.2..=10.0)?;
        self.set_speed_mps.map_or(Ok(()), |set_speed_mps| {
            check("set_speed_mps", set_speed_mps, 1.0..=40.0)
        })
    }
}

/// Checks the stops and sections of a run.
///
/// # Errors
/// Returns the problem, beginning with the name of the key.
pub fn check_manoeuvres(stops: &[Stop], sections: &[Section]) -> Result<(), String> {
    let mut before_m = f64::NEG_INFINITY;
    for (index, stop) in stops.iter().enumerate() {
        stop.check()
            .map_err(|problem| format!("stops[{index}].{problem}"))?;
        if stop.at_m <= before_m {
            return Err(format!(
                "stops[{index}].at_m = {}: expected more than that of the stop before",
                stop.at_m
            ));
        }
        before_m = stop.at_m + stop.carried_m;
    }
    for (index, section) in sections.iter().enumerate() {
        section
            .check()
            .map_err(|problem| format!("sections[{index}].{problem}"))?;
    }
    Ok(())
}
