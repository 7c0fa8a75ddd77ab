//! One CAN frame and its time.
//!
//! The identifier has the flag bits of Linux's `can_frame`: bit 31 set for a 29-bit identifier,
//! bit 30 for a remote frame. Bytes of the data beyond the length are zero.

use embedded_can::{ExtendedId, Frame, Id, StandardId};
use estimator_core::Instant;
use estimator_core::word_record::{halves, next_u64, to_bytes, to_words};

/// Length of a record, bytes.
pub const FRAME_BYTES: usize = 24;

const EXTENDED: u32 = 1 << 31;
const REMOTE: u32 = 1 << 30;

/// A classic CAN frame as a record holds it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RecordedFrame {
    id: Id,
    remote: bool,
    length: usize,
    data: [u8; 8],
}

/// Returns the record of a frame received at `time`; `None` if the frame has more than 8 bytes.
pub fn encode(time: Instant, frame: &impl Frame) -> Option<[u8; FRAME_BYTES]> {
    let RecordedFrame {
        id,
        remote,
        length,
        data,
    } = if frame.is_remote_frame() {
        RecordedFrame::new_remote(frame.id(), frame.dlc())
    } else {
        RecordedFrame::new(frame.id(), frame.data())
    }?;
    let [low, high] = halves(time.micros());
    let id = match id {
        Id::Standard(id) => u32::from(id.as_raw()),
        Id::Extended(id) => id.as_raw() | EXTENDED,
    };
    let flag = if remote { REMOTE } else { 0 };
    let [first, second] = halves(u64::from_le_bytes(data));
    Some(to_bytes([
        low,
        high,
        id | flag,
        length as u32,
        first,
        second,
    ]))
}

/// Returns the frame of a record and its time of reception.
#[must_use]
pub fn decode(record: &[u8]) -> Option<(Instant, RecordedFrame)> {
    let mut words = to_words(record, FRAME_BYTES)?;
    let time = Instant::from_micros(next_u64(&mut words)?);
    let flagged = words.next()?;
    let length = words.next()? as usize;
    let data = next_u64(&mut words)?.to_le_bytes();
    let raw = flagged & !(EXTENDED | REMOTE);
    let id = if flagged & EXTENDED == 0 {
        Id::Standard(StandardId::new(u16::try_from(raw).ok()?)?)
    } else {
        Id::Extended(ExtendedId::new(raw)?)
    };
    let frame = if flagged & REMOTE == 0 {
        RecordedFrame::new(id, data.get(..length)?)
    } else {
        RecordedFrame::new_remote(id, length)
    }?;
    (frame.data == data).then_some((time, frame))
}

impl Frame for RecordedFrame {
    fn new(id: impl Into<Id>, data: &[u8]) -> Option<Self> {
        let mut bytes = [0; 8];
        bytes.get_mut(..data.len())?.copy_from_slice(data);
        Some(Self {
            id: id.into(),
            remote: false,
            length: data.len(),
            data: bytes,
        })
    }

    fn new_remote(id: impl Into<Id>, dlc: usize) -> Option<Self> {
        (dlc <= 8).then(|| Self {
            id: id.into(),
            remote: true,
            length: dlc,
            data: [0; 8],
        })
    }

    fn is_extended(&self) -> bool {
        matches!(self.id, Id::Extended(_))
    }

    fn is_remote_frame(&self) -> bool {
        self.remote
    }

    fn id(&self) -> Id {
        self.id
    }

    fn dlc(&self) -> usize {
        self.length
    }

    fn data(&self) -> &[u8] {
        let length = if self.remote { 0 } else { self.length };
        self.data.get(..length).unwrap_or_default()
    }
}
