//! What to say of a log that has nothing to read.

use super::frame_reader::Skipped;
use crate::files::log_format::{KNOWN, LogFormat};
use crate::source::interfaces::InterfaceCount;

/// Returns what to say of a file whose first bytes are of no format; `None` if there are none.
pub(super) fn unknown_format(head: &[u8]) -> Option<String> {
    const QUOTE_BYTES: usize = 40;
    let line = head.trim_ascii().split(|byte| *byte == b'\n').next()?;
    if is_without_time(line) {
        let words = "candump's lines have no times; record with `candump -L can0 > drive.log`";
        return Some(words.to_owned());
    }
    let quote = line.get(..QUOTE_BYTES).unwrap_or(line).escape_ascii();
    (!line.is_empty()).then(|| format!("unknown format, begins with `{quote}`; known are {KNOWN}"))
}

/// Returns true for `can0  18FEF100   [8]  FF 00 20 FF`: what candump prints by default.
fn is_without_time(line: &[u8]) -> bool {
    let line = String::from_utf8_lossy(line);
    let words: Vec<&str> = line.split_whitespace().take(3).collect();
    let [_, id, length] = words[..] else {
        return false;
    };
    let length = length
        .strip_prefix('[')
        .and_then(|rest| rest.strip_suffix(']'));
    let is_id = u32::from_str_radix(id, 16).is_ok();
    is_id && length.is_some_and(|length| length.parse::<u8>().is_ok())
}

/// Returns what to say of a log without a frame.
pub(super) fn no_frames(format: LogFormat, skipped: Skipped, is_empty: bool) -> String {
    if let Some(words) = skipped.words() {
        let note = if skipped.can_fd > 0 {
            " (J1939 over CAN FD, SAE J1939-22, is not read)"
        } else {
            ""
        };
        return format!(
            "no classic CAN frame among {words}; expected a {format} of a J1939 bus{note}"
        );
    }
    let what = if is_empty {
        "the file is empty"
    } else {
        "no frames"
    };
    format!("{what}; expected a {format} with at least one frame")
}

/// Returns what to say of a log without a frame of the interfaces that are asked for.
pub(super) fn no_interface<'a>(
    wanted: &[String],
    found: impl Iterator<Item = &'a InterfaceCount>,
) -> String {
    let names: Vec<&str> = found.map(|count| &*count.name).collect();
    let (wanted, names) = (wanted.join(", "), names.join(", "));
    format!("no frames of interface {wanted}; expected one of {names}")
}
