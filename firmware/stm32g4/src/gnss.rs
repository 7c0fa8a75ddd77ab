//! A GNSS receiver with NMEA 0183 on a serial line.

use crate::inbox::{InboxItem, InboxSender};
use embassy_stm32::mode::Async;
use embassy_stm32::usart::UartRx;
use embassy_time::Instant as Clock;
use estimator_core::{Instant, Reading, Signal, Value};
use heapless::Vec;
use nmea::ParseResult;
use nmea::sentences::rmc::RmcStatusOfFix;
use nmea::sentences::{FixType, GgaData, RmcData};
use static_cell::StaticCell;

/// Longest sentence (IEC 61162-1), with a margin for receivers that exceed it.
const LONGEST: usize = 120;
const MPS_PER_KNOT: f32 = 1852.0 / 3600.0;

/// Size of the receive buffer, bytes: a quarter of a second at 9600 baud.
const AHEAD: usize = 256;

/// Puts the readings of the sentences into the inbox, forever.
#[embassy_executor::task]
pub async fn receive(line: UartRx<'static, Async>, inbox: &'static InboxSender) {
    static RING: StaticCell<[u8; AHEAD]> = StaticCell::new();
    let mut line = line.into_ring_buffered(RING.init([0; AHEAD]));
    let mut sentence: Vec<u8, LONGEST> = Vec::new();
    let mut bytes = [0; 32];
    loop {
        // After an error of the line reading goes on: a garbled sentence fails its checksum.
        let count = line.read(&mut bytes).await.unwrap_or(0);
        for &byte in bytes.iter().take(count) {
            if byte == b'\n' {
                let now = Instant::from_micros(Clock::now().as_micros());
                if let Ok(text) = core::str::from_utf8(&sentence) {
                    put(text.trim_end(), now, inbox);
                }
                sentence.clear();
            } else if sentence.push(byte).is_err() {
                sentence.clear();
            }
        }
    }
}

fn put(sentence: &str, now: Instant, inbox: &InboxSender) {
    let put = |signal, value| inbox.put(InboxItem::Reading(now, Reading { signal, value }));
    match nmea::parse_str(sentence) {
        Ok(ParseResult::GGA(fix)) => position(&fix, put),
        Ok(ParseResult::RMC(motion)) => motion_of(&motion, put),
        _ => {}
    }
}

/// Puts the readings of a fix in the order of [`Signal`]: the altitude completes the fix.
fn position(fix: &GgaData, put: impl Fn(Signal, Value)) {
    let method = match fix.fix_type {
        None | Some(FixType::Invalid | FixType::Manual | FixType::Simulation) => 0.0,
        Some(FixType::Gps | FixType::Pps) => 1.0,
        Some(FixType::DGps) => 2.0,
        Some(FixType::Rtk) => 4.0,
        Some(FixType::FloatRtk) => 5.0,
        Some(FixType::Estimated) => 6.0,
    };
    put(Signal::FixMethod, Value::Real(method));
    let real = |value: Option<f32>| value.map_or(Value::NotAvailable, Value::Real);
    put(
        Signal::Satellites,
        real(fix.fix_satellites.map(|count| count as f32)),
    );
    put(Signal::Hdop, real(fix.hdop));
    let degrees = |value: Option<f64>| {
        value.map_or(Value::NotAvailable, |degrees| {
            Value::DegreesE7((degrees * 1e7) as i32)
        })
    };
    put(Signal::Latitude, degrees(fix.latitude));
    put(Signal::Longitude, degrees(fix.longitude));
    put(Signal::Altitude, real(fix.altitude));
}

fn motion_of(motion: &RmcData, put: impl Fn(Signal, Value)) {
    if motion.status_of_fix == RmcStatusOfFix::Invalid {
        return;
    }
    let real = |value: Option<f32>| value.map_or(Value::NotAvailable, Value::Real);
    put(Signal::Course, real(motion.true_course));
    let speed_mps = motion.speed_over_ground.map(|knots| knots * MPS_PER_KNOT);
    put(Signal::GnssSpeed, real(speed_mps));
}
