//! Faults of what frames say: sampled, held, coarse, late and wrong signals.

use crate::faults::frames::{lost, pgn};
use crate::faults::signals::{replaced, rewritten};
use crate::faults::{Frames, Window, changed};
use embedded_can::Frame;
use estimator_core::{Signal, Value};
use host_sim::simulator::random::OrnsteinUhlenbeck;
use host_sim::source::can_frame::{CanFrame, TimedFrame};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use std::collections::{BTreeMap, VecDeque};

/// EEC1, with the torque in two signals.
const EEC1: u32 = 61_444;
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
/// Ratio between neighbouring gears.
const GEAR_STEP: f32 = 1.27;
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
    /// The reported gear differs from the engaged one by so many.
    GearOff(i8),
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
            Self::GearOff(off) => rewritten(frames, window, move |_, signal, value| {
                wrong_gear(off, signal, value)
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

fn wrong_gear(off: i8, signal: Signal, value: Value) -> Value {
    match (signal, value) {
        (Signal::CurrentGear | Signal::SelectedGear, Value::Real(gear)) if gear >= 1.0 => {
            Value::Real((gear + f32::from(off)).clamp(1.0, 12.0))
        }
        (Signal::GearRatio, Value::Real(ratio)) => {
            Value::Real(ratio * GEAR_STEP.powi(-i32::from(off)))
        }
        (_, other) => other,
    }
}

/// A filter of first order.
#[derive(Clone, Copy, Debug)]
struct LowPass {
    time_s: f64,
    last: Option<(f64, f64)>,
}

impl LowPass {
    const fn new(time_s: f64) -> Self {
        Self { time_s, last: None }
    }

    fn next(&mut self, at_s: f64, value: f64) -> f64 {
        let filtered = self.last.map_or(value, |(last_s, last)| {
            let part = 1.0 - (-(at_s - last_s).max(0.0) / self.time_s).exp();
            last + part * (value - last)
        });
        self.last = Some((at_s, filtered));
        filtered
    }
}

/// Changes the indicated torque, %, at a time in the window, s; `None` is not available.
fn torque<'a>(
    frames: Frames<'a>,
    window: Window,
    mut of: impl FnMut(f64, f64) -> Option<f64> + 'a,
) -> Frames<'a> {
    let start = window.start;
    changed(frames, window, move |timed| {
        let seconds = timed.time.since(start).micros() as f64 * 1e-6;
        let frame = with_torque(&timed.frame, |percent| of(seconds, percent));
        Some(TimedFrame { frame, ..timed })
    })
}

/// Returns the frame with another torque, if it is EEC1 and has one. SPN 513 is byte 3, in percent
/// from −125 on; SPN 4154 is the upper half of byte 1, in eighths of a percent.
fn with_torque(frame: &CanFrame, of: impl FnOnce(f64) -> Option<f64>) -> CanFrame {
    let mut data = frame.data().to_vec();
    if pgn(frame) != Some(EEC1) || data.len() < 8 || data[2] > 250 {
        return *frame;
    }
    let eighths = Some(data[0] >> 4).filter(|&n| n < 8).unwrap_or(0);
    let percent = f64::from(data[2]) - 125.0 + 0.125 * f64::from(eighths);
    let (whole, eighths) = match of(percent) {
        Some(percent) => {
            let eighths = (8.0 * percent).round().clamp(0.0, 1_000.0) as u16;
            ((eighths / 8) as u8 + 125, (eighths % 8) as u8)
        }
        None => (0xff, 0x0f),
    };
    data[2] = whole;
    data[0] = data[0] & 0x0f | eighths << 4;
    CanFrame::new(frame.id(), &data).unwrap_or(*frame)
}

#[cfg(test)]
mod tests {
    use super::*;
    use estimator_core::Decoder;

    fn eec1(whole: u8, eighths: u8) -> CanFrame {
        let id = 3 << 26 | EEC1 << 8;
        CanFrame::extended(
            id,
            &[eighths << 4 | 2, 0xff, whole + 125, 0, 40, 0xff, 0xff, 0xff],
        )
        .unwrap()
    }

    fn read(frame: &CanFrame) -> (Value, Value) {
        let (mut torque, mut fraction) = (Value::NotAvailable, Value::NotAvailable);
        Decoder::new().decode(frame, |_, _, reading| match reading.signal {
            Signal::EngineTorque => torque = reading.value,
            Signal::EngineTorqueFraction => fraction = reading.value,
            _ => {}
        });
        (torque, fraction)
    }

    #[test]
    fn torque_is_rewritten_in_both_of_its_signals() {
        let changed = with_torque(&eec1(49, 7), |percent| {
            assert_eq!(percent, 49.875);
            Some(percent + 0.5)
        });
        assert_eq!(read(&changed), (Value::Real(50.0), Value::Real(0.375)));
        let none = with_torque(&eec1(49, 7), |_| None);
        assert_eq!(read(&none), (Value::NotAvailable, Value::NotAvailable));
    }

    #[test]
    fn a_low_pass_reaches_63_percent_after_its_time_constant() {
        let mut filter = LowPass::new(2.0);
        assert_eq!(filter.next(0.0, 0.0), 0.0);
        let after: f64 = (1..=20)
            .map(|n| filter.next(0.1 * f64::from(n), 1.0))
            .last()
            .unwrap();
        assert!((after - 0.632).abs() < 1e-3, "{after}");
    }
}
