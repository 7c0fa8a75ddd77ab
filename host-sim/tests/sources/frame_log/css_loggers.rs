//! Tables of the loggers of CSS Electronics: CANedge, CL1000 to CL3000.

use super::{frame, read, read_as, some_frames};
use crate::packed::gzip;
use embedded_can::{Frame, Id};
use estimator_core::Instant;
use host_sim::files::log_format::LogFormat;
use host_sim::source::can_frame::TimedFrame;
use host_sim::source::frame_log::Skipped;
use host_sim::source::log::Log;
use host_sim::source::log_kind::LogKind;
use host_sim::source::read_options::ReadOptions;
use std::fmt::Write;
use std::fs;
use tempfile::TempDir;

/// 2026-11-22T10:00:00Z.
const START_S: u64 = 1_795_341_600;
const CANEDGE: &str =
    "TimestampEpoch;BusChannel;ID;IDE;DLC;DataLength;Dir;EDL;BRS;ESI;RTR;DataBytes\n";
const CLX: &str = "# Logger type: CL2000\n# Time: 20261122T100000\n# Value separator: \";\"\n\
    # Time format: 4\n# Time and date separator: \"T\"\nTimestamp;Type;ID;Data\n";

fn digits(data: &[u8]) -> String {
    data.iter().map(|byte| format!("{byte:02X}")).collect()
}

fn canedge(frames: &[TimedFrame]) -> String {
    let mut text = CANEDGE.to_owned();
    for TimedFrame { time, frame } in frames {
        let (id, ide) = match frame.id() {
            Id::Standard(id) => (id.as_raw().into(), 0),
            Id::Extended(id) => (id.as_raw(), 1),
        };
        let micros = time.micros();
        let (seconds, fraction) = (micros / 1_000_000, micros % 1_000_000);
        let (dlc, data) = (frame.dlc(), frame.data());
        let remote = u8::from(frame.is_remote_frame());
        writeln!(
            text,
            "{seconds}.{fraction:06};1;{id:X};{ide};{dlc};{};0;0;0;0;{remote};{}",
            data.len(),
            digits(data)
        )
        .unwrap();
    }
    text
}

/// Returns a frame with 29 bits at a time after the start.
fn at(ms: u64, k: u8) -> TimedFrame {
    frame(1000 * START_S + ms, 0x0CF0_0400, &[k; 8])
}

fn clx(stamps: &[&str]) -> String {
    let mut text = CLX.to_owned();
    for (k, stamp) in stamps.iter().enumerate() {
        writeln!(text, "{stamp};1;cf00400;{}", digits(&[k as u8; 8])).unwrap();
    }
    text
}

fn times_of(stamps: &[&str]) -> Vec<i64> {
    let text = &clx(stamps).replace("# Time format: 4\n", "");
    let (kind, frames, _) = read(text.as_bytes()).expect(text);
    assert_eq!(kind, LogKind::Frames(LogFormat::Clx), "{text}");
    let first = frames[0].time.micros() as i64;
    let times = frames.iter().map(|timed| timed.time.micros() as i64);
    times.map(|time| (time - first) / 1000).collect()
}

#[test]
fn a_table_of_a_canedge_has_the_frames() {
    let mut frames = some_frames();
    for timed in &mut frames {
        let micros = timed.time.micros() + 1_000_000 * START_S;
        timed.time = Instant::from_micros(micros);
    }
    let text = canedge(&frames);
    let expected = Ok((
        LogKind::Frames(LogFormat::CanEdge),
        frames.clone(),
        Skipped::default(),
    ));
    for name in ["drive", "drive.csv", "drive.txt"] {
        assert_eq!(read_as(name, text.as_bytes()), expected);
    }
    assert_eq!(read(&gzip(text.as_bytes())), expected);
    for text in [
        text.replace(';', ","),
        text.replace(';', "\t"),
        text.replace('\n', "\r\n"),
        format!("# a comment\n\n{text}"),
        // A file behind another one has its header.
        format!("{CANEDGE}{text}"),
    ] {
        assert_eq!(read(text.as_bytes()), expected, "{text}");
    }
}

#[test]
fn rows_of_can_fd_are_counted_and_damaged_ones_left_out() {
    let frames: Vec<TimedFrame> = (0..200).map(|k| at(10 * k, k as u8)).collect();
    let text = canedge(&frames)
        + "1795341609.0;1;CF00400;1;8;8;0;1;0;0;0;0102030405060708\n\
           1795341609.1;1;CF00400;1;9;12;0;1;1;0;0;010203040506070801020304\n\
           1795341609.2;1;CF00400;1;8;8;0;0;0;0;0;01020304050607\n";
    let (_, found, skipped) = read(text.as_bytes()).expect("a log");
    let expected = Skipped {
        can_fd: 2,
        ..Skipped::default()
    };
    assert_eq!((found, skipped), (frames, expected));
    let only = CANEDGE.to_owned() + "1795341609.0;1;CF00400;1;8;8;0;1;0;0;0;0102030405060708\n";
    let message = read(only.as_bytes()).expect_err("no classic frame");
    assert!(message.contains("J1939-22, is not read"), "{message}");
    let lin = "TimestampEpoch;BusChannel;ID;DataLength;Dir;DataBytes\n1795341609.5;1;1F;2;0;1234\n";
    let message = read_as("drive.csv", lin.as_bytes()).expect_err("LIN");
    assert!(
        message.starts_with("drive.csv:1: a table of frames of LIN"),
        "{message}"
    );
}

#[test]
fn channels_and_the_start_are_those_of_the_table() {
    let text = CANEDGE.to_owned()
        + "1795341600.5;2;CF00400;1;1;1;0;0;0;0;0;01\n1795341600.6;1;123;0;1;1;0;0;0;0;0;02\n";
    let folder = TempDir::new().expect("a temporary folder");
    let path = folder.path().join("drive");
    fs::write(&path, text).expect("a temporary file");
    let mut log = Log::open(&path, &ReadOptions::default()).expect("a log");
    let Log::Frames(reader) = &mut log else {
        panic!("no frames");
    };
    while reader.next_frame().expect("a log").is_some() {}
    let report = log.report();
    let names: Vec<&str> = report.interfaces.iter().map(|count| &*count.name).collect();
    assert_eq!(names, ["can1", "can0"]);
    assert_eq!(
        report.start_utc.as_deref(),
        Some("2026-11-22T10:00:00.500Z")
    );
}

#[test]
fn a_log_of_a_clx_has_the_frames() {
    let text = clx(&["22T100000001", "22T100001500", "22T100059999"])
        + "22T100100000;8;7df;02010d5555555555\n22T100100001;0;7e8;\n";
    for text in [
        &text,
        &text.replace(';', ","),
        &text.replace("# Logger", "#Logger"),
    ] {
        for content in [text.as_bytes(), &gzip(text.as_bytes())] {
            let (kind, frames, skipped) = read_as("00000001.txt", content).expect(text);
            assert_eq!(
                (kind, skipped),
                (LogKind::Frames(LogFormat::Clx), Skipped::default())
            );
            assert_eq!(frames[..3], [at(1, 0), at(1500, 1), at(59_999, 2)]);
            assert!(!frames[3].frame.is_extended() && frames[3].frame.data().len() == 8);
            assert!(frames[4].frame.data().is_empty());
        }
    }
    let with_all = "Timestamp;Lost;Type;ID;Length;Data\n22T100000001;0;1;cf00400;2;0102\n\
        22T100000002;0;1;cf00400;3;0102\n";
    let message = read(with_all.as_bytes()).expect_err("one of two rows is damaged");
    assert!(message.contains("no data in `22T100000002"), "{message}");
}

#[test]
fn stamps_of_every_format_go_on_over_their_ends() {
    for (stamps, expected) in [
        (
            &["30T235959500", "01T000000500", "01T000001500"][..],
            &[0, 1000, 2000][..],
        ),
        (&["235959500", "000000500"], &[0, 1000]),
        (&["23:59:59.500", "00:00:00.500"], &[0, 1000]),
        (&["5959500", "0000500", "0001000"], &[0, 1000, 1500]),
        (&["59500", "00500", "01000"], &[0, 1000, 1500]),
        (&["1231T235959500", "0101T000000500"], &[0, 1000]),
        (&["20261231T235959500", "20270101T000000500"], &[0, 1000]),
        (&["1795341600.500", "1795341601.250"], &[0, 750]),
        (&["1795341600500", "1795341601250"], &[0, 750]),
        // Two processors.
        (&["000000050", "235959990", "000000200"], &[0, 60, 210]),
    ] {
        assert_eq!(times_of(stamps), expected, "{stamps:?}");
    }
    let message = read(clx(&["22T10000", "22T100000"]).as_bytes()).expect_err("no stamps");
    assert!(message.contains("no time in `22T10000;"), "{message}");
}
