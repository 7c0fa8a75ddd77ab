//! `[planted]`: effects in the true world that no vehicle file can tell, for a diagnosis to find.
//!
//! All of them are off by default. What the vehicle file could tell, and tells wrongly, is planted
//! with `[errors]`; wind and cold tyres have tables of their own.
//!
//! | key | unit | range | force against the motion |
//! |---|---|---|---|
//! | `cornering_compliance_rad` | rad | 0 to 2 | c m g (v yaw rate / g)²; a truck's tyres have about 1/5.5 |
//! | `driveline_loss` | part of the traction | 0 to 0.5 | part · \|traction\|, while it passes the driveline |
//! | `auxiliary_w` | W | 0 to 200 000 | power that the engine gives beside the wheels, while a gear ties the two |
//! | `fan_w` | W | 0 to 200 000 | the same while the fan is on, which SPN 975 tells |
//! | `fan_period_s` | s | 10 to 3600 | mean time from fan on to fan on; it is on for 0.4 of the time, irregularly |
//! | `brake_drag_n` | N | 0 to 50 000 | constant |
//! | `wheel_radius_factor` | 1 | 0.8 to 1.2 | true over believed radius: told speeds are true ones divided by it |
//! | `rough` | m, m, 1 | −0.01 to 0.05 | added to the rolling resistance between two places, whichever way it is driven |
//! | `side_resistance` | m, m, 1 | −0.01 to 0.05 | the same in the road's forward direction only: one carriageway |
//! | `torque_hysteresis` | % of reference torque | 0 to 50 | torque follows its signal with this much play |
//! | `thermostat_w` | W | 0 to 200 000 | as `auxiliary_w` in the first half of each period; nobody tells it |
//! | `thermostat_period_s` | s | 10 to 3600 | of the log's clock |
//!
//! Places count along the road in its forward direction. Cornering is the lateral force m v ψ'
//! times the slip angle c v ψ'/g that tyres need for it. Play is the backlash operator: what
//! arrives follows what is told only once it is a whole play behind, so that it is too low after
//! the torque rose and too high after it fell. Hysteresis, one-sided resistance and thermostat
//! stand for what a diagnosis has no name for.

use super::range_check::check;
use serde::Deserialize;

/// A stretch of road, from and to in m, and what it adds to the rolling resistance.
pub type Stretch = (f64, f64, f64);

/// The table.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct PlantedTable {
    pub cornering_compliance_rad: f64,
    pub driveline_loss: f64,
    pub auxiliary_w: f64,
    pub fan_w: f64,
    pub fan_period_s: f64,
    pub brake_drag_n: f64,
    pub wheel_radius_factor: f64,
    pub rough: Vec<Stretch>,
    pub side_resistance: Vec<Stretch>,
    pub torque_hysteresis: f64,
    pub thermostat_w: f64,
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
            torque_hysteresis: 0.0,
            thermostat_w: 0.0,
            thermostat_period_s: 90.0,
        }
    }
}

impl PlantedTable {
    /// Whether every value is one that a truck could have.
    ///
    /// # Errors
    /// What is wrong, beginning with the key's name.
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
            ("torque_hysteresis", self.torque_hysteresis, 0.0..=50.0),
            ("thermostat_w", self.thermostat_w, powers),
            ("thermostat_period_s", self.thermostat_period_s, periods),
        ] {
            check(&format!("planted.{name}"), value, range)?;
        }
        for (name, stretches) in [
            ("rough", &self.rough),
            ("side_resistance", &self.side_resistance),
        ] {
            for &(from_m, to_m, rolling) in stretches {
                check(&format!("planted.{name} (start)"), from_m, 0.0..=1e9)?;
                check(&format!("planted.{name} (end)"), to_m, from_m..=1e9)?;
                check(&format!("planted.{name} (rolling)"), rolling, -0.01..=0.05)?;
            }
        }
        Ok(())
    }
}
