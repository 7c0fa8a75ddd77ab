//! Frames to readings.

use super::fast_packet::{FastPackets, Unfinished};
use super::frame_outcome::{FrameOutcome, Pgn, Rejection};
use super::layout::{DESCRIPTIONS, Field, Framing, MESSAGES, Message, index_of};
use super::reading::Reading;
use super::transport::TransportSessions;
use crate::time::Instant;
use embedded_can::{Frame, Id};

/// A decoder of frames. It holds the fast packets and transport sessions that are not complete yet.
#[derive(Clone, Debug)]
pub struct Decoder {
    packets: FastPackets,
    sessions: TransportSessions,
}

impl Decoder {
    /// Creates a decoder without packets.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            packets: FastPackets::new(),
            sessions: TransportSessions::new(),
        }
    }

    /// Decodes one frame and gives each of its readings to `sink`, with the index of the message and
    /// its PGN and source. The outcome repeats index and source. Transport sessions have no timeout.
    pub fn decode<F: Frame>(
        &mut self,
        frame: &F,
        sink: impl FnMut(usize, Pgn, Reading),
    ) -> FrameOutcome {
        self.decode_at(Instant::ZERO, frame, sink)
    }

    /// Decodes one frame that was received at `now`, as [`Self::decode`] does. A transport session
    /// with a pause that is too long is given up: what follows may be another one.
    pub fn decode_at<F: Frame>(
        &mut self,
        now: Instant,
        frame: &F,
        sink: impl FnMut(usize, Pgn, Reading),
    ) -> FrameOutcome {
        self.decode_fields(now, frame, false, sink)
    }

    /// Decodes only the signals that the estimator reads.
    #[inline]
    pub(crate) fn decode_read<F: Frame>(
        &mut self,
        now: Instant,
        frame: &F,
        sink: impl FnMut(usize, Pgn, Reading),
    ) -> FrameOutcome {
        self.decode_fields(now, frame, true, sink)
    }

    #[inline]
    fn decode_fields<F: Frame>(
        &mut self,
        now: Instant,
        frame: &F,
        only_read: bool,
        mut sink: impl FnMut(usize, Pgn, Reading),
    ) -> FrameOutcome {
        let Id::Extended(id) = frame.id() else {
            return FrameOutcome::Ignored;
        };
        let pgn = Pgn::from_raw(id.as_raw());
        let Some(index) = index_of(pgn.number) else {
            return FrameOutcome::Ignored;
        };
        if frame.is_remote_frame() {
            return FrameOutcome::Rejected(Rejection::Remote);
        }
        let (index, message, payload) = match MESSAGES.get(index) {
            Some(message) => match self.payload(message, pgn, frame.data()) {
                Ok(payload) => (index, message, payload),
                Err(outcome) => return outcome,
            },
            // Frames of the transport protocol have the index behind the last message.
            None => match self.sessions.push(now, pgn, id.as_raw(), frame.data()) {
                Ok((index, message, payload)) => (index, message, payload),
                Err(outcome) => return outcome,
            },
        };
        let pgn = Pgn {
            number: message.pgn,
            source: pgn.source,
        };
        let (payload, fields) = message.checked(payload, only_read);
        let mut read = |fields: &[Field]| {
            for field in fields {
                if let Some(value) = field.read(payload) {
                    let signal = field.signal;
                    sink(index, pgn, Reading { signal, value });
                }
            }
        };
        read(fields);
        if !only_read {
            read(DESCRIPTIONS.get(index).map_or(&[], |of| of.unread));
        }
        FrameOutcome::Decoded {
            message: index,
            source: pgn.source,
        }
    }

    /// Returns the payload of a message that single frames or fast packets carry: all readings or
    /// none.
    #[inline(always)] // Called once.
    fn payload<'a>(
        &'a mut self,
        message: &Message,
        pgn: Pgn,
        data: &'a [u8],
    ) -> Result<&'a [u8], FrameOutcome> {
        let payload = if message.framing == Framing::FastPacket {
            let key = (pgn.number << 8) | u32::from(pgn.source);
            self.packets
                .push(key, data)
                .map_err(|unfinished| match unfinished {
                    Unfinished::Partial => FrameOutcome::Partial,
                    Unfinished::Truncated => FrameOutcome::Rejected(Rejection::Truncated),
                    Unfinished::OutOfOrder | Unfinished::CutOff => {
                        FrameOutcome::Rejected(Rejection::FastPacketOrder)
                    }
                })?
        } else {
            data
        };
        if payload.len() * 8 < usize::from(message.end_bit) {
            return Err(FrameOutcome::Rejected(Rejection::Truncated));
        }
        Ok(payload)
    }
}

impl Default for Decoder {
    fn default() -> Self {
        Self::new()
    }
}
