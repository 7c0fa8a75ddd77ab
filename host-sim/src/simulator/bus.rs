//! The bus: each message at its own rate from its own controller, one frame at a time.

use super::broadcasts::Broadcasts;
use super::gnss::GnssReceiver;
use super::inertial::InertialSensors;
use super::random::{Purpose, stream};
use super::scenario::Scenario;
use super::sensors::Sensors;
use crate::source::can_frame::{CanFrame, TimedFrame};
use embedded_can::Frame;
use estimator_core::signal::{encode, messages};
use estimator_core::{Instant, Value};
use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use std::collections::VecDeque;

/// Source addresses: preferred addresses of SAE J1939; the receiver claims its own.
const ENGINE: u8 = 0x00;
const GEARBOX: u8 = 0x03;
const BRAKES: u8 = 0x0b;
const RETARDER: u8 = 0x10;
const CAB: u8 = 0x21;
const RECEIVER: u8 = 0x1c;

/// Silence before the first message, s. The slowest sensor then has a value.
const SILENCE_S: f64 = 0.5;
/// Largest deviation from the period, as a fraction of it and in s.
const JITTER: (f64, f64) = (0.02, 0.0005);
/// Longest payload of a message.
const PAYLOAD: usize = 64;
/// Number of bits of a frame with a 29-bit identifier, without its data, and of a data byte. Both
/// include bit stuffing; the first includes the interframe space.
const FRAME_BITS: (f64, f64) = (75.0, 9.0);
/// Duration of a bit at 250 kbit/s, s.
const BIT_S: f64 = 4e-6;

/// Schedule of a message of one controller.
#[derive(Clone, Copy, Debug)]
struct MessageSchedule {
    pgn: u32,
    address: u8,
    priority: u8,
    period_s: f64,
    /// Without jitter.
    next_s: f64,
    /// With jitter.
    due_s: f64,
    /// Number of the next fast packet, modulo 8.
    sequence: u8,
}

/// The traffic of one run, in order of time.
#[derive(Debug)]
pub struct BusTraffic<'a> {
    sensors: Sensors<'a>,
    inertial: InertialSensors<'a>,
    gnss: GnssReceiver<'a>,
    gnss_latency_s: f64,
    senders: Vec<MessageSchedule>,
    broadcasts: Broadcasts,
    log_start_s: f64,
    end_s: f64,
    /// Time at which the bus is free again, s.
    free_s: f64,
    waiting: VecDeque<TimedFrame>,
    rng: ChaCha8Rng,
}

impl<'a> BusTraffic<'a> {
    /// Creates the traffic of run `index`.
    pub fn new(
        scenario: &Scenario,
        index: usize,
        sensors: Sensors<'a>,
        inertial: InertialSensors<'a>,
        gnss: GnssReceiver<'a>,
        end_s: f64,
    ) -> Self {
        let mut rng = stream(scenario.seed, index, Purpose::Bus);
        let of_inertial = inertial.messages();
        let of_inertial = of_inertial.map(|(pgn, period_ms)| (pgn, BRAKES, period_ms));
        let senders = periods_ms(scenario.rates.fast_ms)
            .into_iter()
            .chain(of_inertial)
            .map(|(pgn, address, period_ms)| {
                let period_s = 1e-3 * period_ms;
                // Otherwise rare messages would be missing in the first seconds of the log.
                let phase_s = rng.random_range(0.0..period_s.min(1.0));
                MessageSchedule {
                    pgn,
                    address,
                    priority: messages()
                        .find(|message| message.pgn() == pgn)
                        .map_or(6, |message| message.priority()),
                    period_s,
                    next_s: SILENCE_S + phase_s,
                    due_s: SILENCE_S + phase_s,
                    sequence: 0,
                }
            })
            .collect();
        Self {
            sensors,
            inertial,
            gnss,
            gnss_latency_s: 1e-3 * scenario.latency_ms.gnss,
            senders,
            broadcasts: Broadcasts::new(scenario, index, ENGINE, RETARDER),
            log_start_s: scenario.runs[index].start_time_s,
            end_s,
            free_s: 0.0,
            waiting: VecDeque::new(),
            rng,
        }
    }

    /// Sends the message that is due first. Returns false if the drive is over.
    fn send(&mut self) -> bool {
        let Some(sender) = self
            .senders
            .iter_mut()
            .min_by(|a, b| a.due_s.total_cmp(&b.due_s))
        else {
            return false;
        };
        let MessageSchedule {
            pgn,
            address,
            priority,
            due_s,
            sequence,
            ..
        } = *sender;
        if due_s > self.end_s {
            return false;
        }
        let duration_s = (FRAME_BITS.0 + 8.0 * FRAME_BITS.1) * BIT_S;
        if let Some((start_s, frame)) = self.broadcasts.next(self.free_s, duration_s, due_s) {
            self.transmit(start_s, frame);
            return true;
        }
        let jitter_s = (JITTER.0 * sender.period_s).min(JITTER.1);
        sender.next_s += sender.period_s;
        sender.due_s = sender.next_s + self.rng.random_range(-jitter_s..=jitter_s);
        sender.sequence = (sequence + 1) % 8;

        let mut payload = [0; PAYLOAD];
        let length = if address == RECEIVER {
            let fix = self.gnss.fix(due_s - self.gnss_latency_s);
            encode(pgn, &mut payload, |signal| fix.value(signal))
        } else {
            encode(pgn, &mut payload, |signal| {
                match self.inertial.value(pgn, signal, due_s) {
                    Some(number) => Value::Real(number),
                    None => self.sensors.value(signal, due_s),
                }
            })
        };
        let payload = &payload[..length.unwrap_or(0)];
        let id = u32::from(priority) << 26 | pgn << 8 | u32::from(address);
        for frame in CanFrame::carrying(id, sequence, payload) {
            self.transmit(due_s, frame);
        }
        true
    }

    /// Sends a frame as soon as the bus is free; it is received after its last bit.
    fn transmit(&mut self, due_s: f64, frame: CanFrame) {
        let bits = FRAME_BITS.0 + FRAME_BITS.1 * frame.dlc() as f64;
        self.free_s = self.free_s.max(due_s) + bits * BIT_S;
        let micros = ((self.log_start_s + self.free_s) * 1e6).round() as u64;
        self.waiting.push_back(TimedFrame {
            time: Instant::from_micros(micros),
            frame,
        });
    }
}

impl Iterator for BusTraffic<'_> {
    type Item = TimedFrame;

    fn next(&mut self) -> Option<TimedFrame> {
        while self.waiting.is_empty() && self.send() {}
        self.waiting.pop_front()
    }
}

/// Returns PGN, source address and period in ms of every message (SAE J1939-71, NMEA 2000).
fn periods_ms(fast_ms: f64) -> [(u32, u8, f64); 16] {
    [
        (61_444, ENGINE, 10.0),
        (65_247, ENGINE, 250.0),
        (65_265, ENGINE, 100.0),
        (65_269, ENGINE, 1000.0),
        (65_213, ENGINE, 1000.0),
        (61_442, GEARBOX, fast_ms),
        (61_445, GEARBOX, 100.0),
        (61_440, RETARDER, 100.0),
        (61_441, BRAKES, 100.0),
        (65_215, BRAKES, 100.0),
        (61_449, BRAKES, fast_ms),
        (65_136, CAB, 10_000.0),
        (129_025, RECEIVER, 100.0),
        (129_026, RECEIVER, 250.0),
        (129_029, RECEIVER, 1000.0),
        (129_539, RECEIVER, 1000.0),
    ]
}
