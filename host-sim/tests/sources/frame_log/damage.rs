//! Logs that are cut off, damaged, or of formats that are not read.

use super::writers::{
    FORMATS, asc_header, blf, blf_container, blf_header, blf_object, blf_objects, blf_time,
    trc_header, zlib,
};
use super::{frame, read, read_as, some_frames};
use crate::packed::gzip;

#[test]
fn a_log_that_is_cut_off_is_used_up_to_there() {
    let frames = some_frames();
    for (name, write) in FORMATS {
        let whole = write(&frames);
        let mut found = 0;
        let last = whole.len() - 1;
        for cut in (5..last).step_by(11).chain([last]) {
            match read(&whole[..cut]) {
                Ok((_, part, _)) => {
                    assert_eq!(part, frames[..part.len()], "{name} at {cut}");
                    assert!(part.len() >= found, "{name} at {cut}");
                    found = part.len();
                }
                Err(message) => {
                    assert_eq!(found, 0, "{name} at {cut}: {message}");
                    // What is left may tell no format.
                    let is_told =
                        ["; expected a", "; known are "].map(|words| message.contains(words));
                    assert!(is_told.contains(&true), "{name} at {cut}: {message}");
                }
            }
        }
        assert!(found >= frames.len() - 1, "{name}: {found}");
    }
}

#[test]
fn a_gzip_log_that_is_cut_off_is_used_up_to_there() {
    let frames = some_frames();
    for (name, write) in FORMATS {
        let whole = write(&frames);
        // Two members, as a rotating logger writes them.
        let (first, second) = whole.split_at(whole.len() / 2);
        let members = [gzip(first), gzip(second)];
        let packed = members.concat();
        for cut in (1..packed.len()).step_by(5) {
            match read(&packed[..cut]) {
                Ok((_, part, _)) => assert_eq!(part, frames[..part.len()], "{name} at {cut}"),
                Err(message) => {
                    let is_told = ["expected", "; known are "].map(|words| message.contains(words));
                    assert!(is_told.contains(&true), "{name}: {message}");
                }
            }
        }
        let (_, part, _) = read(&packed[..members[0].len() + 5]).expect(name);
        assert!(!part.is_empty(), "{name}");
    }
}

#[test]
fn no_damaged_byte_makes_the_reader_panic() {
    let frames = &some_frames()[6..9];
    for (_, write) in FORMATS {
        let whole = write(frames);
        for at in (0..whole.len()).step_by(9) {
            for flip in [0x01, 0xff] {
                let mut damaged = whole.clone();
                damaged[at] ^= flip;
                if let Err(message) = read(&damaged) {
                    assert!(message.starts_with("drive:"), "{message}");
                }
            }
        }
    }
}

#[test]
fn wrong_lines_of_asc_are_named_with_what_was_expected() {
    for (line, what) in [
        ("1.x 1  CF00400x Rx d 1 01", "no time"),
        ("1.0 1  Enginex Rx d 1 01", "no CAN identifier"),
        ("1.0 1  800 Rx d 1 01", "no CAN identifier"),
        ("1.0 1  20000000x Rx d 1 01", "no CAN identifier"),
        ("1.0 1  123 Rx d x 01", "no data length"),
        ("1.0 1  123 Rx d 2 01", "fewer data than the length"),
        ("1.0 1  123 Rx d 2 01 100", "no byte of data"),
        ("base oct", "no such base"),
        ("\0\0\0", "binary data"),
        (
            "0.5 1  123 Rx d 1 01",
            "time runs backwards, from 1.000000 s to 0.500000 s",
        ),
    ] {
        let text = asc_header(16, false) + "   1.0 1  123 Rx d 1 01\n" + line + "\n";
        let message = read(text.as_bytes()).expect_err(line);
        assert!(
            message.starts_with(&format!("drive:8: {what}")),
            "{message}"
        );
        assert!(message.contains("; expected "), "{message}");
    }
}

#[test]
fn wrong_lines_of_trc_are_named_with_what_was_expected() {
    for (line, what) in [
        ("2 x DT 1 0123 Rx - 1 01", "no time"),
        ("2 1.0 XX 1 0123 Rx - 1 01", "no type of message"),
        ("2 1.0 DT 1 012345678 Rx - 1 01", "no CAN identifier"),
        ("2 1.0 DT 1 0800 Rx - 1 01", "no CAN identifier"),
        ("2 1.0 DT 1 0123 Rx - 1786 01", "no data length"),
        ("2 1.0 DT 1 0123 Rx - 2 01", "fewer data than the length"),
        ("2 1.0 DT 1 0123 Rx - 1 0x", "no byte of data"),
    ] {
        let text = trc_header("2.1") + line + "\n";
        let message = read(text.as_bytes()).expect_err(line);
        assert!(
            message.starts_with(&format!("drive:7: {what}")),
            "{message}"
        );
        assert!(message.contains("; expected "), "{message}");
    }
    let new = read(b";$FILEVERSION=9.7\n").expect_err("9.7");
    assert!(
        new.contains("`;$FILEVERSION=9.7`; expected 1.0 to 1.3, 2.0 or 2.1"),
        "{new}"
    );
}

#[test]
fn wrong_objects_of_blf_are_named_with_what_was_expected() {
    let objects = blf_objects(&[frame(1, 0x0CF0_0400, &[1])]);
    let in_file = |tail: Vec<u8>| [blf_header(), tail].concat();
    let mut wrong_id = objects.clone();
    wrong_id[39] = 0;
    let mut wrong_unit = objects.clone();
    wrong_unit[16] = 7;
    let mut damaged = zlib(&objects);
    let last = damaged.len() - 1;
    damaged[last] ^= 1;
    let size = objects.len() as u32;
    for (content, what) in [
        (in_file(vec![0; 64]), "no object behind the one before"),
        (blf(&[7; 64], 2), "no object behind the one before"),
        (blf(&wrong_id, 0), "an identifier with too many bits"),
        (blf(&wrong_unit, 0), "an unknown unit of time"),
        (
            blf(&blf_object(1, 32, &blf_time(true, 0)), 0),
            "an object shorter than its type",
        ),
        (
            in_file(blf_container(2, size, &damaged)),
            "damaged zlib data",
        ),
        (
            in_file(blf_container(2, 1 << 30, &zlib(&objects))),
            "a container of 1073741824 bytes",
        ),
        (
            in_file(blf_container(9, size, &objects)),
            "compression method 9",
        ),
    ] {
        let message = read(&content).expect_err(what);
        assert!(message.contains(what), "{message}");
        assert!(message.contains(", in the object at byte "), "{message}");
    }
    let none = read(&blf_header()).expect_err("no frames");
    assert!(
        none.contains("no frames; expected a Vector BLF log"),
        "{none}"
    );
}

#[test]
fn packed_recordings_of_a_canedge_are_named_by_their_extension() {
    for name in ["00000001.MFC", "00000001.mfe", "00000001.MFM"] {
        let message = read_as(name, &[0x8f; 100]).expect_err(name);
        assert!(
            message.starts_with(&format!("{name}: is a compressed or encrypted")),
            "{message}"
        );
    }
}

#[test]
fn formats_that_are_not_read_are_named() {
    for (start, words) in [
        (&b"PK\x03\x04"[..], "is a zip archive; unpack it first"),
        (b"MDF     3.30", "ASAM MDF 3"),
        (
            b"SQLite format 3\0",
            "`can_logconvert` to .blf, .asc or .log",
        ),
        (b"\xfd7zXZ\0", "xz"),
        (
            b"Generic File",
            "`mdf2finalized` of CSS Electronics makes .MF4",
        ),
    ] {
        let content = [start, &[0; 100]].concat();
        for name in ["drive.log", "drive.csv"] {
            for content in [&content, &gzip(&content)] {
                let message = read_as(name, content).expect_err(words);
                assert!(message.starts_with(&format!("{name}: is ")), "{message}");
                assert!(message.contains(words), "{message}");
            }
        }
    }
}
