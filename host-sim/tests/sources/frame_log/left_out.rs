//! Damage within logs: what is left out, what is told, and what is refused.

use super::writers::{FORMATS, asc_header, blf_container, blf_header, blf_objects, candump, zlib};
use super::{frame, read};
use host_sim::source::can_frame::TimedFrame;
use host_sim::source::damage::Damage;
use host_sim::source::log::Log;
use host_sim::source::read_options::ReadOptions;
use predicates::prelude::*;
use std::fs;
use tempfile::TempDir;
use test_kit::command::program;

fn read_with(content: &[u8], options: &ReadOptions) -> Result<(Vec<TimedFrame>, Damage), String> {
    let folder = TempDir::new().expect("a temporary folder");
    let path = folder.path().join("drive");
    fs::write(&path, content).expect("a temporary file");
    let mut log = Log::open(&path, options).map_err(|e| e.to_string())?;
    let Log::Frames(reader) = &mut log else {
        return Ok((Vec::new(), Damage::default()));
    };
    let frames: Result<Vec<_>, _> = reader.by_ref().collect();
    Ok((frames.map_err(|e| e.to_string())?, log.report().damage))
}

fn read_damaged(content: &[u8]) -> (Vec<TimedFrame>, Damage) {
    read_with(content, &ReadOptions::default()).expect("a log with little damage")
}

fn strict() -> ReadOptions {
    ReadOptions {
        strict: true,
        ..ReadOptions::default()
    }
}

fn many_frames(count: u64) -> Vec<TimedFrame> {
    let noise = |k: u64| k.wrapping_mul(0x9E37_79B9_7F4A_7C15).to_le_bytes();
    (0..count)
        .map(|k| frame(k, 0x18FE_F100, &noise(k)))
        .collect()
}

#[test]
fn damaged_lines_are_left_out_up_to_one_percent_and_the_first_five_are_told() {
    let frames = many_frames(1000);
    for (name, write) in FORMATS.iter().filter(|(name, _)| !name.starts_with("blf")) {
        let text = String::from_utf8(write(&frames)).expect("text");
        let damaged = |every: usize| {
            let lines = text.lines().enumerate();
            let lines = lines.map(|(k, line)| match k % every {
                20 => line.replace("FE", "#?") + "\n",
                _ => line.to_owned() + "\n",
            });
            lines.collect::<String>()
        };
        let is_touched = damaged(150)
            .lines()
            .filter(|line| line.contains("#?"))
            .count();
        if is_touched < 6 {
            continue; // Decimal numbers, without these letters.
        }
        let (found, damage) = read_damaged(damaged(150).as_bytes());
        assert_eq!(damage.lines as usize, is_touched, "{name}");
        assert_eq!(found.len(), 1000 - is_touched, "{name}");
        assert_eq!(damage.first.len(), 5, "{name}");
        assert!(
            damage.first[0].contains("drive:21: "),
            "{name}: {:?}",
            damage.first
        );
        let message = read_with(damaged(150).as_bytes(), &strict()).expect_err("strict");
        assert!(
            message.starts_with("drive:21: ") || message.contains("/drive:21: "),
            "{message}"
        );
        let message = read(damaged(50).as_bytes()).expect_err("too much");
        assert!(message.starts_with("drive:21: "), "{name}: {message}");
        assert!(
            message.contains("lines are damaged, more than 1 %)"),
            "{name}: {message}"
        );
    }
}

#[test]
fn a_damaged_time_stamp_costs_its_frame_only() {
    let frames = many_frames(500);
    let text = String::from_utf8(candump(&frames)).expect("text");
    let (found, damage) = read_damaged(text.replace("(0.200000)", "(9999999.200000)").as_bytes());
    let mut expected = frames.clone();
    expected.remove(200);
    assert!(found == expected);
    assert_eq!(damage.lines, 1);
    assert!(
        damage.first[0].contains("time jumps from 0.199000 s"),
        "{damage:?}"
    );
    // A silence is none.
    let later = frame(10_000_000, 0x18FE_F100, &[1]);
    let paused = [&frames[..], &[later], &[later]].concat();
    assert_eq!(read_damaged(&candump(&paused)).0, paused);
}

#[test]
fn one_lost_block_of_a_short_blf_is_left_out() {
    let frames = many_frames(600);
    let parts: Vec<Vec<u8>> = frames.chunks(100).map(blf_objects).collect();
    let stream = parts.concat();
    // Blocks end within objects, as those of Vector's programs.
    let containers: Vec<Vec<u8>> = stream
        .chunks(stream.len() / 6 + 5)
        .map(|part| blf_container(2, part.len() as u32, &zlib(part)))
        .collect();
    for (at, flip) in [(0, 0xff), (8, 0x40), (11, 0x7f), (60, 0xff), (200, 0x10)] {
        let mut damaged = containers.clone();
        damaged[2][at] ^= flip;
        let file = [blf_header(), damaged.concat()].concat();
        let (found, damage) = read_damaged(&file);
        assert!((490..600).contains(&found.len()), "{at}: {}", found.len());
        assert!(found.iter().all(|timed| frames.contains(timed)), "{at}");
        assert!(damage.blocks > 0 && !damage.cut_off, "{at}: {damage:?}");
        assert!(read_with(&file, &strict()).is_err(), "{at}");
    }
    let mut damaged = containers;
    for block in [1, 3] {
        damaged[block][100] ^= 0xff;
    }
    let message = read(&[blf_header(), damaged.concat()].concat()).expect_err("two of six");
    assert!(
        message.contains("bytes are damaged, more than 1 %)"),
        "{message}"
    );
}

#[test]
fn an_estimate_tells_what_was_left_out() {
    let folder = TempDir::new().expect("a temporary folder");
    let file = |name: &str| folder.path().join(name);
    let scenario = "[road]\nlength_m = 3000.0\n[[runs]]\nname = \"a\"\ntruck = \"A\"\n";
    fs::write(file("scenario.toml"), scenario).expect("a temporary file");
    let mut simulate = program();
    simulate
        .args(["simulate", "--scenario"])
        .arg(file("scenario.toml"));
    simulate.arg("--out").arg(folder.path()).assert().success();
    let mut log = fs::read(file("a.log")).expect("a log");
    log.truncate(log.len() - 9);
    log.splice(..0, b"(0.000000) can0 hello\n".iter().copied());
    fs::write(file("a.log"), log).expect("a log");
    let estimate = |options: &[&str]| {
        let mut estimate = program();
        estimate
            .args(["estimate", "--json", "--vehicle"])
            .arg(file("a.vehicle.toml"));
        estimate.arg("--out").arg(file("run.csv")).args(options);
        estimate.arg(file("a.log")).assert()
    };
    let told = predicate::str::contains("left out 1 damaged line; used up to where it is cut off");
    let line = predicate::str::contains("a.log:1: no CAN identifier");
    let output = estimate(&[]).success().stderr(told.and(line));
    let json: serde_json::Value =
        serde_json::from_slice(&output.get_output().stdout).expect("JSON");
    assert_eq!(
        (&json["damage"]["lines"], &json["damage"]["cut_off"]),
        (&1.into(), &true.into())
    );
    let refused = predicate::str::contains("a.log:1: no CAN identifier");
    fs::remove_file(file("run.csv")).expect("a run");
    estimate(&["--strict"]).code(1).stderr(refused);
    assert!(!file("run.csv").exists());
}

#[test]
fn a_relative_log_with_a_damaged_header_is_refused() {
    let text = asc_header(10, true).replace("dec", "d\u{1}c") + "   0.1 1  123 Rx d 1 01\n";
    let message = read(text.as_bytes()).expect_err("a damaged header");
    assert!(message.starts_with("drive:2: "), "{message}");
}
