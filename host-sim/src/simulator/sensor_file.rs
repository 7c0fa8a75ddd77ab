//! Errors, latencies and rates of the signals in the scenario file.

use serde::Deserialize;

/// `[noise]`: noise of the vehicle sensors.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct SensorNoiseLevels {
    /// White noise of each wheel-speed reading, 1 sigma, m/s, 0 to 5, default 0.011 (thesis 4.3.7).
    pub speed_sigma_mps: f64,
    /// White noise of each yaw-rate reading, 1 sigma, rad/s, 0 to 1, default 0.002.
    pub yaw_rate_sigma_radps: f64,
}

impl Default for SensorNoiseLevels {
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
    /// Slow altitude error, 1 sigma, m, 0 to 100, default 3.
    pub altitude_sigma_m: f64,
    /// Correlation time of the slow altitude error, s, 0.1 to 1e6, default 250.
    pub altitude_time_s: f64,
    /// White noise of each altitude, 1 sigma, m, 0 to 100, default 0.3.
    pub altitude_white_sigma_m: f64,
    /// Slow position error to the north and to the east, 1 sigma, m, 0 to 1000, default 1.5.
    pub position_sigma_m: f64,
    /// Correlation time of the position error, s, 0.1 to 1e6, default 250.
    pub position_time_s: f64,
    /// White noise of the speed over ground, 1 sigma, m/s, 0 to 10, default 0.05.
    pub speed_sigma_mps: f64,
    /// White noise of the course over ground, 1 sigma, deg, 0 to 180, default 0.3.
    pub course_sigma_deg: f64,
    /// Segments without a fix, `[from_m, to_m]` along the road as stored, 0 to 1e9 m, default none.
    pub outages_m: Vec<(f64, f64)>,
    /// Altitude steps, `[from_m, to_m, metres]`: the altitude is wrong by `metres`, -1e4 to 1e4,
    /// between the two distances; default none.
    pub steps: Vec<(f64, f64, f64)>,
    /// Altitude ramps, `[from_m, to_m, metres]`: the error grows to `metres`, -1e4 to 1e4, and ends
    /// there; default none.
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
    /// Engine messages (PGN 61444, 65247), ms, 0 to 5000, default 10.
    pub torque: f64,
    /// Wheel-speed messages (PGN 65265, 65215), ms, 0 to 5000, default 30.
    pub speed: f64,
    /// Gearbox messages (PGN 61442, 61445), ms, 0 to 5000, default 10.
    pub gearbox: f64,
    /// Brake and yaw-rate messages (PGN 65265 SPN 597, 61440, 61441, 61449), ms, 0 to 5000, default
    /// 20.
    pub chassis: f64,
    /// GNSS messages, ms, 0 to 5000, default 150.
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
    /// Period of ETC1 and VDC2, ms, 10 to 1000, default 10. A longer period makes smaller logs.
    pub fast_ms: f64,
}

impl Default for Rates {
    fn default() -> Self {
        Self { fast_ms: 10.0 }
    }
}
