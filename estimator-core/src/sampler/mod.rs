//! Readings of different rates, ages and sources become one sample a cell.
//!
//! The odometer moves from one speed reading to the next: between two of them speed is linear in
//! time and the force is the mean of what was read in between, so that the work done equals the
//! integral of the force whatever the rates. Each interval is then cut at the ends of cells.

mod gnss;
mod latest;
mod odometer;
mod switches;
mod traction;

use crate::cell::{CELL_LENGTH_M, Condition, Place};
use crate::counters::Counters;
use crate::signal::{Reading, Signal};
use crate::time::Instant;
use crate::tuning::Tuning;
use crate::vehicle::{Load, VehicleParameters, air_density};
use gnss::{FixOutcome, Gnss};
use heapless::Deque;
use latest::Latest;
use odometer::{Between, DrivenCell, LONGEST_INTERVAL, Odometer};
use switches::Switches;
use traction::TractionInput;

/// Samples that may wait for the filter.
const QUEUE: usize = 32;
/// Speeds of road vehicles, m/s.
const SPEEDS_MPS: core::ops::RangeInclusive<f32> = 0.0..=70.0;
/// Masses that a vehicle may have, as parts of its parameter.
const MASSES: core::ops::Range<f32> = 0.2..5.0;

/// Mean of the speed readings in a cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpeedMeasurement {
    /// Mean, m/s.
    pub mean_mps: f32,
    /// How far behind the cell's end it was taken, m.
    pub behind_m: f32,
    /// Number of readings.
    pub count: u8,
}

/// A GNSS altitude.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AltitudeMeasurement {
    /// Altitude, m.
    pub altitude_m: f32,
    /// How far behind the cell's end it was taken, m.
    pub behind_m: f32,
    /// Dilution of precision, at least 1.
    pub dilution: f32,
    /// The source is another one than before: its datum may differ by tens of metres.
    pub source_switched: bool,
}

/// What the filter sees of one cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// Where and when the cell ends.
    pub place: Place,
    /// Cells driven since the last sample without one (a gap in the traffic), normally 0.
    pub gap_cells: u32,
    /// Length of the step, m: [`CELL_LENGTH_M`].
    pub length_m: f32,
    /// Time taken, s.
    pub duration_s: f32,
    /// Mean force and mass over the cell.
    pub load: Load,
    /// Speed readings in it.
    pub speed: Option<SpeedMeasurement>,
    /// GNSS altitude taken in it.
    pub altitude: Option<AltitudeMeasurement>,
}

/// Collects readings and cuts the drive into samples.
#[derive(Clone, Debug)]
pub struct Sampler {
    traction: TractionInput,
    switches: Switches,
    gnss: Gnss,
    odometer: Odometer,
    wheel_speed: Latest,
    surroundings: Surroundings,
    samples: Deque<Sample, QUEUE>,
}

/// What changes slowly.
#[derive(Clone, Copy, Debug, Default)]
struct Surroundings {
    mass: Latest,
    ambient: Latest,
    pressure: Latest,
}

impl Sampler {
    /// Nothing read yet.
    #[must_use]
    pub fn new() -> Self {
        Self {
            traction: TractionInput::new(),
            switches: Switches::default(),
            gnss: Gnss::default(),
            odometer: Odometer::default(),
            wheel_speed: Latest::default(),
            surroundings: Surroundings::default(),
            samples: Deque::new(),
        }
    }

    /// The next sample that is ready.
    pub fn next_sample(&mut self) -> Option<Sample> {
        self.samples.pop_front()
    }

    /// Takes one reading. `source_switched` tells that it comes from another sender than the
    /// signal did before.
    pub fn record(
        &mut self,
        vehicle: &VehicleParameters,
        tuning: &Tuning,
        now: Instant,
        reading: Reading,
        source_switched: bool,
        counters: &mut Counters,
    ) {
        self.odometer.start(now);
        let value = reading.value.real();
        match reading.signal {
            Signal::EngineTorqueFraction
            | Signal::FrictionTorque
            | Signal::EngineSpeed
            | Signal::GearRatio
            | Signal::CurrentGear
            | Signal::EngineTorque
            | Signal::TractionForce
            | Signal::DrivelineEngaged => {
                let speed_mps = self.odometer.speed_mps();
                self.switches.record(tuning, now, reading.signal, value);
                if self
                    .traction
                    .record(vehicle, now, reading.signal, value, speed_mps)
                {
                    counters.tractions_used = counters.tractions_used.saturating_add(1);
                }
            }
            Signal::ShiftInProcess
            | Signal::BrakeSwitch
            | Signal::BrakePedal
            | Signal::BrakePressure
            | Signal::RetarderTorque => {
                self.switches.record(tuning, now, reading.signal, value);
            }
            Signal::Mass => self.surroundings.mass.set(value, now),
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
                if self.gnss.altitude(now, value, at_m, source_switched) == FixOutcome::Poor {
                    counters.poor_fixes = counters.poor_fixes.saturating_add(1);
                }
            }
            Signal::WheelSpeed => {
                self.wheel_speed.set(value, now);
                self.speed(vehicle, tuning, now, value, counters);
            }
            // Stands in where the wheel-based speed is missing.
            Signal::FrontAxleSpeed => {
                if self.wheel_speed.within(now, LONGEST_INTERVAL).is_none() {
                    self.speed(vehicle, tuning, now, value, counters);
                }
            }
            Signal::EngineTorqueMode
            | Signal::ParasiticTorque
            | Signal::ClutchSlip
            | Signal::ClutchSwitch
            | Signal::OutputShaftSpeed
            | Signal::SelectedGear
            | Signal::ParkingBrake
            | Signal::Passengers
            | Signal::Fan
            | Signal::YawRate
            | Signal::Course
            | Signal::GnssSpeed => {}
        }
    }

    fn speed(
        &mut self,
        vehicle: &VehicleParameters,
        tuning: &Tuning,
        now: Instant,
        value: Option<f32>,
        counters: &mut Counters,
    ) {
        let Some(speed_mps) = value.filter(|mps| SPEEDS_MPS.contains(mps)) else {
            return;
        };
        counters.speeds_used = counters.speeds_used.saturating_add(1);
        let slower = self
            .odometer
            .speed_mps()
            .map_or(speed_mps, |last| last.min(speed_mps));
        let between = Between {
            mean_force_n: self.traction.take_mean_n(now),
            condition: Condition {
                shifting: self.switches.shifting(now),
                braking: self.switches.braking(now),
                no_traction: !self.traction.is_known(vehicle, now),
                crawling: slower < tuning.crawl_mps,
            },
        };
        let Self {
            traction,
            gnss,
            odometer,
            surroundings,
            samples,
            ..
        } = self;
        let bridged = odometer.drive(now, speed_mps, between, |driven| {
            let sample = surroundings.sample(vehicle, traction, gnss, driven);
            gnss.cell_closed();
            if samples.push_back(sample).is_err() {
                counters.samples_lost = counters.samples_lost.saturating_add(1);
            }
        });
        if !bridged {
            gnss.forget_places();
            counters.gaps = counters.gaps.saturating_add(1);
        }
    }
}

impl Surroundings {
    fn sample(
        &self,
        vehicle: &VehicleParameters,
        traction: &TractionInput,
        gnss: &mut Gnss,
        driven: DrivenCell,
    ) -> Sample {
        Sample {
            place: Place {
                cell: driven.number,
                time: driven.time,
                position_e7: gnss.position_at(CELL_LENGTH_M),
                speed_mps: driven.speed_mps,
                condition: driven.condition,
            },
            gap_cells: driven.gap_cells,
            length_m: CELL_LENGTH_M,
            duration_s: driven.duration_s,
            load: Load {
                traction_n: driven.mean_force_n,
                rotating_kg: traction.rotating_kg(vehicle),
                mass_kg: self.mass_kg(vehicle),
                air_density: air_density(self.pressure.last(), self.ambient.last()),
            },
            speed: driven.speed,
            altitude: gnss.altitude_before(CELL_LENGTH_M),
        }
    }

    /// The mass last told, if a vehicle like this one can have it, else the parameter.
    fn mass_kg(&self, vehicle: &VehicleParameters) -> f32 {
        self.mass
            .last()
            .filter(|mass_kg| MASSES.contains(&(mass_kg / vehicle.mass_kg)))
            .unwrap_or(vehicle.mass_kg)
    }
}

impl Default for Sampler {
    fn default() -> Self {
        Self::new()
    }
}
