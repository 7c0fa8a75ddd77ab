//! NMEA 2000 as text: canboat, Yacht Devices, Actisense.

use super::{frame, read, read_as};
use crate::packed::gzip;
use embedded_can::Frame;
use estimator_core::Instant;
use host_sim::files::log_format::LogFormat;
use host_sim::source::can_frame::{CanFrame, TimedFrame};
use host_sim::source::frame_log::Skipped;
use host_sim::source::log_kind::LogKind;
use std::fmt::Write;

/// 2026-11-22T10:00:00Z.
const START_MS: u64 = 1_795_341_600_000;
const MORNING_MS: u64 = 36_000_000;
/// COG and SOG of source 7, priority 2.
const ID: u32 = 0x09F8_0207;

fn data(k: u64) -> [u8; 8] {
    [0xff, 0xfc, k as u8, 0x1b, 3, 0, 0xff, 0xff]
}

fn spaced(data: &[u8], separator: &str) -> String {
    let bytes: Vec<String> = data.iter().map(|byte| format!("{byte:02X}")).collect();
    bytes.join(separator)
}

/// GNSS position data (129029) at 59.5°, 17.25°, 40 m.
fn position() -> Vec<u8> {
    let mut data = vec![1, 0x9b, 0x4e, 0, 0, 0, 0];
    for value in [59.5_f64, 17.25] {
        data.extend(((value * 1e16) as i64).to_le_bytes());
    }
    data.extend(40_000_000_i64.to_le_bytes());
    data.extend([0x14, 0xfc, 12, 80, 0, 120, 0, 0, 0, 0, 0, 0]);
    data
}

/// A line of a writer at a time of the morning.
type Line = fn(u64, &[u8]) -> String;

fn clock(ms: u64) -> (u64, u64, u64, u64) {
    (
        ms / 3_600_000 % 24,
        ms / 60_000 % 60,
        ms / 1000 % 60,
        ms % 1000,
    )
}

const WRITERS: [(LogKind, Line, u64); 4] = [
    (
        LogKind::Frames(LogFormat::Canboat),
        |ms, data| {
            let (h, m, s, ms) = clock(ms);
            let bytes = spaced(data, ",").to_lowercase();
            let time = format!("2026-11-22T{h:02}:{m:02}:{s:02}.{ms:03}Z");
            format!("{time},2,129026,7,255,{},{bytes}\n", data.len())
        },
        START_MS,
    ),
    (
        LogKind::Frames(LogFormat::Canboat),
        |ms, data| {
            let (h, m, s, ms) = clock(ms);
            let time = format!("2026-11-22-{h:02}:{m:02}:{s:02}.{ms:03}");
            format!(
                "{time}, 2, 129026, 7, 255, {}, {}\n",
                data.len(),
                spaced(data, ", ")
            )
        },
        START_MS,
    ),
    (
        LogKind::Frames(LogFormat::YachtDevices),
        |ms, data| {
            let (h, m, s, ms) = clock(ms);
            format!(
                "{h:02}:{m:02}:{s:02}.{ms:03} R {ID:08X} {}\n",
                spaced(data, " ")
            )
        },
        MORNING_MS,
    ),
    (
        LogKind::Frames(LogFormat::Actisense),
        |ms, data| {
            let (h, m, s, ms) = clock(ms);
            format!(
                "A{h:02}{m:02}{s:02}.{ms:03} 07FF2 1F802 {}\n",
                spaced(data, "")
            )
        },
        MORNING_MS,
    ),
];

fn text(line: Line, count: u64) -> String {
    (0..count)
        .map(|k| line(MORNING_MS + 100 * k, &data(k)))
        .collect()
}

fn frames(start_ms: u64, count: u64) -> Vec<TimedFrame> {
    let at = |k| frame(start_ms + 100 * k, ID, &data(k));
    (0..count).map(at).collect()
}

#[test]
fn lines_of_every_writer_are_frames() {
    for (kind, line, start_ms) in WRITERS {
        let text = text(line, 200);
        let expected = Ok((kind, frames(start_ms, 200), Skipped::default()));
        for name in ["drive", "drive.raw", "drive.csv", "drive.log"] {
            assert_eq!(read_as(name, text.as_bytes()), expected, "{kind} as {name}");
        }
        assert_eq!(read(&gzip(text.as_bytes())), expected, "{kind}");
        for text in [
            text.replace('\n', "\r\n"),
            format!("# a comment\nINFO started\n\n{text}"),
        ] {
            assert_eq!(read(text.as_bytes()), expected, "{kind}");
        }
        // Without its line end, the last line may lack digits.
        let cut = text.trim_end();
        let (_, found, _) = read(cut.as_bytes()).expect("a log");
        assert!(found.len() >= 199, "{kind}");
    }
}

#[test]
fn a_damaged_line_costs_itself() {
    for (kind, line, start_ms) in WRITERS {
        let text = text(line, 200);
        let damaged: String = text
            .lines()
            .enumerate()
            .map(|(k, line)| match k {
                100 => format!(
                    "{}\n",
                    &line[..line.len() - 1].replace("FC", "G").replace("fc", "G")
                ),
                _ => format!("{line}\n"),
            })
            .collect();
        let (_, found, _) = read(damaged.as_bytes()).expect("a log");
        let mut expected = frames(start_ms, 200);
        expected.remove(100);
        assert!(found == expected, "{kind}");
        let all: String = damaged.replace("1B", "XY").replace("1b", "xy");
        assert!(read(all.as_bytes()).is_err(), "{kind}");
    }
}

#[test]
fn midnight_is_no_step() {
    for (kind, line, _) in WRITERS.into_iter().skip(2) {
        let midnight = 86_400_000;
        let times = [-200_i64, -100, 0, -50, 100, 39_600_000, 79_200_000];
        let mut text = String::new();
        for (k, ms) in times.iter().enumerate() {
            text += &line((midnight + ms) as u64, &data(k as u64));
        }
        let (_, found, _) = read(text.as_bytes()).expect("a log");
        let first = found[0].time.micros();
        let found: Vec<u64> = found
            .iter()
            .map(|timed| (timed.time.micros() - first) / 1000)
            .collect();
        assert_eq!(
            found,
            [0, 100, 150, 200, 300, 39_600_200, 79_200_200],
            "{kind}"
        );
    }
}

#[test]
fn whole_messages_are_frames_again() {
    let bytes = position();
    let lines = [
        format!(
            "2026-11-22T10:00:00.000Z,3,129029,7,255,43,{}\n",
            spaced(&bytes, ",")
        ),
        format!("A100000.000 07FF3 1F805 {}\n", spaced(&bytes, "")),
        format!("10:00:00.000 R 0DF80507 {}\n", spaced(&bytes, " ")),
    ];
    for line in lines {
        let (_, found, _) = read(line.repeat(3).as_bytes()).expect(&line);
        // 6 bytes in the first frame, 7 in the six others.
        assert_eq!(found.len(), 21, "{line}");
        let mut sequences = Vec::new();
        for packet in found.chunks(7) {
            let sequence = packet[0].frame.data()[0] >> 5;
            let expected: Vec<CanFrame> =
                CanFrame::carrying(0x0DF8_0507, sequence, &bytes).collect();
            let frames: Vec<CanFrame> = packet.iter().map(|timed| timed.frame).collect();
            assert_eq!(frames, expected, "{line}");
            sequences.push(sequence);
        }
        sequences.dedup();
        assert_eq!(sequences.len(), 3, "{line}");
    }
}

#[test]
fn a_long_message_of_j1939_goes_by_transport_protocol() {
    let bytes: Vec<u8> = (0..20).collect();
    let mut text = format!(
        "2026-11-22T10:00:00.000Z,6,65260,0,255,20,{}\n",
        spaced(&bytes, ",")
    );
    // A gateway's own message, and one to an address.
    writeln!(
        text,
        "2026-11-22T10:00:01.000Z,0,262386,0,0,9,1,2,3,4,5,6,7,8,9"
    )
    .unwrap();
    writeln!(text, "2026-11-22T10:00:02.000Z,6,59904,41,60,3,16,f0,01").unwrap();
    let (_, found, _) = read(text.as_bytes()).expect("a log");
    let frames: Vec<CanFrame> = found.iter().map(|timed| timed.frame).collect();
    let mut expected: Vec<CanFrame> = CanFrame::broadcast(65_260, 0, &bytes).collect();
    expected.extend(CanFrame::extended(0x18EA_3C29, &[0x16, 0xf0, 1]));
    assert_eq!(frames, expected);
    assert_eq!(found[0].time, Instant::from_micros(1000 * START_MS));
}

#[test]
fn times_without_a_fraction_are_read() {
    let text = "2026-11-22-10:00:01,6,127506,40,255,3,00,0a,00\n\
        2026-11-22T10:00:01.250Z,6,127506,40,255,3,00,0a,00\n";
    let (_, found, _) = read(text.as_bytes()).expect("a log");
    let times: Vec<u64> = found
        .iter()
        .map(|timed| timed.time.micros() / 1000)
        .collect();
    assert_eq!(times, [START_MS + 1000, START_MS + 1250]);
    for wrong in [
        "2026-13-22T10:00:01Z",
        "2026-11-22T24:00:01Z",
        "2026-11-22T10:00:01+02:00",
    ] {
        let message = read(text.replace("2026-11-22-10:00:01", wrong).as_bytes());
        let message = message.expect_err("one of two lines is damaged");
        assert!(message.contains("no time in `2026-"), "{message}");
    }
}
