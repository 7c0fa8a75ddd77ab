//! Time stamps of logs.

use super::{error, read, standard};
use host_sim::source::can_frame::TimedFrame;

#[test]
fn a_log_whose_clock_begins_again_is_told_to_be_cut() {
    let drive: String = (0..500)
        .map(|k| format!("({k}.000000) can0 123#01\n"))
        .collect();
    let message = error(format!("{drive}{drive}").as_bytes());
    assert!(
        message.starts_with("drive.log:501: time runs backwards, from 499.000000 s to 0.000000 s"),
        "{message}"
    );
    assert!(
        message.contains("cut the log into one for each drive"),
        "{message}"
    );
}

#[test]
fn time_that_runs_backwards_is_refused_with_both_times() {
    let message =
        error(b"(1.000000) can0 123#01\n(12.345678) can0 123#01\n(12.245677) can0 123#01\n");
    assert!(
        message.starts_with(
            "drive.log:3: time runs backwards, from 12.345678 s to 12.245677 s; expected"
        ),
        "{message}"
    );
}

#[test]
fn frames_that_two_processors_swapped_are_put_in_order() {
    let swapped = b"(1.000000) can0 123#01\n(1.000050) can0 123#02\n(1.000049) can1 124#03\n\
        (0.900050) can1 124#04\n(1.000050) can0 123#05\n(5.0) can0 123#06\n";
    let frames = [
        standard(900_050, 0x124, &[4]),
        standard(1_000_000, 0x123, &[1]),
        standard(1_000_049, 0x124, &[3]),
        standard(1_000_050, 0x123, &[2]),
        standard(1_000_050, 0x123, &[5]),
        standard(5_000_000, 0x123, &[6]),
    ];
    assert_eq!(read(swapped), Ok(frames.to_vec()));
}

#[test]
fn every_kind_of_time_stamp_is_understood() {
    // Differences of time, of irregular and of equal frames; a date; from zero.
    let times = |times: [&str; 6]| {
        let lines = times.map(|time| format!(" ({time})  can0  123   [1]  01\n"));
        let frames = read(lines.concat().as_bytes()).expect("a log");
        let start = frames[0].time;
        let micros = |timed: &TimedFrame| timed.time.since(start).micros();
        frames.iter().map(micros).collect::<Vec<u64>>()
    };
    let irregular = [
        "000.000000",
        "000.010000",
        "000.000500",
        "000.004500",
        "000.000500",
        "001.000000",
    ];
    assert_eq!(
        times(irregular),
        [0, 10_000, 10_500, 15_000, 15_500, 1_015_500]
    );
    let equal = [
        "000.000000",
        "000.010000",
        "000.010000",
        "000.010000",
        "000.010000",
        "000.010000",
    ];
    assert_eq!(times(equal), [0, 10_000, 20_000, 30_000, 40_000, 50_000]);
    let zero = [
        "000.000000",
        "000.010000",
        "000.020000",
        "000.020000",
        "000.040000",
        "000.050000",
    ];
    assert_eq!(times(zero), [0, 10_000, 20_000, 20_000, 40_000, 50_000]);
    let frames = read(b" (2026-11-22 10:00:00.250000)  can0  123   [1]  01\n").expect("a log");
    assert_eq!(frames, [standard(1_795_341_600_250_000, 0x123, &[1])]);
}
