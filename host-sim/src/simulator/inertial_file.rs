//! `[accelerometer]` and `[pitch]` of a scenario: sensors that a vehicle has only where the scenario
//! has their table. An empty table is a sensor with the default errors.

use super::range_check::check;
use serde::Deserialize;

/// `[accelerometer]`: a longitudinal accelerometer on the body.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct AccelerometerTable {
    /// Message that carries it, default ACCS.
    pub message: AccelerometerMessage,
    /// Period of ACCS, ms, 10 to 1000, default 20; VDC2 has that of `[rates]`.
    pub period_ms: f64,
    /// Offset at the start, m/s², -10 to 10, default 0.1.
    pub offset_mps2: f64,
    /// Random walk of the offset, as with temperature: 1 sigma after an hour, m/s², 0 to 10, default
    /// 0.02.
    pub drift_mps2: f64,
    /// Reported over true acceleration, -2 to 2, default 1.01.
    pub scale_factor: f64,
    /// Angle between the axis of the sensor and the road of a body at rest, positive nose up, deg, -180
    /// to 180, default 0.2.
    pub mounting_deg: f64,
    /// Pitch of the body for each m/s² of what it feels, motion and slope alike, deg, 0 to 10, default
    /// 0.3.
    pub body_pitch_deg_per_mps2: f64,
    /// Vibration by the road at 20 m/s, 1 sigma of a reading, m/s², 0 to 20, default 0.3.
    pub roughness_mps2: f64,
}

/// The message of an accelerometer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
pub enum AccelerometerMessage {
    /// ACCS 61485, steps of 0.01 m/s².
    #[serde(rename = "ACCS")]
    Accs,
    /// VDC2 61449, steps of 0.1 m/s².
    #[serde(rename = "VDC2")]
    Vdc2,
}

impl Default for AccelerometerTable {
    fn default() -> Self {
        Self {
            message: AccelerometerMessage::Accs,
            period_ms: 20.0,
            offset_mps2: 0.1,
            drift_mps2: 0.02,
            scale_factor: 1.01,
            mounting_deg: 0.2,
            body_pitch_deg_per_mps2: 0.3,
            roughness_mps2: 0.3,
        }
    }
}

impl AccelerometerTable {
    /// Checks the ranges.
    ///
    /// # Errors
    /// Returns the problem, beginning with the name of the key.
    pub fn check(&self) -> Result<(), String> {
        for (key, value, least, most) in [
            ("period_ms", self.period_ms, 10.0, 1_000.0),
            ("offset_mps2", self.offset_mps2, -10.0, 10.0),
            ("drift_mps2", self.drift_mps2, 0.0, 10.0),
            ("scale_factor", self.scale_factor, -2.0, 2.0),
            ("mounting_deg", self.mounting_deg, -180.0, 180.0),
            (
                "body_pitch_deg_per_mps2",
                self.body_pitch_deg_per_mps2,
                0.0,
                10.0,
            ),
            ("roughness_mps2", self.roughness_mps2, 0.0, 20.0),
        ] {
            check(&format!("accelerometer.{key}"), value, least..=most)?;
        }
        Ok(())
    }
}

/// `[pitch]`: a slope sensor on the body, compensated for acceleration.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct PitchTable {
    /// Message that carries it, default SSI.
    pub message: PitchMessage,
    /// Period, ms, 10 to 1000, default 20.
    pub period_ms: f64,
    /// Offset at the start, the mounting included, deg, -90 to 90, default 0.2.
    pub offset_deg: f64,
    /// Random walk of the offset: 1 sigma after an hour, deg, 0 to 10, default 0.05.
    pub drift_deg: f64,
    /// Pitch of the body for each m/s² of what it feels, deg, 0 to 10, default 0.3.
    pub body_pitch_deg_per_mps2: f64,
    /// White noise of each reading, 1 sigma, deg, 0 to 10, default 0.1.
    pub noise_sigma_deg: f64,
}

/// The message of a slope sensor.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
pub enum PitchMessage {
    /// SSI 61459, steps of 0.002°.
    #[serde(rename = "SSI")]
    Ssi,
    /// SSI2 61481, steps of 3e-5°.
    #[serde(rename = "SSI2")]
    Ssi2,
}

impl Default for PitchTable {
    fn default() -> Self {
        Self {
            message: PitchMessage::Ssi,
            period_ms: 20.0,
            offset_deg: 0.2,
            drift_deg: 0.05,
            body_pitch_deg_per_mps2: 0.3,
            noise_sigma_deg: 0.1,
        }
    }
}

impl PitchTable {
    /// Checks the ranges.
    ///
    /// # Errors
    /// Returns the problem, beginning with the name of the key.
    pub fn check(&self) -> Result<(), String> {
        for (key, value, least, most) in [
            ("period_ms", self.period_ms, 10.0, 1_000.0),
            ("offset_deg", self.offset_deg, -90.0, 90.0),
            ("drift_deg", self.drift_deg, 0.0, 10.0),
            (
                "body_pitch_deg_per_mps2",
                self.body_pitch_deg_per_mps2,
                0.0,
                10.0,
            ),
            ("noise_sigma_deg", self.noise_sigma_deg, 0.0, 10.0),
        ] {
            check(&format!("pitch.{key}"), value, least..=most)?;
        }
        Ok(())
    }
}
