//! The system clock is set while the listener runs.

use crate::bus::Vcan;
use crate::drive::{VcanDrive, replay};
use crate::listener::Listener;
use host_sim::files::run;
use nix::sys::time::TimeSpec;
use nix::time::{ClockId, clock_settime};
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
    thread::scope(|scope| {
        let sending = scope.spawn(|| replay(vcan.0, &drive.log(), &["--speed", "1"]));
        for step in STEPS_MS {
            thread::sleep(Duration::from_secs(3));
            step_by(step);
        }
        sending.join().unwrap();
    });
    listener.signal("INT");
    let output = listener.finish();
    let steps = STEPS_MS.len();
    assert_eq!(
        output.event(0, "clock_set"),
        steps as u64,
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
    drive.estimate(&drive.log());
    let read = |name: &str| run::read(&drive.file(name)).unwrap();
    let (live, alone) = (read("live.csv"), read("estimated.csv"));
    assert!(live.len().abs_diff(alone.len()) <= 2);
    let off = live.iter().zip(&alone).map(|(live, alone)| {
        (live.grade_percent - alone.grade_percent).abs() / alone.grade_sigma_percent
    });
    let worst = off.fold(0.0, f64::max);
    println!("{steps} steps of the clock: cells off by {worst:.3} sigma at most");
    assert!(worst < 1.0, "{worst} sigma");
}
