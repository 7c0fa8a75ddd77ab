//! The driveline: which gear is engaged, and whether its torque reaches the wheels.

use super::latest::Latest;
use crate::context::Context;
use crate::model::Model;
use crate::scalar::Scalar;
use crate::signal::Signal;
use crate::time::Instant;
use crate::tuning::Tuning;
use crate::vehicle::{Driveline, Gear, Powertrain, Traction};

/// Tolerance of a gear that is in, over that of one that the engine approaches at launch.
const ENGAGED: f32 = 2.0;
/// Speed below which a single reduction is taken to be in, m/s.
const SLOW_MPS: f32 = 1.0;

/// The signals of the driveline.
#[derive(Clone, Debug, Default)]
pub(super) struct DrivelineSignals {
    engaged: Latest,
    shifting: Latest,
    clutch_slip: Latest,
    clutch_pedal: Latest,
    gear_ratio: Latest,
    /// The gear of that ratio: it is searched once.
    gear_of_ratio: Option<Gear>,
    gear: Latest,
    engine_speed: Latest,
    /// Whether the engine is a motor.
    is_motor: bool,
    /// Readings in which the engine turned with the reported gear.
    agreed: u16,
    measured_ratio: MeasuredRatio,
}

/// The ratio at which the engine turns, where that is not the reported gear's.
///
/// Torque and engine speed are a power, and power reaches the wheels whatever gear is reported: a
/// wrong report, or a range gear between gearbox and axle.
#[derive(Clone, Copy, Debug, Default)]
struct MeasuredRatio {
    ratio: f32,
    since: Option<Instant>,
}

impl MeasuredRatio {
    /// Takes a ratio. Returns the ratio that has lasted for long enough.
    fn follow(&mut self, tuning: &Tuning, now: Instant, ratio: f32) -> Option<f32> {
        let tolerance = tuning.detection.gear_tolerance;
        let since = self
            .since
            .filter(|_| (ratio - self.ratio).abs() <= tolerance * self.ratio);
        let Some(since) = since else {
            *self = Self {
                ratio,
                since: Some(now),
            };
            return None;
        };
        (now.since(since) >= tuning.hold_times.measured_ratio).then_some(self.ratio)
    }
}

/// The state of the driveline at one time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct DrivelineState {
    /// Gear engaged, open, or unknown.
    pub driveline: Driveline,
    /// A shift is in process, or a clutch slips or may slip: the force at the wheels is not known.
    pub in_transition: bool,
    /// Whether it depends on the engine speed.
    pub needs_engine_speed: bool,
}

impl DrivelineState {
    /// The state before the first reading.
    pub(super) const UNKNOWN: Self = Self {
        driveline: Driveline::Unknown,
        in_transition: false,
        needs_engine_speed: true,
    };
}

impl DrivelineSignals {
    /// Takes a reading. Returns whether it differs from the one before.
    pub(super) fn record(
        &mut self,
        context: &Context,
        now: Instant,
        signal: Signal,
        value: Option<f32>,
    ) -> bool {
        // A switch without a value keeps its last one; a gear without a value is unknown.
        let (latest, keeps_last) = match signal {
            Signal::DrivelineEngaged => (&mut self.engaged, true),
            Signal::ShiftInProcess => (&mut self.shifting, true),
            Signal::ClutchSlip => (&mut self.clutch_slip, true),
            Signal::ClutchSwitch => (&mut self.clutch_pedal, true),
            Signal::GearRatio => (&mut self.gear_ratio, false),
            Signal::CurrentGear => (&mut self.gear, false),
            Signal::EngineSpeed | Signal::MotorSpeed => {
                self.is_motor = signal == Signal::MotorSpeed;
                (&mut self.engine_speed, false)
            }
            _ => return false,
        };
        if keeps_last && value.is_none() {
            return false;
        }
        let timeout = context.tuning.hold_times.state_timeout;
        let changed = latest.within_inlined(now, timeout) != value;
        latest.set(value, now);
        if changed && signal == Signal::GearRatio {
            self.gear_of_ratio = match &context.model.vehicle.traction {
                Traction::Powertrain(powertrain) => {
                    let tolerance = context.tuning.detection.gear_tolerance;
                    value.and_then(|ratio| powertrain.gear_of_ratio(ratio, tolerance))
                }
                Traction::Force => None,
            };
        }
        changed
    }

    /// Returns the state at a speed.
    pub(super) fn state(
        &mut self,
        context: &Context,
        now: Instant,
        speed_mps: Option<f32>,
        net_torque_percent: Option<f32>,
    ) -> DrivelineState {
        let Context { model, tuning, .. } = context;
        let timeout = tuning.hold_times.state_timeout;
        let shifting = self.shifting.is_on(now, timeout);
        let Traction::Powertrain(powertrain) = &model.vehicle.traction else {
            return DrivelineState {
                driveline: Driveline::Unknown,
                in_transition: shifting,
                needs_engine_speed: false,
            };
        };
        let engaged = self.engaged.within(now, timeout);
        let engaged = engaged.map(|engaged| engaged > 0.5);
        let pedal = self.clutch_pedal.is_on(now, timeout);
        let slip_percent = self.clutch_slip.within(now, timeout).unwrap_or(0.0);
        let offset_percent = tuning.detection.clutch_slip_percent;
        let slips = slip_percent > offset_percent;
        let gear = self.gear.within(now, timeout);
        let neutral = gear.is_some_and(|gear| gear.abs() < 0.5);
        // Without a report on the driveline itself, a shift counts as open for as long as it takes.
        let open = engaged.map_or(shifting || slips, |engaged| !engaged) || neutral || pedal;
        if open {
            // At launch the clutch is not closed either, and passes all the torque. An engine
            // without load would speed up.
            let coasts = speed_mps.is_some_and(|mps| mps >= tuning.detection.launch_mps)
                && net_torque_percent
                    .is_none_or(|percent| percent < tuning.detection.loaded_percent);
            let half_open = slips && slip_percent < 100.0 - offset_percent;
            return DrivelineState {
                driveline: Driveline::Open,
                in_transition: shifting || pedal || half_open || !coasts,
                needs_engine_speed: false,
            };
        }
        let (driveline, needs_engine_speed) =
            self.closed(powertrain, model, tuning, now, speed_mps);
        DrivelineState {
            driveline,
            in_transition: shifting || slips,
            needs_engine_speed,
        }
    }

    /// Returns the reported gear; negative in reverse.
    pub(super) fn gear(&self, tuning: &Tuning, now: Instant) -> Option<f32> {
        self.gear.within(now, tuning.hold_times.state_timeout)
    }

    /// Returns the engine speed over the ratio of the engaged gear, rpm. It is proportional to the
    /// speed of the wheels.
    pub(super) fn turns(&self, tuning: &Tuning, now: Instant, driveline: Driveline) -> Option<f32> {
        match driveline {
            Driveline::Engaged(gear) => {
                let rpm = self
                    .engine_speed
                    .within(now, tuning.hold_times.reading_timeout)?;
                Some(rpm / gear.ratio)
            }
            Driveline::Open | Driveline::Unknown => None,
        }
    }

    /// Returns the gear of a driveline that no signal reports to be open, and whether that depends
    /// on the engine speed.
    fn closed(
        &mut self,
        powertrain: &Powertrain,
        model: &Model,
        tuning: &Tuning,
        now: Instant,
        speed_mps: Option<f32>,
    ) -> (Driveline, bool) {
        let timeout = tuning.hold_times.state_timeout;
        let detection = &tuning.detection;
        let is_launch = speed_mps.is_none_or(|mps| mps < detection.launch_mps);
        let engine_rpm = self
            .engine_speed
            .within(now, tuning.hold_times.reading_timeout);
        let ratio = self.gear_ratio.within(now, timeout);
        let number = self.gear.within(now, timeout);
        // A single reduction is in unless a signal says that it is open. Nothing else needs to report
        // it, and the number of a forward gear may be that of a selector. An engine that turns otherwise
        // has a gearbox, of which the file has one gear only.
        if let Some(gear) = powertrain.only_gear()
            && ratio.is_none()
            && number.is_none_or(|number| number > 0.0)
        {
            // At launch, readings of different ages differ much: only a multiple counts.
            let (slowest_mps, tolerance) = if is_launch {
                (SLOW_MPS, 1.0)
            } else {
                (0.0, ENGAGED * detection.gear_tolerance)
            };
            let turns = |(rpm, mps)| {
                let mps = Scalar::max(mps, slowest_mps);
                let turned_rpm = powertrain.engine_rpm(gear, mps, model.wheel_radius_m());
                is_near(rpm, turned_rpm, tolerance)
            };
            let is_in = self.is_motor || engine_rpm.zip(speed_mps).is_none_or(turns);
            let driveline = if is_in {
                Driveline::Engaged(gear)
            } else {
                Driveline::Unknown
            };
            return (driveline, !self.is_motor);
        }
        let reported = ratio
            .and(self.gear_of_ratio)
            .or_else(|| number.and_then(|number| powertrain.gear(number as i32)));
        let is_reported = ratio.is_some() || number.is_some();
        let in_doubt = is_launch || !self.is_clutch_reported(tuning, now);
        let gear = match (reported, engine_rpm, speed_mps) {
            (None, Some(rpm), Some(mps)) if !is_reported => {
                let tolerance = detection.gear_tolerance;
                powertrain.gear_of_speeds(rpm, mps, model.wheel_radius_m(), tolerance)
            }
            // A gear is reported whether it is in or not. Where no other signal reports that, and at
            // launch, the engine must turn with it. It must also do so where it did so far: else the
            // gear is wrong.
            (Some(gear), Some(rpm), Some(mps)) => {
                let tolerance = if is_launch {
                    detection.gear_tolerance
                } else {
                    ENGAGED * detection.gear_tolerance
                };
                let turned_rpm = powertrain.engine_rpm(gear, mps, model.wheel_radius_m());
                let turns = is_near(rpm, turned_rpm, tolerance);
                if turns && !in_doubt {
                    self.agreed = self.agreed.saturating_add(1);
                }
                let must_turn = in_doubt || self.agreed >= detection.gear_agreed_readings;
                if turns || !must_turn {
                    self.measured_ratio = MeasuredRatio::default();
                    Some(gear)
                } else if is_launch {
                    None
                } else {
                    let ratio = gear.ratio * rpm / turned_rpm;
                    let measured = self.measured_ratio.follow(tuning, now, ratio);
                    measured.map(|ratio| Gear { ratio, ..gear })
                }
            }
            (reported, ..) => reported,
        };
        let driveline = gear.map_or(Driveline::Unknown, Driveline::Engaged);
        (driveline, in_doubt || !is_reported)
    }

    /// Returns whether any signal reports shifts or the clutch.
    fn is_clutch_reported(&self, tuning: &Tuning, now: Instant) -> bool {
        [&self.engaged, &self.shifting, &self.clutch_slip]
            .into_iter()
            .any(|signal| {
                signal
                    .within(now, tuning.hold_times.state_timeout)
                    .is_some()
            })
    }
}

/// Returns whether an engine turns as it does in a gear, within a relative tolerance.
fn is_near(rpm: f32, turned_rpm: f32, tolerance: f32) -> bool {
    (rpm - turned_rpm).abs() <= tolerance * turned_rpm
}
