//! Writer of `candump -l` lines.

use super::can_frame::TimedFrame;
use embedded_can::{Frame, Id};
use std::io::{self, Write};

/// Writes a frame in the layout of `candump -l`: `(1.000000) can0 0CF00400#0102030405060708`.
///
/// # Errors
/// Returns the error of `out`.
pub fn write_frame<W: Write + ?Sized>(
    out: &mut W,
    timed: &TimedFrame,
    interface: &str,
) -> io::Result<()> {
    let micros = timed.time.micros();
    let mut text = LineBuffer::default();
    text.byte(b'(');
    text.decimal(micros / 1_000_000, 1);
    text.byte(b'.');
    text.decimal(micros % 1_000_000, 6);
    text.byte(b')');
    text.byte(b' ');
    out.write_all(text.bytes())?;
    out.write_all(interface.as_bytes())?;

    let frame = &timed.frame;
    let mut text = LineBuffer::default();
    text.byte(b' ');
    match frame.id() {
        Id::Extended(id) => text.hex(id.as_raw(), 8),
        Id::Standard(id) => text.hex(u32::from(id.as_raw()), 3),
    }
    text.byte(b'#');
    if frame.is_remote_frame() {
        text.byte(b'R');
        if frame.dlc() > 0 {
            text.decimal(frame.dlc() as u64, 1);
        }
    }
    for byte in frame.data() {
        text.hex(u32::from(*byte), 2);
    }
    text.byte(b'\n');
    out.write_all(text.bytes())
}

/// A text under construction. Simulated logs have millions of lines, too many for `write!`.
#[derive(Default)]
struct LineBuffer {
    bytes: [u8; 32],
    length: usize,
}

impl LineBuffer {
    fn byte(&mut self, byte: u8) {
        self.bytes[self.length] = byte;
        self.length += 1;
    }

    fn hex(&mut self, value: u32, digits: u32) {
        for k in (0..digits).rev() {
            self.byte(b"0123456789ABCDEF"[(value >> (4 * k)) as usize & 0xf]);
        }
    }

    fn decimal(&mut self, value: u64, fewest_digits: usize) {
        let digits = value.checked_ilog10().map_or(1, |log| log as usize + 1);
        let digits = digits.max(fewest_digits);
        let mut left = value;
        for place in self.bytes[self.length..self.length + digits]
            .iter_mut()
            .rev()
        {
            *place = b'0' + (left % 10) as u8;
            left /= 10;
        }
        self.length += digits;
    }

    fn bytes(&self) -> &[u8] {
        &self.bytes[..self.length]
    }
}
