//! Where the records of a channel group have the parts of a frame.

use super::conversion::Conversion;
use super::mdf_file::{Block, MdfFile, number, u32_at};
use crate::error::Result;

/// Latest time of a log, µs, as for other formats.
const MOST_MICROS: f64 = 1e18;

/// The types of a channel that matter here.
const VARIABLE_LENGTH: u8 = 1;
const MASTER: u8 = 2;
/// A channel without bits in the record: its conversion gives a constant.
const VIRTUAL: u8 = 6;

/// A number within a record.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Field {
    pub byte: usize,
    bit: u32,
    pub bits: u32,
    data_type: u8,
}

impl Field {
    /// Reads the bits, as they are; `None` if the record is too short.
    pub(super) fn raw(&self, record: &[u8]) -> Option<u64> {
        let count = self.bit.saturating_add(self.bits).div_ceil(8) as usize;
        let bytes = record.get(self.byte..)?.get(..count)?;
        let is_big_endian = matches!(self.data_type, 1 | 3 | 5);
        let add = |sum: u128, byte: &u8| (sum << 8) | u128::from(*byte);
        let word = if is_big_endian {
            bytes.iter().fold(0, add)
        } else {
            bytes.iter().rev().fold(0, add)
        };
        let mask = u64::MAX.checked_shr(64 - self.bits.clamp(1, 64))?;
        Some(word.checked_shr(self.bit)? as u64 & mask)
    }

    /// Reads the number that the bits mean.
    fn value(&self, record: &[u8]) -> Option<f64> {
        let raw = self.raw(record)?;
        match (self.data_type, self.bits) {
            (4 | 5, 64) => Some(f64::from_bits(raw)),
            (4 | 5, 32) => Some(f32::from_bits(raw as u32).into()),
            (0 | 1, _) => Some(raw as f64),
            (2 | 3, bits @ 1..=64) => Some(((raw << (64 - bits)) as i64 >> (64 - bits)) as f64),
            _ => None,
        }
    }
}

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

/// A time within a record.
#[derive(Clone, Copy, Debug)]
pub(super) struct Clock {
    field: Field,
    factor_us: f64,
    offset_us: f64,
}

impl Clock {
    /// Reads the time of a record, in microseconds since the start of the measurement. Some writers
    /// take the time at which they open the file for that.
    pub(super) fn micros(&self, record: &[u8]) -> Option<i64> {
        let value = self.field.value(record)?;
        let micros = (value * self.factor_us + self.offset_us).round();
        (-MOST_MICROS..=MOST_MICROS)
            .contains(&micros)
            .then_some(micros as i64)
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

/// How records of a group mark parts that are not valid.
#[derive(Clone, Debug, Default)]
struct Invalid {
    /// True if a part never is.
    is_always: bool,
    /// Where the bits stand, by their byte and mask; set for a part that is not.
    bits: Vec<(usize, u8)>,
}

/// Flags of a channel: none of its values is valid; a bit of each record tells.
const ALL_INVALID: u32 = 1;
const HAS_INVALID_BIT: u32 = 2;

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
        let is_set = |(byte, mask): &(usize, u8)| record.get(*byte).is_some_and(|b| b & mask != 0);
        self.invalid.is_always || self.invalid.bits.iter().any(is_set)
    }

    /// Notes how a channel marks invalid values.
    fn note_invalid(&mut self, channel: &[u8], data_bytes: usize) {
        let flags = u32_at(channel, 12).unwrap_or(0);
        self.invalid.is_always |= flags & ALL_INVALID != 0;
        if flags & HAS_INVALID_BIT != 0
            && let Some(bit) = u32_at(channel, 16)
        {
            let byte = data_bytes.saturating_add(bit as usize / 8);
            self.invalid.bits.push((byte, 1 << (bit % 8)));
        }
    }

    /// Takes one channel. Returns true if it is a part of a frame.
    fn take(&mut self, file: &mut MdfFile, channel: &Block, data_bytes: usize) -> Result<bool> {
        let name = file.text(channel.link(2))?;
        let data = file.data(channel)?;
        let (Some([kind, _, data_type, bit]), Some(byte), Some(bits)) =
            (number(&data, 0), u32_at(&data, 4), u32_at(&data, 8))
        else {
            return Ok(false);
        };
        let field = Field {
            byte: byte as usize,
            bit: u32::from(bit).min(7),
            bits,
            data_type,
        };
        if kind == MASTER {
            self.note_invalid(&data, data_bytes);
            self.clock = clock(file, channel, field)?;
            return Ok(false);
        }
        let Some((event, part)) = part_of(&name) else {
            // The frame of which the channels inside are parts.
            if FRAMES.iter().any(|(frame, _)| name == *frame) {
                self.note_invalid(&data, data_bytes);
            }
            return Ok(false);
        };
        self.note_invalid(&data, data_bytes);
        self.event = event;
        let mut conversion = Conversion::of(file, channel)?;
        if kind == VIRTUAL {
            // The raw number is that of the record, which only a constant has no use for.
            conversion = match conversion {
                Conversion::Linear { factor: 0.0, .. } => conversion,
                _ => Conversion::Unknown,
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
                let length = (bits / 8) as usize;
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

/// Reads the conversion of a time to seconds: none, or linear.
fn clock(file: &mut MdfFile, channel: &Block, field: Field) -> Result<Option<Clock>> {
    let (offset_s, factor_s) = match Conversion::of(file, channel)? {
        Conversion::None => (0.0, 1.0),
        Conversion::Linear { offset, factor } => (offset, factor),
        Conversion::Table(_) | Conversion::Unknown => return Ok(None),
    };
    Ok((field.bits <= 64).then_some(Clock {
        field,
        factor_us: factor_s * 1e6,
        offset_us: offset_s * 1e6,
    }))
}
