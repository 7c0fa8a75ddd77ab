//! Formats beside those of Vector and PEAK: MDF, CSV, packings, standard input.

use super::writers::{asc_header, candump, trc_header};
use super::{frame, read, some_frames};
use crate::packed::gzip;
use embedded_can::{Frame, Id, StandardId};
use host_sim::files::log_format::LogFormat;
use host_sim::source::can_frame::TimedFrame;
use host_sim::source::log::Log;
use host_sim::source::log_kind::LogKind;
use host_sim::source::read_options::ReadOptions;
use std::fs;
use std::path::Path;
use tempfile::TempDir;
use test_kit::command::program;
use test_kit::mdf::{MDF_FORMS, MdfBlocks, MdfData, MdfFrame, mdf};

/// A recording of a standing truck, as a candump log and as an MDF file, if it is there.
fn truck_idle(ending: &str) -> Option<Vec<u8>> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let path = root
        .join("../shared/data/css_truck_idle/truck_idle")
        .with_extension(ending);
    let content = fs::read(&path).ok();
    if content.is_none() {
        eprintln!("SKIPPED: there is no {}", path.display());
    }
    content
}

#[test]
fn an_mdf_file_has_the_frames_of_the_candump_log() {
    let (Some(mdf), Some(log)) = (truck_idle("mf4"), truck_idle("log")) else {
        return;
    };
    let (kind, expected, skipped) = read(&log).expect("a log");
    assert_eq!(kind, LogKind::Frames(LogFormat::Candump));
    assert!(expected.len() > 50_000);
    for content in [&mdf, &gzip(&mdf)] {
        let found = read(content).expect("an MDF file");
        assert_eq!(
            (found.0, found.2),
            (LogKind::Frames(LogFormat::Mdf), skipped)
        );
        assert!(found.1.len() == expected.len());
        // The log has eight bytes of each frame, whatever its length.
        for (found, expected) in found.1.iter().zip(&expected) {
            let (found_frame, frame) = (found.frame, expected.frame);
            assert_eq!((found.time, found_frame.id()), (expected.time, frame.id()));
            let (short, whole) = (found_frame.data(), frame.data());
            assert_eq!(short, &whole[..short.len()]);
            assert!(whole[short.len()..].iter().all(|byte| *byte == 0));
        }
    }
    let (_, expected, _) = read(&mdf).expect("an MDF file");
    // Cut off anywhere behind its header.
    for cut in [20_000, 1_000_001, mdf.len() - 1] {
        let (_, part, _) = read(&mdf[..cut]).expect("a part");
        assert!(!part.is_empty() && part == expected[..part.len()], "{cut}");
    }
    // A damaged header ends in a message.
    for at in (0..15_000).step_by(97) {
        let mut damaged = mdf[..40_000].to_vec();
        damaged[at] ^= 0xff;
        if let Err(message) = read(&damaged) {
            assert!(message.starts_with("drive"), "{message}");
        }
    }
}

pub fn of_mdf(frames: &[TimedFrame]) -> Vec<MdfFrame> {
    let of = |timed: &TimedFrame| {
        let (id, is_extended) = match timed.frame.id() {
            Id::Standard(id) => (id.as_raw().into(), false),
            Id::Extended(id) => (id.as_raw(), true),
        };
        MdfFrame {
            micros: timed.time.micros(),
            bus: 1,
            id,
            is_extended,
            data: timed.frame.data().to_vec(),
        }
    };
    frames.iter().map(of).collect()
}

#[test]
fn every_form_of_mdf_gives_the_same_frames() {
    let mut frames = some_frames();
    frames.retain(|timed| !timed.frame.is_remote_frame());
    for k in 0..5000 {
        frames.push(frame(3_600_001 + k, 0x18FE_F100, &(k * k).to_le_bytes()));
    }
    for (blocks, data) in MDF_FORMS {
        let file = mdf(&of_mdf(&frames), blocks, data);
        let (kind, found, _) = read(&file).expect("an MDF file");
        assert!(
            kind == LogKind::Frames(LogFormat::Mdf) && found == frames,
            "{blocks:?} {data:?}"
        );
        for cut in (file.len() / 2..file.len()).step_by(file.len() / 11) {
            if let Ok((_, part, _)) = read(&file[..cut]) {
                assert!(part == frames[..part.len()], "{blocks:?} {data:?} at {cut}");
            }
        }
        for at in (64..file.len()).step_by(file.len() / 97) {
            let mut damaged = file.clone();
            damaged[at] ^= 0xff;
            if let Err(message) = read(&damaged) {
                assert!(message.starts_with("drive"), "{message}");
            }
        }
    }
}

#[test]
fn a_lost_block_of_mdf_costs_its_frames_only() {
    let frames: Vec<TimedFrame> = (0..3000_u64)
        .map(|k| frame(k, 0x18FE_F100, &(k * k).to_le_bytes()))
        .collect();
    for blocks in [MdfBlocks::Deflated, MdfBlocks::Transposed] {
        let mut file = mdf(&of_mdf(&frames), blocks, MdfData::InRecord);
        let starts: Vec<usize> = memchr::memmem::find_iter(&file, b"##DZ").collect();
        file[starts[1] + 100] ^= 0xff;
        let (_, found, _) = read(&file).expect("two of three blocks");
        assert!((1998..2001).contains(&found.len()), "{}", found.len());
        assert!(found.iter().all(|timed| frames.contains(timed)));
    }
}

#[test]
fn an_unknown_compression_method_of_mdf_is_named() {
    let frames = [frame(1, 0x18FE_F100, &[1, 2, 3])];
    for blocks in [MdfBlocks::Deflated, MdfBlocks::Lz4Transposed] {
        let mut file = mdf(&of_mdf(&frames), blocks, MdfData::InRecord);
        let starts: Vec<usize> = memchr::memmem::find_iter(&file, b"##DZ").collect();
        for start in starts {
            file[start + 26] = 6;
        }
        let message = read(&file).expect_err("nothing can be read");
        assert!(
            message.contains("compression method 6, which is not read"),
            "{message}"
        );
    }
}

#[test]
fn a_circle_of_data_blocks_in_mdf_ends() {
    let frames: Vec<TimedFrame> = (0..300_u64)
        .map(|k| frame(k, 0x18FE_F100, &k.to_le_bytes()))
        .collect();
    let mut file = mdf(&of_mdf(&frames), MdfBlocks::List, MdfData::InRecord);
    let list = memchr::memmem::find(&file, b"##DL").expect("a list");
    // Its first link is the next list.
    file[list + 24..list + 32].copy_from_slice(&(list as u64).to_le_bytes());
    let message = read(&file).expect_err("a circle");
    assert!(
        message.contains("more data blocks than the file has"),
        "{message}"
    );
}

#[test]
fn csv_of_other_programs_is_read() {
    let savvy = "Time Stamp,ID,Extended,Dir,Bus,LEN,D1,D2,D3,D4,D5,D6,D7,D8\n\
        1000,0CF00400,true,Rx,0,3,60,7D,84,\n2000,00000123,false,Rx,1,0,\n";
    let old = "Time Stamp,ID,Extended,Bus,LEN,D1,D2,D3,D4,D5,D6,D7,D8\n\
        1000,0CF00400,true,0,3,60,7D,84,00,00,00,00,00\n2000,123,false,1,0\n";
    let python = "timestamp,arbitration_id,extended,remote,error,dlc,data\n\
        0.001,0xcf00400,1,0,0,3,YH2E\n0.002,0x123,0,0,0,0,\n0.002,0x0,0,0,1,0,\n";
    let id = StandardId::new(0x123).expect("an identifier");
    let empty = TimedFrame {
        frame: Frame::new(id, &[]).expect("a frame"),
        ..frame(2, 0, &[])
    };
    let frames = [frame(1, 0x0CF0_0400, &[0x60, 0x7D, 0x84]), empty];
    for (kind, text) in [
        (LogKind::Frames(LogFormat::SavvyCan), savvy),
        (LogKind::Frames(LogFormat::SavvyCan), old),
        (LogKind::Frames(LogFormat::PythonCan), python),
    ] {
        let (found_kind, found, _) = read(text.as_bytes()).expect(text);
        assert_eq!((found_kind, &found[..]), (kind, &frames[..]), "{text}");
    }
    let wrong = savvy.replace("00000123", "0000X123");
    let message = read(wrong.as_bytes()).expect_err("a wrong identifier");
    assert!(
        message.starts_with("drive:3: no CAN identifier"),
        "{message}"
    );
}

#[test]
fn packings_and_utf_16_change_nothing() {
    let frames = some_frames();
    let text = candump(&frames);
    let expected = read(&text).expect("a log");
    let wide: Vec<u16> = String::from_utf8(text.clone())
        .expect("text")
        .encode_utf16()
        .collect();
    let little: Vec<u8> = wide.iter().flat_map(|unit| unit.to_le_bytes()).collect();
    let big: Vec<u8> = wide.iter().flat_map(|unit| unit.to_be_bytes()).collect();
    let level = ruzstd::encoding::CompressionLevel::Fastest;
    let zstd = |content: &[u8]| ruzstd::encoding::compress_to_vec(content, level);
    for content in [
        [&b"\xff\xfe"[..], &little].concat(),
        [&b"\xfe\xff"[..], &big].concat(),
        gzip(&[&b"\xff\xfe"[..], &little].concat()),
        zstd(&text),
        [zstd(&text[..100]), zstd(&text[100..])].concat(),
    ] {
        assert_eq!(read(&content), Ok(expected.clone()));
    }
}

#[test]
fn standard_input_is_a_log() {
    let mut inspect = program();
    let output = inspect
        .args(["inspect", "--json", "-"])
        .write_stdin(candump(&some_frames()));
    let output = output.assert().success().get_output().stdout.clone();
    let json: serde_json::Value = serde_json::from_slice(&output).expect("JSON");
    assert_eq!(json["frames"], some_frames().len());
    let mut inspect = program();
    let table = "time_s,altitude_m\n1,2\n2,3\n";
    let output = inspect
        .args(["inspect", "--json", "-"])
        .write_stdin(table)
        .assert()
        .success();
    let json: serde_json::Value =
        serde_json::from_slice(&output.get_output().stdout).expect("JSON");
    assert_eq!(json["rows"], 2);
    if let Some(mdf) = truck_idle("mf4") {
        let mut inspect = program();
        let output = inspect
            .args(["inspect", "--json", "-"])
            .write_stdin(mdf)
            .assert()
            .success();
        let json: serde_json::Value =
            serde_json::from_slice(&output.get_output().stdout).expect("JSON");
        assert_eq!(json["frames"], 57_849);
    }
}

#[test]
fn the_start_is_known_where_the_log_has_it() {
    let folder = TempDir::new().expect("a temporary folder");
    let path = folder.path().join("drive");
    let line = "   1.500000 1  123 Rx d 1 01\n";
    let date = asc_header(16, false);
    let trc = trc_header("2.1") + "      1      1500.000 DT 1      0123 Rx -  1    01\n";
    for (text, start) in [
        (date.clone() + line, Some("2026-11-22T10:00:01.500Z")),
        (
            date.replace(" am", "") + line,
            Some("2026-11-22T10:00:01.500Z"),
        ),
        (
            date.replace(" am", " pm") + line,
            Some("2026-11-22T22:00:01.500Z"),
        ),
        (line.to_owned() + line, None),
        (trc, Some("2026-11-22T10:00:01.500003Z")),
        (
            "(1795341601.500000) can0 123#01\n".to_owned(),
            Some("2026-11-22T10:00:01.500Z"),
        ),
        ("(1.500000) can0 123#01\n".to_owned(), None),
    ] {
        fs::write(&path, &text).expect("a temporary file");
        let mut log = Log::open(&path, &ReadOptions::default()).expect(&text);
        let Log::Frames(reader) = &mut log else {
            panic!("{text}");
        };
        while reader.next_frame().expect(&text).is_some() {}
        assert_eq!(log.report().start_utc.as_deref(), start, "{text}");
    }
}
