//! Seeded random numbers. Each purpose and run has its own stream, so that a change of one use does
//! not change the others.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::StandardNormal;

/// Purpose of a stream.
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
    /// Jitter of the messages.
    Bus,
    /// Gusts of wind.
    Wind,
    /// Switching times of a planted fan.
    Fan,
    /// Errors of the inertial sensors.
    Inertial,
}

/// Returns the stream of `purpose` in run `index` of the scenario with this `seed`.
#[must_use]
pub fn stream(seed: u64, index: usize, purpose: Purpose) -> ChaCha8Rng {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    rng.set_stream(((index as u64) << 8) | purpose as u64);
    rng
}

/// Draws from the standard normal distribution.
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
    /// Creates a process with this standard deviation and correlation time, in its stationary
    /// state.
    pub fn new(sigma: f64, time_s: f64, rng: &mut ChaCha8Rng) -> Self {
        Self {
            sigma,
            time_s,
            value: sigma * normal(rng),
        }
    }

    /// Advances by `seconds` and returns the value; exact for any step.
    pub fn advance(&mut self, seconds: f64, rng: &mut ChaCha8Rng) -> f64 {
        let decay = (-seconds / self.time_s).exp();
        let fresh = self.sigma * (1.0 - decay * decay).sqrt();
        self.value = decay * self.value + fresh * normal(rng);
        self.value
    }
}
