//! Damage within gzip and Zstandard data: what is before it is used, and what is in later members.

use super::frame;
use super::writers::{FORMATS, candump};
use crate::packed::gzip;
use host_sim::source::can_frame::TimedFrame;
use host_sim::source::damage::Damage;
use host_sim::source::log::Log;
use host_sim::source::read_options::ReadOptions;
use ruzstd::encoding::{CompressionLevel, compress_to_vec};
use std::fs;
use tempfile::TempDir;

/// Frames, or the rows of a table; and what was left out.
fn read(content: &[u8], strict: bool) -> Result<(Vec<TimedFrame>, usize, Damage), String> {
    let folder = TempDir::new().expect("a temporary folder");
    let path = folder.path().join("drive");
    fs::write(&path, content).expect("a temporary file");
    let options = ReadOptions {
        strict,
        ..ReadOptions::default()
    };
    let mut log = Log::open(&path, &options).map_err(|e| e.to_string())?;
    let (mut frames, mut rows) = (Vec::new(), 0);
    match &mut log {
        Log::Frames(log) => {
            while let Some(frame) = log.next_frame().map_err(|e| e.to_string())? {
                frames.push(frame);
            }
        }
        Log::Table(table) => {
            while table.next_row().map_err(|e| e.to_string())?.is_some() {
                rows += 1;
            }
        }
        Log::Parquet(_) | Log::Signals(_) => unreachable!("no table in Parquet, nor MDF"),
    }
    Ok((frames, rows, log.report().damage))
}

fn many_frames() -> Vec<TimedFrame> {
    (0..9_000_u64)
        .map(|k| {
            let noise = k.wrapping_mul(0x9E37_79B9_7F4A_7C15).to_le_bytes();
            frame(k, 0x18FE_F100, &noise)
        })
        .collect()
}

fn zstd(content: &[u8]) -> Vec<u8> {
    compress_to_vec(content, CompressionLevel::Fastest)
}

type Pack = fn(&[u8]) -> Vec<u8>;
const PACKINGS: [(&str, Pack); 2] = [("gzip", gzip), ("zstd", zstd)];

/// Packs three parts of a log, and damages the middle of the second one.
fn damaged_in_three(content: &[u8], pack: Pack) -> Vec<u8> {
    let parts = content.chunks(content.len().div_ceil(3));
    let mut members: Vec<Vec<u8>> = parts.map(pack).collect();
    spoil(&mut members[1]);
    members.concat()
}

fn spoil(member: &mut [u8]) {
    let middle = member.len() / 2;
    member[middle..middle + 600].fill(0xff);
}

#[test]
fn a_damaged_member_is_used_up_to_the_damage_and_the_next_one_is_read() {
    let frames = many_frames();
    for (name, write) in FORMATS {
        for (packing, pack) in PACKINGS {
            let packed = damaged_in_three(&write(&frames), pack);
            let words = format!("{name} in {packing}");
            let (found, _, damage) = match read(&packed, false) {
                // What stands behind the damage may be too much of another kind of damage.
                Err(message) if name.starts_with("blf") => {
                    assert!(message.contains("more than 1 %"), "{words}: {message}");
                    continue;
                }
                read => read.expect(&words),
            };
            // A log with times since the line before has lost those in between.
            let is_relative = name.contains("relative");
            let part = frames.len() / 3;
            let is_known = |found: &&TimedFrame| !frames.contains(found);
            let wrong = found.iter().filter(is_known).count();
            assert!(is_relative || wrong == 0, "{words}: {wrong} wrong frames");
            assert!(found.len() > 2 * part - 20, "{words}: {}", found.len());
            assert!(found.len() < frames.len() - 100, "{words}: {}", found.len());
            assert!(
                damage.blocks >= 1 && damage.bytes > 0,
                "{words}: {damage:?}"
            );
            let strict = read(&packed, true).expect_err(&words);
            assert!(strict.starts_with('/'), "{strict}");
        }
    }
}

#[test]
fn damage_in_the_only_member_ends_the_log_there() {
    let frames = many_frames();
    for (packing, pack) in PACKINGS {
        let mut packed = pack(&candump(&frames));
        spoil(&mut packed);
        let (found, _, damage) = read(&packed, false).expect(packing);
        assert_eq!(found, frames[..found.len()], "{packing}");
        assert!(found.len() > frames.len() / 4, "{packing}: {}", found.len());
        assert_eq!(damage.blocks, 1, "{packing}: {damage:?}");
        let words = format!("the {packing} data are damaged at byte ");
        assert!(damage.first[0].contains(&words), "{damage:?}");
    }
}

#[test]
fn a_wrong_checksum_is_told_and_nothing_is_lost() {
    let frames = many_frames();
    let (first, second) = frames.split_at(4_000);
    let mut packed = gzip(&candump(first));
    let checksum = packed.len() - 8;
    packed[checksum] ^= 1;
    let members = [&packed[..], &gzip(&candump(second))].concat();
    let (found, _, damage) = read(&members, false).expect("a log");
    assert_eq!(found, frames);
    assert!(damage.blocks == 1 && damage.lines == 0, "{damage:?}");
}

#[test]
fn a_packed_table_and_a_packed_mdf_file_are_used_up_to_the_damage() {
    let rows: String = (0..9_000_u32)
        .map(|k| format!("{}.5,{}\n", k, f64::from(k).sin().abs()))
        .collect();
    let table = format!("time_s,wheel_speed_mps\n{rows}");
    for (packing, pack) in PACKINGS {
        let packed = damaged_in_three(table.as_bytes(), pack);
        let (_, rows, damage) = read(&packed, false).expect(packing);
        assert!((6_000..8_990).contains(&rows), "{packing}: {rows}");
        assert!(damage.blocks == 1 && damage.lines <= 2, "{damage:?}");
    }
    let frames = super::formats::of_mdf(&many_frames());
    let mdf = test_kit::mdf::mdf(
        &frames,
        test_kit::mdf::MdfBlocks::Plain,
        test_kit::mdf::MdfData::InRecord,
    );
    let packed = damaged_in_three(&mdf, gzip);
    let (found, _, damage) = read(&packed, false).expect("a part");
    assert!((3_000..6_000).contains(&found.len()), "{}", found.len());
    assert!(damage.blocks == 1 && damage.cut_off, "{damage:?}");
}

#[test]
fn skippable_frames_of_zstandard_pass_by() {
    let frames = many_frames();
    let content = candump(&frames);
    let skippable = [&[0x5a, 0x2a, 0x4d, 0x18, 5, 0, 0, 0][..], b"12345"].concat();
    let packed = [&skippable[..], &zstd(&content), &skippable].concat();
    let (found, _, damage) = read(&packed, false).expect("a log");
    assert_eq!(found, frames);
    assert!(damage.is_none(), "{damage:?}");
}
