//! A node that floods the bus.

use crate::bus::{PATIENCE, Vcan};
use crate::drive::{VcanDrive, replay};
use crate::listener::Listener;
use host_sim::source::can_frame::CanFrame;
use host_sim::source::socketcan::FrameSender;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::thread;
use std::time::Duration;

/// The outcome of a drive beside a babbling node.
struct Babbled {
    /// Number of frames that the node sent.
    sent: u64,
    /// Number of these frames that the listener read.
    read: u64,
    /// Number of values that the estimator refused because another address sends them, with the
    /// node and without it.
    refused: [u64; 2],
}

const REFUSED: &str = "values of other senders";
/// Each second takes 10 s of the drive: a listener on a slow machine loses nothing.
const FASTER: [&str; 3] = ["--log-time", "--speed", "10"];
/// Frames of the drive before the node fails: each of its messages has come.
const BEFORE: usize = 1_000;

/// Listens to a drive beside a node that sends `frame` again and again, `burst` times a
/// millisecond. Checks that the cells are those from the file.
fn beside(name: &'static str, frame: CanFrame, burst: usize) -> Babbled {
    let vcan = Vcan::new(name);
    let drive = VcanDrive::new("A", 500.0);
    let options = ["--log-time", "--out", "live.csv"];
    let undisturbed = Listener::start(&drive, &[vcan.0], &options);
    replay(vcan.0, &drive.log(), &FASTER);
    let undisturbed = undisturbed.finish();
    assert_eq!(undisturbed.lost(0), 0);
    let from_file = drive.estimate(&drive.log());
    let is_over = AtomicBool::new(false);
    let sent = AtomicU64::new(0);
    let node = FrameSender::open(name, &[(0, 0)]).unwrap();
    let output = thread::scope(|scope| {
        let listener = Listener::start(&drive, &[vcan.0], &options);
        scope.spawn(|| {
            // The senders of the drive come first, as on a truck on which a node fails later.
            for _ in 0..BEFORE {
                node.receive(PATIENCE)
                    .unwrap()
                    .expect("a frame of the drive");
            }
            while !is_over.load(Ordering::Relaxed) {
                for _ in 0..burst {
                    node.send(&frame).unwrap();
                    sent.fetch_add(1, Ordering::Relaxed);
                }
                thread::sleep(Duration::from_millis(1));
            }
        });
        replay(vcan.0, &drive.log(), &FASTER);
        is_over.store(true, Ordering::Relaxed);
        listener.finish()
    });
    assert_eq!(output.lost(0), 0);
    assert_eq!(drive.read("live.csv"), from_file);
    let babbled = Babbled {
        sent: sent.into_inner(),
        read: output.frames(0) - drive.frames.len() as u64,
        refused: [output.counted(REFUSED), undisturbed.counted(REFUSED)],
    };
    let Babbled {
        sent,
        read,
        refused,
    } = &babbled;
    println!("{sent} frames of the babbling node, {read} read, {refused:?} values refused");
    babbled
}

#[test]
#[ignore = "needs a CAN interface: tests/run vcan"]
fn the_kernel_filters_out_unwanted_frames() {
    // The highest priority, as fast as the interface accepts it.
    let frame = CanFrame::extended(0, &[0; 8]).unwrap();
    let babbled = beside("rgbabble", frame, 200);
    assert!(babbled.sent > 1_000);
    assert_eq!(babbled.read, 0);
}

#[test]
#[ignore = "needs a CAN interface: tests/run vcan"]
fn a_wanted_message_from_a_wrong_address_is_refused() {
    // EEC1 with full torque at 2,000 rpm, from the address of a trailer.
    let frame = CanFrame::extended(0x0CF0_04C8, &[0, 225, 225, 0x80, 0x3e, 0, 0, 225]).unwrap();
    let babbled = beside("rgliar", frame, 3);
    assert!(babbled.read > 100);
    let [with, without] = babbled.refused;
    // Torque, its fraction and engine speed.
    assert_eq!(with - without, 3 * babbled.read);
}
