//! Faults of what frames say: sampled, held, coarse, late and wrong signals.

use super::low_pass::LowPass;
use super::torque_edit::torque;
use crate::faults::frames::lost;
use crate::faults::signals::{replaced, rewritten};
use crate::faults::{Frames, Window};
use estimator_core::{Signal, Value};
use host_sim::simulator::random::OrnsteinUhlenbeck;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use std::collections::{BTreeMap, VecDeque};

const SPEEDS: &[Signal] = &[Signal::WheelSpeed, Signal::FrontAxleSpeed];
/// What turns with the driven wheels.
const DRIVEN: &[Signal] = &[
    Signal::WheelSpeed,
    Signal::EngineSpeed,
    Signal::OutputShaftSpeed,
];
const BRAKES: &[Signal] = &[
    Signal::BrakeSwitch,
    Signal::BrakePedal,
    Signal::RetarderTorque,
];
const MASS: &[Signal] = &[Signal::Mass];
const GEARS: &[Signal] = &[Signal::CurrentGear, Signal::SelectedGear];
const RATIO: &[Signal] = &[Signal::GearRatio];
/// Gears of both trucks.
const GEAR_COUNT: f32 = 12.0;
/// Period of an anti-lock brake, s, the part of it with locking wheels, and the slip then.
const ANTI_LOCK: (f64, f64, f32) = (0.6, 0.5, 0.25);

/// A change of what frames say.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Edit {
    /// Torque is available once in so many seconds only.
    TorqueEvery(f64),
    /// Torque keeps its value for so many seconds.
    TorqueHeld(f64),
    /// Torque comes in steps of so many percent.
    TorqueSteps(f64),
    /// Torque passes a filter of first order with this time constant, s.
    TorqueLowPass(f64),
    /// Torque is late by so many seconds.
    TorqueLate(f64),
    /// Torque is wrong by a part that wanders: standard deviation, correlation time in s, seed.
    TorqueWander(f64, f64, u64),
    /// The reported number of the gear differs from that of the engaged one by so many.
    GearOff(i8),
    /// The ratio of the gear is not reported.
    RatioUntold,
    /// The reverse gear is not reported.
    ReverseUntold,
    /// Both wheel speeds are too high by this factor.
    SpeedFactor(f32),
    /// Both wheel speeds come in steps of so many m/s.
    SpeedSteps(f32),
    /// Both wheel speeds pass a filter of first order with this time constant, s.
    SpeedLowPass(f64),
    /// GNSS altitude passes a filter of first order with this time constant, s.
    AltitudeLowPass(f64),
    /// Neither brake nor retarder is reported.
    BrakesUntold,
    /// The mass is not reported.
    MassUntold,
    /// The driven wheels slip by this part.
    Slip(f32),
    /// The wheels lock and turn again, as with an anti-lock brake.
    AntiLock,
    /// Nothing is sent: ignition off.
    Silence,
}

impl Edit {
    /// Returns the frames with the change within a window.
    #[must_use]
    pub fn applied<'a>(&self, frames: Frames<'a>, window: Window) -> Frames<'a> {
        match *self {
            Self::TorqueEvery(period_s) => {
                let mut sent = None;
                torque(frames, window, move |s, percent| {
                    let turn = (s / period_s) as i64;
                    (sent.replace(turn) != Some(turn)).then_some(percent)
                })
            }
            Self::TorqueHeld(period_s) => {
                let mut held = (-1, 0.0);
                torque(frames, window, move |s, percent| {
                    let turn = (s / period_s) as i64;
                    if turn != held.0 {
                        held = (turn, percent);
                    }
                    Some(held.1)
                })
            }
            Self::TorqueSteps(step) => torque(frames, window, move |_, percent| {
                Some((percent / step).round() * step)
            }),
            Self::TorqueLowPass(time_s) => {
                let mut filter = LowPass::new(time_s);
                torque(frames, window, move |s, percent| {
                    Some(filter.next(s, percent))
                })
            }
            Self::TorqueLate(late_s) => {
                let mut past = VecDeque::new();
                torque(frames, window, move |s, percent| {
                    past.push_back((s, percent));
                    while past
                        .get(1)
                        .is_some_and(|second: &(f64, f64)| second.0 <= s - late_s)
                    {
                        past.pop_front();
                    }
                    past.front().map(|first| first.1)
                })
            }
            Self::TorqueWander(sigma, time_s, seed) => {
                let mut rng = ChaCha8Rng::seed_from_u64(seed);
                let mut error = OrnsteinUhlenbeck::new(sigma, time_s, &mut rng);
                let mut last_s = 0.0;
                torque(frames, window, move |s, percent| {
                    let part = error.advance((s - last_s).max(0.0), &mut rng);
                    last_s = s;
                    Some(percent * (1.0 + part))
                })
            }
            Self::GearOff(off) => rewritten(frames, window, move |_, signal, value| match value {
                Value::Real(gear) if GEARS.contains(&signal) && gear >= 1.0 => {
                    Value::Real((gear + f32::from(off)).clamp(1.0, GEAR_COUNT))
                }
                other => other,
            }),
            Self::RatioUntold => replaced(frames, window, RATIO, Value::NotAvailable),
            Self::ReverseUntold => rewritten(frames, window, |_, signal, value| match value {
                Value::Real(gear) if GEARS.contains(&signal) && gear < 0.0 => Value::NotAvailable,
                other => other,
            }),
            Self::SpeedFactor(factor) => scaled(frames, window, SPEEDS, factor),
            Self::SpeedSteps(step) => rewritten(frames, window, move |_, signal, value| {
                number_of(SPEEDS, signal, value, |mps| (mps / step).floor() * step)
            }),
            Self::SpeedLowPass(time_s) => low_passed(frames, window, SPEEDS, time_s),
            Self::AltitudeLowPass(time_s) => {
                low_passed(frames, window, &[Signal::Altitude], time_s)
            }
            Self::BrakesUntold => replaced(frames, window, BRAKES, Value::Real(0.0)),
            Self::MassUntold => replaced(frames, window, MASS, Value::NotAvailable),
            Self::Slip(part) => scaled(frames, window, DRIVEN, 1.0 + part),
            Self::AntiLock => rewritten(frames, window, |s, signal, value| {
                let (period_s, part, slip) = ANTI_LOCK;
                let locks = s.rem_euclid(period_s) < part * period_s;
                number_of(SPEEDS, signal, value, |mps| {
                    if locks { mps * (1.0 - slip) } else { mps }
                })
            }),
            Self::Silence => lost(frames, window, |_| true),
        }
    }
}

/// Returns what `of` makes of a number, for some signals.
fn number_of(
    signals: &[Signal],
    signal: Signal,
    value: Value,
    of: impl FnOnce(f32) -> f32,
) -> Value {
    match value {
        Value::Real(number) if signals.contains(&signal) => Value::Real(of(number)),
        other => other,
    }
}

fn scaled<'a>(
    frames: Frames<'a>,
    window: Window,
    signals: &'static [Signal],
    factor: f32,
) -> Frames<'a> {
    rewritten(frames, window, move |_, signal, value| {
        number_of(signals, signal, value, |number| number * factor)
    })
}

fn low_passed<'a>(
    frames: Frames<'a>,
    window: Window,
    signals: &'static [Signal],
    time_s: f64,
) -> Frames<'a> {
    let mut filters = BTreeMap::new();
    rewritten(frames, window, move |s, signal, value| {
        number_of(signals, signal, value, |number| {
            let filter = filters
                .entry(signal)
                .or_insert_with(|| LowPass::new(time_s));
            filter.next(s, f64::from(number)) as f32
        })
    })
}
