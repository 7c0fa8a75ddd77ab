//! Time stamps of logs: their order, counters that begin again, clocks that are set.

use super::frame;
use super::writers::{FORMATS, candump};
use host_sim::source::can_frame::{CanFrame, TimedFrame};
use host_sim::source::damage::Damage;
use host_sim::source::log::Log;
use host_sim::source::log_report::LogReport;
use host_sim::source::read_options::ReadOptions;
use std::fmt::Write;
use std::fs;
use tempfile::TempDir;
use test_kit::mdf::{MdfBlocks, MdfData, mdf};

fn read_with(
    content: &[u8],
    options: &ReadOptions,
) -> Result<(Vec<TimedFrame>, LogReport), String> {
    let folder = TempDir::new().expect("a temporary folder");
    let path = folder.path().join("drive");
    fs::write(&path, content).expect("a temporary file");
    let mut log = Log::open(&path, options).map_err(|e| e.to_string())?;
    let Log::Frames(reader) = &mut log else {
        return Err("a table".to_owned());
    };
    let frames: Result<Vec<_>, _> = reader.by_ref().collect();
    Ok((frames.map_err(|e| e.to_string())?, log.report()))
}

fn read(content: &[u8]) -> (Vec<TimedFrame>, LogReport) {
    read_with(content, &ReadOptions::default()).expect("a log")
}

fn rejoin() -> ReadOptions {
    ReadOptions {
        rejoin: true,
        ..ReadOptions::default()
    }
}

/// Returns frames of three messages, in the order of time.
fn three_messages() -> Vec<TimedFrame> {
    let ids = [0x18FE_F100, 0x0CF0_0400, 0x18FE_DF00];
    (0..600)
        .map(|k| {
            frame(
                100 * (k / 3) + k % 3,
                ids[(k % 3) as usize],
                &k.to_le_bytes(),
            )
        })
        .collect()
}

#[test]
fn a_log_that_is_sorted_by_identifier_or_stored_in_chunks_is_put_in_order() {
    let frames = three_messages();
    let mut by_identifier = frames.clone();
    by_identifier.sort_by_key(|timed| format!("{:?}", embedded_can::Frame::id(&timed.frame)));
    let mut by_chunks = frames.clone();
    for chunk in by_chunks.chunks_mut(90) {
        chunk.sort_by_key(|timed| format!("{:?}", embedded_can::Frame::id(&timed.frame)));
    }
    for stored in [by_identifier, by_chunks] {
        assert!(stored != frames);
        for (name, write) in FORMATS {
            if name.contains("relative") {
                continue; // Its times cannot fall.
            }
            let (found, report) = read(&write(&stored));
            assert!(found == frames, "{name}");
            assert_eq!(report.damage, Damage::default(), "{name}");
            let told = report.mended.join("; ");
            assert!(
                told.contains("frames stand behind later ones"),
                "{name}: {told}"
            );
        }
        let file = mdf(
            &super::formats::of_mdf(&stored),
            MdfBlocks::List,
            MdfData::InRecord,
        );
        assert!(read(&file).0 == frames);
        let (found, _) = read(&candump(&stored));
        assert!(found == frames);
    }
    let (_, report) = read(&candump(&frames));
    assert!(report.mended.is_empty(), "{:?}", report.mended);
}

#[test]
fn a_counter_of_32_bits_that_begins_again_goes_on() {
    let mut text = "Time Stamp,ID,Extended,Dir,Bus,LEN,D1\n".to_owned();
    let start = (1_u64 << 32) - 20_000_000;
    for k in 0..400 {
        let micros = (start + 100_000 * k) % (1 << 32);
        writeln!(text, "{micros},18FEF100,true,Rx,0,1,{:02X}", k % 256).unwrap();
    }
    let (found, report) = read(text.as_bytes());
    let expected: Vec<TimedFrame> = (0..400)
        .map(|k| {
            let time = estimator_core::Instant::from_micros(start + 100_000 * k);
            let frame = CanFrame::extended(0x18FE_F100, &[k as u8]).unwrap();
            TimedFrame { time, frame }
        })
        .collect();
    assert!(found == expected);
    assert_eq!(
        report.mended,
        ["the counter of microseconds began again once (32 bits); time goes on"]
    );
}

#[test]
fn a_clock_that_is_set_back_a_little_goes_on_and_by_much_only_if_asked() {
    let log = |step_us: u64| {
        let mut text = String::new();
        for k in 0..400_u64 {
            let back_us = if k < 200 { 0 } else { step_us };
            let micros = 1_700_000_000_000_000 + 100_000 * k - back_us;
            let (seconds, micros) = (micros / 1_000_000, micros % 1_000_000);
            writeln!(text, "({seconds}.{micros:06}) can0 123#{:02X}", k % 256).unwrap();
        }
        text
    };
    let check = |found: &[TimedFrame], report: &LogReport| {
        assert_eq!(found.len(), 400);
        assert!(found.is_sorted_by_key(|timed| timed.time));
        let (first, last) = (found[0].time, found[399].time);
        let duration_us = last.since(first).micros();
        assert!(
            (39_700_000..=39_900_000).contains(&duration_us),
            "{duration_us}"
        );
        assert_eq!(report.damage, Damage::default());
        assert!(
            report.mended[0].contains("the clock was set back once"),
            "{report:?}"
        );
    };
    for step_us in [300_000, 2_000_000, 9_000_000] {
        let (found, report) = read(log(step_us).as_bytes());
        check(&found, &report);
    }
    for step_us in [15_000_000, 3_600_000_000, 800_000_000_000_000] {
        let text = log(step_us);
        let message = read_with(text.as_bytes(), &ReadOptions::default()).expect_err("set back");
        assert!(
            message.contains("drive:201: time runs backwards, from "),
            "{message}"
        );
        assert!(message.contains("give --rejoin"), "{message}");
        let (found, report) = read_with(text.as_bytes(), &rejoin()).expect("one drive");
        check(&found, &report);
    }
}

#[test]
fn one_stamp_of_another_clock_costs_its_frame_only() {
    let stamp = |k: u64| format!("({}.{:06})", 1_700_000_000 + k / 10, k % 10 * 100_000);
    let text: String = (0..400)
        .map(|k| format!("{} can0 {:03X}#{:02X}\n", stamp(k), 0x100 + k % 7, k % 256))
        .collect();
    let whole = read(text.as_bytes()).0;
    assert_eq!(whole.len(), 400);
    // 1970, an hour ago, an hour ahead, the far future.
    for other in [
        "(0.500000)",
        "(1699996400.000000)",
        "(1700003600.000000)",
        "(4102444800.000000)",
    ] {
        for at in [0, 1, 200, 398, 399] {
            let changed = text.replace(&stamp(at), other);
            let (found, report) = read(changed.as_bytes());
            // Of the last frame, and of an early one within the hour, nobody knows.
            let is_open =
                at == 399 && !other.starts_with("(0") || at == 0 && !other.starts_with("(0");
            if is_open {
                assert!(found.len() >= 399, "{other} at {at}");
                continue;
            }
            assert_eq!(found.len(), 399, "{other} at {at}: {:?}", report.damage);
            assert!(
                found.iter().all(|timed| whole.contains(timed)),
                "{other} at {at}"
            );
            assert_eq!(report.damage.lines, 1, "{other} at {at}");
        }
    }
}

#[test]
fn one_stamp_that_is_seconds_ahead_costs_its_frame_only() {
    let stamp = |k: u64| format!("({}.{:06})", 1_700_000_000 + k / 10, k % 10 * 100_000);
    let text: String = (0..400)
        .map(|k| format!("{} can0 {:03X}#{:02X}\n", stamp(k), 0x100 + k % 7, k % 256))
        .collect();
    let whole = read(text.as_bytes()).0;
    for at in [10, 200, 380] {
        for ahead in [15, 50, 300, 590] {
            let changed = text.replace(&stamp(at), &stamp(at + ahead));
            let (found, report) = read(changed.as_bytes());
            assert_eq!(found.len(), 399, "{ahead} at {at}: {report:?}");
            assert!(
                found.iter().all(|timed| whole.contains(timed)),
                "{ahead} at {at}"
            );
            assert_eq!(report.damage.lines, 1, "{ahead} at {at}");
        }
    }
}

#[test]
fn negative_times_are_moved_to_begin_with_zero_in_every_format() {
    let seconds = |k: i64| {
        let micros = -1_000_000 + 100_000 * k;
        let sign = if micros < 0 { "-" } else { "" };
        let micros = micros.unsigned_abs();
        format!("{sign}{}.{:06}", micros / 1_000_000, micros % 1_000_000)
    };
    let asc = |k: i64| format!("   {} 1  18FEF100x       Rx   d 1 {k:02X}\n", seconds(k));
    let candump = |k: i64| format!("({}) can0 18FEF100#{k:02X}\n", seconds(k));
    let trc = |k: i64| format!("{k:6}) {:9}  18FEF100  1  {k:02X}\n", -1000 + 100 * k);
    let savvy = |k: i64| {
        format!(
            "{},18FEF100,true,Rx,0,1,{k:02X},\n",
            -1_000_000 + 100_000 * k
        )
    };
    let python = |k: i64| {
        use base64::Engine;
        let data = base64::engine::general_purpose::STANDARD.encode([k as u8]);
        format!("{:.6},0x18fef100,1,0,0,1,{data}\n", -1.0 + 0.1 * k as f64)
    };
    let expected: Vec<TimedFrame> = (0..40)
        .map(|k| frame(100 * k, 0x18FE_F100, &[k as u8]))
        .collect();
    let lines = |head: &str, line: &dyn Fn(i64) -> String| {
        head.to_owned() + &(0..40).map(line).collect::<String>()
    };
    let date = "date Sun Nov 22 10:00:00.000 am 2026\nbase hex  timestamps absolute\n";
    for text in [
        lines(date, &asc),
        lines("", &candump),
        lines(";   a trace\n", &trc),
        lines("Time Stamp,ID,Extended,Dir,Bus,LEN,D1\n", &savvy),
        lines(
            "timestamp,arbitration_id,extended,remote,error,dlc,data\n",
            &python,
        ),
    ] {
        let (found, report) = read(text.as_bytes());
        assert!(found == expected, "{text}");
        assert_eq!(
            report.mended,
            ["times begin at -1.000000 s; moved to begin with zero"]
        );
        if text.starts_with("date") {
            let start = report.start_utc.as_deref();
            assert_eq!(start, Some("2026-11-22T09:59:59Z"));
        }
    }
}
