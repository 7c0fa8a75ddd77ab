//! Drives that are given as readings.

use estimator_core::sample::Sample;
use estimator_core::{Context, Instant, Intake, Model, Reading, Sampler, Signal, Tuning, Value};

/// A drive that is given as readings every 100 ms.
pub struct ReadingsDrive {
    pub context: Context,
    intake: Intake,
    sampler: Sampler,
    pub now_ms: u64,
    pub samples: Vec<Sample>,
}

impl ReadingsDrive {
    pub fn of(model: impl Into<Model>) -> Self {
        let context = Context::new(model, Tuning::default()).unwrap();
        Self {
            intake: Intake::new(&context.tuning),
            context,
            sampler: Sampler::new(),
            now_ms: 0,
            samples: Vec::new(),
        }
    }

    fn put(&mut self, signal: Signal, value: Value) {
        let now = Instant::from_micros(self.now_ms * 1000);
        let reading = Reading { signal, value };
        self.intake
            .on_reading(&mut self.context, now, reading, &mut self.sampler);
    }

    /// Drives on for some seconds with these readings every 100 ms, in their order. Returns the
    /// samples of that time.
    pub fn on(&mut self, seconds: f64, readings: &[(Signal, f32)]) -> Vec<Sample> {
        let values: Vec<(Signal, Value)> = readings
            .iter()
            .map(|&(signal, value)| (signal, Value::Real(value)))
            .collect();
        self.on_values(seconds, &values)
    }

    pub fn on_values(&mut self, seconds: f64, readings: &[(Signal, Value)]) -> Vec<Sample> {
        let first = self.samples.len();
        for _ in 0..(10.0 * seconds).round() as u64 {
            for &(signal, value) in readings {
                self.put(signal, value);
            }
            while let Some(sample) = self.sampler.next_sample() {
                self.samples.push(sample);
            }
            self.now_ms += 100;
        }
        self.samples[first..].to_vec()
    }
}
