//! Lines that are no classic frames, and frames in other digits.

use super::{error, extended, log, read, standard};
use host_sim::source::frame_log::{FrameLog, Skipped};

#[test]
fn comments_and_text_are_no_damage() {
    let text = b"# a truck, empty\n; logger\n// start in the yard\n\n(1.0) can0 123#01\n\
        a line of text\n (002.000000)  can0  20000088   [8]  00 00 80 19 00 00 00 00   ERRORFRAME\n\
        \tbus-error\n\terror-counter-tx-rx{{128}{0}}\n#(3.0) can0 123#03\n(4.0) can0 123#04\n";
    let log = log("drive.log", text);
    let mut reader = FrameLog::open_candump(&log.path).expect("a log");
    let frames: Vec<_> = reader.by_ref().map(Result::unwrap).collect();
    let expected = [
        standard(1_000_000, 0x123, &[1]),
        standard(4_000_000, 0x123, &[4]),
    ];
    assert_eq!(frames, expected);
    assert!(reader.damage().is_none(), "{:?}", reader.damage());
    assert_eq!(reader.skipped().bus_errors, 1);
}

#[test]
fn an_unknown_text_is_told_with_the_formats_that_are_known() {
    for text in ["hello world\n", "some,table\n1,2\n", "int main() {\n"] {
        let message = error(text.as_bytes());
        let first = text.lines().next().unwrap();
        let words = format!("drive.log: unknown format, begins with `{first}`; known are candump");
        assert!(message.starts_with(&words), "{message}");
    }
}

#[test]
fn binary_digits_and_swapped_bytes_are_read() {
    // candump -i, and candump -S.
    let text = b" (001.000000)  can0  123   [3]  00000001 10000000 11111111\n \
        (002.000000)  can0  0CF00400   [3]  03`02`01\n \
        (003.000000)  can0  123   [1]  00010000\n";
    let frames = [
        standard(1_000_000, 0x123, &[0x01, 0x80, 0xff]),
        extended(2_000_000, 0x0cf0_0400, &[1, 2, 3]),
        standard(3_000_000, 0x123, &[0x10]),
    ];
    assert_eq!(read(text), Ok(frames.to_vec()));
}

#[test]
fn frames_of_other_kinds_are_counted_as_such() {
    let text = b"(1.0) can0 123#01\n\
        (1.1) can0 45123#81:00:12345678#11223344.5566\n\
        (1.2) can0 123###81.00.12345678.11223344\n\
        (001.300000)  can0  45123   [0012]  (81|00|12345678)  11 22 33 44\n\
        (1.4) can0 123#000102030405060708090A0B\n\
        (1.5) can0 123##100\n";
    let log = log("drive.log", text);
    let mut reader = FrameLog::open_candump(&log.path).expect("a log");
    assert_eq!(reader.by_ref().count(), 1);
    let expected = Skipped {
        can_fd: 2,
        can_xl: 3,
        ..Skipped::default()
    };
    assert_eq!(reader.skipped(), expected);
    assert!(reader.damage().is_none(), "{:?}", reader.damage());
}

#[test]
fn microseconds_that_are_not_carried_are() {
    let line = |k: u64| match k % 10 {
        0 if k > 0 => format!("({}.1000000) can0 123#{k:02X}\n", k / 10 - 1),
        _ => format!("({}.{}00000) can0 123#{k:02X}\n", k / 10, k % 10),
    };
    let text: String = (0..200).map(line).collect();
    let expected: Vec<_> = (0..200)
        .map(|k| standard(k * 100_000, 0x123, &[k as u8]))
        .collect();
    assert_eq!(read(text.as_bytes()), Ok(expected));
    // More than the microseconds of two seconds are none: nothing is known of such a line.
    let wrong = text.replace("(5.1000000)", "(5.2000000)");
    let frames = read(wrong.as_bytes()).expect("one damaged line");
    assert_eq!(frames.len(), 199);
}
