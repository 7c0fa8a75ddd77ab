//! The blocks of a pcapng file (draft-ietf-opsawg-pcapng): sections, their interfaces, packets.

use super::super::byte_file::{ByteFile, number};
use super::super::fields::MOST_MICROS;
use super::super::line_problem::{LineProblem, Parsed, problem};
use super::packet::Link;
use super::step::{Captured, Step};
use crate::error::Result;
use crate::source::interfaces::{InterfaceIndex, Interfaces};
use pcap_parser::{Block, InterfaceDescriptionBlock, OptionCode, parse_block_be, parse_block_le};

/// Bytes of a block without its content: type, length, and the length again.
const LEAST_BLOCK_BYTES: u32 = 12;
/// Most bytes of a block.
const MOST_BLOCK_BYTES: u32 = 16 << 20;
/// Most bytes of a block behind damage, where nothing else tells that it is one.
const MOST_BYTES_IN_DOUBT: u32 = 4096;
/// Types of blocks.
const SECTION: u32 = 0x0a0d_0d0a;
const INTERFACE: u32 = 1;
/// A packet in the form before the enhanced packet (6).
const OLD_PACKET: u32 = 2;
const PACKET: u32 = 6;
/// Where the packet begins in a block of either form.
const PACKET_AT: usize = 28;
/// The magic number of a section.
const BYTE_ORDER: u32 = 0x1a2b_3c4d;

/// An interface of a section.
struct Interface {
    link: Link,
    /// Units of time in a second; `None` if they are not known.
    units: Option<u128>,
    offset_us: i64,
    index: InterfaceIndex,
}

/// What was read of the file.
#[derive(Default)]
pub(super) struct Blocks {
    is_open: bool,
    is_big_endian: bool,
    interfaces: Vec<Interface>,
    /// Kinds of the interfaces of all sections.
    links: Vec<Link>,
}

const NO_BLOCK: LineProblem = problem(
    "no block of a packet capture",
    "a type and its length twice",
);
const NO_SECTION: LineProblem = problem("no header of a packet capture", "a section header block");
const NO_INTERFACE: LineProblem = problem(
    "a damaged description of an interface",
    "a whole one: it says how to read the packets",
);

impl Blocks {
    /// Returns the kinds of the interfaces so far.
    pub(super) fn links(&self) -> &[Link] {
        &self.links
    }

    /// Reads the next block.
    ///
    /// # Errors
    /// Returns an error of the disk.
    pub(super) fn next(
        &mut self,
        file: &mut ByteFile,
        bytes: &mut Vec<u8>,
        interfaces: &mut Interfaces,
    ) -> Result<Step> {
        if !file.take(bytes, LEAST_BLOCK_BYTES.into())? {
            let is_end = bytes.is_empty();
            return Ok(if is_end { Step::End } else { Step::CutOff });
        }
        let Some(length) = self.begin(bytes) else {
            return self.skip(file, bytes);
        };
        let rest = length - LEAST_BLOCK_BYTES;
        if !file.take_more(bytes, rest.into())? {
            return self.skip(file, bytes).map(Step::or_cut_off);
        }
        match self.block(bytes, interfaces) {
            Some(Ok(step)) => Ok(step),
            Some(Err(problem)) => Ok(Step::Unreadable(problem)),
            None => self.skip(file, bytes),
        }
    }

    /// Returns the length of the block that begins with these bytes, if it is one. The header of a section
    /// says the byte order.
    fn begin(&mut self, bytes: &[u8]) -> Option<u32> {
        if number(bytes, 0).map(u32::from_le_bytes) == Some(SECTION) {
            self.is_big_endian = is_big_endian(number(bytes, 8)?)?;
        } else if !self.is_open {
            return None;
        }
        let length = self.word(bytes, 4)?;
        let is_length = (LEAST_BLOCK_BYTES..=MOST_BLOCK_BYTES).contains(&length) && length % 4 == 0;
        is_length.then_some(length)
    }

    fn word(&self, bytes: &[u8], at: usize) -> Option<u32> {
        let word = number(bytes, at)?;
        Some(if self.is_big_endian {
            u32::from_be_bytes(word)
        } else {
            u32::from_le_bytes(word)
        })
    }

    /// Takes a whole block; `None` if it is damaged.
    fn block(&mut self, bytes: &[u8], interfaces: &mut Interfaces) -> Option<Parsed<Step>> {
        let length = self.word(bytes, bytes.len().checked_sub(4)?)?;
        if length as usize != bytes.len() {
            return None;
        }
        let parse = if self.is_big_endian {
            parse_block_be
        } else {
            parse_block_le
        };
        let (_, block) = parse(bytes).ok()?;
        Some(match block {
            Block::SectionHeader(_) => {
                self.is_open = true;
                self.interfaces.clear();
                Ok(Step::Other)
            }
            Block::InterfaceDescription(described) => {
                let interface = self.interface(&described, interfaces);
                self.links.push(interface.link);
                self.interfaces.push(interface);
                Ok(Step::Other)
            }
            Block::EnhancedPacket(packet) => self.packet(
                bytes,
                packet.if_id,
                [packet.ts_high, packet.ts_low],
                [packet.caplen, packet.origlen],
            ),
            Block::Unknown(_) if self.word(bytes, 0) == Some(OLD_PACKET) => {
                let [first, second] = number(bytes, 8)?;
                let interface = if self.is_big_endian {
                    u16::from_be_bytes([first, second])
                } else {
                    u16::from_le_bytes([first, second])
                };
                let word = |at| self.word(bytes, at);
                let (time, lengths) = ([word(12)?, word(16)?], [word(20)?, word(24)?]);
                self.packet(bytes, interface.into(), time, lengths)
            }
            Block::SimplePacket(_) => Err(problem(
                "a simple packet block, which has no time",
                "enhanced packet blocks",
            )),
            _ => Ok(Step::Other),
        })
    }

    fn interface(
        &self,
        described: &InterfaceDescriptionBlock,
        interfaces: &mut Interfaces,
    ) -> Interface {
        let option = |code: OptionCode| {
            let options = described.options.iter();
            let mut options = options.take_while(|option| option.code != OptionCode::EndOfOpt);
            options.find(|option| option.code == code)?.as_bytes().ok()
        };
        // The crate's own fields have neither powers of two nor big-endian offsets.
        let resolution = option(OptionCode::IfTsresol).and_then(|value| value.first());
        let units = match resolution {
            None => Some(1_000_000),
            Some(power) if power & 0x80 == 0 => 10_u128.checked_pow(u32::from(*power)),
            Some(power) => 1_u128.checked_shl(u32::from(power & 0x7f)),
        };
        let offset = option(OptionCode::IfTsoffset).and_then(|value| number(value, 0));
        let offset_s = offset.map_or(0, |offset| {
            if self.is_big_endian {
                i64::from_be_bytes(offset)
            } else {
                i64::from_le_bytes(offset)
            }
        });
        let name = option(OptionCode::IfName).unwrap_or_default();
        let name = name.split(|byte| *byte == 0).next().unwrap_or_default();
        let index = if name.is_empty() {
            interfaces.channel(self.interfaces.len() as u32 + 1)
        } else {
            interfaces.named(name)
        };
        Interface {
            link: Link::of(described.linktype.0 as u16),
            units,
            offset_us: offset_s.saturating_mul(1_000_000),
            index,
        }
    }

    fn packet(
        &self,
        bytes: &[u8],
        interface: u32,
        [high, low]: [u32; 2],
        [kept_bytes, whole_bytes]: [u32; 2],
    ) -> Parsed<Step> {
        let interface = self.interfaces.get(interface as usize).ok_or(problem(
            "a packet of an interface that is not described",
            "an interface description block before it",
        ))?;
        let data = PACKET_AT..PACKET_AT + kept_bytes as usize;
        bytes.get(data.clone()).ok_or(NO_BLOCK)?;
        let time = u128::from(high) << 32 | u128::from(low);
        let units = interface.units.filter(|units| *units > 0);
        let micros = units.and_then(|units| i64::try_from(time * 1_000_000 / units).ok());
        let micros = micros.and_then(|micros| micros.checked_add(interface.offset_us));
        let micros = micros.filter(|micros| micros.abs() <= MOST_MICROS);
        let micros = micros.ok_or(problem(
            "a time out of range",
            "at most 10^12 s, in a unit that the interface names",
        ))?;
        Ok(Step::Packet(Captured {
            micros,
            link: interface.link,
            interface: Some(interface.index),
            whole_bytes,
            data,
            is_big_endian: self.is_big_endian,
        }))
    }

    /// Skips to the next block behind damage. Without the header of the section or the description of an
    /// interface, nothing behind them can be read.
    fn skip(&self, file: &mut ByteFile, bytes: &mut Vec<u8>) -> Result<Step> {
        if !self.is_open || number(bytes, 0).map(u32::from_le_bytes) == Some(SECTION) {
            return Ok(Step::Refused(NO_SECTION));
        }
        if self.word(bytes, 0) == Some(INTERFACE) {
            return Ok(Step::Refused(NO_INTERFACE));
        }
        let left_out = file.skip_until(bytes, MOST_BYTES_IN_DOUBT as usize, |bytes, _| {
            (0..bytes.len()).find(|at| self.begins_block(bytes, *at))
        })?;
        Ok(Step::Damaged(NO_BLOCK, left_out))
    }

    /// Returns true if a packet or a section begins at this place, beyond doubt.
    fn begins_block(&self, bytes: &[u8], at: usize) -> bool {
        let is_big_endian = match number(bytes, at).map(u32::from_le_bytes) {
            Some(SECTION) => number(bytes, at + 8).and_then(is_big_endian),
            _ => Some(self.is_big_endian),
        };
        let Some(is_big_endian) = is_big_endian else {
            return false;
        };
        let in_order = Self {
            is_big_endian,
            ..Self::default()
        };
        let kind = in_order.word(bytes, at);
        if !matches!(kind, Some(SECTION | INTERFACE | OLD_PACKET | PACKET)) {
            return false;
        }
        let Some(length) = in_order.word(bytes, at + 4) else {
            return false;
        };
        let is_length = (LEAST_BLOCK_BYTES..=MOST_BYTES_IN_DOUBT).contains(&length);
        is_length && in_order.word(bytes, at + length as usize - 4) == Some(length)
    }
}

/// Returns true if this is the magic number of a section in big-endian order; `None` if it is none.
fn is_big_endian(magic: [u8; 4]) -> Option<bool> {
    let is = |number: u32| number == BYTE_ORDER;
    (is(u32::from_be_bytes(magic)) || is(u32::from_le_bytes(magic)))
        .then(|| is(u32::from_be_bytes(magic)))
}
