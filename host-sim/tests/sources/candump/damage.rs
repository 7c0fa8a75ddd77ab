//! Logs that are damaged or wrong.

use super::{LOG_LAYOUT, SCREEN_LAYOUT, error, four_frames, log, read, read_path, standard};
use crate::packed::gzip;
use host_sim::source::can_frame::TimedFrame;
use host_sim::source::damage::Damage;
use host_sim::source::frame_log::{FrameLog, Skipped};
use std::path::Path;

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
        ..Skipped::default()
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
        ("(1.500000) can0 123   [2]  01020304", "no frame data"),
        ("(1.500000) can0 123   [2]  00000001 01", "fewer data than"),
        ("123#01", "no time in brackets"),
        ("01 02 03", "no time in brackets"),
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
        let words = "drive.log: unknown format, begins with `";
        assert!(message.starts_with(words), "{message}");
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
