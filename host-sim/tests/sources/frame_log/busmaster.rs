//! The text of BUSMASTER.

use super::{frame, read, read_as, some_frames};
use crate::packed::gzip;
use embedded_can::{Frame, Id};
use host_sim::files::log_format::LogFormat;
use host_sim::source::can_frame::{CanFrame, TimedFrame};
use host_sim::source::frame_log::Skipped;
use host_sim::source::log::Log;
use host_sim::source::log_kind::LogKind;
use host_sim::source::read_options::ReadOptions;
use std::fmt::Write;
use std::fs;
use tempfile::TempDir;

const ID: u32 = 0x0CF0_0400;

fn header(protocol: &str, base: &str, mode: &str) -> String {
    format!(
        "***BUSMASTER Ver 3.2.2***\n***PROTOCOL {protocol}***\n***NOTE: PLEASE DO NOT EDIT THIS \
         DOCUMENT***\n***[START LOGGING SESSION]***\n***START DATE AND TIME 22:11:2026 10:0:0:5***\n\
         ***{base}***\n***{mode} MODE***\n***START CHANNEL BAUD RATE***\n***CHANNEL 1 - 250000 \
         bps***\n***END CHANNEL BAUD RATE***\n***START DATABASE FILES (DBF/DBC)***\n***END OF DATABASE \
         FILES (DBF/DBC)***\n***<Time><Tx/Rx><Channel><CAN ID><Type><DLC><DataBytes>***\n"
    )
}

const FOOTER: &str = "***END DATE AND TIME 22:11:2026 11:0:1:42***\n***[STOP LOGGING SESSION]***\n";

fn stamp(ms: u64) -> String {
    let (seconds, ms) = (ms / 1000, ms % 1000);
    format!(
        "{:02}:{:02}:{:02}:{:04}",
        seconds / 3600,
        seconds / 60 % 60,
        seconds % 60,
        10 * ms
    )
}

/// Returns a log of frames; in `SYSTEM` mode, their times are those of the day.
fn log(frames: &[TimedFrame], base: &str, mode: &str) -> String {
    let mut text = header("CAN", base, mode);
    let mut last = 0;
    for TimedFrame { time, frame } in frames {
        let ms = time.micros() / 1000;
        let shown = if mode == "RELATIVE" { ms - last } else { ms };
        last = ms;
        let (id, mark) = match frame.id() {
            Id::Standard(id) => (id.as_raw().into(), 's'),
            Id::Extended(id) => (id.as_raw(), 'x'),
        };
        let id = if base == "DEC" {
            format!("{id}")
        } else {
            format!("0x{id:03X}")
        };
        let remote = if frame.is_remote_frame() { "r" } else { "" };
        let bytes = frame.data().iter().map(|byte| {
            if base == "DEC" {
                format!(" {byte:03}")
            } else {
                format!(" {byte:02X}")
            }
        });
        let (shown, bytes) = (stamp(shown), bytes.collect::<String>());
        let length = frame.dlc();
        writeln!(text, "{shown} Rx 1 {id} {mark}{remote} {length}{bytes}").unwrap();
    }
    text + FOOTER
}

fn times_and_start(text: &str) -> (Vec<u64>, Option<String>) {
    let folder = TempDir::new().expect("a temporary folder");
    let path = folder.path().join("drive");
    fs::write(&path, text).expect("a temporary file");
    let mut log = Log::open(&path, &ReadOptions::default()).expect(text);
    let Log::Frames(reader) = &mut log else {
        panic!("{text}");
    };
    let times: Vec<u64> = reader
        .by_ref()
        .map(|timed| timed.expect(text).time.micros())
        .collect();
    let first = times[0];
    let times = times
        .into_iter()
        .map(|time| (time - first) / 1000)
        .collect();
    (times, log.report().start_utc)
}

#[test]
fn every_mode_gives_the_same_frames() {
    let frames = some_frames();
    for base in ["HEX", "DEC"] {
        for mode in ["SYSTEM", "ABSOLUTE", "RELATIVE"] {
            let text = log(&frames, base, mode);
            for content in [
                text.as_bytes().to_vec(),
                gzip(text.as_bytes()),
                text.replace('\n', "\r\n").into_bytes(),
                format!("// a comment\n{text}").into_bytes(),
            ] {
                for name in ["drive", "drive.log", "drive.csv"] {
                    let (kind, found, skipped) = read_as(name, &content).expect("a log");
                    assert_eq!(
                        (kind, skipped),
                        (LogKind::Frames(LogFormat::Busmaster), Skipped::default())
                    );
                    let of = |frames: &[TimedFrame]| -> Vec<(u64, CanFrame)> {
                        let first = frames[0].time.micros();
                        let apart = |timed: &TimedFrame| timed.time.micros() - first;
                        frames
                            .iter()
                            .map(|timed| (apart(timed), timed.frame))
                            .collect()
                    };
                    assert_eq!(of(&found), of(&frames), "{base} {mode}");
                }
            }
        }
    }
}

#[test]
fn the_start_is_the_date_of_the_header() {
    let line = |ms: u64| format!("{} Rx 1 0x0CF00400 x 1 00\n", stamp(ms));
    let ten = 36_000_000;
    for (mode, ms, start) in [
        ("SYSTEM", ten + 500, "2026-11-22T10:00:00.500Z"),
        ("ABSOLUTE", 500, "2026-11-22T10:00:00.505Z"),
        ("RELATIVE", 500, "2026-11-22T10:00:00.505Z"),
    ] {
        let text = header("CAN", "HEX", mode) + &line(ms);
        assert_eq!(
            times_and_start(&text),
            (vec![0], Some(start.to_owned())),
            "{mode}"
        );
    }
    // Midnight, of a clock that begins again and of one that counts on.
    for after in [400, 86_400_400] {
        let text = header("CAN", "HEX", "SYSTEM") + &line(86_399_900) + &line(after);
        assert_eq!(times_and_start(&text).0, [0, 500]);
    }
    // Another day behind it.
    let next = header("CAN", "HEX", "SYSTEM").replace("22:11:2026", "23:11:2026");
    let text = header("CAN", "HEX", "SYSTEM") + &line(ten) + FOOTER + &next + &line(ten);
    assert_eq!(times_and_start(&text).0, [0, 86_400_000]);
    // Without a date, times are those of the day.
    let text = header("CAN", "HEX", "SYSTEM").replace("22:11:2026 10:0:0:5", "") + &line(ten);
    assert_eq!(times_and_start(&text), (vec![0], None));
}

#[test]
fn what_is_not_a_classic_frame_is_counted() {
    let frames: Vec<TimedFrame> = (0..200)
        .map(|k| frame(36_000_000 + k, ID, &[k as u8; 8]))
        .collect();
    let text = log(&frames, "HEX", "SYSTEM")
        + "10:00:09:0000 Rx 1 0x0CF00400 x-fd 8 01 02 03 04 05 06 07 08\n\
           10:00:09:0000 Rx 1 0x0CF00400 x 12 01 02 03 04 05 06 07 08 09 0A 0B 0C\n\
           10:00:09:0000 Rx 1 0x000 ERR Stuff Error - 1\n\
           10:00:09:0000 Rx 1 0x0CF00400 x 8 01 02 03\n";
    let (_, found, skipped) = read(text.as_bytes()).expect("a log");
    let expected = Skipped {
        can_fd: 2,
        bus_errors: 1,
        ..Skipped::default()
    };
    assert_eq!((found.len(), skipped), (200, expected));
    let only = header("CAN", "HEX", "SYSTEM") + "10:00:09:0000 Rx 1 0x0CF00400 x-fd 1 01\n";
    let message = read(only.as_bytes()).expect_err("no classic frame");
    assert!(message.contains("J1939-22, is not read"), "{message}");
    let lin = header("LIN", "HEX", "SYSTEM") + "10:00:09:0000 Rx 1 0x0CF00400 x 1 01\n";
    let message = read(lin.as_bytes()).expect_err("LIN");
    assert!(
        message.starts_with("drive:2: a protocol that is not read"),
        "{message}"
    );
}

#[test]
fn lines_of_j1939_are_frames() {
    let head = header("J1939", "HEX", "SYSTEM");
    let bytes: Vec<u8> = (1..=10).collect();
    let whole = "10:00:01:0000 1 0x18FEEC00 0x00FEEC BROADCAST 00 FF 6 Rx 10 01 02 03 04 05 06 07 08 09 0A\n";
    let single = "10:00:02:0000 1 0x0CF00400 0x00F004 NONE 00 FF 3 Rx 8 00 01 02 03 04 05 06 07\n";
    let (_, found, _) = read((head.clone() + whole + single).as_bytes()).expect("a log");
    let mut expected: Vec<CanFrame> = CanFrame::broadcast(65_260, 0, &bytes).collect();
    expected.extend(CanFrame::extended(ID, &[0, 1, 2, 3, 4, 5, 6, 7]));
    let frames: Vec<CanFrame> = found.iter().map(|timed| timed.frame).collect();
    assert_eq!(frames, expected);
    // Where its frames are in the log, the message is not there twice.
    let part = "10:00:00:5000 1 0x18EBFF00 0x00EB00 TPDT 00 FF 6 Rx 8 01 01 02 03 04 05 06 07\n";
    let (_, found, _) = read((head + part + whole + single).as_bytes()).expect("a log");
    assert_eq!(found.len(), 2);
}
