//! What a frame is of, and what became of it.

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
    /// A packet of its transport session is missing, swapped or late, or the session was cut off.
    TransportOrder,
    /// The announcement of its transport session contradicts itself.
    TransportAnnouncement,
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
    /// It is a part of a fast packet or transport session that is not complete yet.
    Partial,
    /// Its message is unknown.
    Ignored,
    /// Its message is known, but the frame is unusable.
    Rejected(Rejection),
}
