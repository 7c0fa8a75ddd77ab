//! Packet captures with frames of SocketCAN: pcap and pcapng, as tcpdump and Wireshark write them.
//!
//! The crate `pcap-parser` reads headers and blocks; where they begin, and where to go on behind damage,
//! is decided here.

mod blocks;
mod packet;
mod records;
mod step;

use super::byte_file::ByteFile;
use super::frame_reader::{FrameReader, LogNotes, LoggedFrame};
use super::line_problem::Parsed;
use crate::error::{Error, Result};
use crate::files::log_format::PCAPNG_MAGIC;
use crate::source::interfaces::{InterfaceIndex, Interfaces};
use crate::source::log_file::LogFile;
use crate::source::packing::Joint;
use blocks::Blocks;
use packet::{Content, Link, Packet};
use records::Records;
use step::{Captured, Step};

enum Form {
    Records(Records),
    Blocks(Blocks),
}

/// Reader of the frames of a packet capture. A file that is cut off ends there.
pub(super) struct PcapReader {
    file: ByteFile,
    form: Form,
    /// Where the newest packet begins in the file.
    packet_at: u64,
    bytes: Vec<u8>,
    notes: LogNotes,
}

impl PcapReader {
    /// Opens a packet capture.
    ///
    /// # Errors
    /// Returns an error of the disk, for a damaged header, and for a capture of another network.
    pub(super) fn boxed(mut file: LogFile, is_strict: bool) -> Result<Box<dyn FrameReader>> {
        file.join(Joint::Bytes);
        let is_ng = file.look_at_head().starts_with(PCAPNG_MAGIC);
        let mut file = ByteFile::new(file);
        let mut bytes = Vec::new();
        let form = if is_ng {
            Form::Blocks(Blocks::default())
        } else {
            match Records::open(&mut file, &mut bytes)? {
                Ok(records) => Form::Records(records),
                Err(problem) => return Err(error_at(&file, 0, problem.what, problem.expected)),
            }
        };
        if let Form::Records(records) = &form
            && let Link::Other(link) = records.link()
        {
            return Err(other_network(file.log(), link));
        }
        Ok(Box::new(Self {
            file,
            form,
            packet_at: 0,
            bytes,
            notes: LogNotes::new(is_strict),
        }))
    }

    fn step(&mut self) -> Result<Step> {
        self.packet_at = self.file.offset();
        match &mut self.form {
            Form::Records(records) => records.next(&mut self.file, &mut self.bytes),
            Form::Blocks(blocks) => {
                let interfaces = &mut self.notes.interfaces;
                blocks.next(&mut self.file, &mut self.bytes, interfaces)
            }
        }
    }

    /// Takes what a packet contains; `None` if it is not a frame.
    fn take(&mut self, captured: &Captured) -> Parsed<Option<LoggedFrame>> {
        let packet = Packet {
            link: captured.link,
            bytes: self.bytes.get(captured.data.clone()).unwrap_or_default(),
            whole_bytes: captured.whole_bytes,
            is_big_endian: captured.is_big_endian,
        };
        let skipped = &mut self.notes.skipped;
        match packet.content()? {
            Content::Frame(frame) => {
                let interfaces = &mut self.notes.interfaces;
                let index = interface_of(interfaces, packet.interface(), captured.interface);
                return Ok(Some(self.notes.frame(captured.micros, index, frame)));
            }
            Content::FlexibleRate => skipped.can_fd += 1,
            Content::ExtraLarge => skipped.can_xl += 1,
            Content::BusError => skipped.bus_errors += 1,
            Content::Foreign => skipped.foreign += 1,
        }
        Ok(None)
    }

    /// Checks at the end that the file can have frames of a bus.
    fn check_network(&self) -> Result<()> {
        let Form::Blocks(blocks) = &self.form else {
            return Ok(());
        };
        let is_other = |link: &Link| matches!(link, Link::Other(_));
        match blocks.links().first() {
            Some(Link::Other(first)) if blocks.links().iter().all(is_other) => {
                Err(other_network(self.file(), *first))
            }
            _ => Ok(()),
        }
    }
}

/// Returns the interface of a packet: the one that it names, that of the file, or the only one.
fn interface_of(
    interfaces: &mut Interfaces,
    named: Option<u32>,
    of_file: Option<InterfaceIndex>,
) -> InterfaceIndex {
    match (named, of_file) {
        (Some(number), _) => interfaces.named(format!("if{number}").as_bytes()),
        (None, Some(index)) => index,
        (None, None) => interfaces.channel(1),
    }
}

fn error_at(file: &ByteFile, at: u64, problem: &str, expected: &str) -> Error {
    let problem = format!("{problem}, in the packet at byte {at}; expected {expected}");
    Error::content(file.log().path(), problem)
}

/// Returns the error for a capture of a network that is no bus.
fn other_network(file: &LogFile, link: u16) -> Error {
    let name = match link {
        1 => "Ethernet ",
        12 | 101 | 228 | 229 => "IP packets ",
        105 | 127 => "a wireless network ",
        189 | 220 | 249 => "USB ",
        _ => "",
    };
    let problem = format!(
        "is a packet capture (PCAP) of {name}(link type {link}), without frames of a CAN bus; expected link \
         type 227 (SocketCAN), or 113 or 276 (Linux cooked capture)"
    );
    Error::content(file.path(), problem)
}

impl FrameReader for PcapReader {
    fn next_logged(&mut self) -> Result<Option<LoggedFrame>> {
        loop {
            let step = self.step()?;
            let captured = match step {
                Step::Packet(captured) => captured,
                Step::Other => continue,
                Step::Unreadable(problem) => {
                    let error = self.error(problem.what, problem.expected);
                    self.notes.damage.line(error, self.notes.frames)?;
                    continue;
                }
                Step::Damaged(problem, left_out) => {
                    let error = self.error(problem.what, problem.expected);
                    self.notes.damage.block(error, left_out.bytes)?;
                    continue;
                }
                Step::Refused(problem) => {
                    return Err(self.error(problem.what, problem.expected));
                }
                Step::CutOff => {
                    let error = self.error("the file is cut off", "a whole packet");
                    self.notes.damage.cut_off(error)?;
                    continue;
                }
                Step::End => {
                    self.check_network()?;
                    return Ok(None);
                }
            };
            match self.take(&captured) {
                Ok(Some(frame)) => return Ok(Some(frame)),
                Ok(None) => {}
                Err(problem) => {
                    let error = self.error(problem.what, problem.expected);
                    self.notes.damage.line(error, self.notes.frames)?;
                }
            }
        }
    }

    fn error(&self, problem: &str, expected: &str) -> Error {
        error_at(&self.file, self.packet_at, problem, expected)
    }

    fn file(&self) -> &LogFile {
        self.file.log()
    }

    fn notes(&self) -> &LogNotes {
        &self.notes
    }

    fn notes_mut(&mut self) -> &mut LogNotes {
        &mut self.notes
    }
}
