//! Layouts of MDF: constants, conversions, marks of what is invalid.

use super::formats::of_mdf;
use super::{frame, read};
use host_sim::files::log_format::LogFormat;
use host_sim::source::can_frame::TimedFrame;
use host_sim::source::frame_log::Skipped;
use host_sim::source::log_kind::LogKind;
use std::fs;
use std::path::Path;
use test_kit::mdf::{MDF_FORMS, MdfBlocks, MdfData, mdf};

/// Where the data of a channel and those of a channel group begin, bytes from the block.
const OF_CHANNEL: usize = 24 + 8 * 8;
const OF_GROUP: usize = 24 + 8 * 6;

fn frames(count: u64) -> Vec<TimedFrame> {
    (0..count)
        .map(|k| {
            frame(
                k,
                0x18FE_F100,
                &[k as u8, 2, 3, 4, 5, 6, 7, (k % 3 == 0).into()],
            )
        })
        .collect()
}

fn put(file: &mut [u8], at: usize, bytes: &[u8]) {
    file[at..at + bytes.len()].copy_from_slice(bytes);
}

/// Returns the blocks of a kind.
fn blocks(file: &[u8], id: &[u8]) -> Vec<usize> {
    memchr::memmem::find_iter(file, id).collect()
}

/// Gives a channel a conversion.
fn convert(file: &mut Vec<u8>, channel: usize, kind: u8, values: &[f64]) {
    file.resize(file.len().next_multiple_of(8), 0);
    let at = file.len();
    let mut block = b"##CC\0\0\0\0".to_vec();
    block.extend((24 + 32 + 24 + 8 * values.len() as u64).to_le_bytes());
    block.extend(4_u64.to_le_bytes());
    block.extend([0; 32]);
    block.extend([kind, 0, 0, 0, 0, 0]);
    block.extend((values.len() as u16).to_le_bytes());
    block.extend([0; 16]);
    block.extend(values.iter().flat_map(|value| value.to_le_bytes()));
    file.extend(block);
    put(file, channel + 24 + 8 * 4, &(at as u64).to_le_bytes());
}

/// Makes a channel the same constant in all records.
fn make_constant(file: &mut Vec<u8>, channel: usize, value: f64) {
    put(file, channel + OF_CHANNEL, &[6]);
    put(file, channel + OF_CHANNEL + 4, &[0; 8]);
    convert(file, channel, 1, &[value, 0.0]);
}

#[test]
fn constants_and_tables_give_the_parts_of_frames() {
    let frames = frames(100);
    for data in [MdfData::InRecord, MdfData::SignalData] {
        let mut file = mdf(&of_mdf(&frames), MdfBlocks::Plain, data);
        let channels = blocks(&file, b"##CN");
        // In the order in which the kit writes them: data, length, IDE, ID, bus.
        make_constant(&mut file, channels[2], 1.0);
        make_constant(&mut file, channels[4], 2.0);
        let lengths: Vec<f64> = (0..=8).flat_map(|k| [f64::from(k); 2]).collect();
        convert(&mut file, channels[1], 5, &lengths);
        assert_eq!(
            read(&file),
            Ok((
                LogKind::Frames(LogFormat::Mdf),
                frames.clone(),
                Skipped::default()
            ))
        );
        // Identifiers of 29 bits without their mark are none: refused, not taken for others.
        let mut standard = mdf(&of_mdf(&frames), MdfBlocks::Plain, data);
        make_constant(&mut standard, channels[2], 0.0);
        let message = read(&standard).expect_err("wrong identifiers");
        assert!(message.contains("a frame without its data"), "{message}");
        // A length that the table lacks.
        let mut other = mdf(&of_mdf(&frames), MdfBlocks::Plain, data);
        convert(&mut other, channels[1], 5, &[1.0, 1.0]);
        let message = read(&other).expect_err("no length");
        assert!(message.contains("a record without its fields"), "{message}");
    }
}

#[test]
fn records_that_are_marked_as_invalid_are_left_out_and_counted() {
    let frames = frames(90);
    let mut file = mdf(&of_mdf(&frames), MdfBlocks::Plain, MdfData::InRecord);
    // The last byte of each record has the mark of the data: set in each third.
    let group = *blocks(&file, b"##CG").last().expect("a group");
    let bytes = file[group + OF_GROUP + 24];
    put(&mut file, group + OF_GROUP + 24, &[bytes - 1]);
    put(&mut file, group + OF_GROUP + 28, &[1]);
    let data = blocks(&file, b"##CN")[0];
    put(&mut file, data + OF_CHANNEL + 12, &[2, 0, 0, 0, 0, 0, 0, 0]);
    let valid: Vec<TimedFrame> = frames
        .iter()
        .enumerate()
        .filter(|(k, _)| k % 3 != 0)
        .map(|(_, frame)| *frame)
        .collect();
    let skipped = Skipped {
        invalid: 30,
        ..Skipped::default()
    };
    assert_eq!(
        read(&file),
        Ok((LogKind::Frames(LogFormat::Mdf), valid, skipped))
    );
    // A channel of which nothing is valid, in every form of data.
    for (forms, data) in MDF_FORMS {
        let mut file = mdf(&of_mdf(&frames), forms, data);
        let channel = blocks(&file, b"##CN")[3];
        put(&mut file, channel + OF_CHANNEL + 12, &[1]);
        let message = read(&file).expect_err("nothing is valid");
        let words = "no classic CAN frame among 90 records marked as invalid";
        assert!(message.contains(words), "{forms:?} {data:?}: {message}");
    }
}

#[test]
fn a_compressed_block_that_is_cut_off_is_used_up_to_there() {
    let noise = |k: u64| k.wrapping_mul(0x9E37_79B9_7F4A_7C15).to_le_bytes();
    let frames: Vec<TimedFrame> = (0..3000)
        .map(|k| frame(k, 0x18FE_F100, &noise(k)))
        .collect();
    for forms in [MdfBlocks::Deflated, MdfBlocks::Zstd, MdfBlocks::Lz4] {
        let file = mdf(&of_mdf(&frames), forms, MdfData::InRecord);
        // Lists of the kit stand behind their blocks; the link of the group is to a block here.
        let starts = blocks(&file, b"##DZ");
        let group = *blocks(&file, b"##DG").last().expect("a group");
        let mut file = file[..starts[1] - 200].to_vec();
        put(
            &mut file,
            group + 24 + 16,
            &(starts[0] as u64).to_le_bytes(),
        );
        let found = read(&file).map(|(_, found, _)| found).unwrap_or_default();
        assert!(found == frames[..found.len()], "{forms:?}");
        if forms == MdfBlocks::Deflated {
            assert!(found.len() > 900, "{}", found.len());
        }
    }
}

/// Frames of a file, as an independent reader of a few lines counted them.
#[test]
fn recordings_of_newer_loggers_are_read_whole() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/data/canedge");
    for (name, expected, extended) in [
        ("fw0107_ev_1", 4_024, 0),
        ("fw0107_truck_or_bus_standing", 150_411, 139_136),
        ("fw0108_car_27km", 72_009, 0),
    ] {
        let path = root.join(name).with_extension("MF4");
        let Ok(content) = fs::read(&path) else {
            eprintln!("SKIPPED: there is no {}", path.display());
            continue;
        };
        let (_, frames, skipped) = read(&content).expect(name);
        assert_eq!(
            (frames.len(), skipped),
            (expected, Skipped::default()),
            "{name}"
        );
        let is_extended = |timed: &&TimedFrame| embedded_can::Frame::is_extended(&timed.frame);
        assert_eq!(
            frames.iter().filter(is_extended).count(),
            extended,
            "{name}"
        );
        assert!(frames.is_sorted_by_key(|timed| timed.time), "{name}");
    }
}
