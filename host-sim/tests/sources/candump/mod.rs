//! candump logs: both layouts, gzip, all errors that a log can have, and writing.

mod damage;
mod foreign;
mod times;

use crate::packed::gzip;
use embedded_can::{ExtendedId, Frame, Id, StandardId};
use estimator_core::Instant;
use host_sim::files::log_format::LogFormat;
use host_sim::source::can_frame::{CanFrame, TimedFrame};
use host_sim::source::candump_writer::write_frame;
use host_sim::source::frame_log::FrameLog;
use host_sim::source::log_kind::{LogKind, kind_of};
use proptest::prelude::*;
use std::path::{Path, PathBuf};
use tempfile::TempDir;

/// A log in its own folder.
struct Log {
    _folder: TempDir,
    path: PathBuf,
}

fn log(name: &str, content: &[u8]) -> Log {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join(name);
    std::fs::write(&path, content).expect("a temporary file");
    Log {
        _folder: folder,
        path,
    }
}

fn read_path(path: &Path) -> Result<Vec<TimedFrame>, String> {
    FrameLog::open_candump(path)
        .and_then(Iterator::collect)
        .map_err(|e| e.to_string())
}

fn read(content: &[u8]) -> Result<Vec<TimedFrame>, String> {
    read_path(&log("drive.log", content).path)
}

/// Returns the message for a bad log, without the folder.
fn error(content: &[u8]) -> String {
    let log = log("drive.log", content);
    let message = read_path(&log.path).expect_err("a bad log is refused");
    let folder = log.path.parent().expect("a folder").display().to_string();
    let (head, tail) = message.split_at(folder.len() + 1);
    assert_eq!(head, format!("{folder}/"), "names the file");
    tail.to_owned()
}

fn extended(micros: u64, id: u32, data: &[u8]) -> TimedFrame {
    TimedFrame {
        time: Instant::from_micros(micros),
        frame: CanFrame::extended(id, data).expect("a frame"),
    }
}

fn standard(micros: u64, id: u16, data: &[u8]) -> TimedFrame {
    TimedFrame {
        time: Instant::from_micros(micros),
        frame: CanFrame::standard(id, data).expect("a frame"),
    }
}

fn remote(micros: u64, id: u16, length: usize) -> TimedFrame {
    let id = StandardId::new(id).expect("an identifier");
    TimedFrame {
        time: Instant::from_micros(micros),
        frame: CanFrame::new_remote(id, length).expect("a frame"),
    }
}

fn four_frames() -> Vec<TimedFrame> {
    vec![
        extended(
            1_000_000,
            0x0CF0_0400,
            &[0x60, 0x7D, 0x84, 0x48, 0x14, 0, 0xF0, 0x84],
        ),
        standard(1_000_250, 0x009, &[0xD9, 0x2B]),
        standard(2_500_000, 0x7FF, &[]),
        remote(2_500_000, 0x123, 4),
    ]
}

const LOG_LAYOUT: &str = "(1.000000) can0 0CF00400#607D84481400F084\n\
    (1.000250) vcan1 009#D92B\n\
    (2.500000) can0 7FF#\n\
    (2.500000) can0 123#R4\n";

const SCREEN_LAYOUT: &str = " (001.000000)  can0  0CF00400   [8]  60 7D 84 48 14 00 F0 84\n \
    (001.000250)  vcan1  009   [2]  D9 2B\n \
    (002.500000)  can0  7FF   [0] \n \
    (002.500000)  can0  123   [4]  remote request\n";

#[test]
fn both_layouts_give_the_same_frames() {
    assert_eq!(read(LOG_LAYOUT.as_bytes()), Ok(four_frames()));
    assert_eq!(read(SCREEN_LAYOUT.as_bytes()), Ok(four_frames()));
}

#[test]
fn options_of_candump_change_nothing() {
    // -x: direction and flags; -a: text; lower case, separators and epoch time.
    let decorated = " (001.000000)  can0  RX - -  0CF00400   [8]  60 7D 84 48 14 00 F0 84   '`}.H....'\n\
        (1.000250) vcan1 009#d92b R\n\
        (2.500000) can0 7FF# T\n\
        (2.500000) can0 123#R4\n";
    assert_eq!(read(decorated.as_bytes()), Ok(four_frames()));
    assert_eq!(
        read(b"(1700000000.123456) can0 123#11.22\n(1700000000.1234569) can0 123#11\n"),
        Ok(vec![
            standard(1_700_000_000_123_456, 0x123, &[0x11, 0x22]),
            standard(1_700_000_000_123_456, 0x123, &[0x11]),
        ])
    );
}

#[test]
fn blank_lines_and_carriage_returns_are_tolerated() {
    let spaced = format!("\r\n\n{}\n  \n", LOG_LAYOUT.replace('\n', "\r\n"));
    assert_eq!(read(spaced.as_bytes()), Ok(four_frames()));
}

#[test]
fn gzip_is_recognised_by_its_content() {
    let packed = gzip(LOG_LAYOUT.as_bytes());
    for name in ["drive.log", "drive.log.gz", "drive"] {
        assert_eq!(read_path(&log(name, &packed).path), Ok(four_frames()));
    }
    // Two members, as `cat a.gz b.gz` or a rotating logger writes them.
    let halves = [
        gzip(&LOG_LAYOUT.as_bytes()[..60]),
        gzip(&LOG_LAYOUT.as_bytes()[60..]),
    ];
    assert_eq!(read(&halves.concat()), Ok(four_frames()));
    // A wrong name.
    assert_eq!(
        read_path(&log("drive.log.gz", LOG_LAYOUT.as_bytes()).path),
        Ok(four_frames())
    );
}

#[test]
fn lines_are_whole_across_the_reader_s_buffer() {
    // More data than the buffer holds. The lengths put the border of the buffer anywhere in a line.
    let frames: Vec<_> = (0..40_000_u64)
        .map(|k| extended(k * 7, 0x18FE_F100, &k.to_le_bytes()[..(k % 9) as usize]))
        .collect();
    let mut text = Vec::new();
    for frame in &frames {
        write_frame(&mut text, frame, "can0").expect("memory");
    }
    assert!(text.len() > 1_000_000);
    assert_eq!(read(&text), Ok(frames));
}

#[test]
fn the_writer_writes_what_candump_does() {
    let mut text = Vec::new();
    for frame in four_frames() {
        write_frame(&mut text, &frame, "can0").expect("memory");
    }
    let text = String::from_utf8(text).expect("text");
    assert_eq!(text, LOG_LAYOUT.replace("vcan1", "can0"));
}

#[test]
fn the_name_determines_the_kind_of_a_log() {
    for (name, kind) in [
        ("a.log", LogKind::Frames(LogFormat::Candump)),
        ("a.log.gz", LogKind::Frames(LogFormat::Candump)),
        ("a", LogKind::Frames(LogFormat::Candump)),
        ("a.csv", LogKind::SignalTable),
        ("a.csv.gz", LogKind::SignalTable),
        ("A.CSV", LogKind::SignalTable),
    ] {
        assert_eq!(
            kind_of(&log(name, b"").path).expect("a file"),
            kind,
            "{name}"
        );
    }
    assert!(kind_of(Path::new("no/such.csv")).is_err());
}

fn any_frame() -> impl Strategy<Value = CanFrame> {
    let id = prop_oneof![
        (0..=0x7FF_u16).prop_map(|raw| Id::from(StandardId::new(raw).unwrap())),
        (0..=0x1FFF_FFFF_u32).prop_map(|raw| Id::from(ExtendedId::new(raw).unwrap())),
    ];
    let data = prop::collection::vec(any::<u8>(), 0..=8);
    (id, data, any::<bool>()).prop_map(|(id, data, is_remote)| {
        if is_remote {
            CanFrame::new_remote(id, data.len()).unwrap()
        } else {
            CanFrame::new(id, &data).unwrap()
        }
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn written_frames_are_read_back(
        start in 0..2_000_000_000_000_000_u64,
        frames in prop::collection::vec((0..5_000_000_u64, any_frame()), 1..50),
    ) {
        let mut micros = start;
        let mut timed = Vec::new();
        for (step, frame) in frames {
            micros += step;
            timed.push(TimedFrame { time: Instant::from_micros(micros), frame });
        }
        let mut text = Vec::new();
        for frame in &timed {
            write_frame(&mut text, frame, "vcan0").unwrap();
        }
        prop_assert_eq!(read(&text), Ok(timed.clone()));
        prop_assert_eq!(read(&gzip(&text)), Ok(timed));
    }

    #[test]
    fn any_text_is_read_or_refused(content in prop::collection::vec(any::<u8>(), 0..400)) {
        let _ = read(&content);
    }

    #[test]
    fn any_line_is_read_or_refused(line in r"\(1\.0{1,9}\) can0 [0-9A-F]{0,9}[#\[ ]{0,3}[0-9A-FR\] ]{0,20}") {
        let _ = read(line.as_bytes());
    }
}

/// Run by hand:
/// `cargo test --release -p host-sim --test sources frames_per_second -- --ignored --nocapture`.
#[test]
#[ignore = "a measurement, not a check"]
fn frames_per_second() {
    const FRAMES: u64 = 5_000_000;
    let mut text = Vec::new();
    let started = std::time::Instant::now();
    for k in 0..FRAMES {
        let frame = extended(
            k * 500,
            0x0CF0_0400,
            &k.wrapping_mul(0x9E37_79B9_7F4A_7C15).to_le_bytes(),
        );
        write_frame(&mut text, &frame, "can0").expect("memory");
    }
    eprintln!(
        "written: {:.1} million frames/s",
        FRAMES as f64 / 1e6 / started.elapsed().as_secs_f64()
    );
    for (name, content) in [("plain", &text), ("gzip", &gzip(&text))] {
        let log = log("long.log", content);
        for _ in 0..3 {
            let started = std::time::Instant::now();
            let mut reader = FrameLog::open_candump(&log.path).expect("a log");
            let mut frames = 0;
            while reader.next_frame().expect("a good log").is_some() {
                frames += 1;
            }
            assert_eq!(frames, FRAMES);
            let seconds = started.elapsed().as_secs_f64();
            eprintln!(
                "{name}: {:.1} million frames/s",
                FRAMES as f64 / 1e6 / seconds
            );
        }
    }
}
