//! Where the records of a channel group have the parts of a frame.

use crate::error::Result;
use crate::source::mdf::conversion::Conversion;
use crate::source::mdf::field::{
    ChannelHead, Clock, Field, Invalid, MASTER, VARIABLE_LENGTH, VIRTUAL,
};
use crate::source::mdf::mdf_file::{Block, MdfFile};

/// A whole number that a record has, or that all records share.
#[derive(Clone, Debug)]
pub(super) struct Part {
    field: Field,
    conversion: Conversion,
}

impl Part {
    /// Reads the number; `None` if it is not there.
    pub(super) fn number(&self, record: &[u8]) -> Option<u64> {
        let raw = match self.field.bits {
            0 => 0,
            1..=64 => self.field.raw(record)?,
            _ => return None,
        };
        self.conversion.whole(raw)
    }
}

/// The bytes of a frame's data.
#[derive(Clone, Copy, Debug)]
pub(super) enum DataField {
    /// In the record.
    Fixed { byte: usize, length: usize },
    /// In another place, which this link points to; the record has the offset there.
    Variable { offset: Field, link: u64 },
}

/// What the records of a group are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Event {
    Data,
    Remote,
    Error,
}

/// The parts of a frame.
#[derive(Clone, Debug)]
pub(super) struct FrameLayout {
    pub event: Event,
    pub clock: Option<Clock>,
    pub id: Option<Part>,
    pub ide: Option<Part>,
    pub bus: Option<Part>,
    pub dlc: Option<Part>,
    pub length: Option<Part>,
    pub is_fd: Option<Part>,
    pub data: Option<DataField>,
    invalid: Invalid,
}

impl FrameLayout {
    /// Reads the layout of a group from its channels; `None` if its records are no frames. The bits that
    /// mark invalid parts stand behind the data bytes of a record.
    pub(super) fn read(file: &mut MdfFile, first: u64, data_bytes: usize) -> Result<Option<Self>> {
        let mut found = Self {
            event: Event::Data,
            clock: None,
            id: None,
            ide: None,
            bus: None,
            dlc: None,
            length: None,
            is_fd: None,
            data: None,
            invalid: Invalid::default(),
        };
        let mut is_frame = false;
        let mut next = first;
        while next != 0 {
            let channel = file.described(next, b"##CN")?;
            is_frame |= found.take(file, &channel, data_bytes)?;
            // The parts of a frame are channels within one.
            let mut part = channel.link(1);
            while part != 0 {
                let Ok(channel) = file.described(part, b"##CN") else {
                    break; // An array, which no frame has.
                };
                is_frame |= found.take(file, &channel, data_bytes)?;
                part = channel.link(0);
            }
            next = channel.link(0);
        }
        Ok((is_frame && found.clock.is_some()).then_some(found))
    }

    /// Returns true for a record with a part that its file marks as invalid.
    pub(super) fn is_invalid(&self, record: &[u8]) -> bool {
        self.invalid.is_set(record)
    }

    /// Takes one channel. Returns true if it is a part of a frame.
    fn take(&mut self, file: &mut MdfFile, channel: &Block, data_bytes: usize) -> Result<bool> {
        let name = file.text(channel.link(2))?;
        let data = file.data(channel)?;
        let Some(ChannelHead { kind, field, .. }) = ChannelHead::read(&data) else {
            return Ok(false);
        };
        if kind == MASTER {
            self.invalid.note(&data, data_bytes);
            self.clock = Clock::read(file, channel, Some(field))?;
            return Ok(false);
        }
        let Some((event, part)) = part_of(&name) else {
            // The frame of which the channels inside are parts.
            if FRAMES.iter().any(|(frame, _)| name == *frame) {
                self.invalid.note(&data, data_bytes);
            }
            return Ok(false);
        };
        self.invalid.note(&data, data_bytes);
        self.event = event;
        let mut conversion = Conversion::of(file, channel)?;
        if kind == VIRTUAL {
            // The raw number is that of the record, which only a constant has no use for.
            conversion = match conversion {
                Conversion::Linear { factor: 0.0, .. } => conversion,
                _ => Conversion::Unknown(u8::MAX),
            };
        }
        let number = Some(Part { field, conversion });
        match part {
            b"ID" => self.id = number,
            b"IDE" => self.ide = number,
            b"BusChannel" => self.bus = number,
            b"DLC" => self.dlc = number,
            b"DataLength" => self.length = number,
            b"EDL" => self.is_fd = number,
            b"DataBytes" if kind == VARIABLE_LENGTH => {
                let offset = Field {
                    bits: 64,
                    data_type: 0,
                    ..field
                };
                let link = channel.link(5);
                self.data = Some(DataField::Variable { offset, link });
            }
            b"DataBytes" => {
                let length = (field.bits / 8) as usize;
                self.data = Some(DataField::Fixed {
                    byte: field.byte,
                    length,
                });
            }
            _ => {}
        }
        Ok(true)
    }
}

/// Channels whose parts are those of a frame.
const FRAMES: [(&[u8], Event); 3] = [
    (b"CAN_DataFrame", Event::Data),
    (b"CAN_RemoteFrame", Event::Remote),
    (b"CAN_ErrorFrame", Event::Error),
];

/// Returns the event and its part that a channel such as `CAN_DataFrame.ID` has.
fn part_of(name: &[u8]) -> Option<(Event, &[u8])> {
    let point = name.iter().rposition(|byte| *byte == b'.')?;
    let (group, part) = (name.get(..point)?, name.get(point + 1..)?);
    let known = FRAMES.iter().find(|(frame, _)| group.starts_with(frame));
    let (_, event) = *known?;
    Some((event, part))
}
