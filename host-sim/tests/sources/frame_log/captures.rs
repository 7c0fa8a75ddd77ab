//! Packet captures with frames of SocketCAN.

use super::formats::of_mdf;
use super::{frame, read, read_as, some_frames};
use crate::packed::gzip;
use embedded_can::Frame;
use host_sim::files::log_format::LogFormat;
use host_sim::source::can_frame::TimedFrame;
use host_sim::source::damage::Damage;
use host_sim::source::frame_log::Skipped;
use host_sim::source::log::Log;
use host_sim::source::log_kind::LogKind;
use host_sim::source::read_options::ReadOptions;
use std::collections::BTreeSet;
use std::fs;
use tempfile::TempDir;
use test_kit::mdf::MdfFrame;
use test_kit::pcap::{COOKED, Pcap, PcapForm, SOCKET_CAN, pcap_forms};

const PLAIN: Pcap = Pcap {
    form: PcapForm::Records { is_nano: false },
    is_big_endian: false,
    link: SOCKET_CAN,
};
const BLOCKS: Pcap = Pcap {
    form: PcapForm::Blocks {
        resolution: 6,
        offset_s: 0,
    },
    ..PLAIN
};

/// Returns frames of every length, from a time after 1000 s on, and none that is remote.
fn data_frames() -> Vec<TimedFrame> {
    let mut frames = some_frames();
    frames.retain(|timed| !timed.frame.is_remote_frame());
    for timed in &mut frames {
        let micros = timed.time.micros() + 1_000_000_000;
        timed.time = estimator_core::Instant::from_micros(micros);
    }
    frames
}

fn many_frames() -> Vec<TimedFrame> {
    let noise = |k: u64| k.wrapping_mul(0x9E37_79B9_7F4A_7C15).to_le_bytes();
    (0..3000)
        .map(|k| frame(2_000_000 + k, 0x18FE_F100, &noise(k)))
        .collect()
}

fn damage_of(content: &[u8]) -> (Vec<TimedFrame>, Damage) {
    let folder = TempDir::new().expect("a temporary folder");
    let path = folder.path().join("drive");
    fs::write(&path, content).expect("a temporary file");
    let mut log = Log::open(&path, &ReadOptions::default()).expect("a log");
    let Log::Frames(reader) = &mut log else {
        panic!("no frames");
    };
    let frames = reader.by_ref().map(|timed| timed.expect("little damage"));
    (frames.collect(), log.report().damage)
}

#[test]
fn every_form_gives_the_same_frames() {
    let frames = data_frames();
    let expected = Ok((
        LogKind::Frames(LogFormat::Pcap),
        frames.clone(),
        Skipped::default(),
    ));
    for form in pcap_forms() {
        let file = form.file(&of_mdf(&frames));
        for name in ["drive", "drive.pcap", "drive.csv"] {
            assert_eq!(read_as(name, &file), expected, "{form:?}");
        }
        assert_eq!(read(&gzip(&file)), expected, "{form:?}");
    }
}

#[test]
fn a_capture_that_is_cut_off_is_used_up_to_there() {
    let frames = many_frames();
    for form in pcap_forms() {
        let file = form.file(&of_mdf(&frames));
        for cut in (file.len() / 2..file.len()).step_by(file.len() / 7) {
            let (part, damage) = damage_of(&file[..cut]);
            assert!(
                part.len() > 1000 && part == frames[..part.len()],
                "{form:?}"
            );
            assert!(damage.cut_off || damage.is_none(), "{form:?}: {damage:?}");
        }
    }
}

#[test]
fn a_damaged_packet_costs_itself() {
    let mut frames = many_frames();
    frames.truncate(900);
    let known: BTreeSet<&[u8]> = frames.iter().map(|timed| timed.frame.data()).collect();
    for form in pcap_forms() {
        let whole = form.file(&of_mdf(&frames));
        let record = form.record(0, 1, &form.packet(&of_mdf(&frames)[0])).len();
        let at = form.header().len() + 700 * record;
        // Each byte of a packet and of its header.
        for byte in at..at + record {
            let mut file = whole.clone();
            file[byte] ^= 0xff;
            let (found, damage) = damage_of(&file);
            // Not by time: a stamp that is ahead by seconds is for the clock of all formats.
            let others = found
                .iter()
                .filter(|timed| !known.contains(timed.frame.data()));
            assert!(others.count() <= 1, "{form:?} at {}", byte - at);
            assert!(found.len() > 890, "{form:?} at {}: {damage:?}", byte - at);
        }
        // Bytes that are lost or are too many.
        for change in [3, 16] {
            let mut file = whole.clone();
            file.drain(at + 5..at + 5 + change);
            assert!(damage_of(&file).0.len() > 890, "{form:?}");
            let mut file = whole.clone();
            file.splice(at + 5..at + 5, vec![0xa5; change]);
            assert!(damage_of(&file).0.len() > 890, "{form:?}");
        }
    }
}

#[test]
fn frames_of_other_kinds_are_counted() {
    let ids = [
        (0x0c, 0x8CF0_0400_u32, 12_u8, 0_u8, 12),
        (0x0d, 0x8CF0_0400, 8, 4, 64),
        (0x0e, 0, 0x80, 0, 60),
        (0x0c, 0x2000_0004, 8, 0, 8),
    ];
    for form in pcap_forms() {
        let mut file = form.file(&of_mdf(&many_frames()));
        for (protocol, id, length, flags, bytes) in ids {
            let packet = form.packet_of(id, protocol, length, flags, &vec![1; bytes]);
            file.extend(form.record(2_003_000_000, 1, &packet));
        }
        let mut expected = Skipped {
            can_fd: 2,
            can_xl: 1,
            bus_errors: 1,
            ..Skipped::default()
        };
        if form.link != SOCKET_CAN {
            let packet = form.packet_of(0, 0x0800, 5, 0, &[1; 40]);
            file.extend(form.record(2_003_000_000, 1, &packet));
            expected.foreign = 1;
        }
        let (_, frames, skipped) = read(&file).expect("a log");
        assert!(
            frames == many_frames() && skipped == expected,
            "{form:?}: {skipped:?}"
        );
    }
    // Old writers do not mark CAN FD: the size tells.
    let unmarked = PLAIN.packet_of(0x8CF0_0400, 0, 8, 0, &[1; 64]);
    let remote = PLAIN.packet_of(0xCCF0_0400, 0, 3, 0, &[0; 8]);
    let file = [
        PLAIN.header(),
        PLAIN.record(1_000, 1, &unmarked),
        PLAIN.record(2_000, 1, &remote),
    ];
    let (_, frames, skipped) = read(&file.concat()).expect("a log");
    assert!(frames.len() == 1 && frames[0].frame.is_remote_frame() && skipped.can_fd == 1);
}

#[test]
fn a_capture_of_can_fd_says_what_is_not_read() {
    let packet = BLOCKS.packet_of(0x8CF0_0400, 0, 64, 4, &[1; 64]);
    let file = [BLOCKS.header(), BLOCKS.record(1_000, 1, &packet)].concat();
    let message = read(&file).expect_err("no classic frame");
    assert!(
        message.contains("no classic CAN frame among 1 CAN FD frames"),
        "{message}"
    );
    assert!(message.contains("J1939-22, is not read"), "{message}");
}

#[test]
fn interfaces_have_the_names_of_the_capture() {
    let of_two = |k: u64| MdfFrame {
        micros: 1_000_000 * k,
        bus: 1 + (k % 2) as u8,
        id: 0x0CF0_0400 + (k % 2) as u32,
        is_extended: true,
        data: vec![0; 8],
    };
    let frames: Vec<MdfFrame> = (1..20).map(of_two).collect();
    let names = |form: Pcap| {
        let folder = TempDir::new().expect("a temporary folder");
        let path = folder.path().join("drive");
        fs::write(&path, form.file(&frames)).expect("a temporary file");
        let mut log = Log::open(&path, &ReadOptions::default()).expect("a log");
        let Log::Frames(reader) = &mut log else {
            panic!("no frames");
        };
        while reader.next_frame().expect("a log").is_some() {}
        let names = log.report().interfaces.into_iter().map(|count| count.name);
        names.collect::<Vec<String>>()
    };
    assert_eq!(names(BLOCKS), ["can1", "can2"]);
    assert_eq!(names(PLAIN), ["can0"]);
    let cooked = Pcap {
        link: test_kit::pcap::COOKED_2,
        ..PLAIN
    };
    assert_eq!(names(cooked), ["if3"]);
}

#[test]
fn captures_of_other_networks_are_refused() {
    for (link, words) in [
        (1, "of Ethernet (link type 1), without frames of a CAN bus"),
        (220, "of USB (link type 220)"),
        (9999, "of (link type 9999)"),
    ] {
        for form in [PLAIN, BLOCKS] {
            let form = Pcap { link, ..form };
            let content = [form.header(), form.record(1000, 1, &[0; 60])].concat();
            let message = read_as("drive.log", &content).expect_err(words);
            assert!(
                message.starts_with("drive.log: is a packet capture (PCAP)"),
                "{message}"
            );
            assert!(message.contains(words), "{message}");
        }
    }
    let cooked = Pcap {
        link: COOKED,
        ..PLAIN
    };
    let packet = cooked.packet_of(0, 0x0800, 0, 0, &[0; 60]);
    let content = [cooked.header(), cooked.record(1000, 1, &packet)].concat();
    let message = read(&content).expect_err("no bus");
    assert!(
        message.contains("among 1 messages of other networks"),
        "{message}"
    );
}

#[test]
fn captures_behind_one_another_are_one_log() {
    let frames = many_frames();
    for form in pcap_forms() {
        let [first, second] =
            [&frames[..1000], &frames[1000..]].map(|part| form.file(&of_mdf(part)));
        let (_, found, _) = read(&[first, second].concat()).expect("a log");
        assert!(found == frames, "{form:?}");
    }
}

#[test]
fn damaged_headers_are_refused() {
    for form in [PLAIN, BLOCKS] {
        let file = form.file(&of_mdf(&many_frames()));
        assert!(read(&file[..20]).is_err());
        assert!(read(&[&file[..8], &[0; 100]].concat()).is_err());
    }
    // An interface whose description is damaged would give its number to the next one.
    let mut file = BLOCKS.file(&of_mdf(&many_frames()));
    file[28 + 5] ^= 0xff;
    let message = read(&file).expect_err("a damaged interface");
    assert!(
        message.contains("a damaged description of an interface"),
        "{message}"
    );
}

#[test]
fn a_packet_that_is_cut_or_without_a_time_is_damaged() {
    let frames = of_mdf(&many_frames());
    let short = PLAIN.packet_of(0x8CF0_0400, 0, 8, 0, &[1; 3]);
    let file = [PLAIN.file(&frames), PLAIN.record(2_003_000_000, 1, &short)].concat();
    let (found, damage) = damage_of(&file);
    assert_eq!((found.len(), damage.lines), (3000, 1));
    assert!(
        damage.first[0].contains("a packet shorter than its frame"),
        "{damage:?}"
    );
    let simple = BLOCKS.block(3, &[&8_u32.to_le_bytes()[..], &[0; 16]].concat());
    let statistics = BLOCKS.block(5, &[0; 12]);
    let comment = BLOCKS.block(0x0bad, &[0; 16]);
    let file = [BLOCKS.file(&frames), simple, statistics, comment].concat();
    let (found, damage) = damage_of(&file);
    assert_eq!((found.len(), damage.lines, damage.blocks), (3000, 1, 0));
    assert!(damage.first[0].contains("which has no time"), "{damage:?}");
}
