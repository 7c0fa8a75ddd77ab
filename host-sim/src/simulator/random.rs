//! Seeded randomness: one independent stream a purpose and run, so that a change in one place
//! leaves the numbers of every other as they were.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::StandardNormal;

/// What the numbers are for.
#[derive(Clone, Copy, Debug)]
pub enum Purpose {
    /// Profile and plan of the road; the same for every run.
    Road,
    /// True parameters of a run's vehicle.
    Parameters,
    /// Durations of gear shifts.
    Gearbox,
    /// Noise of the vehicle's sensors.
    Sensors,
    /// Errors of the GNSS receiver.
    Gnss,
    /// Moments at which messages are sent.
    Bus,
    /// Gusts of wind.
    Wind,
    /// When a planted fan runs.
    Fan,
}

/// The stream of `purpose` in run `index` of the scenario seeded with `seed`.
#[must_use]
pub fn stream(seed: u64, index: usize, purpose: Purpose) -> ChaCha8Rng {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    rng.set_stream(((index as u64) << 8) | purpose as u64);
    rng
}

/// One draw from the standard normal distribution.
pub fn normal(rng: &mut ChaCha8Rng) -> f64 {
    rng.sample(StandardNormal)
}

/// A stationary Ornstein-Uhlenbeck process: exponentially correlated noise.
#[derive(Clone, Copy, Debug)]
pub struct OrnsteinUhlenbeck {
    sigma: f64,
    time_s: f64,
    value: f64,
}

impl OrnsteinUhlenbeck {
    /// A process with this standard deviation and correlation time, already in its stationary
    /// state.
    pub fn new(sigma: f64, time_s: f64, rng: &mut ChaCha8Rng) -> Self {
        Self {
            sigma,
            time_s,
            value: sigma * normal(rng),
        }
    }

    /// The value after `seconds` more; exact for any step.
    pub fn advance(&mut self, seconds: f64, rng: &mut ChaCha8Rng) -> f64 {
        let kept = (-seconds / self.time_s).exp();
        let fresh = self.sigma * (1.0 - kept * kept).sqrt();
        self.value = kept * self.value + fresh * normal(rng);
        self.value
    }
}
