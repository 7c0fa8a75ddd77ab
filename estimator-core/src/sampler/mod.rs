//! The sampler: readings of different rates and ages become one sample a cell.
//!
//! The odometer moves from one speed reading to the next. Between two of them the speed is linear in
//! time and the force is the mean of what was read in between, so that the work equals the integral
//! of the force at any rate. Each interval is then divided at the ends of cells.
//!
//! | file | content |
//! |---|---|
//! | `driveline`, `traction` | gear and clutch; torque or force to mean traction force |
//! | `engine_configuration` | reference torque and inertia that the engine reports |
//! | `torque_rests` | torque that is not renewed |
//! | `brakes`, `retarder` | brakes and retarders that signals report |
//! | `odometer`, `speed_check`, `speed_returns` | distance and cells; plausibility of speed readings; those of two senders |
//! | `gnss` | positions and altitudes along the driven distance |
//! | `delays`, `speed_slots`, `lag_likelihood` | how late receiver and force are beside the wheel speed |
//! | `speed_scale` | scale of the wheel speed |
//! | `stops`, `reversing` | standstills, weighings, load changes; direction of motion |
//! | `inertial` | the accelerometer: one mean a cell |
//! | `slope_sensors` | vertical speed and pitch: the slope directly |
//! | `effect_inputs` | what effects depend on |
//! | `parts` | what these collect, and the sample of a cell |
//! | `latest`, `accepted_ranges` | newest values and their age; ranges of readings |
//!
//! Hold times make the model invalid for some time after a gear shift or a brake. The one after a
//! shift is in `parts` (`Parts::hold_shift`); those after a brake or a retarder are in `brakes`.
//! Their lengths are [`HoldTimes`](crate::tuning::HoldTimes).

mod accepted_ranges;
mod brakes;
mod delays;
mod driveline;
mod effect_inputs;
mod engine_configuration;
mod gnss;
mod inertial;
mod lag_likelihood;
mod latest;
mod odometer;
mod parts;
mod resolution;
mod retarder;
mod reversing;
mod slope_sensors;
mod speed_check;
mod speed_returns;
mod speed_scale;
mod speed_slots;
mod stops;
mod torque_rests;
mod traction;

use crate::cell::CELL_LENGTH_M;
use crate::context::Context;
use crate::counters::count;
use crate::delay::Delays;
use crate::effect::Acts;
use crate::sample::{AltitudeContinuity, Sample};
use crate::scalar::Scalar;
use crate::signal::{Reading, Signal, Value};
use crate::time::{Duration, Instant};
use crate::tuning::Tuning;
use accepted_ranges::SPEEDS_MPS;
use gnss::AltitudeOutcome;
use heapless::Deque;
use latest::TimedValue;
use odometer::{Interval, Odometer};
use parts::Parts;
use reversing::DirectionSignals;
use slope_sensors::SlopeSensors;
use speed_check::SpeedCheck;

/// Number of samples that may wait for the filter.
const QUEUE: usize = 24;
/// Number of samples that may wait for a course: a receiver reports one within ten metres.
const WAITING: u8 = 4;

/// Collects readings and divides the drive into samples.
#[derive(Clone, Debug)]
pub struct Sampler {
    odometer: Odometer,
    parts: Parts,
    samples: Deque<Sample, QUEUE>,
    /// Number of the newest samples whose direction is not known yet.
    waiting: u8,
}

impl Sampler {
    /// Creates a sampler before the first reading.
    #[must_use]
    #[inline(always)] // See Estimator::new_in().
    pub fn new() -> Self {
        Self {
            odometer: Odometer::default(),
            parts: Parts::new(),
            samples: Deque::new(),
            waiting: 0,
        }
    }

    /// Returns the next sample that is ready.
    pub fn next_sample(&mut self) -> Option<Sample> {
        let mut place = None;
        self.move_next_to(&mut place).copied()
    }

    /// Moves the next sample that is ready to where it is used, and returns it. Without one, the place
    /// stays as it is.
    #[inline]
    pub(crate) fn move_next_to<'a>(&mut self, place: &'a mut Option<Sample>) -> Option<&'a Sample> {
        if self.samples.len() <= usize::from(self.waiting) {
            return None;
        }
        let sample = place.insert(*self.samples.front()?);
        self.samples.pop_front();
        Some(sample)
    }

    /// Returns the age of a fix when it arrives: that which the speeds show, or the assumed one.
    #[must_use]
    pub fn gnss_latency(&self, tuning: &Tuning) -> Duration {
        self.parts.delays.latency(tuning.hold_times.gnss_latency)
    }

    /// Returns how late receiver and force are, as the drive shows it.
    #[must_use]
    pub const fn delays(&self) -> Delays {
        self.parts.delays.delays()
    }

    /// Starts with the delays that an earlier drive found.
    pub(crate) const fn resume(&mut self, delays: &Delays) {
        self.parts.delays.resume(delays);
    }

    /// Starts the drive with the first input, if it has not started.
    pub fn start(&mut self, now: Instant) {
        self.odometer.start(now);
    }

    /// Takes one reading. `source_switched` is whether it comes from another source than the last
    /// reading of the signal.
    // The parts with many signals are called, not inlined: a compiler for Cortex-M0 computes the
    // addresses of all that is inlined here before the match, for every reading.
    #[inline(always)] // Called once: where the intake passes readings on.
    pub fn record(
        &mut self,
        context: &mut Context,
        now: Instant,
        reading: Reading,
        source_switched: bool,
    ) {
        let value = reading.value.real();
        if source_switched {
            self.switch_source(reading.signal);
        }
        let Self {
            odometer, parts, ..
        } = self;
        match reading.signal {
            Signal::EngineTorqueFraction
            | Signal::FrictionTorque
            | Signal::EngineTorque
            | Signal::NetEngineTorque
            | Signal::MotorTorque
            | Signal::TractionForce => {
                if parts.traction.record(context, now, reading.signal, value) {
                    context.counters.tractions_used += 1;
                }
            }
            Signal::EngineSpeed
            | Signal::DrivelineEngaged
            | Signal::ShiftInProcess
            | Signal::ClutchSlip
            | Signal::ClutchSwitch
            | Signal::GearRatio
            | Signal::CurrentGear => {
                let speed_mps = odometer.speed_mps();
                parts.record_driveline(context, now, reading.signal, value, speed_mps);
            }
            Signal::MotorSpeed => {
                // A motor turns as an engine does, and in reverse the other way.
                let rpm = value.map(f32::abs);
                parts.record_driveline(context, now, reading.signal, rpm, odometer.speed_mps());
            }
            Signal::BrakeSwitch
            | Signal::BrakeLight
            | Signal::FoundationBrake
            | Signal::BrakePedal
            | Signal::BrakePressure
            | Signal::ParkingBrake
            | Signal::RetarderTorque
            | Signal::RetarderForce => {
                parts
                    .brakes
                    .record(&context.tuning, now, reading.signal, value);
                if matches!(
                    reading.signal,
                    Signal::RetarderTorque | Signal::RetarderForce
                ) {
                    parts.retarder.record(context, now, reading.signal, value);
                }
            }
            Signal::RetarderReferenceTorque => parts.retarder.set_reference(value),
            Signal::Mass => parts.stops.mass(context, now, value),
            Signal::AmbientTemperature => parts.air.ambient.set(value, now),
            Signal::AirPressure => parts.air.pressure.set(value, now),
            Signal::FixMethod
            | Signal::Satellites
            | Signal::Hdop
            | Signal::Vdop
            | Signal::Latitude
            | Signal::Longitude
            | Signal::Altitude => {
                self.record_fix(context, now, reading.signal, reading.value, source_switched);
            }
            Signal::WheelSpeed | Signal::FrontAxleSpeed | Signal::TachographSpeed => {
                let cell = odometer.cell();
                if let Some(mps) = parts.check_speed(context, now, cell, reading.signal, value) {
                    self.speed(context, now, mps);
                }
            }
            Signal::LongitudinalAcceleration => parts.accelerometer.record(now, value),
            Signal::VerticalSpeed => parts.record_vertical_speed(context, now, value),
            Signal::Pitch => parts.slope_sensors.pitch(value),
            Signal::EngineReferenceTorque | Signal::EngineInertia => {
                parts.record_configuration(context, reading.signal, value);
            }
            Signal::RoadwayGrade
            | Signal::EngineTorqueMode
            | Signal::ParasiticTorque
            | Signal::OutputShaftSpeed
            | Signal::SelectedGear
            | Signal::Passengers
            | Signal::PitchRate => {}
            Signal::Fan | Signal::YawRate | Signal::Course | Signal::GnssSpeed => {
                let speed_mps = odometer.speed_mps();
                let signals = &mut parts.effect_signals;
                signals.record(&context.tuning, now, reading.signal, value, speed_mps);
                if let (Signal::GnssSpeed, Some(mps)) = (reading.signal, value) {
                    parts.delays.ground(now, mps, &context.tuning.detection);
                }
            }
        }
    }

    /// Takes a change of a signal's source. Forces and speeds of two sources do not go together: a
    /// difference that no force caused would be read as a slope, and as a scale.
    #[inline(never)] // Rare.
    fn switch_source(&mut self, signal: Signal) {
        match signal {
            Signal::EngineTorque | Signal::TractionForce => {}
            Signal::LongitudinalAcceleration => return self.parts.accelerometer.switch_source(),
            Signal::WheelSpeed => self.parts.wheel_check = SpeedCheck::default(),
            Signal::FrontAxleSpeed => self.parts.front_axle_check = SpeedCheck::default(),
            Signal::TachographSpeed => self.parts.tachograph_check = SpeedCheck::default(),
            Signal::GnssSpeed => return self.parts.delays.switch_receiver(),
            _ => return,
        }
        self.odometer.interrupt();
    }

    /// Takes whether the engine's torque comes from another sender than the engine.
    pub(crate) const fn doubt_torque(&mut self, is_doubted: bool) {
        self.parts.is_torque_doubted = is_doubted;
    }

    /// Takes whether the wheel speed comes more often than it did, and has for a second.
    pub(crate) fn doubt_speed(&mut self, comes_too_often: bool) {
        let driven_m = self.odometer.speed_mps().unwrap_or_default();
        let cells = (driven_m / CELL_LENGTH_M) as u32;
        let cell = self.odometer.cell().saturating_sub(cells);
        self.parts.doubt_speed(comes_too_often, cell);
    }

    /// Returns the distance at which a fix that arrives now was taken, from the start of the open
    /// cell, m.
    #[inline(never)] // Called from two places.
    fn fix_distance_m(&self, context: &Context, now: Instant) -> f32 {
        let longest = context.tuning.hold_times.reading_timeout;
        let (latency, way_m) = match self.parts.delays.way_m(now) {
            Some(way_m) => (Duration::default(), way_m),
            None => (self.gnss_latency(&context.tuning), 0.0),
        };
        self.odometer.distance_m(now, latency, longest) - way_m
    }

    /// Takes a reading of the GNSS receiver.
    #[inline(never)] // See record().
    fn record_fix(
        &mut self,
        context: &mut Context,
        now: Instant,
        signal: Signal,
        value: Value,
        source_switched: bool,
    ) {
        let gnss = &mut self.parts.gnss;
        match signal {
            Signal::Latitude => gnss.latitude(value),
            Signal::Longitude => {
                let at_m = self.fix_distance_m(context, now);
                if self.parts.gnss.longitude(value, at_m) {
                    self.odometer.interrupt();
                }
            }
            Signal::Altitude => self.altitude(context, now, value.real(), source_switched),
            _ => gnss.quality(now, signal, value.real()),
        }
    }

    #[inline(never)] // Called from two places.
    fn altitude(
        &mut self,
        context: &mut Context,
        now: Instant,
        value: Option<f32>,
        source_switched: bool,
    ) {
        let at_m = self.fix_distance_m(context, now);
        let continuity = if source_switched {
            AltitudeContinuity::Switched
        } else {
            AltitudeContinuity::Followed
        };
        let gnss = &mut self.parts.gnss;
        match gnss.altitude(&context.tuning, now, value, at_m, continuity) {
            AltitudeOutcome::Taken => {}
            AltitudeOutcome::Poor => count(&mut context.counters.poor_fixes),
            AltitudeOutcome::Frozen => count(&mut context.counters.frozen_fixes),
        }
    }

    /// Takes a plausible speed, and drives the distance since the last one.
    fn speed(&mut self, context: &mut Context, now: Instant, reported_mps: f32) {
        let Self {
            odometer,
            parts,
            samples,
            waiting,
        } = self;
        let rolled_mps = reported_mps * context.model.effects.factor(Acts::WheelRadius);
        let rolled = TimedValue {
            value: rolled_mps,
            time: now,
        };
        let Tuning {
            hold_times,
            detection,
            ..
        } = &context.tuning;
        let mean_force_n = parts.traction.take_mean_n(now);
        let assumed = hold_times.gnss_latency;
        let further_m = parts
            .delays
            .wheels(rolled, mean_force_n, assumed, detection);
        if further_m != 0.0 {
            // The last fixes move to where they were taken.
            parts.gnss.put_back(further_m);
        }
        let factor = parts.delays.speed_factor();
        if factor != parts.speed_factor {
            parts.speed_factor = factor;
            odometer.interrupt();
        }
        // The range of readings bounds the cells of one: a factor may be any.
        let speed_mps = Scalar::min(rolled_mps * factor, *SPEEDS_MPS.end());
        let speed = TimedValue {
            value: speed_mps,
            time: now,
        };
        context.counters.speeds_used += 1;
        parts.follow_driveline(context, now, Some(speed_mps));
        parts.brakes.hold(&context.tuning, now);
        parts.stops.speed(&context.tuning, speed);
        let direction = DirectionSignals {
            speed_mps,
            gear: parts.driveline.gear(&context.tuning, now),
            course: parts.effect_signals.fresh_course(&context.tuning, now),
        };
        let was_reversing = parts.reversing.is_on();
        // What ends at a standstill was driven before it.
        let has_stood = parts.reversing.waits_for_course(direction.gear);
        if parts.reversing.follow(&context.tuning, now, &direction) {
            if !was_reversing {
                count(&mut context.counters.reversals);
            }
            take_back(samples, odometer, core::mem::take(waiting));
            parts.accelerometer.take(now);
            parts.slope_sensors = SlopeSensors::default();
            parts.gnss.clear();
            odometer.stand(speed);
            return;
        }
        let slower_mps = odometer
            .speed_mps()
            .map_or(speed_mps, |last| Scalar::min(last, speed_mps));
        let interval = Interval {
            mean_force_n,
            retarder_n: parts.retarder.take_mean_n(context, &parts.brakes, now),
            service_braking: parts.brakes.service_brakes_are_on(now),
            acceleration: parts.accelerometer.take(now),
            condition: parts.condition(context, now, slower_mps),
            resolution_mps: parts.resolution_mps(context, now),
        };
        let longest = context.tuning.hold_times.reading_timeout;
        let waits = has_stood && parts.reversing.waits_for_course(direction.gear);
        let bridged = odometer.drive(speed, interval, longest, |driven| {
            let sample = parts.sample(context, &driven);
            if samples.push_back(sample).is_err() {
                count(&mut context.counters.samples_lost);
            } else if waits {
                *waiting += 1;
            }
        });
        if *waiting >= WAITING {
            parts.reversing.give_up();
        }
        if !parts.reversing.waits_for_course(direction.gear) {
            *waiting = 0;
        }
        if !bridged {
            parts.slope_sensors = SlopeSensors::default();
            parts.gnss.clear();
            count(&mut context.counters.gaps);
        }
    }
}

/// Takes the newest cells back: they were driven backwards.
#[inline(never)] // Rare.
fn take_back(samples: &mut Deque<Sample, QUEUE>, odometer: &mut Odometer, count: u8) {
    samples.truncate(samples.len().saturating_sub(count.into()));
    odometer.take_back(count);
}

impl Default for Sampler {
    fn default() -> Self {
        Self::new()
    }
}
