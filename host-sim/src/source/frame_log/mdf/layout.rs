//! Where the records of a channel group have the parts of a frame.

use super::mdf_file::{Block, MdfFile, number, u32_at};
use crate::error::Result;

/// Latest time of a log, µs, as for other formats.
const MOST_MICROS: f64 = 1e18;

/// The types of a channel that matter here.
const VARIABLE_LENGTH: u8 = 1;
const MASTER: u8 = 2;

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
    pub id: Option<Field>,
    pub ide: Option<Field>,
    pub bus: Option<Field>,
    pub dlc: Option<Field>,
    pub length: Option<Field>,
    pub is_fd: Option<Field>,
    pub data: Option<DataField>,
}

impl FrameLayout {
    /// Reads the layout of a group from its channels; `None` if its records are no frames.
    pub(super) fn read(file: &mut MdfFile, first: u64) -> Result<Option<Self>> {
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
        };
        let mut is_frame = false;
        let mut next = first;
        while next != 0 {
            let channel = file.described(next, b"##CN")?;
            is_frame |= found.take(file, &channel)?;
            // The parts of a frame are channels within one.
            let mut part = channel.link(1);
            while part != 0 {
                let Ok(channel) = file.described(part, b"##CN") else {
                    break; // An array, which no frame has.
                };
                is_frame |= found.take(file, &channel)?;
                part = channel.link(0);
            }
            next = channel.link(0);
        }
        Ok((is_frame && found.clock.is_some()).then_some(found))
    }

    /// Takes one channel. Returns true if it is a part of a frame.
    fn take(&mut self, file: &mut MdfFile, channel: &Block) -> Result<bool> {
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
            self.clock = clock(file, channel, field)?;
            return Ok(false);
        }
        let Some((event, part)) = part_of(&name) else {
            return Ok(false);
        };
        self.event = event;
        let number = Some(field).filter(|field| field.bits <= 64);
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

/// Returns the event and its part that a channel such as `CAN_DataFrame.ID` has.
fn part_of(name: &[u8]) -> Option<(Event, &[u8])> {
    let point = name.iter().rposition(|byte| *byte == b'.')?;
    let (group, part) = (name.get(..point)?, name.get(point + 1..)?);
    let event = if group.starts_with(b"CAN_DataFrame") {
        Event::Data
    } else if group.starts_with(b"CAN_RemoteFrame") {
        Event::Remote
    } else if group.starts_with(b"CAN_ErrorFrame") {
        Event::Error
    } else {
        return None;
    };
    Some((event, part))
}

/// Reads the conversion of a time to seconds: none, or linear.
fn clock(file: &mut MdfFile, channel: &Block, field: Field) -> Result<Option<Clock>> {
    let mut clock = Clock {
        field,
        factor_us: 1e6,
        offset_us: 0.0,
    };
    let link = channel.link(4);
    if link != 0 {
        let conversion = file.described(link, b"##CC")?;
        let data = file.data(&conversion)?;
        let value = |at| number(&data, at).map(f64::from_le_bytes);
        match (data.first(), value(24), value(32)) {
            (Some(0), ..) => {}
            (Some(1), Some(offset), Some(factor)) => {
                clock.offset_us = offset * 1e6;
                clock.factor_us = factor * 1e6;
            }
            _ => return Ok(None),
        }
    }
    Ok((field.bits <= 64).then_some(clock))
}
