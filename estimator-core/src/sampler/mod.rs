//! The sampler: readings of different rates and ages become one sample a cell.
//!
//! The odometer moves from one speed reading to the next. Between two of them the speed is linear in
//! time and the force is the mean of what was read in between, so that the work equals the integral
//! of the force at any rate. Each interval is then divided at the ends of cells.
//!
//! | file | content |
//! |---|---|
//! | `driveline`, `traction` | gear and clutch; torque or force to mean traction force |
//! | `brakes`, `brake_detector` | brakes that signals report; brakes that none reports |
//! | `odometer`, `speed_check` | distance and cells; plausibility of speed readings |
//! | `gnss` | positions and altitudes along the driven distance |
//! | `stops`, `reversing` | standstills, weighings, load changes; direction of motion |
//! | `effect_inputs` | what effects depend on |
//! | `latest`, `held_signal`, `accepted_ranges` | newest values, their age and rests; ranges of readings |
//!
//! Hold times make the model invalid for some time after a gear shift or a brake. The one after a
//! shift is in this file (`Parts::hold_shift`); those after a brake or a retarder are in `brakes`.
//! Their lengths are [`HoldTimes`](crate::tuning::HoldTimes).

mod accepted_ranges;
mod brake_detector;
mod brakes;
mod driveline;
mod effect_inputs;
mod gnss;
mod gnss_timing;
mod held_signal;
mod latest;
mod odometer;
mod reversing;
mod speed_check;
mod stops;
mod traction;

use crate::cell::{CELL_LENGTH_M, CellEnd, Condition, Disagreement};
use crate::context::Context;
use crate::counters::count;
use crate::effect::Acts;
use crate::sample::{AltitudeContinuity, EffectInputs, ForceInputs, Sample};
use crate::scalar::Scalar;
use crate::signal::{Reading, Signal, Value};
use crate::time::{Duration, Instant};
use crate::tuning::Tuning;
use crate::vehicle::{Driveline, Traction, air_density};
use accepted_ranges::SPEEDS_MPS;
use brake_detector::BrakeDetector;
use brakes::Brakes;
use driveline::{DrivelineSignals, DrivelineState};
use effect_inputs::EffectSignals;
use gnss::{AltitudeOutcome, Gnss};
use gnss_timing::GnssTiming;
use heapless::Deque;
use latest::{Latest, TimedValue};
use odometer::{DrivenCell, Interval, Odometer};
use reversing::{DirectionSignals, Reversing};
use speed_check::{Plausibility, SpeedCheck};
use stops::Stops;
use traction::TractionInput;

/// Number of samples that may wait for the filter.
const QUEUE: usize = 24;

/// Collects readings and divides the drive into samples.
#[derive(Clone, Debug)]
pub struct Sampler {
    odometer: Odometer,
    parts: Parts,
    samples: Deque<Sample, QUEUE>,
}

/// What the sampler collects from readings.
#[derive(Clone, Debug)]
struct Parts {
    driveline: DrivelineSignals,
    driveline_state: DrivelineState,
    /// End of the hold time of the last gear shift.
    shift_until: Instant,
    traction: TractionInput,
    brakes: Brakes,
    brake_detector: BrakeDetector,
    stops: Stops,
    reversing: Reversing,
    gnss: Gnss,
    gnss_timing: GnssTiming,
    /// Factor on the wheel speed in use.
    speed_factor: f32,
    wheel_speed: Latest,
    wheel_check: SpeedCheck,
    front_axle_check: SpeedCheck,
    air: AirSignals,
    effect_signals: EffectSignals,
}

/// Temperature and pressure of the air.
#[derive(Clone, Copy, Debug, Default)]
struct AirSignals {
    ambient: Latest,
    pressure: Latest,
}

impl AirSignals {
    fn density(&self) -> f32 {
        air_density(self.pressure.last(), self.ambient.last())
    }
}

impl Sampler {
    /// Creates a sampler before the first reading.
    #[must_use]
    pub fn new() -> Self {
        Self {
            odometer: Odometer::default(),
            parts: Parts {
                driveline: DrivelineSignals::default(),
                driveline_state: DrivelineState::UNKNOWN,
                shift_until: Instant::default(),
                traction: TractionInput::new(),
                brakes: Brakes::default(),
                brake_detector: BrakeDetector::default(),
                stops: Stops::default(),
                reversing: Reversing::default(),
                gnss: Gnss::default(),
                gnss_timing: GnssTiming::default(),
                speed_factor: 1.0,
                wheel_speed: Latest::default(),
                wheel_check: SpeedCheck::default(),
                front_axle_check: SpeedCheck::default(),
                air: AirSignals::default(),
                effect_signals: EffectSignals::default(),
            },
            samples: Deque::new(),
        }
    }

    /// Returns the next sample that is ready.
    pub fn next_sample(&mut self) -> Option<Sample> {
        self.samples.pop_front()
    }

    /// Returns the age of a fix when it arrives: that which the speeds show, or the assumed one.
    #[must_use]
    pub fn gnss_latency(&self, tuning: &Tuning) -> Duration {
        self.parts
            .gnss_timing
            .latency(tuning.hold_times.gnss_latency)
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
            Signal::BrakeSwitch
            | Signal::BrakePedal
            | Signal::BrakePressure
            | Signal::ParkingBrake
            | Signal::RetarderTorque => {
                parts
                    .brakes
                    .record(&context.tuning, now, reading.signal, value);
            }
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
            Signal::WheelSpeed | Signal::FrontAxleSpeed => {
                if let Some(mps) = parts.check_speed(context, now, reading.signal, value) {
                    self.speed(context, now, mps);
                }
            }
            Signal::EngineTorqueMode
            | Signal::ParasiticTorque
            | Signal::OutputShaftSpeed
            | Signal::SelectedGear
            | Signal::Passengers => {}
            Signal::Fan | Signal::YawRate | Signal::Course | Signal::GnssSpeed => {
                let speed_mps = odometer.speed_mps();
                let signals = &mut parts.effect_signals;
                signals.record(&context.tuning, now, reading.signal, value, speed_mps);
                if let (Signal::GnssSpeed, Some(mps)) = (reading.signal, value) {
                    self.compare_speeds(context, now, mps);
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
            Signal::WheelSpeed => self.parts.wheel_check = SpeedCheck::default(),
            Signal::FrontAxleSpeed => self.parts.front_axle_check = SpeedCheck::default(),
            _ => return,
        }
        self.odometer.interrupt();
        self.parts.brake_detector.restart();
    }

    /// Returns the distance at which a fix that arrives now was taken, from the start of the open
    /// cell, m.
    fn fix_distance_m(&self, context: &Context, now: Instant) -> f32 {
        let longest = context.tuning.hold_times.speed_timeout;
        if let Some(way_m) = self.parts.gnss_timing.way_m(now) {
            return self.odometer.distance_m(now, Duration::default(), longest) - way_m;
        }
        let latency = self.gnss_latency(&context.tuning);
        self.odometer.distance_m(now, latency, longest)
    }

    /// Compares a speed over ground with that of the wheels. If this shows another latency, the last
    /// fixes move to where they were taken.
    #[inline(never)] // See record().
    fn compare_speeds(&mut self, context: &Context, now: Instant, ground_mps: f32) {
        let Tuning {
            hold_times,
            detection,
            ..
        } = &context.tuning;
        let before_m = self.fix_distance_m(context, now);
        let timing = &mut self.parts.gnss_timing;
        timing.ground(now, ground_mps, hold_times.gnss_latency, detection);
        let metres = before_m - self.fix_distance_m(context, now);
        if metres != 0.0 {
            self.parts.gnss.put_back(metres);
        }
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
                self.parts.gnss.longitude(value, at_m);
            }
            Signal::Altitude => self.altitude(context, now, value.real(), source_switched),
            _ => gnss.quality(now, signal, value.real()),
        }
    }

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
        } = self;
        let rolled_mps = reported_mps * context.model.effects.factor(Acts::WheelRadius);
        parts.gnss_timing.wheels(TimedValue {
            value: rolled_mps,
            time: now,
        });
        let factor = parts.gnss_timing.speed_factor();
        if factor != parts.speed_factor {
            parts.speed_factor = factor;
            odometer.interrupt();
            parts.brake_detector.restart();
        }
        let speed_mps = rolled_mps * factor;
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
        if parts.reversing.follow(&context.tuning, now, &direction) {
            if !was_reversing {
                count(&mut context.counters.reversals);
            }
            parts.traction.take_mean_n(now);
            parts.gnss.clear();
            parts.brake_detector.restart();
            odometer.stand(speed);
            return;
        }
        let slower_mps = odometer
            .speed_mps()
            .map_or(speed_mps, |last| Scalar::min(last, speed_mps));
        let interval = Interval {
            mean_force_n: parts.traction.take_mean_n(now),
            condition: parts.condition(context, now, slower_mps),
            resolution_mps: parts.resolution_mps(context, now),
        };
        let detects_brakes = context.model.vehicle.traction != Traction::Force;
        let longest = context.tuning.hold_times.speed_timeout;
        let bridged = odometer.drive(speed, interval, longest, |driven| {
            let sample = parts.sample(context, &driven, detects_brakes);
            if samples.push_back(sample).is_err() {
                count(&mut context.counters.samples_lost);
            }
        });
        if !bridged {
            parts.gnss.clear();
            parts.brake_detector.restart();
            count(&mut context.counters.gaps);
        }
    }
}

impl Default for Sampler {
    fn default() -> Self {
        Self::new()
    }
}

impl Parts {
    /// Takes a reading of the driveline. Most readings repeat the one before; then only the hold
    /// time of a transition is extended.
    #[inline(never)] // See Sampler::record().
    fn record_driveline(
        &mut self,
        context: &Context,
        now: Instant,
        signal: Signal,
        value: Option<f32>,
        speed_mps: Option<f32>,
    ) {
        let changed = self.driveline.record(context, now, signal, value);
        let counts = signal != Signal::EngineSpeed || self.driveline_state.needs_engine_speed;
        // Whether an open driveline coasts depends on the torque.
        if changed && counts || self.driveline_state.driveline == Driveline::Open {
            self.follow_driveline(context, now, speed_mps);
        } else if self.driveline_state.in_transition {
            self.hold_shift(context, now);
        }
    }

    /// Updates the state of the driveline, and the hold time after its changes.
    fn follow_driveline(&mut self, context: &Context, now: Instant, speed_mps: Option<f32>) {
        let net_percent = self.traction.net_torque_percent(context, now);
        let state = self.driveline.state(context, now, speed_mps, net_percent);
        let changed = self.traction.set_driveline(context, now, state.driveline);
        if changed || state.in_transition {
            self.hold_shift(context, now);
        }
        self.driveline_state = state;
    }

    fn hold_shift(&mut self, context: &Context, now: Instant) {
        let until = now + context.tuning.hold_times.shift_hold;
        self.shift_until = self.shift_until.max(until);
    }

    /// Returns the speed of a reading if it counts, m/s. The front axle's speed replaces the
    /// wheel-based speed where that is missing.
    fn check_speed(
        &mut self,
        context: &mut Context,
        now: Instant,
        signal: Signal,
        value: Option<f32>,
    ) -> Option<f32> {
        let Context {
            tuning, counters, ..
        } = context;
        let driveline = self.driveline_state.driveline;
        let turns = self.driveline.turns(tuning, now, driveline);
        let is_wheels = signal == Signal::WheelSpeed;
        let sensor = if is_wheels {
            &mut self.wheel_check
        } else {
            &mut self.front_axle_check
        };
        let reported_mps = value.filter(|mps| SPEEDS_MPS.contains(mps));
        let checked =
            reported_mps.map(|mps| (mps, sensor.check(now, mps, turns, &tuning.detection)));
        let plausible_mps = match checked {
            None => None,
            Some((mps, Plausibility::Plausible)) => Some(mps),
            Some((_, Plausibility::Jumped)) => {
                count(&mut counters.speed_leaps);
                return None;
            }
            Some((_, Plausibility::Frozen)) => {
                count(&mut counters.frozen_speeds);
                None
            }
        };
        if is_wheels {
            self.wheel_speed.set(plausible_mps, now);
            return plausible_mps;
        }
        let timeout = tuning.hold_times.speed_timeout;
        let is_missing = self.wheel_speed.within(now, timeout).is_none();
        plausible_mps.filter(|_| is_missing)
    }

    /// Returns the resolution of the speed in use, m/s.
    fn resolution_mps(&self, context: &Context, now: Instant) -> f32 {
        let timeout = context.tuning.hold_times.speed_timeout;
        if self.wheel_speed.within(now, timeout).is_some() {
            self.wheel_check.resolution_mps(&context.tuning.detection)
        } else {
            self.front_axle_check
                .resolution_mps(&context.tuning.detection)
        }
    }

    /// Returns the condition of the interval that ends now.
    #[inline(always)] // In Sampler::speed.
    fn condition(&self, context: &Context, now: Instant, slower_mps: f32) -> Condition {
        Condition {
            shifting: now < self.shift_until,
            braking: self.brakes.are_on(now),
            no_traction: !self.traction.is_known(context, now),
            crawling: slower_mps < context.tuning.detection.crawl_mps,
        }
    }

    /// Returns the sample of a cell that was driven to its end.
    #[inline(always)] // In Sampler::speed.
    fn sample(
        &mut self,
        context: &mut Context,
        driven: &DrivenCell,
        detects_brakes: bool,
    ) -> Sample {
        let model = &context.model;
        let forces = ForceInputs {
            traction_n: driven.mean_force_n * model.effects.factor(Acts::Traction),
            rotating_kg: self.traction.rotating_kg(model),
            mass_kg: self.stops.mass_kg(model),
            air_density: self.air.density(),
        };
        let mut condition = driven.condition;
        if detects_brakes {
            let is_invalid = !condition.is_valid() || condition.crawling;
            let detector = &mut self.brake_detector;
            if detector.advance(context, &forces, driven.speed_mps, is_invalid) {
                condition.braking = true;
                context.counters.brakes_guessed += 1;
            }
        } else {
            self.brake_detector.restart();
        }
        let model = &context.model;
        let sample = Sample {
            end: CellEnd {
                cell: driven.number,
                time: driven.time,
                position_e7: self.gnss.position_at(&context.tuning, CELL_LENGTH_M),
                speed_mps: driven.speed_mps,
                condition,
            },
            gap_cells: driven.gap_cells,
            length_m: CELL_LENGTH_M,
            duration_s: driven.duration_s,
            forces,
            effect_inputs: EffectInputs {
                driven_s: self.stops.driven_s(),
                ambient_celsius: self.air.ambient.last().into(),
                engaged: self.traction.is_engaged(model),
                ..self
                    .effect_signals
                    .take(&context.tuning, driven.time, driven.speed_mps)
            },
            speed: driven.speed,
            altitude: self.gnss.altitude_before(CELL_LENGTH_M),
            after_load_change: self.stops.take_load_change(context),
            after_stop: self.stops.take_stop(),
            mass_is_reported: self.stops.has_reported_mass(),
            disagreement: Disagreement::default(),
        };
        self.gnss.cell_closed();
        sample
    }
}
