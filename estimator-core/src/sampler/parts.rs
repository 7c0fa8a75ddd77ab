//! What the sampler collects from readings, and what it makes of it: the state of the driveline, the
//! speed that counts, and the sample of a driven cell.

use super::accepted_ranges::SPEEDS_MPS;
use super::brakes::Brakes;
use super::delays::DelayEstimator;
use super::driveline::{DrivelineSignals, DrivelineState};
use super::effect_inputs::EffectSignals;
use super::engine_configuration::EngineConfiguration;
use super::gnss::Gnss;
use super::inertial::Accelerometer;
use super::latest::{Latest, TimedValue};
use super::odometer::DrivenCell;
use super::retarder::Retarder;
use super::reversing::Reversing;
use super::slope_sensors::SlopeSensors;
use super::speed_check::{Plausibility, SpeedCheck};
use super::stops::Stops;
use super::traction::TractionInput;
use crate::cell::{CELL_LENGTH_M, CellEnd, Condition, Disagreement};
use crate::context::Context;
use crate::counters::count;
use crate::effect::Acts;
use crate::sample::{EffectInputs, ForceInputs, Sample};
use crate::signal::Signal;
use crate::time::{Duration, Instant};
use crate::vehicle::{Driveline, air_density};

/// What the sampler collects from readings.
#[derive(Clone, Debug)]
pub(super) struct Parts {
    pub driveline: DrivelineSignals,
    driveline_state: DrivelineState,
    /// End of the hold time of the last gear shift.
    shift_until: Instant,
    pub traction: TractionInput,
    engine_configuration: EngineConfiguration,
    pub accelerometer: Accelerometer,
    pub slope_sensors: SlopeSensors,
    pub brakes: Brakes,
    pub retarder: Retarder,
    pub stops: Stops,
    pub reversing: Reversing,
    pub gnss: Gnss,
    pub delays: DelayEstimator,
    /// Factor on the wheel speed in use.
    pub speed_factor: f32,
    wheel_speed: Latest,
    front_axle_speed: Latest,
    pub wheel_check: SpeedCheck,
    pub front_axle_check: SpeedCheck,
    pub tachograph_check: SpeedCheck,
    /// Whether the engine's torque comes from another sender than the engine.
    pub is_torque_doubted: bool,
    /// Whether the wheel speed comes more often than it did.
    comes_too_often: bool,
    /// Whether it may come from two senders.
    is_speed_doubted: bool,
    /// Last cell before speeds that have been found to be wrong since the last sample.
    right_until: Option<u32>,
    pub air: AirSignals,
    pub effect_signals: EffectSignals,
}

/// Temperature and pressure of the air.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct AirSignals {
    pub ambient: Latest,
    pub pressure: Latest,
}

impl AirSignals {
    fn density(&self) -> f32 {
        air_density(self.pressure.last(), self.ambient.last())
    }
}

impl Parts {
    /// Creates the parts before the first reading.
    #[inline(always)] // See Estimator::new_in().
    pub(super) fn new() -> Self {
        Self {
            driveline: DrivelineSignals::default(),
            driveline_state: DrivelineState::UNKNOWN,
            shift_until: Instant::default(),
            traction: TractionInput::new(),
            engine_configuration: EngineConfiguration::default(),
            accelerometer: Accelerometer::default(),
            slope_sensors: SlopeSensors::default(),
            brakes: Brakes::default(),
            retarder: Retarder::default(),
            stops: Stops::default(),
            reversing: Reversing::default(),
            gnss: Gnss::default(),
            delays: DelayEstimator::new(),
            speed_factor: 1.0,
            wheel_speed: Latest::default(),
            front_axle_speed: Latest::default(),
            wheel_check: SpeedCheck::default(),
            front_axle_check: SpeedCheck::default(),
            tachograph_check: SpeedCheck::default(),
            is_torque_doubted: false,
            comes_too_often: false,
            is_speed_doubted: false,
            right_until: None,
            air: AirSignals::default(),
            effect_signals: EffectSignals::default(),
        }
    }

    /// Takes a reading of the driveline. Most readings repeat the one before; then only the hold
    /// time of a transition is extended.
    #[inline(never)] // See Sampler::record().
    pub(super) fn record_driveline(
        &mut self,
        context: &Context,
        now: Instant,
        signal: Signal,
        value: Option<f32>,
        speed_mps: Option<f32>,
    ) {
        let changed = self.driveline.record(context, now, signal, value);
        let counts = self.driveline_state.needs_engine_speed
            || !matches!(signal, Signal::EngineSpeed | Signal::MotorSpeed);
        // Whether an open driveline coasts depends on the torque.
        if changed && counts || self.driveline_state.driveline == Driveline::Open {
            self.follow_driveline(context, now, speed_mps);
        } else if self.driveline_state.in_transition {
            self.hold_shift(context, now);
        }
    }

    /// Updates the state of the driveline, and the hold time after its changes.
    pub(super) fn follow_driveline(
        &mut self,
        context: &Context,
        now: Instant,
        speed_mps: Option<f32>,
    ) {
        let net_percent = self.traction.net_torque_percent(context, now);
        let state = self.driveline.state(context, now, speed_mps, net_percent);
        let changed = self.traction.set_driveline(context, now, state.driveline);
        if changed || state.in_transition {
            self.hold_shift(context, now);
        }
        self.driveline_state = state;
    }

    /// Takes a reading of the engine's configuration.
    pub(super) fn record_configuration(
        &mut self,
        context: &mut Context,
        signal: Signal,
        value: Option<f32>,
    ) {
        if self.engine_configuration.record(context, signal, value) {
            self.stops.scale_changed();
        }
    }

    /// Takes a vertical speed, which is worth as much as the fixes.
    #[inline(never)] // See Sampler::record().
    pub(super) fn record_vertical_speed(
        &mut self,
        context: &Context,
        now: Instant,
        value: Option<f32>,
    ) {
        let value = value.filter(|_| !self.gnss.is_poor(&context.tuning, now));
        self.slope_sensors.vertical_speed(value);
    }

    fn hold_shift(&mut self, context: &Context, now: Instant) {
        // What the engine says then is of before.
        let late = Duration::from_seconds(self.delays.traction_late_s());
        let until = now + context.tuning.hold_times.hold + late;
        self.shift_until = self.shift_until.max(until);
    }

    /// Returns the speed of a reading if it counts, m/s. The front axle's speed replaces the
    /// wheel-based speed where that is missing, and the tachograph's where both are. `cell` is the
    /// last one that was driven to its end.
    pub(super) fn check_speed(
        &mut self,
        context: &mut Context,
        now: Instant,
        cell: u32,
        signal: Signal,
        value: Option<f32>,
    ) -> Option<f32> {
        let Context {
            tuning, counters, ..
        } = context;
        let driveline = self.driveline_state.driveline;
        let turns = self.driveline.turns(tuning, now, driveline);
        let sensor = match signal {
            Signal::WheelSpeed => &mut self.wheel_check,
            Signal::FrontAxleSpeed => &mut self.front_axle_check,
            _ => &mut self.tachograph_check,
        };
        let reported_mps = value.filter(|mps| SPEEDS_MPS.contains(mps));
        let checked = reported_mps.map(|value| {
            let reading = TimedValue { value, time: now };
            (value, sensor.check(reading, cell, turns, tuning))
        });
        let plausible_mps = match checked {
            None => None,
            Some((mps, Plausibility::Plausible)) => Some(mps),
            // Those of a noisy sensor go back and forth as well.
            Some((mps, Plausibility::Contradicted)) if !self.comes_too_often => Some(mps),
            Some((_, Plausibility::Jumped)) => {
                count(&mut counters.speed_leaps);
                return None;
            }
            Some((_, Plausibility::Contradicted)) => {
                count(&mut counters.speed_leaps);
                None
            }
            Some((_, stuck)) => {
                count(&mut counters.frozen_speeds);
                if let Plausibility::Wrong { right_until } = stuck {
                    self.doubt_since(right_until);
                }
                None
            }
        };
        let timeout = tuning.hold_times.reading_timeout;
        let is_missing = |better: &Latest| better.within(now, timeout).is_none();
        let counts = match signal {
            Signal::WheelSpeed => {
                self.wheel_speed.set(plausible_mps, now);
                true
            }
            Signal::FrontAxleSpeed => {
                self.front_axle_speed.set(plausible_mps, now);
                is_missing(&self.wheel_speed)
            }
            _ => is_missing(&self.wheel_speed) && is_missing(&self.front_axle_speed),
        };
        plausible_mps.filter(|_| counts)
    }

    /// Takes whether the wheel speed comes more often than it did, since behind the cell with this
    /// number. It may come from two senders then, if its readings go back and forth.
    pub(super) fn doubt_speed(&mut self, comes_too_often: bool, cell: u32) {
        self.comes_too_often = comes_too_often;
        let is_doubted = self.wheel_check.take_returns() && comes_too_often;
        if is_doubted && !self.is_speed_doubted {
            self.doubt_since(cell);
        }
        self.is_speed_doubted = is_doubted;
    }

    /// Notes that the speed may be wrong in the cells behind that with this number.
    pub(super) fn doubt_since(&mut self, cell: u32) {
        let before = self.right_until.unwrap_or(cell);
        self.right_until = Some(before.min(cell));
    }

    /// Returns the resolution of the speed in use, m/s.
    pub(super) fn resolution_mps(&self, context: &Context, now: Instant) -> f32 {
        let timeout = context.tuning.hold_times.reading_timeout;
        let sensor = if self.wheel_speed.within(now, timeout).is_some() {
            &self.wheel_check
        } else if self.front_axle_speed.within(now, timeout).is_some() {
            &self.front_axle_check
        } else {
            &self.tachograph_check
        };
        sensor.resolution_mps(&context.tuning.detection)
    }

    /// Returns the condition of the interval that ends now.
    #[inline(always)] // In Sampler::speed.
    pub(super) fn condition(&self, context: &Context, now: Instant, slower_mps: f32) -> Condition {
        Condition {
            shifting: now < self.shift_until,
            braking: self.brakes.are_on(now),
            no_traction: !self.traction.is_known(context, now),
            crawling: slower_mps < context.tuning.detection.slow_mps,
        }
    }

    /// Returns the sample of a cell that was driven to its end.
    #[inline(always)] // In Sampler::speed.
    pub(super) fn sample(&mut self, context: &mut Context, driven: &DrivenCell) -> Sample {
        let model = &context.model;
        let forces = ForceInputs {
            traction_n: driven.mean_force_n * model.effects.factor(Acts::Traction),
            rotating_kg: self.traction.rotating_kg(model),
            mass_kg: self.stops.mass_kg(model),
            air_density: self.air.density(),
        };
        let condition = driven.condition;
        let right_until = self.right_until.take().unwrap_or(driven.number);
        let wrong_cells = driven.number.saturating_sub(right_until).min(0xffff) as u16;
        let disagreement = Disagreement {
            speed: self.is_speed_doubted || wrong_cells > 0,
            torque: self.is_torque_doubted,
            ..Disagreement::default()
        };
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
            retarder_n: driven.retarder_n,
            service_braking: driven.service_braking,
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
            inertial: self.accelerometer.measurement(&driven.acceleration),
            slope: self.slope_sensors.take(driven.speed_mps),
            after_load_change: self.stops.take_load_change(context),
            after_stop: self.stops.take_stop(),
            mass_is_reported: self.stops.has_reported_mass(),
            torque_rest: self.traction.take_rests(driven.time),
            traction_late_s: self.delays.traction_late_s(),
            disagreement,
            disagreeing_cells: wrong_cells.max(u16::from(!disagreement.is_none())),
        };
        self.gnss.cell_closed();
        sample
    }
}
