//! The system clock is set while the listener runs.

use crate::bus::Vcan;
use crate::drive::{VcanDrive, replay};
use crate::listener::Listener;
use estimator_core::Instant;
use host_sim::source::can_frame::TimedFrame;
use host_sim::source::frame_log::FrameLog;
use nix::sys::time::TimeSpec;
use nix::time::{ClockId, clock_settime};
use std::path::Path;
use std::thread;
use std::time::{Duration, SystemTime, UNIX_EPOCH};

/// Steps of the clock, ms; together none. A truck's computer starts in 1970 and gets the time from
/// its receiver.
const STEPS_MS: [i64; 7] = [
    3_600_000,
    -7_200_000,
    3_600_000,
    500,
    -500,
    -1_500_000_000_000,
    1_500_000_000_000,
];

/// Largest shift of a time stamp beyond the lateness of the replay, ms. Below the smallest step.
const ALLOWED_MS: f64 = 200.0;

/// Moves the system clock.
fn step_by(millis: i64) {
    let now = SystemTime::now().duration_since(UNIX_EPOCH).unwrap();
    let set = now.as_nanos() as i64 + millis * 1_000_000;
    let set = Duration::from_nanos(u64::try_from(set).unwrap());
    clock_settime(ClockId::CLOCK_REALTIME, TimeSpec::from_duration(set)).unwrap();
}

/// Only the virtual machine has a clock that may be set.
#[test]
#[ignore = "sets the clock: tests/run vcan"]
fn steps_of_the_system_clock_do_not_reach_the_estimate() {
    if std::env::var_os("CLOCK_MAY_BE_SET").is_none() {
        println!("SKIPPED steps of the system clock: not in a virtual machine");
        return;
    }
    let vcan = Vcan::new("rgclock");
    let drive = VcanDrive::new("A", 800.0);
    let options = ["--out", "live.csv", "--log", "output.log"];
    let listener = Listener::start(&drive, &[vcan.0], &options);
    let replayed = thread::scope(|scope| {
        let sending = scope.spawn(|| replay(vcan.0, &drive.log(), &["--speed", "1"]));
        for step in STEPS_MS {
            thread::sleep(Duration::from_secs(3));
            step_by(step);
        }
        sending.join().unwrap()
    });
    listener.signal("INT");
    let output = listener.finish();
    assert_eq!(
        output.event(0, "clock_set"),
        STEPS_MS.len() as u64,
        "{:?}",
        output.said
    );
    assert_eq!(output.lost(0), 0);
    assert_eq!(output.frames(0), drive.frames.len() as u64);
    // In the order of time, since the reader of the log refuses any other.
    assert_eq!(
        drive.estimate(&drive.file("output.log")),
        drive.read("live.csv")
    );
    // The replay itself is late where the machine is busy; this is no step of the clock.
    let late_ms = replayed["latest_ms"].as_f64().unwrap();
    let off_ms = largest_shift_ms(&drive.frames, &drive.file("output.log"));
    println!("time stamps off by {off_ms:.1} ms at most, the replay by {late_ms:.1} ms");
    assert!(off_ms < late_ms + ALLOWED_MS, "{off_ms} ms");
}

/// Returns the largest difference between the times of the recorded log and those of the drive,
/// each counted from the first frame, ms.
fn largest_shift_ms(drive: &[TimedFrame], recorded: &Path) -> f64 {
    let recorded: Vec<_> = FrameLog::open_candump(recorded)
        .unwrap()
        .map(|timed| timed.unwrap().time)
        .collect();
    let shifts = recorded.iter().zip(drive).map(|(time, sent)| {
        let since = |time: Instant, first: Instant| time.since(first).as_secs_f64();
        (since(*time, recorded[0]) - since(sent.time, drive[0].time)).abs()
    });
    1e3 * shifts.fold(0.0, f64::max)
}
