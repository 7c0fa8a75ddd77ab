//! Plausibility of the input of an estimate: wrong units, swapped columns, a vehicle file of another
//! vehicle.
//!
//! All thresholds are from physics: what no wheel, engine, road or receiver does. Readings are
//! collected as they come, in fixed memory, as they were reported: the estimator drops what it
//! cannot use, and a wrong unit is often just that. The warnings are made at the end of the drive.
//! Causes come first, and hide their consequences.
//!
//! | file | content |
//! |---|---|
//! | `way`, `positions`, `integral` | speed, clock, positions, course |
//! | `forces` | torque, force, engine speed |
//! | `gearbox` | gear, gear ratio, driveline |
//! | `brakes` | brake pressure, retarder |
//! | `climb` | altitude |
//! | `accelerometer` | longitudinal acceleration |
//! | `surroundings` | air, yaw rate, reported mass |
//! | `model_fit` | gears that never match, late forces, scale, measured slopes |
//! | `tap` | readings of frames |
//! | `distribution` | quantiles in fixed memory |

mod accelerometer;
mod brakes;
mod climb;
mod distribution;
mod forces;
mod gearbox;
mod integral;
mod model_fit;
mod positions;
mod surroundings;
mod tap;
mod warning;
mod way;

pub use warning::Warning;

use crate::smooth::SmoothedCell;
use crate::source::can_frame::CanFrame;
use accelerometer::Accelerometer;
use brakes::Brakes;
use climb::Climb;
use estimator_core::{
    Instant, Reading, Sample, Signal, Traction, Tuning, Value, VehicleParameters,
};
use forces::Forces;
use gearbox::Gearbox;
use model_fit::ModelFit;
use surroundings::Surroundings;
use tap::Tap;
use way::Way;

/// Collects what a drive reports.
#[derive(Clone, Debug, Default)]
pub(super) struct Plausibility {
    tap: Tap,
    seen: Seen,
}

impl Plausibility {
    /// Leaves out a signal of frames.
    pub(super) fn ignore(&mut self, signal: Signal) {
        self.tap.ignore(signal);
    }

    /// Leaves out a signal of built-in messages, which own messages give.
    pub(super) fn reserve(&mut self, signal: Signal) {
        self.tap.reserve(signal);
    }

    /// Takes a frame.
    pub(super) fn frame(
        &mut self,
        now: Instant,
        frame: &CanFrame,
        vehicle: &VehicleParameters,
        tuning: &Tuning,
    ) {
        let Self { tap, seen } = self;
        tap.readings(now, frame, &tuning.hold_times, |reading| {
            seen.reading(now, reading, vehicle);
        });
    }

    /// Takes a reading that comes without a bus.
    pub(super) fn reading(&mut self, now: Instant, reading: Reading, vehicle: &VehicleParameters) {
        self.seen.reading(now, reading, vehicle);
    }

    /// Takes a sample of the estimator.
    pub(super) fn sample(&mut self, sample: &Sample, vehicle: &VehicleParameters) {
        self.seen.fit.sample(sample);
        self.seen.climb.sample(sample, vehicle);
    }

    /// Takes a cell of the smoothed run, in any order.
    pub(super) fn smoothed(&mut self, cell: &SmoothedCell) {
        self.seen.fit.smoothed(cell);
    }

    /// Returns what is not plausible, causes first.
    pub(super) fn judge(&self, vehicle: &VehicleParameters) -> Vec<Warning> {
        self.seen.judge(vehicle)
    }
}

/// What was seen of the drive, by subject.
#[derive(Clone, Debug, Default)]
struct Seen {
    way: Way,
    forces: Forces,
    gearbox: Gearbox,
    brakes: Brakes,
    climb: Climb,
    accelerometer: Accelerometer,
    surroundings: Surroundings,
    fit: ModelFit,
}

impl Seen {
    fn reading(&mut self, now: Instant, reading: Reading, vehicle: &VehicleParameters) {
        match reading.value {
            Value::DegreesE7(e7) => match reading.signal {
                Signal::Latitude => self.way.latitude(e7),
                Signal::Longitude => self.way.longitude(e7),
                _ => {}
            },
            Value::Real(value) if value.is_finite() => {
                self.number(now, reading.signal, f64::from(value), vehicle);
            }
            _ => {}
        }
    }

    fn number(&mut self, now: Instant, signal: Signal, value: f64, vehicle: &VehicleParameters) {
        let speed_mps = self.way.speed_mps().unwrap_or(0.0);
        self.gearbox.reading(signal, value, speed_mps, vehicle);
        match signal {
            Signal::WheelSpeed | Signal::FrontAxleSpeed => {
                self.way.wheels(now, signal, value);
                self.brakes.speed(now, value);
                self.accelerometer.speed(now, signal, value);
            }
            Signal::GnssSpeed => self.way.ground(now, value),
            Signal::Course => self.way.course(value),
            Signal::EngineTorque => self.forces.torque(value),
            Signal::FrictionTorque => self.forces.friction(value),
            Signal::TractionForce => self.forces.force(value),
            Signal::EngineSpeed => self.forces.engine_speed(value, speed_mps, vehicle),
            Signal::BrakePressure => self.brakes.pressure(value),
            Signal::RetarderTorque => self.brakes.retarder(value),
            Signal::Altitude => self.climb.altitude(value, self.way.wheels_m()),
            Signal::AmbientTemperature => self.surroundings.temperature(value),
            Signal::AirPressure => self.surroundings.air_pressure(value),
            Signal::LongitudinalAcceleration => self.accelerometer.reading(value),
            Signal::YawRate => self.surroundings.yaw_rate(value, speed_mps),
            Signal::Mass => self.surroundings.mass(value),
            _ => {}
        }
    }

    fn judge(&self, vehicle: &VehicleParameters) -> Vec<Warning> {
        let mut found = Vec::new();
        let way_m = self.way.wheels_m();
        self.way.judge(&mut found);
        self.forces.judge(way_m, vehicle, &mut found);
        self.surroundings.judge(vehicle, &mut found);
        let spoils = |found: &[Warning]| found.iter().any(|warning| warning.spoils.is_some());
        if !spoils(&found) {
            self.brakes.judge(&mut found);
            found.extend(self.accelerometer.judge());
            found.extend(self.fit.late());
        }
        found.extend(self.climb.judge_changes(way_m));
        if !spoils(&found) {
            let gears = || match &vehicle.traction {
                Traction::Powertrain(powertrain) => Some(self.forces.ratios(powertrain)),
                Traction::Force => None,
            };
            found.extend(self.fit.never_valid(gears));
        }
        let gears = if spoils(&found) {
            None
        } else {
            self.gearbox.judge()
        };
        let gears_are_wrong = gears.is_some();
        found.extend(gears);
        if !spoils(&found) {
            found.extend(self.climb.judge_scale());
        }
        // Forces follow from the gears, and the scale from the forces.
        if !spoils(&found) && !gears_are_wrong {
            found.extend(self.fit.scale());
        }
        found
    }
}
