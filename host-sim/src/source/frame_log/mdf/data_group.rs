//! A data group: its channel groups, and the frames of its records.

use super::layout::{DataField, Event, FrameLayout, Part};
use super::signal_data::SignalData;
use crate::error::Result;
use crate::source::can_frame::CanFrame;
use crate::source::frame_log::fields::identifier;
use crate::source::frame_log::frame_reader::LogNotes;
use crate::source::mdf::group::GroupHead;
use crate::source::mdf::mdf_file::{Block, MdfFile};
use crate::source::mdf::records::{Records, Size, Step};
use embedded_can::Frame;
use std::collections::{BTreeMap, VecDeque};

/// Frames or values that may wait for each other.
const MOST_WAITING: usize = 4096;
/// Bit of an identifier with 29 bits, in files without a channel for it.
const EXTENDED: u64 = 1 << 31;
/// Largest identifier of 11 bits.
const LARGEST_STANDARD: u64 = 0x7ff;
const ID_MASK: u64 = 0x1fff_ffff;
/// Data bytes of a classic frame.
const MOST_BYTES: usize = 8;

/// A frame and where it is from.
#[derive(Clone, Copy)]
pub(super) struct Found {
    pub micros: i64,
    pub channel: u32,
    pub frame: CanFrame,
}

/// What a record says without its data.
#[derive(Clone, Copy)]
struct Head {
    micros: i64,
    channel: u32,
    raw_id: u32,
    is_extended: bool,
    is_remote: bool,
    is_fd: bool,
    length: usize,
}

/// Where the data of a group of frames come from.
enum Payload {
    InRecord,
    /// Another group of the same data group, by its number. Its records come in the same order.
    OtherGroup(u64),
    Signal(SignalData),
}

struct FrameGroup {
    layout: FrameLayout,
    payload: Payload,
    heads: VecDeque<Head>,
    values: VecDeque<([u8; MOST_BYTES], usize)>,
}

/// The frames of one data group.
pub(super) struct DataGroup {
    records: Records,
    groups: BTreeMap<u64, FrameGroup>,
}

impl DataGroup {
    /// Reads what a data group has; `None` if it has no frames.
    pub(super) fn read(file: &mut MdfFile, block: &Block) -> Result<Option<Self>> {
        let id_bytes = file
            .data(block)?
            .first()
            .map_or(0, |count| usize::from(*count));
        let mut sizes = BTreeMap::new();
        let mut layouts = Vec::new();
        let mut numbers = BTreeMap::new();
        let mut next = block.link(1);
        while next != 0 {
            let group = file.described(next, b"##CG")?;
            let head = GroupHead::read(file, &group)?;
            let size = head.size();
            numbers.insert(next, head.id);
            sizes.insert(head.id, size);
            let data_bytes = head.data_bytes as usize;
            if size != Size::Variable
                && let Some(layout) = FrameLayout::read(file, group.link(1), data_bytes)?
            {
                layouts.push((head.id, layout));
            }
            next = group.link(0);
        }
        if layouts.is_empty() {
            return Ok(None);
        }
        let groups = layouts.into_iter().map(|(id, layout)| {
            let payload = match layout.data {
                Some(DataField::Variable { link, .. }) => match numbers.get(&link) {
                    Some(number) => Payload::OtherGroup(*number),
                    None => Payload::Signal(SignalData::new(link)),
                },
                _ => Payload::InRecord,
            };
            (id, FrameGroup::new(layout, payload))
        });
        Ok(Some(Self {
            groups: groups.collect(),
            records: Records::new(block.link(2), id_bytes, sizes),
        }))
    }

    /// Reads the next frame; `None` at the end.
    ///
    /// # Errors
    /// Returns an error of the disk, and what the damage check does not allow.
    pub(super) fn next_frame(
        &mut self,
        file: &mut MdfFile,
        notes: &mut LogNotes,
    ) -> Result<Option<Found>> {
        loop {
            let (id, length) = match self.records.next(file, &mut notes.damage)? {
                Step::Record { id, length } => (id, length),
                Step::Lost => {
                    for group in self.groups.values_mut() {
                        group.heads.clear();
                        group.values.clear();
                    }
                    continue;
                }
                Step::End => return Ok(None),
            };
            let record = self.records.record(length);
            let found = match self.groups.get_mut(&id) {
                Some(group) => group.take(record, file, notes)?,
                None => self.take_value(id, length),
            };
            if found.is_some() {
                return Ok(found);
            }
        }
    }

    /// Takes a value that may belong to a frame.
    fn take_value(&mut self, id: u64, length: usize) -> Option<Found> {
        let value = self.records.record(length);
        let is_of = |group: &&mut FrameGroup| matches!(group.payload, Payload::OtherGroup(number) if number == id);
        let group = self.groups.values_mut().find(is_of)?;
        let mut bytes = [0; MOST_BYTES];
        for (to, from) in bytes.iter_mut().zip(value) {
            *to = *from;
        }
        group.values.push_back((bytes, value.len()));
        group.pair()
    }
}

impl FrameGroup {
    fn new(layout: FrameLayout, payload: Payload) -> Self {
        Self {
            layout,
            payload,
            heads: VecDeque::new(),
            values: VecDeque::new(),
        }
    }

    /// Takes a record of the group. Returns its frame, if it is one and complete.
    fn take(
        &mut self,
        record: &[u8],
        file: &mut MdfFile,
        notes: &mut LogNotes,
    ) -> Result<Option<Found>> {
        if self.layout.event == Event::Error {
            notes.skipped.bus_errors += 1;
            return Ok(None);
        }
        if self.layout.is_invalid(record) {
            notes.skipped.invalid += 1;
            if let Payload::OtherGroup(_) = self.payload {
                self.heads.push_back(Head::NONE);
                return Ok(self.pair());
            }
            return Ok(None);
        }
        let Some(head) = self.head(record) else {
            let error = file.error("a record without its fields", "time, identifier and length");
            notes.damage.line(error, notes.frames)?;
            return Ok(None);
        };
        let is_fd = head.is_fd || head.length > MOST_BYTES;
        if is_fd {
            notes.skipped.can_fd += 1;
        }
        if let Payload::OtherGroup(_) = self.payload {
            self.heads.push_back(head);
            return Ok(self.pair());
        }
        if is_fd {
            return Ok(None);
        }
        let value = match (&mut self.payload, self.layout.data) {
            (Payload::Signal(data), Some(DataField::Variable { offset, .. })) => {
                let offset = offset.raw(record);
                match offset {
                    Some(offset) => data.value(offset, file, &mut notes.damage)?,
                    None => None,
                }
            }
            (_, Some(DataField::Fixed { byte, length })) => {
                record.get(byte..).and_then(|bytes| bytes.get(..length))
            }
            _ => None,
        };
        let found = head.with(value);
        if found.is_none() {
            let error = file.error(
                "a frame without its data",
                "as many bytes as its length says",
            );
            notes.damage.line(error, notes.frames)?;
        }
        Ok(found)
    }

    /// Reads what a record has besides data.
    fn head(&self, record: &[u8]) -> Option<Head> {
        let layout = &self.layout;
        // A part that the file has, but that cannot be read, leaves out the record.
        let read = |part: &Option<Part>| match part {
            Some(part) => part.number(record).map(Some),
            None => Some(None),
        };
        let raw = read(&layout.id)??;
        let is_extended = match read(&layout.ide)? {
            Some(flag) => flag != 0,
            None => raw & EXTENDED != 0 || raw > LARGEST_STANDARD,
        };
        // The length code of more than 8 bytes is 8 in a classic frame.
        let of_code = |code: u64| code.min(MOST_BYTES as u64);
        let length = match read(&layout.length)? {
            Some(length) => length,
            None => of_code(read(&layout.dlc)??),
        };
        Some(Head {
            micros: layout.clock?.micros(record, 0)?,
            channel: read(&layout.bus)?.unwrap_or(1) as u32,
            raw_id: (raw & ID_MASK) as u32,
            is_extended,
            is_remote: layout.event == Event::Remote,
            is_fd: read(&layout.is_fd)? == Some(1),
            length: length as usize,
        })
    }

    /// Returns the next frame whose head and data are both there.
    fn pair(&mut self) -> Option<Found> {
        while !self.heads.is_empty() && !self.values.is_empty() {
            let (head, (bytes, length)) = self.heads.pop_front().zip(self.values.pop_front())?;
            // CAN FD frames and invalid records are counted already.
            if !head.is_fd
                && head.length <= MOST_BYTES
                && length <= MOST_BYTES
                && let Some(found) = head.with(bytes.get(..length))
            {
                return Some(found);
            }
        }
        if self.heads.len().max(self.values.len()) > MOST_WAITING {
            self.heads.clear();
            self.values.clear();
        }
        None
    }
}

impl Head {
    /// The head of a record that is no frame, for the data that belong to it.
    const NONE: Self = Self {
        micros: 0,
        channel: 0,
        raw_id: 0,
        is_extended: false,
        is_remote: false,
        is_fd: true,
        length: usize::MAX,
    };

    /// Returns the frame with these data; `None` if there are too few.
    fn with(&self, data: Option<&[u8]>) -> Option<Found> {
        let id = identifier(self.raw_id, self.is_extended)?;
        let frame = if self.is_remote {
            CanFrame::new_remote(id, self.length)?
        } else {
            CanFrame::new(id, data.unwrap_or_default().get(..self.length)?)?
        };
        Some(Found {
            micros: self.micros,
            channel: self.channel,
            frame,
        })
    }
}
