//! Logs as other programs write them: headers, flags, events, marks.

use super::writers::{asc_header, blf, blf_container, blf_header, blf_objects, zlib};
use super::{frame, read};
use host_sim::files::log_format::LogFormat;
use host_sim::source::can_frame::TimedFrame;
use host_sim::source::frame_log::Skipped;
use host_sim::source::log::Log;
use host_sim::source::log_kind::LogKind;
use host_sim::source::read_options::ReadOptions;
use std::fmt::Write;
use tempfile::TempDir;

const ID: u32 = 0x18FE_F100;

fn data(k: u64) -> [u8; 8] {
    (k * 0x0101_0101).to_le_bytes()
}

fn frames(count: u64) -> Vec<TimedFrame> {
    (0..count).map(|k| frame(100 * k, ID, &data(k))).collect()
}

fn hex(bytes: &[u8]) -> String {
    let bytes: Vec<String> = bytes.iter().map(|byte| format!("{byte:02X}")).collect();
    bytes.join(" ")
}

/// Returns lines of ASC, each with `direction` and what is behind.
fn asc_lines(count: u64) -> String {
    let mut text = String::new();
    for k in 0..count {
        let (seconds, tenth) = (k / 10, k % 10);
        writeln!(
            text,
            "   {seconds}.{tenth}00000 1  18FEF100x       Rx   d 8 {}",
            hex(&data(k))
        )
        .unwrap();
    }
    text
}

fn start_of(text: &str) -> Option<String> {
    let folder = TempDir::new().expect("a temporary folder");
    let path = folder.path().join("drive");
    std::fs::write(&path, text).expect("a temporary file");
    let mut log = Log::open(&path, &ReadOptions::default()).expect(text);
    let Log::Frames(reader) = &mut log else {
        panic!("{text}");
    };
    while reader.next_frame().expect(text).is_some() {}
    log.report().start_utc
}

#[test]
fn a_clock_of_24_hours_beside_am_or_pm_is_one_of_24_hours() {
    for (time, expected) in [
        ("13:14:48.626 am", Some("2020-01-07T13:14:48.626Z")),
        ("13:14:48.626 pm", Some("2020-01-07T13:14:48.626Z")),
        ("23:00:00.000 am", Some("2020-01-07T23:00:00Z")),
        ("12:14:48.626 am", Some("2020-01-07T00:14:48.626Z")),
        ("12:14:48.626 pm", Some("2020-01-07T12:14:48.626Z")),
        ("01:14:48.626 pm", Some("2020-01-07T13:14:48.626Z")),
        ("00:14:48.626 am", Some("2020-01-07T00:14:48.626Z")),
        // Nobody knows.
        ("00:14:48.626 pm", None),
        ("24:14:48.626 am", None),
    ] {
        let text =
            format!("date Tue Jan 7 {time} 2020\nbase hex  timestamps absolute\n") + &asc_lines(3);
        assert_eq!(start_of(&text).as_deref(), expected, "{time}");
    }
}

#[test]
fn the_header_of_asc_may_lack_parts() {
    for header in [
        "base hex  no internal events logged\n",
        "base hex\n",
        "Base HEX  Timestamps Absolute\n",
        "internal events logged\n// version 7.1.0\n",
        "",
    ] {
        let text = header.to_owned() + &asc_lines(20);
        let expected = Ok((
            LogKind::Frames(LogFormat::Asc),
            frames(20),
            Skipped::default(),
        ));
        assert_eq!(read(text.as_bytes()), expected, "{header}");
    }
    let text = "base hex  timestamps sometimes\n".to_owned() + &asc_lines(20);
    let message = read(text.as_bytes()).expect_err("a kind of times that nobody knows");
    assert!(
        message.starts_with("drive:1: no such base or kind of time stamps"),
        "{message}"
    );
}

#[test]
fn a_log_is_known_by_most_of_its_first_lines() {
    let asc = asc_lines(20);
    let candump: String = (0..20)
        .map(|k| {
            format!(
                "({}.{}00000) can0 18FEF100#{:016X}\n",
                k / 10,
                k % 10,
                data(k)
                    .iter()
                    .fold(0_u64, |sum, byte| sum << 8 | u64::from(*byte))
            )
        })
        .collect();
    let trc: String = (0..20)
        .map(|k| {
            format!(
                "{:6}) {:9} 18FEF100  8  {}\n",
                k + 1,
                100 * k,
                hex(&data(k))
            )
        })
        .collect();
    for (start, text, kind) in [
        (
            "   0.010000 1  Statistic: D 120 R 0 XD 900 XR 0 E 0 O 0 B 31.20%\n",
            &asc,
            LogKind::Frames(LogFormat::Asc),
        ),
        (
            "   0.000000 Start of measurement\n",
            &asc,
            LogKind::Frames(LogFormat::Asc),
        ),
        (
            "   0.000000 CAN 1 Status:chip status error active\n",
            &asc,
            LogKind::Frames(LogFormat::Asc),
        ),
        (
            "a word of the logger\n",
            &asc,
            LogKind::Frames(LogFormat::Asc),
        ),
        (
            "; a comment\n;another\n// a third\n",
            &candump,
            LogKind::Frames(LogFormat::Candump),
        ),
        (
            "date Sun Nov 22 10:00:00 2026\n",
            &candump,
            LogKind::Frames(LogFormat::Candump),
        ),
        ("", &trc, LogKind::Frames(LogFormat::Trc)),
        ("// a comment\n", &trc, LogKind::Frames(LogFormat::Trc)),
    ] {
        let (found_kind, found, _) = read(format!("{start}{text}").as_bytes()).expect(start);
        assert_eq!((found_kind, found), (kind, frames(20)), "{start}");
    }
    let savvy = "# a comment\nTime Stamp,ID,Extended,Dir,Bus,LEN,D1,D2,D3,D4,D5,D6,D7,D8\n\
        1000,0CF00400,true,Rx,0,1,60\n";
    let (kind, found, _) = read(savvy.as_bytes()).expect("a log");
    assert_eq!(
        (kind, found.len()),
        (LogKind::Frames(LogFormat::SavvyCan), 1)
    );
}

#[test]
fn the_flags_of_a_line_tell_a_classic_frame_not_its_word() {
    let line = |k: u64, brs: u8, dlc: &str, bytes: &str, flags: &str| {
        format!(
            "   {}.{}00000 CANFD   1 Rx 18FEF100x   {brs} 0 {dlc} {bytes}   0    0   {flags}   0 0 0 0 0\n",
            k / 10,
            k % 10
        )
    };
    let mut text = asc_header(16, false);
    for k in 0..20 {
        text += &line(k, 0, "8", &format!(" 8 {}", hex(&data(k))), "0");
    }
    text += &line(20, 0, "8", &format!(" 8 {}", hex(&data(0))), "1000");
    text += &line(21, 1, "8", &format!(" 8 {}", hex(&data(0))), "0");
    text += &line(22, 0, "9", &format!("12 {}", hex(&[7; 12])), "0");
    text += "   2.300000 CANFD   1 Rx 18FEF100x  0 0 8  8 01 02 03 04 05 06 07 08\n";
    text += "   2.400000 CANFD   1 Rx ErrorFrame\n";
    text += "   2.500000 CANXL   1 Rx 123 0 0 8  8 01 02 03 04 05 06 07 08\n";
    let expected = Skipped {
        can_fd: 4,
        can_xl: 1,
        bus_errors: 1,
        ..Skipped::default()
    };
    assert_eq!(
        read(text.as_bytes()),
        Ok((LogKind::Frames(LogFormat::Asc), frames(20), expected))
    );
    // With the name of the message.
    let named = text.replace("18FEF100x   0 0", "18FEF100x  CCVS1 0 0");
    assert_eq!(
        read(named.as_bytes()),
        Ok((LogKind::Frames(LogFormat::Asc), frames(20), expected))
    );
}

#[test]
fn long_frames_in_the_classic_layout_are_can_fd() {
    let mut text = asc_header(16, false) + &asc_lines(20);
    for (k, (length, bytes)) in [("10", 16), ("9", 12), ("F", 64), ("40", 64)]
        .iter()
        .enumerate()
    {
        let bytes = hex(&vec![0x0A; *bytes]);
        writeln!(
            text,
            "   2.{k}00000 1  321  Rx   d {length} {bytes}  Length = 0"
        )
        .unwrap();
    }
    // A length of more than 8 means 8 in a classic frame.
    writeln!(
        text,
        "   2.500000 1  18FEF100x  Rx   d F {} Length = 0",
        hex(&data(25))
    )
    .unwrap();
    let mut expected = frames(20);
    expected.push(frame(2500, ID, &data(25)));
    let skipped = Skipped {
        can_fd: 4,
        ..Skipped::default()
    };
    assert_eq!(
        read(text.as_bytes()),
        Ok((LogKind::Frames(LogFormat::Asc), expected, skipped))
    );
}

#[test]
fn a_time_of_savvycan_in_another_unit_is_none() {
    let text = "Time Stamp,ID,Extended,Dir,Bus,LEN,D1\n1.5,123,false,Rx,0,1,60,\n";
    let message = read(text.as_bytes()).expect_err("seconds");
    assert!(
        message.starts_with("drive:2: no time in `1.5,"),
        "{message}"
    );
}

#[test]
fn a_table_of_savvycan_may_have_any_separator_and_clock() {
    let header = "Time Stamp,ID,Extended,Dir,Bus,LEN,D1";
    let rows = |first: i64| -> String {
        let row = |k: i64| format!("{},18FEF100,true,Rx,0,1,60,\n", first + k * 100_000);
        (0..20).map(row).collect()
    };
    for first in [0, 1_717_751_916_236_254, -1_717_751_916_236_254] {
        let table = format!("{header}\n{}", rows(first));
        for separator in [",", ";", "\t"] {
            let text = table.replace(',', separator);
            let (kind, found, _) = read(text.as_bytes()).expect(separator);
            assert_eq!(
                (kind, found.len()),
                (LogKind::Frames(LogFormat::SavvyCan), 20)
            );
            let way = found[19].time.since(found[0].time).as_secs_f64();
            assert!((way - 1.9).abs() < 1e-6, "{first}: {way}");
        }
    }
    let python = "timestamp,arbitration_id,extended,remote,error,dlc,data\n\
        0.001,0xcf00400,1,0,0,3,YH2E\n0.002,0x123,0,0,0,0,\n";
    // As saved again with a number in front of each row.
    let numbered = ",timestamp,arbitration_id,extended,remote,error,dlc,data\n\
        0,0.001,0xcf00400,1,0,0,3,YH2E\n1,0.002,0x123,0,0,0,0,\n";
    assert_eq!(read(numbered.as_bytes()), read(python.as_bytes()));
}

#[test]
fn candump_without_times_is_named() {
    let text = "  can0  18FEF100   [8]  FF 00 20 FF FF FF FF FF\n  can0  123   [0]\n";
    let message = read(text.as_bytes()).expect_err("no times");
    assert!(
        message.contains("no times") && message.contains("candump -L"),
        "{message}"
    );
}

#[test]
fn a_container_that_is_cut_off_is_used_up_to_there() {
    let noise = |k: u64| k.wrapping_mul(0x9E37_79B9_7F4A_7C15).to_le_bytes();
    let frames: Vec<TimedFrame> = (0..400).map(|k| frame(k, ID, &noise(k))).collect();
    let stream = blf_objects(&frames);
    for (method, content) in [(0, stream.clone()), (2, zlib(&stream))] {
        let container = blf_container(method, stream.len() as u32, &content);
        let file = [blf_header(), container].concat();
        let cut = &file[..file.len() * 3 / 4];
        let (_, found, _) = read(cut).expect("a part");
        assert!((200..400).contains(&found.len()), "{}", found.len());
        assert!(found == frames[..found.len()]);
    }
    let (_, whole, _) = read(&blf(&stream, 2)).expect("a log");
    assert!(whole == frames);
}
