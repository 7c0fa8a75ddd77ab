//! Frames to readings.

use super::fast_packet::{FastPackets, Unfinished};
use super::layout::{Field, MESSAGES, Message, index_of};
use super::reading::Reading;
use embedded_can::{Frame, Id};

/// Parameter group number and source address of a 29-bit identifier (SAE J1939-21).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Pgn {
    /// The parameter group number.
    pub number: u32,
    /// The source address.
    pub source: u8,
}

impl Pgn {
    /// Returns the parts of a raw 29-bit identifier. In the PDU1 range the destination address is not
    /// part of the number.
    #[must_use]
    pub const fn from_raw(id: u32) -> Self {
        let group = (id >> 8) & 0x3_ffff;
        let number = if (group >> 8) & 0xff < 0xf0 {
            group & 0x3_ff00
        } else {
            group
        };
        Self {
            number,
            source: (id & 0xff) as u8,
        }
    }
}

/// Why a frame of a known message has no readings.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Rejection {
    /// It is a remote frame, which has no data.
    Remote,
    /// The payload ends before its last signal.
    Truncated,
    /// A frame of its fast packet is missing, repeated or swapped.
    FastPacketOrder,
}

/// What became of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum FrameOutcome {
    /// It had readings.
    Decoded {
        /// Index of the message.
        message: usize,
        /// The source address.
        source: u8,
    },
    /// It is a part of a fast packet that is not complete yet.
    Partial,
    /// Its message is unknown.
    Ignored,
    /// Its message is known, but the frame is unusable.
    Rejected(Rejection),
}

/// A decoder of frames. It holds the fast packets that are not complete yet.
#[derive(Clone, Debug)]
pub struct Decoder {
    packets: FastPackets,
}

impl Decoder {
    /// Creates a decoder without packets.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            packets: FastPackets::new(),
        }
    }

    /// Decodes one frame and gives each of its readings to `sink`, with the index of the message and
    /// its PGN and source. The outcome repeats index and source.
    pub fn decode<F: Frame>(
        &mut self,
        frame: &F,
        sink: impl FnMut(usize, Pgn, Reading),
    ) -> FrameOutcome {
        self.decode_fields(frame, |message| message.fields, sink)
    }

    /// Decodes only the signals that the estimator reads.
    #[inline]
    pub(crate) fn decode_read<F: Frame>(
        &mut self,
        frame: &F,
        sink: impl FnMut(usize, Pgn, Reading),
    ) -> FrameOutcome {
        let read = |message: &Message| message.fields.get(..message.read).unwrap_or_default();
        self.decode_fields(frame, read, sink)
    }

    #[inline]
    fn decode_fields<F: Frame>(
        &mut self,
        frame: &F,
        fields: impl Fn(&'static Message) -> &'static [Field],
        mut sink: impl FnMut(usize, Pgn, Reading),
    ) -> FrameOutcome {
        let Id::Extended(id) = frame.id() else {
            return FrameOutcome::Ignored;
        };
        let pgn = Pgn::from_raw(id.as_raw());
        let Some(index) = index_of(pgn.number) else {
            return FrameOutcome::Ignored;
        };
        let Some(message) = MESSAGES.get(index) else {
            return FrameOutcome::Ignored;
        };
        if frame.is_remote_frame() {
            return FrameOutcome::Rejected(Rejection::Remote);
        }
        let payload = if message.length <= 8 {
            frame.data()
        } else {
            let key = (pgn.number << 8) | u32::from(pgn.source);
            match self.packets.push(key, frame.data()) {
                Ok(payload) => payload,
                Err(Unfinished::Partial) => return FrameOutcome::Partial,
                Err(Unfinished::Truncated) => return FrameOutcome::Rejected(Rejection::Truncated),
                Err(Unfinished::OutOfOrder | Unfinished::CutOff) => {
                    return FrameOutcome::Rejected(Rejection::FastPacketOrder);
                }
            }
        };
        // All readings or none.
        if payload.len() * 8 < usize::from(message.end_bit) {
            return FrameOutcome::Rejected(Rejection::Truncated);
        }
        for field in fields(message) {
            if let Some(value) = field.read(payload) {
                let signal = field.signal;
                sink(index, pgn, Reading { signal, value });
            }
        }
        FrameOutcome::Decoded {
            message: index,
            source: pgn.source,
        }
    }
}

impl Default for Decoder {
    fn default() -> Self {
        Self::new()
    }
}
