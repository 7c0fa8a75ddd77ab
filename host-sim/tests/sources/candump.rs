//! candump logs: both layouts, gzip, all errors that a log can have, and writing.

use embedded_can::{ExtendedId, Frame, Id, StandardId};
use estimator_core::Instant;
use flate2::{Compression, write::GzEncoder};
use host_sim::source::can_frame::{CanFrame, TimedFrame};
use host_sim::source::candump_writer::write_frame;
use host_sim::source::damage::Damage;
use host_sim::source::frame_log::{FrameLog, Skipped};
use host_sim::source::log_kind::{LogKind, kind_of};
use proptest::prelude::*;
use std::io::Write;
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

fn gzip(content: &[u8]) -> Vec<u8> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::default());
    encoder.write_all(content).expect("memory");
    encoder.finish().expect("memory")
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
fn fd_frames_and_bus_errors_are_left_out_and_counted() {
    let mixed = log(
        "drive.log",
        b"(1.0) can0 123##500112233445566778899AABB\n\
          (1.1) can0 20000004#0000000000000000\n\
          (1.2) can0 123#01\n\
          (001.300000)  can0  123  [08]  00 01 02 03 04 05 06 07\n\
          (001.400000)  can0  20000088   [8]  00 00 80 19 00 00 00 00   ERRORFRAME\n",
    );
    let mut reader = FrameLog::open_candump(&mixed.path).expect("a log");
    let frames: Vec<_> = reader.by_ref().map(Result::unwrap).collect();
    assert_eq!(frames, [standard(1_200_000, 0x123, &[1])]);
    let expected = Skipped {
        can_fd: 2,
        bus_errors: 2,
    };
    assert_eq!(reader.skipped(), expected);

    let none = error(b"(1.0) can0 123##500\n");
    assert!(
        none.contains("no classic CAN frame among 1 CAN FD frames"),
        "{none}"
    );
}

#[test]
fn a_log_without_frames_is_refused() {
    for content in [&b""[..], b"\n\r\n   \n", &gzip(b"")] {
        let message = error(content);
        assert!(
            message.contains("the file is empty; expected a candump log"),
            "{message}"
        );
    }
    let message = read_path(Path::new("no/such.log")).expect_err("no file");
    assert!(message.starts_with("no/such.log: "), "{message}");
    let folder = tempfile::tempdir().expect("a temporary folder");
    let message = read_path(folder.path()).expect_err("a folder is no log");
    assert!(
        message.contains("is a folder; expected a file"),
        "{message}"
    );
}

#[test]
fn wrong_lines_are_named_with_what_was_expected() {
    for (line, what) in [
        ("hello world", "no time in brackets"),
        (
            "can0  0CF00400   [8]  01 02 03 04 05 06 07 08",
            "no time in brackets",
        ),
        ("(2024-13-01 12:00:00.000000) can0 123#01", "no time"),
        ("(1) can0 123#01", "no time"),
        ("(99999999999999999999.000000) can0 123#01", "no time"),
        ("(1.500000)", "no frame behind the time"),
        ("(1.500000) can0", "no frame behind the time"),
        ("(1.500000) can0 12#01", "no CAN identifier"),
        ("(1.500000) can0 800#01", "no CAN identifier"),
        ("(1.500000) can0 C0000000#01", "no CAN identifier"),
        ("(1.500000) can0 123", "no frame data"),
        ("(1.500000) can0 123#0", "no frame data"),
        ("(1.500000) can0 123#0x", "no frame data"),
        ("(1.500000) can0 123#010203040506070809", "too many bytes"),
        ("(1.500000) can0 123#R9", "unknown text behind the frame"),
        ("(1.500000) can0 123   [9]  01", "no frame data"),
        (
            "(1.500000) can0 123   [3]  01 02",
            "fewer data than the length",
        ),
        ("(1.500000) can0 123   [1]  0102", "no frame data"),
    ] {
        let message = error(format!("(1.000000) can0 123#01\n\n{line}\n").as_bytes());
        assert!(
            message.starts_with(&format!("drive.log:3: {what}")),
            "{line}: {message}"
        );
        assert!(message.contains("; expected "), "{message}");
    }
}

#[test]
fn binary_data_are_refused_without_filling_the_screen() {
    let noise: Vec<u8> = (0..100_000_u32)
        .map(|k| (k.wrapping_mul(2_654_435_761) >> 24) as u8)
        .collect();
    for content in [noise, vec![0; 1_000_000]] {
        let message = error(&content);
        assert!(message.starts_with("drive.log:1: "), "{message}");
        assert!(message.len() < 600, "{} bytes", message.len());
        assert!(message.is_ascii() || message.contains('…'), "{message}");
    }
    let message = error(b"(1.000000) can0 123#01\n\x00\x01\x02\n");
    assert!(message.starts_with("drive.log:2: binary data"), "{message}");
}

/// Reads a log with what was left out.
fn read_damaged(content: &[u8]) -> (Vec<TimedFrame>, Damage) {
    let log = log("drive.log", content);
    let mut reader = FrameLog::open_candump(&log.path).expect("a log");
    let frames = reader.by_ref().map(Result::unwrap).collect();
    (frames, reader.damage().clone())
}

#[test]
fn a_log_that_is_cut_off_is_used_up_to_where_data_could_be_missing() {
    let whole = format!("{LOG_LAYOUT}(3.000000) can0 0CF00401#0102030405060708\n");
    let start = LOG_LAYOUT.len();
    for cut in start + 1..whole.len() - 1 {
        let (frames, damage) = read_damaged(&whole.as_bytes()[..cut]);
        assert_eq!(frames, four_frames(), "{cut}");
        assert!(damage.cut_off && damage.lines == 0, "{cut}");
        let told = &damage.first[0];
        let words = "drive.log:5: the log is cut off within its last line";
        assert!(told.contains(words), "{cut}: {told}");
    }
    // All eight bytes are there: only the line feed is missing.
    let (frames, damage) = read_damaged(&whole.as_bytes()[..whole.len() - 1]);
    assert!(frames.len() == 5 && damage.is_none());
    // The screen layout contains the number of bytes of a frame.
    let screen = SCREEN_LAYOUT.trim_end();
    assert_eq!(read(screen.as_bytes()), Ok(four_frames()));
    let cut = b" (001.000000)  can0  123   [1]  01\n (001.000250)  can0  009   [2]  D9 ";
    let (frames, damage) = read_damaged(cut);
    assert_eq!(frames, [standard(1_000_000, 0x123, &[1])]);
    assert!(damage.cut_off);
    // Blocks of the disk that were never written.
    let unwritten = [LOG_LAYOUT.as_bytes(), &[0; 1_000_000]].concat();
    let (frames, damage) = read_damaged(&unwritten);
    assert_eq!(frames, four_frames());
    assert!(damage.cut_off);
}

#[test]
fn gzip_data_that_are_cut_off_are_used_up_to_there_and_a_wrong_checksum_is_told() {
    let text: String = (0..5_000)
        .map(|k| {
            format!(
                "({k}.000000) can0 123#{:08X}\n",
                k * 2_654_435_761_u64 % (1 << 32)
            )
        })
        .collect();
    let packed = gzip(text.as_bytes());
    for cut in [3, 12] {
        let message = error(&packed[..cut]);
        assert!(message.contains("the gzip data are cut off"), "{message}");
        assert!(
            message.ends_with("expected a complete gzip file"),
            "{message}"
        );
    }
    for (cut, least) in [(packed.len() / 2, 2000), (packed.len() - 1, 5000)] {
        let (frames, damage) = read_damaged(&packed[..cut]);
        assert!(frames.len() >= least, "{}", frames.len());
        assert!(damage.cut_off);
    }
    let (frames, damage) = read_damaged(&[&packed[..], &[0; 512]].concat());
    assert_eq!((frames.len(), damage.cut_off), (5000, true));
    let mut damaged = packed.clone();
    let checksum = damaged.len() - 8;
    damaged[checksum] ^= 1;
    let (frames, damage) = read_damaged(&damaged);
    assert_eq!(
        (frames.len(), damage.blocks, damage.cut_off),
        (5000, 1, false)
    );
    let told = &damage.first[0];
    assert!(
        told.contains("the gzip data are damaged at byte "),
        "{told}"
    );
}

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
        error(b"(1.000000) can0 123#01\n(12.345678) can0 123#01\n(12.245677) can1 1AB#01\n");
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
        ("a.log", LogKind::Candump),
        ("a.log.gz", LogKind::Candump),
        ("a", LogKind::Candump),
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
