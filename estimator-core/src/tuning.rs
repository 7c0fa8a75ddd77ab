//! The numbers a user may turn, each in a unit that can be judged.

use crate::time::Duration;

/// Noise levels, hold times and latencies.
///
/// Force noises are forces: the grade error they make goes as 1/(m g), so that one set serves a
/// loaded combination and a solo tractor alike.
#[derive(Clone, Debug, PartialEq)]
pub struct Tuning {
    /// White noise of one wheel-speed reading, 1 sigma, m/s. From the width of the pointwise
    /// grade errors in the thesis (tables 2 and 3): 0.009 to 0.013.
    pub speed_sigma_mps: f32,
    /// The same below [`Self::crawl_mps`], where pulses of a wheel sensor are few, m/s.
    pub crawl_speed_sigma_mps: f32,
    /// Speed under which speed readings are coarse, m/s.
    pub crawl_mps: f32,

    /// Change of grade along the road: 1 sigma of its rate, % per m. A crest built for
    /// 110 km/h has 0.014 (AASHTO K = 74).
    pub slope_rate_sigma: f32,
    /// Distance over which the rate of change keeps its sign, m; the length of a vertical curve.
    pub slope_rate_length_m: f32,
    /// Grade expected before anything is known, 1 sigma, %.
    pub slope_sigma: f32,

    /// Force the model misses from cell to cell, white, 1 sigma over one cell of 2.5 m, N.
    pub force_noise_n: f32,
    /// Grade-equivalent noise over one cell while the model does not hold (shift, brake), %.
    pub invalid_noise_percent: f32,

    /// Slow model error that does not grow with mass (wind, auxiliaries), 1 sigma, N.
    pub bias_force_n: f32,
    /// Slow model error as a part of the rolling resistance (tyres, surface), 1 sigma, 1.
    pub bias_rolling: f32,
    /// Slow model error as a part of the air resistance (shape, density), 1 sigma, 1.
    pub bias_drag: f32,
    /// Distance over which the slow error keeps its value, m.
    pub bias_length_m: f32,

    /// Wind along the road that comes and goes, 1 sigma, m/s.
    pub wind_sigma_mps: f32,
    /// Distance over which it keeps its value, m.
    pub wind_length_m: f32,

    /// What the slow error may be besides where a drive begins and nothing is known, as a part of
    /// the rolling resistance, 1 sigma: cold tyres add 0.3 to 0.8 of it.
    pub bias_start_rolling: f32,

    /// Error of the traction scale (mass or torque) at the start, 1 sigma, 1.
    pub scale_sigma: f32,
    /// How far it may have gone from where it began, in sigmas, before that was too narrow.
    pub scale_sigmas: f32,
    /// Wander of the scale, 1 sigma, per square root of a km.
    pub scale_walk_per_sqrt_km: f32,

    /// Largest change of traction over weight in one cell that the road may have caused, %. The
    /// sharpest crest for 80 km/h bends by 0.096 (AASHTO K = 26).
    pub load_change_percent: f32,

    /// White noise of one GNSS altitude at a dilution of precision of one, 1 sigma, m.
    pub altitude_sigma_m: f32,
    /// Coloured error of GNSS altitude, 1 sigma, m.
    pub gnss_error_sigma_m: f32,
    /// Time over which it keeps its value, s.
    pub gnss_error_time_s: f32,
    /// How far fixes may climb unlike the road, in sigmas of what model and receiver may be off,
    /// before they are taken to drift.
    pub drift_sigmas: f32,
    /// Silence of GNSS after which the altitude is set anew from the next fix: it says no more what
    /// the way climbed.
    pub gnss_silence: Duration,
    /// Age of a GNSS fix when it arrives.
    pub gnss_latency: Duration,

    /// How long the model stays invalid after a gear shift.
    pub shift_hold: Duration,
    /// How long the model stays invalid after braking.
    pub brake_hold: Duration,
    /// How long the model stays invalid after a retarder's torque is gone: it empties slowly.
    pub retarder_hold: Duration,
    /// Speed from which an open driveline is one that coasts, m/s. Below it a clutch that is not
    /// closed slips at launch and passes torque.
    pub coast_mps: f32,

    /// Slope of the moment over that of the last 100 m from which, where no brake signal is heard,
    /// it is taken for a brake, %.
    pub slowing_percent: f32,

    /// Shortest standstill at which the vehicle may be weighed.
    pub stop: Duration,
    /// Standstill, or silence, so long that anything may have been loaded or coupled, and tyres
    /// are cold again: scale and bias are as uncertain as at the start.
    pub long_stop: Duration,
    /// Change of the mass told at stops, since the last such, that does the same, 1. Less is
    /// within what weighings and passenger counts tell well enough.
    pub mass_change: f32,
}

impl Default for Tuning {
    fn default() -> Self {
        Self {
            speed_sigma_mps: 0.013,
            crawl_speed_sigma_mps: 0.1,
            crawl_mps: 1.5,
            slope_rate_sigma: 0.006,
            slope_rate_length_m: 150.0,
            slope_sigma: 3.0,
            force_noise_n: 120.0,
            invalid_noise_percent: 30.0,
            bias_force_n: 250.0,
            bias_rolling: 0.15,
            bias_drag: 0.1,
            bias_length_m: 100_000.0,
            wind_sigma_mps: 0.7,
            wind_length_m: 3_000.0,
            bias_start_rolling: 0.5,
            scale_sigma: 0.1,
            scale_sigmas: 3.0,
            scale_walk_per_sqrt_km: 0.002,
            load_change_percent: 0.1,
            altitude_sigma_m: 0.5,
            gnss_error_sigma_m: 3.0,
            gnss_error_time_s: 200.0,
            drift_sigmas: 4.0,
            gnss_silence: Duration::from_millis(300_000),
            gnss_latency: Duration::from_millis(150),
            shift_hold: Duration::from_millis(1000),
            brake_hold: Duration::from_millis(1000),
            retarder_hold: Duration::from_millis(2000),
            coast_mps: 5.0,
            slowing_percent: 3.0,
            stop: Duration::from_millis(3_000),
            long_stop: Duration::from_millis(600_000),
            mass_change: 0.15,
        }
    }
}
