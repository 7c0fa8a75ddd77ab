//! Speed and acceleration of a log, collected while it is read.

use crate::inertial_judge::InertialProfile;
use crate::source::input::LogInput;
use estimator_core::{Decoder, Instant, Reading, Signal, Value};

/// Collects speed and acceleration from the inputs of a log.
#[derive(Default)]
pub(super) struct Collector {
    decoder: Decoder,
    speed_mps: f64,
    times_s: Vec<f64>,
    speeds_mps: Vec<f64>,
    accelerations_mps2: Vec<f64>,
}

impl Collector {
    /// Takes an input.
    pub(super) fn on_input(&mut self, input: &LogInput) {
        match input {
            LogInput::Reading(time, reading) => self.take(seconds(*time), *reading),
            LogInput::Frame(timed) => {
                let mut readings = Vec::new();
                self.decoder.decode(&timed.frame, |_, _, reading| {
                    readings.push(reading);
                });
                for reading in readings {
                    self.take(seconds(timed.time), reading);
                }
            }
        }
    }

    fn take(&mut self, time_s: f64, reading: Reading) {
        let Value::Real(value) = reading.value else {
            return;
        };
        match reading.signal {
            Signal::WheelSpeed => {
                self.speed_mps = f64::from(value);
                // A row of a table is one time: its speed belongs to its acceleration.
                if self.times_s.last() == Some(&time_s)
                    && let Some(last) = self.speeds_mps.last_mut()
                {
                    *last = self.speed_mps;
                }
            }
            Signal::LongitudinalAcceleration if self.times_s.last() != Some(&time_s) => {
                self.times_s.push(time_s);
                self.speeds_mps.push(self.speed_mps);
                self.accelerations_mps2.push(f64::from(value));
            }
            _ => {}
        }
    }

    /// Returns the profile; `None` if there was no acceleration.
    pub(super) fn profile(self) -> Option<InertialProfile> {
        (!self.times_s.is_empty()).then(|| {
            InertialProfile::new(&self.times_s, &self.speeds_mps, &self.accelerations_mps2)
        })
    }
}

/// Returns the time of the log's clock, s.
pub(super) fn seconds(time: Instant) -> f64 {
    time.since(Instant::ZERO).as_secs_f64()
}
