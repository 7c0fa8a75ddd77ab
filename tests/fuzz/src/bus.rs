//! Bus traffic made of arbitrary bytes: noise, known messages with any content, and drives that
//! bring the filter into states in which a fault can do harm.

use arbitrary::Arbitrary;
use embedded_can::{ExtendedId, Frame, StandardId};
use estimator_core::signal::{encode, messages};
use estimator_core::{Instant, Signal, Value};
use host_sim::source::can_frame::{CanFrame, TimedFrame};

/// An event on a bus.
#[derive(Arbitrary, Debug)]
pub enum Event {
    /// Any frame.
    Frame {
        id: u32,
        extended: bool,
        remote: bool,
        length: u8,
        data: [u8; 8],
    },
    /// A message that the estimator knows, with any content.
    Message {
        which: u8,
        source: u8,
        sequence: u8,
        data: [u8; 16],
    },
    /// A part of a fast packet.
    Part {
        which: u8,
        source: u8,
        head: u8,
        length: u8,
        data: [u8; 7],
    },
    /// Seconds of driving at a speed, in cm/s, with the other signals of that time.
    Drive {
        seconds: u8,
        speed_cmps: u16,
        torque_percent: i8,
        gear: i8,
        climb_cmps: i16,
        braking: bool,
        shifting: bool,
        gnss: bool,
    },
    /// One signal with any value.
    Signal { which: u8, value: f32, source: u8 },
    /// Moves the time forward or back.
    Wait { millis: i32 },
}

/// Longest drive of one event, s.
const LONGEST_DRIVE_S: u8 = 40;
const EEC1: u32 = 61_444;
const ETC1: u32 = 61_442;
const ETC2: u32 = 61_445;
const CCVS1: u32 = 65_265;
const GNSS_POSITION: u32 = 129_029;

/// The time and the position, which events change.
#[derive(Debug)]
pub struct EventBus {
    micros: i64,
    altitude_m: f32,
    sequence: u8,
}

impl Default for EventBus {
    fn default() -> Self {
        Self {
            micros: 1_000_000,
            altitude_m: 100.0,
            sequence: 0,
        }
    }
}

impl EventBus {
    /// Hands the frames of an event to `sink`.
    pub fn play(&mut self, event: &Event, sink: &mut impl FnMut(&TimedFrame)) {
        match *event {
            Event::Frame {
                id,
                extended,
                remote,
                length,
                data,
            } => {
                if let Some(frame) = any_frame(id, extended, remote, length, &data) {
                    self.send(frame, sink);
                }
            }
            Event::Message {
                which,
                source,
                sequence,
                data,
            } => {
                let Some(message) = nth_message(which) else {
                    return;
                };
                let mut payload = [0xff; 64];
                for (byte, arbitrary) in payload.iter_mut().zip(data.iter().cycle()) {
                    *byte = *arbitrary;
                }
                let length = message.length().min(payload.len());
                self.sequence = sequence;
                self.message(message.pgn(), source, &payload[..length], sink);
            }
            Event::Part {
                which,
                source,
                head,
                length,
                data,
            } => {
                let Some(message) = nth_message(which) else {
                    return;
                };
                let mut bytes = [head; 8];
                bytes[1..].copy_from_slice(&data);
                let bytes = &bytes[..usize::from(length % 9)];
                if let Some(frame) = CanFrame::extended(id(message.pgn(), source), bytes) {
                    self.send(frame, sink);
                }
            }
            Event::Drive {
                seconds,
                speed_cmps,
                torque_percent,
                gear,
                climb_cmps,
                braking,
                shifting,
                gnss,
            } => {
                for tenth in 0..10 * u32::from(seconds.min(LONGEST_DRIVE_S)) {
                    self.micros += 100_000;
                    self.altitude_m += f32::from(climb_cmps) * 1e-3;
                    let altitude_m = self.altitude_m;
                    let value_of = |signal| match signal {
                        Signal::WheelSpeed => Value::Real(f32::from(speed_cmps) * 0.01),
                        Signal::EngineTorque => Value::Real(f32::from(torque_percent)),
                        Signal::EngineTorqueFraction => Value::Real(0.0),
                        Signal::EngineSpeed => Value::Real(1_200.0),
                        Signal::CurrentGear => Value::Real(f32::from(gear)),
                        Signal::DrivelineEngaged => Value::Real(f32::from(u8::from(!shifting))),
                        Signal::ShiftInProcess => Value::Real(f32::from(u8::from(shifting))),
                        Signal::BrakeSwitch => Value::Real(f32::from(u8::from(braking))),
                        Signal::Latitude => Value::DegreesE7(580_000_000),
                        Signal::Longitude => Value::DegreesE7(150_000_000 + tenth as i32 * 40),
                        Signal::Altitude => Value::Real(altitude_m),
                        Signal::FixMethod => Value::Real(1.0),
                        Signal::Satellites => Value::Real(9.0),
                        Signal::Hdop | Signal::Vdop => Value::Real(1.0),
                        _ => Value::NotAvailable,
                    };
                    for pgn in [EEC1, ETC1, ETC2, CCVS1] {
                        self.encoded(pgn, 0, &value_of, sink);
                    }
                    if gnss && tenth % 5 == 0 {
                        self.encoded(GNSS_POSITION, 1, &value_of, sink);
                    }
                }
            }
            Event::Signal {
                which,
                value,
                source,
            } => {
                let all = Signal::ALL;
                let Some(reported) = all.get(usize::from(which) % all.len()) else {
                    return;
                };
                let value_of = |signal| {
                    if signal == *reported {
                        Value::Real(value)
                    } else {
                        Value::NotAvailable
                    }
                };
                let carrier = messages().find(|message| message.signals().any(|s| s == *reported));
                if let Some(message) = carrier {
                    self.encoded(message.pgn(), source, &value_of, sink);
                }
            }
            Event::Wait { millis } => {
                self.micros = (self.micros + 1_000 * i64::from(millis)).max(0)
            }
        }
    }

    fn encoded(
        &mut self,
        pgn: u32,
        source: u8,
        value_of: &impl Fn(Signal) -> Value,
        sink: &mut impl FnMut(&TimedFrame),
    ) {
        let mut payload = [0; 64];
        if let Some(length) = encode(pgn, &mut payload, value_of) {
            self.message(pgn, source, &payload[..length], sink);
        }
    }

    /// Sends a message as one frame, or as the parts of a fast packet.
    fn message(
        &mut self,
        pgn: u32,
        source: u8,
        payload: &[u8],
        sink: &mut impl FnMut(&TimedFrame),
    ) {
        if payload.len() > 8 {
            self.sequence = self.sequence.wrapping_add(1) % 8;
        }
        for frame in CanFrame::carrying(id(pgn, source), self.sequence, payload) {
            self.send(frame, sink);
        }
    }

    fn send(&mut self, frame: CanFrame, sink: &mut impl FnMut(&TimedFrame)) {
        self.micros += 250;
        let time = Instant::from_micros(self.micros as u64);
        sink(&TimedFrame { time, frame });
    }
}

fn nth_message(which: u8) -> Option<estimator_core::signal::MessageInfo> {
    messages().nth(usize::from(which) % messages().count())
}

fn id(pgn: u32, source: u8) -> u32 {
    6 << 26 | pgn << 8 | u32::from(source)
}

fn any_frame(
    id: u32,
    extended: bool,
    remote: bool,
    length: u8,
    data: &[u8; 8],
) -> Option<CanFrame> {
    let length = usize::from(length % 9);
    let id = if extended {
        embedded_can::Id::Extended(ExtendedId::new(id & ExtendedId::MAX.as_raw())?)
    } else {
        embedded_can::Id::Standard(StandardId::new(id as u16 & StandardId::MAX.as_raw())?)
    };
    if remote {
        CanFrame::new_remote(id, length)
    } else {
        CanFrame::new(id, &data[..length])
    }
}
