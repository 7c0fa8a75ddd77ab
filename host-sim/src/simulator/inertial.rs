//! Inertial sensors of the vehicle, with the errors of their [tables](super::inertial_file).
//!
//! An accelerometer feels the specific force of the body: f = dv/dt + g sin(slope). The body pitches
//! under the same force, because within the vehicle a slope cannot be told from an acceleration. Its
//! springs follow with a delay. A sensor that is tilted by θ against the road reads
//! f cos θ + g cos(slope) sin θ. Vibration by the road has a power that grows with the speed (ISO 8608:
//! the displacement falls with the square of the wave number).

use super::drive::{DriveState, SimulatedDrive};
use super::inertial_file::{AccelerometerMessage, AccelerometerTable, PitchMessage, PitchTable};
use super::random::{OrnsteinUhlenbeck, Purpose, normal, stream};
use super::scenario::Scenario;
use super::truck::GRAVITY;
use crate::numeric::slope::sine;
use estimator_core::Signal;
use rand_chacha::ChaCha8Rng;

/// Time in which the springs of the body follow, s.
const SPRINGS_S: f64 = 0.3;
/// Correlation time of the vibration that a sensor lets through, s: a low pass of 10 Hz.
const VIBRATION_S: f64 = 0.016;
/// Speed at which the vibration is that of the table, m/s.
const VIBRATION_MPS: f64 = 20.0;
const HOUR_S: f64 = 3_600.0;

/// The inertial sensors of one run.
#[derive(Debug)]
pub struct InertialSensors<'a> {
    drive: &'a SimulatedDrive,
    latency_s: f64,
    accelerometer: Option<Accelerometer>,
    slope_sensor: Option<SlopeSensor>,
    rng: ChaCha8Rng,
}

impl<'a> InertialSensors<'a> {
    /// Creates the sensors of run `index`; none, if the scenario has none.
    #[must_use]
    pub fn new(scenario: &Scenario, index: usize, drive: &'a SimulatedDrive) -> Self {
        let mut rng = stream(scenario.seed, index, Purpose::Inertial);
        Self {
            drive,
            latency_s: 1e-3 * scenario.latency_ms.chassis,
            accelerometer: scenario
                .accelerometer
                .map(|table| Accelerometer::new(table, &mut rng)),
            slope_sensor: scenario.pitch.map(SlopeSensor::new),
            rng,
        }
    }

    /// Returns PGN and period in ms of the messages that only these sensors send.
    pub fn messages(&self) -> impl Iterator<Item = (u32, f64)> {
        let accs = self.accelerometer.iter().filter_map(|of| {
            (of.table.message == AccelerometerMessage::Accs)
                .then_some((of.pgn(), of.table.period_ms))
        });
        let slope = self.slope_sensor.iter();
        accs.chain(slope.map(|of| (of.pgn(), of.table.period_ms)))
    }

    /// Returns the value of a signal in a message that is sent at a time of the drive; `None` if no
    /// sensor here gives it.
    pub fn value(&mut self, pgn: u32, signal: Signal, sent_s: f64) -> Option<f32> {
        let time_s = sent_s - self.latency_s;
        match signal {
            Signal::LongitudinalAcceleration => {
                let sensor = self.accelerometer.as_mut().filter(|of| of.pgn() == pgn)?;
                Some(sensor.read(self.drive, time_s, &mut self.rng) as f32)
            }
            Signal::Pitch => {
                let sensor = self.slope_sensor.as_mut().filter(|of| of.pgn() == pgn)?;
                Some(sensor.read(self.drive, time_s, &mut self.rng) as f32)
            }
            _ => None,
        }
    }
}

/// Returns the specific force along the vehicle, m/s², and the slope angle in its direction, rad.
fn felt(drive: &SimulatedDrive, state: &DriveState) -> (f64, f64) {
    let slope_rad = sine(drive.road.grade(state.distance_m)).asin();
    let forward_mps2 = if state.in_reverse {
        -state.acceleration_mps2
    } else {
        state.acceleration_mps2
    };
    (forward_mps2 + GRAVITY * slope_rad.sin(), slope_rad)
}

/// What changes from one reading of a sensor to the next.
#[derive(Clone, Copy, Debug, Default)]
struct SlowErrors {
    time_s: Option<f64>,
    /// The specific force that the springs have followed, m/s².
    followed_mps2: f64,
    /// Random walk, in units of its sigma after an hour.
    walk: f64,
}

impl SlowErrors {
    /// Advances to a time at which the body feels `force_mps2`. Returns the time since the last reading,
    /// s.
    fn advance(&mut self, time_s: f64, force_mps2: f64, rng: &mut ChaCha8Rng) -> f64 {
        let Some(before_s) = self.time_s.replace(time_s) else {
            self.followed_mps2 = force_mps2;
            return 0.0;
        };
        let seconds = (time_s - before_s).max(0.0);
        let left = (-seconds / SPRINGS_S).exp();
        self.followed_mps2 = force_mps2 + left * (self.followed_mps2 - force_mps2);
        self.walk += (seconds / HOUR_S).sqrt() * normal(rng);
        seconds
    }
}

#[derive(Debug)]
struct Accelerometer {
    table: AccelerometerTable,
    slow: SlowErrors,
    vibration: OrnsteinUhlenbeck,
}

impl Accelerometer {
    fn new(table: AccelerometerTable, rng: &mut ChaCha8Rng) -> Self {
        Self {
            table,
            slow: SlowErrors::default(),
            vibration: OrnsteinUhlenbeck::new(table.roughness_mps2, VIBRATION_S, rng),
        }
    }

    const fn pgn(&self) -> u32 {
        match self.table.message {
            AccelerometerMessage::Accs => 61_485,
            AccelerometerMessage::Vdc2 => 61_449,
        }
    }

    /// Returns the reading at a time, m/s².
    fn read(&mut self, drive: &SimulatedDrive, time_s: f64, rng: &mut ChaCha8Rng) -> f64 {
        let table = &self.table;
        let state = drive.at(time_s);
        let (force_mps2, slope_rad) = felt(drive, &state);
        let seconds = self.slow.advance(time_s, force_mps2, rng);
        let body_deg = table.body_pitch_deg_per_mps2 * self.slow.followed_mps2;
        let (sine, cosine) = (table.mounting_deg + body_deg).to_radians().sin_cos();
        let tilted_mps2 = force_mps2 * cosine + GRAVITY * slope_rad.cos() * sine;
        let offset_mps2 = table.offset_mps2 + table.drift_mps2 * self.slow.walk;
        let rough = (state.speed_mps / VIBRATION_MPS).sqrt();
        let vibration_mps2 = rough * self.vibration.advance(seconds, rng);
        table.scale_factor * tilted_mps2 + offset_mps2 + vibration_mps2
    }
}

#[derive(Debug)]
struct SlopeSensor {
    table: PitchTable,
    slow: SlowErrors,
}

impl SlopeSensor {
    fn new(table: PitchTable) -> Self {
        Self {
            table,
            slow: SlowErrors::default(),
        }
    }

    const fn pgn(&self) -> u32 {
        match self.table.message {
            PitchMessage::Ssi => 61_459,
            PitchMessage::Ssi2 => 61_481,
        }
    }

    /// Returns the reading at a time, °.
    fn read(&mut self, drive: &SimulatedDrive, time_s: f64, rng: &mut ChaCha8Rng) -> f64 {
        let table = &self.table;
        let (force_mps2, slope_rad) = felt(drive, &drive.at(time_s));
        self.slow.advance(time_s, force_mps2, rng);
        slope_rad.to_degrees()
            + table.body_pitch_deg_per_mps2 * self.slow.followed_mps2
            + table.offset_deg
            + table.drift_deg * self.slow.walk
            + table.noise_sigma_deg * normal(rng)
    }
}
