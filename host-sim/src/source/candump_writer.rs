//! Frames as lines of `candump -l`: `(1.000000) can0 0CF00400#0102030405060708`.

use super::can_frame::TimedFrame;
use embedded_can::{Frame, Id};
use std::io::{self, Write};

/// Writes one frame as heard on `interface`.
///
/// # Errors
/// What `out` says.
pub fn write_frame(out: &mut dyn Write, interface: &str, timed: &TimedFrame) -> io::Result<()> {
    let micros = timed.time.micros();
    let frame = &timed.frame;
    write!(
        out,
        "({}.{:06}) {interface} ",
        micros / 1_000_000,
        micros % 1_000_000
    )?;
    match frame.id() {
        Id::Extended(id) => write!(out, "{:08X}#", id.as_raw())?,
        Id::Standard(id) => write!(out, "{:03X}#", id.as_raw())?,
    }
    if frame.is_remote_frame() {
        return writeln!(out, "R{}", frame.dlc());
    }
    // Sixteen hex digits and the end of the line, written at once.
    let mut text = [b'\n'; 17];
    for (pair, byte) in text.chunks_exact_mut(2).zip(frame.data()) {
        pair[0] = b"0123456789ABCDEF"[usize::from(byte >> 4)];
        pair[1] = b"0123456789ABCDEF"[usize::from(byte & 0xf)];
    }
    out.write_all(&text[..=2 * frame.data().len()])
}
