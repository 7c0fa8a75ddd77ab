//! A full bus, and more frames than the listener reads.

use crate::bus::Vcan;
use crate::drive::{VcanDrive, frames_of, replay, write_log};
use crate::listener::Listener;
use estimator_core::signal;
use estimator_core::signal::Pgn;
use host_sim::files::run;
use host_sim::source::can_frame::{CanFrame, TRANSPORT_DATA, TRANSPORT_MANAGEMENT, TimedFrame};
use host_sim::source::socketcan::{FrameSender, accepts, wanted};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::thread;
use std::time::{Duration, Instant as Monotonic};

/// Largest rate of frames with 29-bit identifier and eight bytes on a bus of 500 kbit/s: 131 bits
/// each with the gap after it, without stuff bits.
const FULL_LOAD_HZ: u64 = 3_817;
const SECONDS: u64 = 10;
/// Speed of the slower sections of a simulated drive, m/s.
const SLOW_MPS: f64 = 20.0;

/// Returns a drive with other traffic that fills the bus for some seconds. Half of that traffic is
/// messages that the estimator reads, from another address.
fn full_bus(drive: &VcanDrive, seconds: u64) -> impl Iterator<Item = TimedFrame> {
    let mut random = ChaCha8Rng::seed_from_u64(5);
    let pgns: Vec<u32> = signal::messages().map(|message| message.pgn()).collect();
    let start = drive.frames[0].time;
    let end = start + estimator_core::Duration::from_micros(seconds * 1_000_000);
    let mut own = drive
        .frames
        .iter()
        .filter(move |frame| frame.time < end)
        .peekable();
    (0..seconds * FULL_LOAD_HZ).map(move |slot| {
        let time = start + estimator_core::Duration::from_micros(slot * 1_000_000 / FULL_LOAD_HZ);
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
}

fn is_wanted(frame: &CanFrame) -> bool {
    let embedded_can::Id::Extended(id) = embedded_can::Frame::id(frame) else {
        return false;
    };
    let pgn = Pgn::from_raw(id.as_raw()).number;
    let is_packet = [TRANSPORT_MANAGEMENT, TRANSPORT_DATA].contains(&pgn);
    is_packet || signal::messages().any(|message| message.pgn() == pgn)
}

#[test]
#[ignore = "needs a CAN interface: tests/run vcan"]
fn a_full_bus_is_read_without_a_lost_frame() {
    let vcan = Vcan::new("rgload");
    let drive = VcanDrive::new("A", 300.0);
    let traffic: Vec<TimedFrame> = full_bus(&drive, SECONDS).collect();
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

/// What was sent.
#[derive(Default)]
struct Sent {
    frames: u64,
    wanted: u64,
    latest: Duration,
}

/// Sends frames at their times. Frames that are due are sent at once: no thread wakes up for each.
fn send_in_time(vcan: &Vcan, frames: impl Iterator<Item = TimedFrame>) -> Sent {
    const LEAST_WAIT: Duration = Duration::from_millis(1);
    let sender = FrameSender::open(vcan.0, &[]).unwrap();
    let mut frames = frames.peekable();
    let first = frames.peek().expect("a frame").time;
    let begun = Monotonic::now();
    let mut sent = Sent::default();
    for TimedFrame { time, frame } in frames {
        let due = begun + Duration::from_micros(time.since(first).micros());
        let now = Monotonic::now();
        if due > now + LEAST_WAIT {
            thread::sleep(due - now);
        }
        sent.latest = sent.latest.max(now.saturating_duration_since(due));
        sender.send(&frame).unwrap();
        sent.frames += 1;
        sent.wanted += u64::from(is_wanted(&frame));
    }
    sent
}

/// Fills the bus for `BUS_MINUTES` minutes, and does nothing without that variable. The cells are told,
/// not judged: the other traffic has messages that the truck does not send, such as its mass, and
/// nobody contradicts them.
#[test]
#[ignore = "takes an hour: tests/run long_bus"]
fn a_bus_at_full_load_for_minutes() {
    let Ok(minutes) = std::env::var("BUS_MINUTES") else {
        return;
    };
    let seconds = 60 * minutes.parse::<u64>().expect("BUS_MINUTES: a number");
    let vcan = Vcan::new("rghour");
    let drive = VcanDrive::new("A", SLOW_MPS * seconds as f64);
    let listener = Listener::start(&drive, &[vcan.0], &["--out", "live.csv"]);
    let sent = send_in_time(&vcan, full_bus(&drive, seconds));
    listener.signal("INT");
    let output = listener.finish();
    drive.estimate(&drive.log());
    let read = |name: &str| run::read(&drive.file(name)).unwrap();
    let (live, alone) = (read("live.csv"), read("estimated.csv"));
    let off = live.iter().zip(&alone).map(|(live, alone)| {
        (live.grade_percent - alone.grade_percent).abs() / alone.grade_sigma_percent
    });
    println!(
        "full load: {minutes} min, {} frames, {} wanted, {} lost, {} dropped before the socket, \
         {} cells of {}, {:.3} sigma off at most, sent {:.1} ms late at most",
        sent.frames,
        sent.wanted,
        output.lost(0),
        vcan.rx_dropped(),
        live.len(),
        alone.len(),
        off.fold(0.0, f64::max),
        1e3 * sent.latest.as_secs_f64(),
    );
    assert_eq!(output.lost(0), 0);
    assert_eq!(output.frames(0), sent.wanted);
    // The drive may end some seconds after the load.
    assert!(live.len() + 100 > alone.len());
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
    for frame in full_bus(&drive, SECONDS).map(|timed| timed.frame) {
        let embedded_can::Id::Extended(id) = embedded_can::Frame::id(&frame) else {
            panic!("all are extended");
        };
        let word = 0x8000_0000 | id.as_raw();
        assert_eq!(accepts(&filters, word), is_wanted(&frame), "{word:08x}");
    }
}
