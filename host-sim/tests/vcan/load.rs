//! A full bus, and more frames than the listener reads.

use crate::bus::Vcan;
use crate::drive::{VcanDrive, frames_of, replay, write_log};
use crate::listener::Listener;
use estimator_core::signal;
use estimator_core::signal::Pgn;
use host_sim::source::can_frame::{CanFrame, TimedFrame};
use host_sim::source::socketcan::{FrameSender, accepts, wanted};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::thread;
use std::time::Duration;

/// Largest rate of frames with 29-bit identifier and eight bytes on a bus of 500 kbit/s: 131 bits
/// each with the gap after it, without stuff bits.
const FULL_LOAD_HZ: u64 = 3_817;
const SECONDS: u64 = 10;

/// Returns a drive with other traffic that fills the bus. Half of that traffic is messages that the
/// estimator reads, from another address.
fn full_bus(drive: &VcanDrive) -> Vec<TimedFrame> {
    let mut random = ChaCha8Rng::seed_from_u64(5);
    let pgns: Vec<u32> = signal::messages().map(|message| message.pgn()).collect();
    let start = drive.frames[0].time;
    let end = start + estimator_core::Duration::from_micros(SECONDS * 1_000_000);
    let mut own = drive
        .frames
        .iter()
        .filter(|frame| frame.time < end)
        .peekable();
    (0..SECONDS * FULL_LOAD_HZ)
        .map(|slot| {
            let time =
                start + estimator_core::Duration::from_micros(slot * 1_000_000 / FULL_LOAD_HZ);
            if let Some(frame) = own.next_if(|frame| frame.time <= time) {
                return TimedFrame { time, ..*frame };
            }
            let pgn = if random.random_bool(0.5) {
                pgns[random.random_range(0..pgns.len())]
            } else {
                random.random_range(0xf000..0xff00)
            };
            let id = random.random_range(0_u32..8) << 26 | pgn << 8 | 0x7d;
            let frame = CanFrame::extended(id, &random.random::<[u8; 8]>()).unwrap();
            TimedFrame { time, frame }
        })
        .collect()
}

fn is_wanted(frame: &CanFrame) -> bool {
    let embedded_can::Id::Extended(id) = embedded_can::Frame::id(frame) else {
        return false;
    };
    let pgn = Pgn::from_raw(id.as_raw()).number;
    signal::messages().any(|message| message.pgn() == pgn)
}

#[test]
#[ignore = "needs a CAN interface: tests/run vcan"]
fn a_full_bus_is_read_without_a_lost_frame() {
    let vcan = Vcan::new("rgload");
    let drive = VcanDrive::new("A", 300.0);
    let traffic = full_bus(&drive);
    write_log(&drive.file("full.log"), &traffic);
    let listener = Listener::start(&drive, &[vcan.0], &["--log", "output.log"]);
    let sent = replay(vcan.0, &drive.file("full.log"), &["--speed", "1"]);
    listener.signal("INT");
    let output = listener.finish();
    let expected: Vec<CanFrame> = traffic
        .iter()
        .map(|timed| timed.frame)
        .filter(is_wanted)
        .collect();
    assert!(expected.len() > traffic.len() / 2 && expected.len() < traffic.len());
    assert_eq!(output.lost(0), 0);
    assert_eq!(output.frames(0), expected.len() as u64);
    assert!(
        frames_of(&drive.file("output.log")) == expected,
        "other frames, or another order"
    );
    println!(
        "{} frames at {:.0} frames/s, {} of them wanted, none lost",
        traffic.len(),
        sent["frames_per_s"].as_f64().unwrap(),
        expected.len()
    );
}

#[test]
#[ignore = "needs a CAN interface: tests/run vcan"]
fn frames_that_the_kernel_drops_are_counted() {
    let vcan = Vcan::new("rgdrop");
    let drive = VcanDrive::new("A", 300.0);
    let listener = Listener::start(&drive, &[vcan.0], &["--end-after-silence", "3"]);
    // The stopped listener does not read, so the receive buffer fills.
    listener.signal("STOP");
    let sender = FrameSender::open(vcan.0, &[]).unwrap();
    let wheel_speed = CanFrame::extended(0x18FE_F100, &[0xff; 8]).unwrap();
    const SENT: u64 = 100_000;
    for _ in 0..SENT {
        sender.send(&wheel_speed).unwrap();
    }
    // Longer than the silence that ends the drive. Frames in the buffer are read nevertheless.
    thread::sleep(Duration::from_secs(4));
    listener.signal("CONT");
    let output = listener.finish();
    assert!(output.lost(0) > 0);
    // A busy kernel drops frames before they reach a socket. Only the interface counts these.
    let before_sockets = vcan.rx_dropped();
    assert_eq!(output.frames(0) + output.lost(0) + before_sockets, SENT);
    println!(
        "{} frames waited, {} were dropped and counted, {before_sockets} never reached the socket",
        output.frames(0),
        output.lost(0)
    );
}

#[test]
fn filters_pass_what_the_decoder_reads_and_nothing_else() {
    let filters = wanted();
    let drive = VcanDrive::new("A", 300.0);
    for frame in full_bus(&drive).iter().map(|timed| timed.frame) {
        let embedded_can::Id::Extended(id) = embedded_can::Frame::id(&frame) else {
            panic!("all are extended");
        };
        let word = 0x8000_0000 | id.as_raw();
        assert_eq!(accepts(&filters, word), is_wanted(&frame), "{word:08x}");
    }
}
