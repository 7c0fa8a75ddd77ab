//! Readings of different rates, ages and sources become one sample a cell.
//!
//! The odometer moves from one speed reading to the next: between two of them speed is linear in
//! time and the force is the mean of what was read in between, so that the work done equals the
//! integral of the force whatever the rates. Each interval is then cut at the ends of cells.

mod circumstances;
mod driveline;
mod gnss;
mod latest;
mod odometer;
mod slowing;
mod speedometer;
mod stops;
mod switches;
mod traction;

use crate::cell::{CELL_LENGTH_M, Condition, Place};
use crate::counters::Counters;
use crate::effect::Acts;
use crate::scalar::Scalar;
use crate::signal::{Reading, Signal};
use crate::time::Instant;
use crate::tuning::Tuning;
use crate::vehicle::{Driveline, Load, Traction, VehicleParameters, air_density};
pub use circumstances::Circumstances;
use circumstances::CircumstancesInput;
use driveline::{DrivelineInput, Passage};
use gnss::{FixOutcome, Gnss};
use heapless::Deque;
use latest::Latest;
use odometer::{Between, LONGEST_INTERVAL, Odometer};
use slowing::Slowing;
use speedometer::{Speedometer, Worth};
use stops::Stops;
use switches::Switches;
use traction::TractionInput;

/// Samples that may wait for the filter.
const QUEUE: usize = 24;
/// Speeds of road vehicles, m/s.
const SPEEDS_MPS: core::ops::RangeInclusive<f32> = 0.0..=70.0;

/// Mean of the speed readings in a cell.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct SpeedMeasurement {
    /// Quadratic mean, m/s: it is v²/2 that grows evenly with distance.
    pub mean_mps: f32,
    /// How far behind the cell's end it was taken, m.
    pub behind_m: f32,
    /// Number of readings.
    pub count: u8,
}

/// A GNSS altitude.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct AltitudeMeasurement {
    /// Altitude, m.
    pub altitude_m: f32,
    /// How far behind the cell's end it was taken, m.
    pub behind_m: f32,
    /// Dilution of precision, at least 1.
    pub dilution: f32,
    /// How it follows from the one before.
    pub continuity: Continuity,
}

/// How an altitude follows from the one before it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Continuity {
    /// From the same receiver.
    #[default]
    Followed,
    /// The slow error may have gone anywhere since. No sender tells this; a second look at a drive
    /// may know it from the first.
    Drifted,
    /// The source is another one than before: its datum may differ by tens of metres.
    Switched,
}

/// What the filter sees of one cell.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Sample {
    /// Where and when the cell ends.
    pub place: Place,
    /// Cells driven since the last sample without one (a gap in the traffic), normally 0.
    pub gap_cells: u32,
    /// Length of the step, m: [`CELL_LENGTH_M`].
    pub length_m: f32,
    /// Time taken, s.
    pub duration_s: f32,
    /// Mean force and mass over the cell, scaled by the effects that the vehicle has adopted.
    pub load: Load,
    /// What else effects depend on.
    pub circumstances: Circumstances,
    /// Speed readings in it.
    pub speed: Option<SpeedMeasurement>,
    /// GNSS altitude taken in it.
    pub altitude: Option<AltitudeMeasurement>,
    /// The vehicle stood before it, for long or to be loaded: what was learned of it may be wrong.
    pub reopened: bool,
}

/// Collects readings and cuts the drive into samples.
#[derive(Clone, Debug)]
pub struct Sampler {
    driveline: DrivelineInput,
    passage: Passage,
    traction: TractionInput,
    switches: Switches,
    slowing: Slowing,
    stops: Stops,
    gnss: Gnss,
    odometer: Odometer,
    wheel_speed: Latest,
    wheels: Speedometer,
    front_axle: Speedometer,
    surroundings: Surroundings,
    circumstances: CircumstancesInput,
    samples: Deque<Sample, QUEUE>,
}

/// What changes slowly.
#[derive(Clone, Copy, Debug, Default)]
struct Surroundings {
    ambient: Latest,
    pressure: Latest,
}

impl Sampler {
    /// Nothing read yet.
    #[must_use]
    pub fn new() -> Self {
        Self {
            driveline: DrivelineInput::default(),
            passage: Passage::UNKNOWN,
            traction: TractionInput::new(),
            switches: Switches::default(),
            slowing: Slowing::default(),
            stops: Stops::default(),
            gnss: Gnss::default(),
            odometer: Odometer::default(),
            wheel_speed: Latest::default(),
            wheels: Speedometer::default(),
            front_axle: Speedometer::default(),
            surroundings: Surroundings::default(),
            circumstances: CircumstancesInput::default(),
            samples: Deque::new(),
        }
    }

    /// The next sample that is ready.
    pub fn next_sample(&mut self) -> Option<Sample> {
        self.samples.pop_front()
    }

    /// Something was heard: the drive counts from the first time on.
    pub fn start(&mut self, now: Instant) {
        self.odometer.start(now);
    }

    /// Takes one reading. `source_switched` tells that it comes from another sender than the
    /// signal did before.
    #[inline(always)] // In the one place that hands readings on, whatever they came with.
    pub fn record(
        &mut self,
        vehicle: &VehicleParameters,
        tuning: &Tuning,
        now: Instant,
        reading: Reading,
        source_switched: bool,
        counters: &mut Counters,
    ) {
        let value = reading.value.real();
        if source_switched {
            self.switched_to(reading.signal);
        }
        match reading.signal {
            Signal::EngineTorqueFraction
            | Signal::FrictionTorque
            | Signal::EngineTorque
            | Signal::TractionForce => {
                if self.traction.record(vehicle, now, reading.signal, value) {
                    counters.tractions_used += 1;
                }
            }
            Signal::EngineSpeed
            | Signal::DrivelineEngaged
            | Signal::ShiftInProcess
            | Signal::ClutchSlip
            | Signal::ClutchSwitch
            | Signal::GearRatio
            | Signal::CurrentGear => {
                self.driveline(vehicle, tuning, now, reading.signal, value);
            }
            Signal::BrakeSwitch
            | Signal::BrakePedal
            | Signal::BrakePressure
            | Signal::ParkingBrake
            | Signal::RetarderTorque => {
                self.switches.record(tuning, now, reading.signal, value);
            }
            Signal::Mass => self.stops.mass(vehicle, tuning, now, value),
            Signal::AmbientTemperature => self.surroundings.ambient.set(value, now),
            Signal::AirPressure => self.surroundings.pressure.set(value, now),
            Signal::FixMethod | Signal::Satellites | Signal::Hdop | Signal::Vdop => {
                self.gnss.quality(now, reading.signal, value);
            }
            Signal::Latitude => self.gnss.latitude(reading.value),
            Signal::Longitude => {
                let at_m = self.odometer.place_m(now, tuning.gnss_latency);
                self.gnss.longitude(reading.value, at_m);
            }
            Signal::Altitude => {
                let at_m = self.odometer.place_m(now, tuning.gnss_latency);
                let continuity = if source_switched {
                    Continuity::Switched
                } else {
                    Continuity::Followed
                };
                let counter = match self.gnss.altitude(now, value, at_m, continuity) {
                    FixOutcome::Taken => return,
                    FixOutcome::Poor => &mut counters.poor_fixes,
                    FixOutcome::Frozen => &mut counters.frozen_fixes,
                };
                *counter = counter.saturating_add(1);
            }
            Signal::WheelSpeed | Signal::FrontAxleSpeed => {
                if let Some(told_mps) = self.judged_speed(now, reading.signal, value, counters) {
                    self.speed(vehicle, tuning, now, told_mps, counters);
                }
            }
            Signal::EngineTorqueMode
            | Signal::ParasiticTorque
            | Signal::OutputShaftSpeed
            | Signal::SelectedGear
            | Signal::Passengers => {}
            Signal::Fan | Signal::YawRate | Signal::Course | Signal::GnssSpeed => {
                let speed_mps = self.odometer.speed_mps();
                self.circumstances
                    .record(now, reading.signal, value, speed_mps);
            }
        }
    }

    /// Another sender tells a signal from now on. Forces and speeds of two do not go together: a
    /// difference that nothing drove would be read as a slope, and as a scale.
    #[inline(never)] // Seldom.
    fn switched_to(&mut self, signal: Signal) {
        match signal {
            Signal::EngineTorque | Signal::TractionForce => {}
            Signal::WheelSpeed => self.wheels = Speedometer::default(),
            Signal::FrontAxleSpeed => self.front_axle = Speedometer::default(),
            _ => return,
        }
        self.odometer.interrupt();
        self.slowing.forget();
    }

    /// Takes a reading of the driveline. Most repeat what was told before: then only the hold time
    /// of what goes on begins anew.
    #[inline(always)] // In Sampler::record.
    fn driveline(
        &mut self,
        vehicle: &VehicleParameters,
        tuning: &Tuning,
        now: Instant,
        signal: Signal,
        value: Option<f32>,
    ) {
        let changed = self.driveline.record(vehicle, now, signal, value);
        let counts = signal != Signal::EngineSpeed || self.passage.asks_engine_speed;
        // Of an open one the torque tells whether it coasts.
        if changed && counts || self.passage.driveline == Driveline::Open {
            self.follow_driveline(vehicle, tuning, now, self.odometer.speed_mps());
        } else if self.passage.in_transit {
            self.switches.driveline_in_transit(tuning, now);
        }
    }

    /// What the driveline passes now, and what its changes disturb.
    fn follow_driveline(
        &mut self,
        vehicle: &VehicleParameters,
        tuning: &Tuning,
        now: Instant,
        speed_mps: Option<f32>,
    ) {
        let net_percent = self.traction.net_torque_percent(now);
        let passage = self
            .driveline
            .passage(vehicle, tuning, now, speed_mps, net_percent);
        let changed = self.traction.driveline_is(vehicle, now, passage.driveline);
        if changed || passage.in_transit {
            self.switches.driveline_in_transit(tuning, now);
        }
        self.passage = passage;
    }

    /// The speed that a sensor tells, if it counts. The front axle's stands in where the
    /// wheel-based speed is missing.
    fn judged_speed(
        &mut self,
        now: Instant,
        signal: Signal,
        value: Option<f32>,
        counters: &mut Counters,
    ) -> Option<f32> {
        let turns = self.driveline.turns(now, self.passage.driveline);
        let is_wheels = signal == Signal::WheelSpeed;
        let sensor = if is_wheels {
            &mut self.wheels
        } else {
            &mut self.front_axle
        };
        let told_mps = value.filter(|mps| SPEEDS_MPS.contains(mps));
        let good_mps = match told_mps.map(|mps| (mps, sensor.judge(now, mps, turns))) {
            None => None,
            Some((mps, Worth::Good)) => Some(mps),
            Some((_, Worth::Leapt)) => {
                counters.speed_leaps = counters.speed_leaps.saturating_add(1);
                return None;
            }
            Some((_, Worth::Frozen)) => {
                counters.frozen_speeds = counters.frozen_speeds.saturating_add(1);
                None
            }
        };
        if is_wheels {
            self.wheel_speed.set(good_mps, now);
            return good_mps;
        }
        let is_missing = self.wheel_speed.within(now, LONGEST_INTERVAL).is_none();
        good_mps.filter(|_| is_missing)
    }

    fn speed(
        &mut self,
        vehicle: &VehicleParameters,
        tuning: &Tuning,
        now: Instant,
        told_mps: f32,
        counters: &mut Counters,
    ) {
        let speed_mps = told_mps * vehicle.effects.factor(Acts::WheelRadius);
        counters.speeds_used += 1;
        self.follow_driveline(vehicle, tuning, now, Some(speed_mps));
        self.switches.hold(tuning, now);
        self.stops.speed(tuning, now, speed_mps);
        let slower = self
            .odometer
            .speed_mps()
            .map_or(speed_mps, |last| Scalar::min(last, speed_mps));
        let between = Between {
            mean_force_n: self.traction.take_mean_n(now),
            condition: Condition {
                shifting: self.switches.shifting(now),
                braking: self.switches.braking(now),
                no_traction: !self.traction.is_known(vehicle, now),
                crawling: slower < tuning.crawl_mps,
            },
        };
        let guesses_brakes =
            vehicle.traction != Traction::Force && !self.switches.tells_brakes(now);
        let Self {
            traction,
            slowing,
            stops,
            gnss,
            odometer,
            surroundings,
            circumstances,
            samples,
            ..
        } = self;
        let traction_factor = vehicle.effects.factor(Acts::Traction);
        let bridged = odometer.drive(now, speed_mps, between, |driven| {
            let load = Load {
                traction_n: driven.mean_force_n * traction_factor,
                rotating_kg: traction.rotating_kg(vehicle),
                mass_kg: stops.mass_kg(vehicle),
                air_density: surroundings.air_density(),
            };
            let mut condition = driven.condition;
            if guesses_brakes {
                let told = !condition.is_valid() || condition.crawling;
                if slowing.brakes(vehicle, tuning, &load, driven.speed_mps, told) {
                    condition.braking = true;
                    counters.brakes_guessed += 1;
                }
            } else {
                slowing.forget();
            }
            let sample = Sample {
                place: Place {
                    cell: driven.number,
                    time: driven.time,
                    position_e7: gnss.position_at(CELL_LENGTH_M),
                    speed_mps: driven.speed_mps,
                    condition,
                },
                gap_cells: driven.gap_cells,
                length_m: CELL_LENGTH_M,
                duration_s: driven.duration_s,
                load,
                circumstances: Circumstances {
                    driven_s: stops.driven_s(),
                    ambient_celsius: surroundings.ambient.last().into(),
                    engaged: traction.arrives(vehicle),
                    ..circumstances.take(driven.time, driven.speed_mps)
                },
                speed: driven.speed,
                altitude: gnss.altitude_before(CELL_LENGTH_M),
                reopened: stops.take_reopening(vehicle, tuning),
            };
            gnss.cell_closed();
            if samples.push_back(sample).is_err() {
                counters.samples_lost = counters.samples_lost.saturating_add(1);
            }
        });
        if !bridged {
            gnss.forget_places();
            slowing.forget();
            counters.gaps = counters.gaps.saturating_add(1);
        }
    }
}

impl Surroundings {
    fn air_density(&self) -> f32 {
        air_density(self.pressure.last(), self.ambient.last())
    }
}

impl Default for Sampler {
    fn default() -> Self {
        Self::new()
    }
}
