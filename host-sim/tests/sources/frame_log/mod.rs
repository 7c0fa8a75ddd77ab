//! Logs in the formats of Vector and PEAK: the same frames as candump's, and all that is not a frame.

mod busmaster;
mod captures;
mod css_loggers;
mod damage;
mod foreign;
mod formats;
mod interfaces;
mod left_out;
mod mdf_layouts;
mod n2k_text;
mod packed_damage;
mod times;
mod writers;

use crate::packed::gzip;
use embedded_can::{Frame, StandardId};
use estimator_core::Instant;
use host_sim::files::log_format::LogFormat;
use host_sim::source::can_frame::{CanFrame, TimedFrame};
use host_sim::source::frame_log::{FrameLog, Skipped};
use host_sim::source::log::Log;
use host_sim::source::log_kind::LogKind;
use host_sim::source::read_options::ReadOptions;
use std::fs;
use std::path::Path;
use tempfile::TempDir;
use test_kit::command::program;
use writers::{FORMATS, asc_header, blf, blf_object, blf_objects, blf_time, candump, trc_header};

/// What a log contains, or the message about it without its folder.
type Content = Result<(LogKind, Vec<TimedFrame>, Skipped), String>;

fn read_as(name: &str, content: &[u8]) -> Content {
    let folder = TempDir::new().expect("a temporary folder");
    let path = folder.path().join(name);
    fs::write(&path, content).expect("a temporary file");
    read_path(&path).map_err(|message| {
        let start = format!("{}/", folder.path().display());
        let words = message.strip_prefix(&start);
        words.expect("the name of the file").to_owned()
    })
}

fn read_path(path: &Path) -> Content {
    let log = Log::open(path, &ReadOptions::default()).map_err(|e| e.to_string())?;
    let kind = log.kind();
    let Log::Frames(mut log) = log else {
        return Ok((kind, Vec::new(), Skipped::default()));
    };
    let mut frames = Vec::new();
    while let Some(frame) = log.next_frame().map_err(|e| e.to_string())? {
        frames.push(frame);
    }
    Ok((kind, frames, log.skipped()))
}

fn read(content: &[u8]) -> Content {
    read_as("drive", content)
}

fn kind_of_format(name: &str) -> LogKind {
    match &name[..3] {
        "asc" => LogKind::Frames(LogFormat::Asc),
        "trc" => LogKind::Frames(LogFormat::Trc),
        _ => LogKind::Frames(LogFormat::Blf),
    }
}

fn frame(ms: u64, id: u32, data: &[u8]) -> TimedFrame {
    TimedFrame {
        time: Instant::from_micros(1000 * ms),
        frame: CanFrame::extended(id, data).expect("a frame"),
    }
}

/// Frames of both kinds of identifier, of every length, and a remote one.
fn some_frames() -> Vec<TimedFrame> {
    let data = [0x60, 0x7D, 0x84, 0xFF, 0x14, 0, 0xF0, 0x0A];
    let mut frames: Vec<TimedFrame> = (0..=8)
        .map(|k| frame(1 + 7 * k as u64, 0x0CF0_0400 + k as u32, &data[..k]))
        .collect();
    let id = StandardId::new(0x123).expect("an identifier");
    frames.push(TimedFrame {
        time: Instant::from_micros(70_000),
        frame: CanFrame::new(id, &[0x11, 0x22]).expect("a frame"),
    });
    frames.push(TimedFrame {
        time: Instant::from_micros(70_000),
        frame: CanFrame::new_remote(id, 4).expect("a frame"),
    });
    frames.push(frame(3_600_000, 0x18FE_F100, &data));
    frames
}

#[test]
fn every_format_gives_the_same_frames_whatever_its_name() {
    let frames = some_frames();
    for (name, write) in FORMATS {
        let content = write(&frames);
        let expected = Ok((kind_of_format(name), frames.clone(), Skipped::default()));
        for file in ["drive", "drive.log", "drive.csv", "drive.gz"] {
            assert_eq!(read_as(file, &content), expected, "{name} as {file}");
            assert_eq!(read_as(file, &gzip(&content)), expected, "{name} in gzip");
        }
        // A byte order mark and the line ends of Windows.
        if kind_of_format(name) != LogKind::Frames(LogFormat::Blf) {
            let text = String::from_utf8(content).expect("text");
            let text = format!("\u{feff}{}", text.replace('\n', "\r\n"));
            assert_eq!(read(text.as_bytes()), expected, "{name} of Windows");
        }
    }
    let marked = [b"\xef\xbb\xbf", &candump(&frames)[..]].concat();
    let expected = Ok((
        LogKind::Frames(LogFormat::Candump),
        frames,
        Skipped::default(),
    ));
    assert_eq!(read(&marked), expected);
}

#[test]
fn logs_longer_than_all_buffers_are_read() {
    let frames: Vec<_> = (0..8_000_u64)
        .map(|k| {
            let noise = k.wrapping_mul(0x9E37_79B9_7F4A_7C15).to_le_bytes();
            frame(k, 0x18FE_F100, &noise)
        })
        .collect();
    for (name, write) in FORMATS {
        let (_, found, _) = read(&gzip(&write(&frames))).expect(name);
        assert!(found == frames, "{name}");
    }
}

#[test]
fn what_is_not_a_frame_passes_by_in_asc() {
    let text = asc_header(16, true)
        + "   0.001000 1  CF00400x       Rx   d 8 01 02 03 04 05 06 07 08\n\
           0.001 1  ErrorFrame\n\
           0.001 1  Statistic: D 0 R 0 XD 0 XR 0 E 0 O 0 B 0.00%\n\
           0.001 CAN 1 Status:chip status error active\n\
           0.001 CANFD   1 Rx        300                 1 0 8  8 01 02 03 04 05 06 07 08\n\
           0.001 CANFD   1 Rx   ErrorFrame\n\
           0.001 1  CF00401x       TxRq   d 1 01\n\
           0.001 J1939TP FEE3p 6 0 0 - Rx d 3 01 02 03\n\
           0.001 1  7FF       Tx   d F 01 02 03 04 05 06 07 08\n\
           // a comment\nEnd TriggerBlock\n";
    let (_, frames, skipped) = read(text.as_bytes()).expect("a log");
    let data = [1, 2, 3, 4, 5, 6, 7, 8];
    let standard = StandardId::new(0x7FF).expect("an identifier");
    let last = TimedFrame {
        time: Instant::from_micros(9_000),
        frame: CanFrame::new(standard, &data).expect("a frame"),
    };
    assert_eq!(frames, [frame(1, 0x0CF0_0400, &data), last]);
    let expected = Skipped {
        can_fd: 1,
        bus_errors: 2,
        ..Skipped::default()
    };
    assert_eq!(skipped, expected);
}

#[test]
fn what_is_not_a_frame_passes_by_in_trc() {
    let new = trc_header("2.1")
        + "      1         1.000 DT 1  0CF00400 Tx -  1    01\n\
           2         1.100 FD 1      0300 Rx - 15    01\n\
           3         1.200 FB 1      0300 Rx -  9    01\n\
           4         1.300 ST 1         - Rx -  4    00 00 00 08\n\
           5         1.400 ER 1         - Rx -  5    04 00 02 00 00\n\
           6         1.500 EC 1         - Rx -  2    02 02\n\
           7         1.600 EV 1         - -  -  -    text\n\
           8         2.000 DT 1  0CF00400 Rx -  1    02\n";
    let old = trc_header("1.1")
        + "     1)         1.0  Tx     0CF00400  1  01\n\
                2)         1.2  Warng  FFFFFFFF  4  00 00 00 08  BUSHEAVY\n\
                2)         1.3  Rx     18FEE300  9  01 02 03 04 05 06 07 08 09\n\
                3)         2.0  Rx     0CF00400  1  02\n";
    let first = trc_header("1.0")
        + "     1)         1     0CF00400  1  01\n\
                2)         1     FFFFFFFF  4  00 00 00 08\n\
                3)         2     0CF00400  1  02\n";
    for (text, can_fd) in [(new, 2), (old, 0), (first, 0)] {
        let (_, frames, skipped) = read(text.as_bytes()).expect("a log");
        assert_eq!(
            frames,
            [frame(1, 0x0CF0_0400, &[1]), frame(2, 0x0CF0_0400, &[2])]
        );
        let expected = Skipped {
            can_fd,
            bus_errors: 1,
            ..Skipped::default()
        };
        assert_eq!(skipped, expected);
    }
}

#[test]
fn what_is_not_a_frame_passes_by_in_blf() {
    let one = [frame(1, 0x0CF0_0400, &[1])];
    let object = |kind: u32, body: &[u8]| {
        blf_object(kind, 32, &[blf_time(false, 5_000), body.to_vec()].concat())
    };
    // CAN FD messages of both kinds: with the mark of CAN FD, and classic frames.
    let mut fd = vec![1, 0, 0, 2, 0x00, 0x04, 0xF0, 0x8C];
    fd.extend([0; 84]);
    fd[20] = 7;
    let classic = fd.clone();
    fd[13] = 1;
    let mut fd64 = vec![1, 2, 2, 0, 0x00, 0x04, 0xF0, 0x8C];
    fd64.extend([0; 36]);
    fd64[40] = 7;
    let classic64 = fd64.clone();
    fd64[13] = 0x10;
    let objects = [
        blf_objects(&one),
        object(65, b"text of an odd length"),
        object(73, &[0; 24]),
        object(4, &[0; 20]),
        object(100, &fd),
        object(101, &fd64),
        object(100, &classic),
        object(101, &classic64),
    ];
    let (_, frames, skipped) = read(&blf(&objects.concat(), 2)).expect("a log");
    let second = frame(5, 0x0CF0_0400, &[7, 0]);
    assert_eq!(frames, [one[0], second, second]);
    let expected = Skipped {
        can_fd: 2,
        bus_errors: 1,
        ..Skipped::default()
    };
    assert_eq!(skipped, expected);
}

#[test]
fn estimates_equal_those_of_candump_to_the_last_byte() {
    let folder = TempDir::new().expect("a temporary folder");
    let file = |name: &str| folder.path().join(name);
    let scenario = "[road]\nlength_m = 3000.0\n[[runs]]\nname = \"a\"\ntruck = \"A\"\n";
    fs::write(file("scenario.toml"), scenario).expect("a temporary file");
    let mut simulate = program();
    simulate
        .args(["simulate", "--scenario"])
        .arg(file("scenario.toml"));
    simulate.arg("--out").arg(folder.path()).assert().success();
    let log = FrameLog::open_candump(&file("a.log")).expect("a log");
    let frames: Vec<TimedFrame> = log
        .map(|timed| {
            let TimedFrame { time, frame } = timed.expect("a whole log");
            let time = Instant::from_micros(time.micros() / 1000 * 1000);
            TimedFrame { time, frame }
        })
        .collect();
    let estimate = |content: &[u8]| {
        fs::write(file("log"), content).expect("a temporary file");
        let mut estimate = program();
        estimate
            .args(["estimate", "--vehicle"])
            .arg(file("a.vehicle.toml"));
        estimate.arg("--out").arg(file("run.csv")).arg(file("log"));
        let output = estimate.assert().success().get_output().stdout.clone();
        // Not every format has the time of the start.
        let output = String::from_utf8(output).expect("a table");
        let is_same = |line: &&str| !line.starts_with("| start") && !line.starts_with("|--");
        let lines = output.lines().filter(is_same);
        let lines: Vec<String> = lines.map(|line| line.replace(' ', "")).collect();
        (fs::read(file("run.csv")).expect("a run"), lines)
    };
    let expected = estimate(&candump(&frames));
    assert!(expected.0.len() > 10_000);
    for (name, write) in FORMATS {
        assert!(estimate(&write(&frames)) == expected, "{name}");
    }
}

#[test]
fn inspect_names_the_kind_of_a_log() {
    let folder = TempDir::new().expect("a temporary folder");
    let path = folder.path().join("drive.log");
    for (name, write) in FORMATS {
        fs::write(&path, write(&some_frames())).expect("a temporary file");
        let output = program().arg("inspect").arg(&path).assert().success();
        let text = String::from_utf8_lossy(&output.get_output().stdout).into_owned();
        let kind = kind_of_format(name).to_string();
        assert!(
            text.lines()
                .next()
                .is_some_and(|head| head.contains(&format!(": {kind}, "))),
            "{text}"
        );
    }
}

#[test]
fn commas_and_names_of_other_countries_are_understood() {
    let start = |content: &str| {
        let folder = TempDir::new().expect("a temporary folder");
        let path = folder.path().join("drive");
        fs::write(&path, content).expect("a temporary file");
        let log = Log::open(&path, &ReadOptions::default()).expect("a log");
        let Log::Frames(mut log) = log else {
            panic!("no frames");
        };
        let first = log.next_frame().expect("a log").expect("a frame");
        while log.next_frame().expect("a log").is_some() {}
        let start = log.report().start_utc.expect("a start");
        (first.time.micros(), start)
    };
    let asc = "date Son Okt 4 10:00:00 2026\nbase hex  timestamps absolute\n   0,001500 1  \
               CF00400x  Rx   d 1 01\n";
    let expected = (1_500, "2026-10-04T10:00:00.001500Z".to_owned());
    assert_eq!(start(asc), expected);
    for header in ["46348.4166666667;", "46348,4166666667"] {
        let trc = format!(
            ";$FILEVERSION=1.1\n;$STARTTIME={header}\n     1)         1,5  Rx     0CF00400  1  01\n"
        );
        let expected = (1_500, "2026-11-22T10:00:00.001503Z".to_owned());
        assert_eq!(start(&trc), expected);
    }
}

#[test]
fn what_other_programs_write_is_understood() {
    // Identifiers of TRC without leading zeros, and times of BLF from floating point.
    let text = trc_header("2.1") + "      0         0.000 DT  1  CF00400 Rx -  1    01\n";
    let (_, frames, _) = read(text.as_bytes()).expect("a log");
    assert_eq!(frames, [frame(0, 0x0CF0_0400, &[1])]);
    let mut objects = blf_objects(&[frame(0, 0x0CF0_0400, &[1]), frame(2, 0x0CF0_0400, &[1])]);
    let time = objects.len() - 56 + 24;
    objects[time..time + 8].copy_from_slice(&1_999_999_u64.to_le_bytes());
    let (_, frames, _) = read(&blf(&objects, 2)).expect("a log");
    assert_eq!(frames[1].time, Instant::from_micros(2_000));
}
