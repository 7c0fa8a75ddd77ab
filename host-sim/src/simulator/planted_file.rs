//! `[planted]`: true effects that no vehicle file describes, as test cases for the diagnosis.
//!
//! All effects are off by default. Errors of parameters that a vehicle file has are set in
//! `[errors]`; wind and cold tyres have their own tables.
//!
//! | key | unit | range | force against the motion |
//! |---|---|---|---|
//! | `cornering_compliance_rad` | rad | 0 to 2 | c m g (v yaw rate / g)²; a truck's tyres have about 1/5.5 |
//! | `driveline_loss` | part of the traction | 0 to 0.5 | part · \|traction\|, while it passes the driveline |
//! | `auxiliary_w` | W | 0 to 200 000 | engine power for auxiliaries, while a gear couples engine and wheels |
//! | `fan_w` | W | 0 to 200 000 | the same while the fan is on; SPN 975 reports the fan |
//! | `fan_period_s` | s | 10 to 3600 | mean period; the fan is on for 0.4 of the time, at random intervals |
//! | `brake_drag_n` | N | 0 to 50 000 | constant |
//! | `wheel_radius_factor` | 1 | 0.8 to 1.2 | true over assumed radius: reported speeds are true ones divided by it |
//! | `rough` | m, m, 1 | −0.01 to 0.05 | added to the rolling resistance between two distances, in both directions |
//! | `side_resistance` | m, m, 1 | −0.01 to 0.05 | the same in the road's forward direction only: one carriageway |
//! | `tyre_temperature_per_k` | 1/K | −0.05 to 0.1 | amount · c_r m g (25 °C − air temperature) |
//! | `torque_hysteresis` | % of reference torque | 0 to 50 | backlash between the signal and the torque |
//! | `thermostat_w` | W | 0 to 200 000 | as `auxiliary_w` in the first half of each period; no signal reports it |
//! | `thermostat_period_s` | s | 10 to 3600 | of the log's clock |
//!
//! Distances count along the road in its forward direction. The cornering force is the lateral
//! force m v ψ' times the slip angle c v ψ'/g that the tyres need for it. Hysteresis is the
//! backlash operator: the torque follows its signal only when it lags by the whole width, so it is
//! too low after a rise and too high after a fall. Hysteresis, one-sided resistance and thermostat
//! are effects that the diagnosis has no candidate for.

use super::range_check::check;
use serde::Deserialize;

/// A road section: from and to, m, and the rolling resistance that it adds.
pub type ResistanceSection = (f64, f64, f64);

/// The table `[planted]`; the module lists units and ranges.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct PlantedTable {
    /// Compliance of the tyres in cornering, rad, 0 to 2, default 0.
    pub cornering_compliance_rad: f64,
    /// Loss in the driveline, as a part of the traction, 0 to 0.5, default 0.
    pub driveline_loss: f64,
    /// Constant auxiliary power of the engine, W, 0 to 200 000, default 0.
    pub auxiliary_w: f64,
    /// Fan power while the fan is on, W, 0 to 200 000, default 0; SPN 975 reports the fan.
    pub fan_w: f64,
    /// Mean period of the fan, s, 10 to 3600, default 120.
    pub fan_period_s: f64,
    /// Constant brake drag, N, 0 to 50 000, default 0.
    pub brake_drag_n: f64,
    /// True over assumed wheel radius, 0.8 to 1.2, default 1.
    pub wheel_radius_factor: f64,
    /// Rough road sections, in both directions, default none.
    pub rough: Vec<ResistanceSection>,
    /// Rough road sections, in the forward direction only, default none.
    pub side_resistance: Vec<ResistanceSection>,
    /// Rolling resistance for each kelvin below 25 °C, as a part of it, 1/K, −0.05 to 0.1, default
    /// 0.
    pub tyre_temperature_per_k: f64,
    /// Hysteresis of the torque, % of the reference torque, 0 to 50, default 0.
    pub torque_hysteresis: f64,
    /// Auxiliary power in the first half of each period, W, 0 to 200 000, default 0; no signal
    /// reports it.
    pub thermostat_w: f64,
    /// Period of the thermostat by the log clock, s, 10 to 3600, default 90.
    pub thermostat_period_s: f64,
}

impl Default for PlantedTable {
    fn default() -> Self {
        Self {
            cornering_compliance_rad: 0.0,
            driveline_loss: 0.0,
            auxiliary_w: 0.0,
            fan_w: 0.0,
            fan_period_s: 120.0,
            brake_drag_n: 0.0,
            wheel_radius_factor: 1.0,
            rough: Vec::new(),
            side_resistance: Vec::new(),
            tyre_temperature_per_k: 0.0,
            torque_hysteresis: 0.0,
            thermostat_w: 0.0,
            thermostat_period_s: 90.0,
        }
    }
}

impl PlantedTable {
    /// Checks that every value is within its range.
    ///
    /// # Errors
    /// Returns the problem, beginning with the name of the key.
    pub fn check(&self) -> Result<(), String> {
        let periods = 10.0..=3_600.0;
        let powers = 0.0..=200_000.0;
        for (name, value, range) in [
            (
                "cornering_compliance_rad",
                self.cornering_compliance_rad,
                0.0..=2.0,
            ),
            ("driveline_loss", self.driveline_loss, 0.0..=0.5),
            ("auxiliary_w", self.auxiliary_w, powers.clone()),
            ("fan_w", self.fan_w, powers.clone()),
            ("fan_period_s", self.fan_period_s, periods.clone()),
            ("brake_drag_n", self.brake_drag_n, 0.0..=50_000.0),
            ("wheel_radius_factor", self.wheel_radius_factor, 0.8..=1.2),
            (
                "tyre_temperature_per_k",
                self.tyre_temperature_per_k,
                -0.05..=0.1,
            ),
            ("torque_hysteresis", self.torque_hysteresis, 0.0..=50.0),
            ("thermostat_w", self.thermostat_w, powers),
            ("thermostat_period_s", self.thermostat_period_s, periods),
        ] {
            check(&format!("planted.{name}"), value, range)?;
        }
        for (name, sections) in [
            ("rough", &self.rough),
            ("side_resistance", &self.side_resistance),
        ] {
            for &(from_m, to_m, rolling) in sections {
                check(&format!("planted.{name} (start)"), from_m, 0.0..=1e9)?;
                check(&format!("planted.{name} (end)"), to_m, from_m..=1e9)?;
                check(&format!("planted.{name} (rolling)"), rolling, -0.01..=0.05)?;
            }
        }
        Ok(())
    }
}
