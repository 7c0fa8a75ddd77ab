//! The GNSS receiver: position and altitude with correlated errors.
//!
//! An Ornstein-Uhlenbeck process in time models the errors of atmosphere, orbits and multipath of a
//! single-frequency fix. White noise models the receiver's own noise.

use super::drive::SimulatedDrive;
use super::random::{OrnsteinUhlenbeck, Purpose, normal, stream};
use super::scenario::Scenario;
use super::sensor_file::GnssErrors;
use estimator_core::{Signal, Value};
use rand_chacha::ChaCha8Rng;

/// Satellites in use: mean, standard deviation and correlation time, s.
const SATELLITES: (f64, f64, f64) = (10.0, 1.2, 60.0);
/// Vertical over horizontal dilution of precision.
const VDOP_TO_HDOP: f64 = 1.4;

/// The output of the receiver at one time.
#[derive(Clone, Copy, Debug)]
pub struct GnssFix {
    has_fix: bool,
    latitude_e7: i32,
    longitude_e7: i32,
    altitude_m: f64,
    speed_mps: f64,
    course_deg: f64,
    satellites: f64,
    hdop: f64,
}

/// The receiver of one run.
#[derive(Debug)]
pub struct GnssReceiver<'a> {
    drive: &'a SimulatedDrive,
    errors: GnssErrors,
    /// Length of the road if it is driven against its direction, m; faults are placed on the road
    /// as stored.
    turned_m: Option<f64>,
    altitude: OrnsteinUhlenbeck,
    north: OrnsteinUhlenbeck,
    east: OrnsteinUhlenbeck,
    satellites: OrnsteinUhlenbeck,
    last_s: f64,
    rng: ChaCha8Rng,
}

impl<'a> GnssReceiver<'a> {
    /// Creates the receiver of run `index`.
    #[must_use]
    pub fn new(scenario: &Scenario, index: usize, drive: &'a SimulatedDrive) -> Self {
        let mut rng = stream(scenario.seed, index, Purpose::Gnss);
        let errors = scenario.gnss.clone();
        let turned_m = scenario.runs[index].backward.then(|| drive.road.length_m());
        let altitude =
            OrnsteinUhlenbeck::new(errors.altitude_sigma_m, errors.altitude_time_s, &mut rng);
        let mut position =
            || OrnsteinUhlenbeck::new(errors.position_sigma_m, errors.position_time_s, &mut rng);
        let (north, east) = (position(), position());
        let satellites = OrnsteinUhlenbeck::new(SATELLITES.1, SATELLITES.2, &mut rng);
        Self {
            drive,
            turned_m,
            altitude,
            north,
            east,
            satellites,
            last_s: 0.0,
            rng,
            errors,
        }
    }

    /// Returns the fix at a time of the drive. Calls must be in order of time.
    pub fn fix(&mut self, time_s: f64) -> GnssFix {
        let seconds = (time_s - self.last_s).max(0.0);
        self.last_s = time_s;
        let rng = &mut self.rng;
        let north_m = self.north.advance(seconds, rng);
        let east_m = self.east.advance(seconds, rng);
        let noise_m =
            self.altitude.advance(seconds, rng) + self.errors.altitude_white_sigma_m * normal(rng);
        let satellites = (SATELLITES.0 + self.satellites.advance(seconds, rng)).round();
        let satellites = satellites.clamp(5.0, 16.0);
        let state = self.drive.at(time_s);
        let road = &self.drive.road;
        let stored_m = match self.turned_m {
            Some(length_m) => length_m - state.distance_m,
            None => state.distance_m,
        };
        let altitude_error_m = noise_m + self.errors.fault_m(stored_m, self.turned_m.is_some());
        let place = road.position(state.distance_m).moved(north_m, east_m);
        let backwards_deg = if state.is_reversing() { 180.0 } else { 0.0 };
        let course_deg = road.course_rad(state.distance_m).to_degrees()
            + backwards_deg
            + self.errors.course_sigma_deg * normal(rng);
        GnssFix {
            has_fix: !self
                .errors
                .outages_m
                .iter()
                .any(|&(from, to)| (from..to).contains(&stored_m)),
            latitude_e7: (place.latitude_deg * 1e7).round() as i32,
            longitude_e7: (place.longitude_deg * 1e7).round() as i32,
            altitude_m: road.altitude_m(state.distance_m) + altitude_error_m,
            speed_mps: (state.speed_mps
                + state.carried_mps
                + self.errors.speed_sigma_mps * normal(rng))
            .max(0.0),
            course_deg: course_deg.rem_euclid(360.0),
            satellites,
            hdop: 0.6 + 2.0 / (satellites - 3.0),
        }
    }
}

impl GnssErrors {
    /// Returns the altitude error of steps and ramps at a distance on the stored road, m.
    fn fault_m(&self, stored_m: f64, turned: bool) -> f64 {
        let within = |from: f64, to: f64| (from..to).contains(&stored_m);
        let steps = self
            .steps
            .iter()
            .filter(|(from, to, _)| within(*from, *to))
            .map(|(.., metres)| metres);
        let ramps = self
            .ramps
            .iter()
            .filter(|(from, to, _)| within(*from, *to))
            .map(|(from, to, metres)| {
                let part = (stored_m - from) / (to - from);
                metres * if turned { 1.0 - part } else { part }
            });
        steps.sum::<f64>() + ramps.sum::<f64>()
    }
}

impl GnssFix {
    /// Returns the value of one of the receiver's signals.
    #[must_use]
    pub fn value(&self, signal: Signal) -> Value {
        match signal {
            Signal::FixMethod => Value::Real(f32::from(u8::from(self.has_fix))),
            Signal::Satellites if !self.has_fix => Value::Real(0.0),
            _ if !self.has_fix => Value::NotAvailable,
            Signal::Latitude => Value::DegreesE7(self.latitude_e7),
            Signal::Longitude => Value::DegreesE7(self.longitude_e7),
            Signal::Altitude => Value::Real(self.altitude_m as f32),
            Signal::Course => Value::Real(self.course_deg as f32),
            Signal::GnssSpeed => Value::Real(self.speed_mps as f32),
            Signal::Satellites => Value::Real(self.satellites as f32),
            Signal::Hdop => Value::Real(self.hdop as f32),
            Signal::Vdop => Value::Real((VDOP_TO_HDOP * self.hdop) as f32),
            _ => Value::NotAvailable,
        }
    }
}
