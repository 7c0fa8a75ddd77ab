//! A longitudinal accelerometer on a simulated drive, with the errors of one in a cab.

use estimator_core::sample::{InertialMeasurement, Sample};
use host_sim::simulator::drive::SimulatedDrive;
use host_sim::simulator::random::{OrnsteinUhlenbeck, normal};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

/// Time between two readings, s.
const READING_S: f64 = 0.02;
const GRAVITY: f64 = 9.806_65;

/// Errors of the accelerometer.
#[derive(Clone, Copy, Debug)]
pub struct SensorErrors {
    /// Offset, m/s².
    pub offset_mps2: f64,
    /// Drift of the offset over twenty minutes, 1 sigma, m/s².
    pub drift_mps2: f64,
    /// White noise of one reading, 1 sigma, m/s².
    pub white_mps2: f64,
    /// Scale factor.
    pub scale: f64,
    /// Reading for each m/s² that the body pitches under acceleration, m/s².
    pub pitch_gain: f64,
    /// Resolution, m/s².
    pub resolution_mps2: f64,
}

/// Those of the issue: an offset of 0.1 m/s², and 0.3° of pitch for 1 m/s².
pub const HONEST: SensorErrors = SensorErrors {
    offset_mps2: 0.1,
    drift_mps2: 0.02,
    white_mps2: 0.2,
    scale: 1.0,
    pitch_gain: 0.05,
    resolution_mps2: 0.01,
};

/// The accelerometer.
pub struct Accelerometer<'a> {
    drive: &'a SimulatedDrive,
    errors: SensorErrors,
    drift: OrnsteinUhlenbeck,
    drift_mps2: f64,
    rng: ChaCha8Rng,
    next_s: f64,
}

impl<'a> Accelerometer<'a> {
    pub fn new(drive: &'a SimulatedDrive, errors: SensorErrors, seed: u64) -> Self {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        Self {
            drive,
            errors,
            drift: OrnsteinUhlenbeck::new(errors.drift_mps2, 1_200.0, &mut rng),
            drift_mps2: 0.0,
            rng,
            next_s: 0.0,
        }
    }

    /// Returns the mean of the readings in the cell of a sample.
    pub fn measure(&mut self, sample: &Sample) -> Option<InertialMeasurement> {
        let end_s = sample.end.time.micros() as f64 * 1e-6;
        self.next_s = self.next_s.max(end_s - f64::from(sample.duration_s));
        let (mut sum, mut count) = (0.0, 0_u8);
        while self.next_s < end_s {
            sum += self.read();
            count = count.saturating_add(1);
            self.next_s += READING_S;
        }
        (count > 0).then(|| InertialMeasurement {
            acceleration_mps2: (sum / f64::from(count)) as f32,
            count,
            resolution_mps2: self.errors.resolution_mps2 as f32,
        })
    }

    fn read(&mut self) -> f64 {
        let state = self.drive.at(self.next_s);
        let slope = self.drive.road.grade(state.distance_m);
        let gravity = GRAVITY * slope / (1.0 + slope * slope).sqrt();
        let moved = state.acceleration_mps2;
        self.drift_mps2 = self.drift.advance(READING_S, &mut self.rng);
        let SensorErrors {
            offset_mps2,
            white_mps2,
            scale,
            pitch_gain,
            resolution_mps2,
            ..
        } = self.errors;
        let exact = scale * (moved * (1.0 + pitch_gain) + gravity)
            + offset_mps2
            + self.drift_mps2
            + white_mps2 * normal(&mut self.rng);
        resolution_mps2 * (exact / resolution_mps2).round()
    }
}
