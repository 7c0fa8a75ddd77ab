//! The channels of a group, and its time.

use super::catalog::Time;
use super::channel::{Channel, Place, Problem};
use super::scan::Scan;
use crate::error::Result;
use crate::source::mdf::conversion::Conversion;
use crate::source::mdf::field::{
    ChannelHead, Clock, FIXED_LENGTH, Invalid, MASTER, VIRTUAL, VIRTUAL_MASTER,
};
use crate::source::mdf::group::GroupHead;
use crate::source::mdf::mdf_file::Block;
use std::sync::Arc;

/// Most channels of a file.
const MOST_CHANNELS: usize = 1 << 17;
/// Structures within structures.
const DEEPEST: usize = 4;
/// What a master channel counts: seconds, and not radians, metres or records. Some writers do not say.
const SECONDS: [u8; 2] = [0, 1];
/// Flag of a group whose records are events of a bus.
const BUS_EVENT: u16 = 1 << 1;
/// Parts of frames, of which the reader of frames knows those of CAN.
const FRAMES: [&str; 3] = ["CAN_DataFrame", "CAN_RemoteFrame", "CAN_ErrorFrame"];
const EVENTS: [&str; 5] = ["CAN_", "LIN_", "FLX_", "ETH_", "MOST_"];

/// What the channels of a group are.
pub(super) struct Found {
    head: GroupHead,
    is_columns: bool,
    pub time: Time,
    pub channels: Vec<Channel>,
    pub has_frames: bool,
}

impl Found {
    pub(super) fn new(head: GroupHead, is_columns: bool) -> Self {
        Self {
            head,
            is_columns,
            time: Time::None("its group has no channel of times".to_owned()),
            channels: Vec::new(),
            has_frames: false,
        }
    }
}

impl Scan<'_> {
    /// Reads a chain of channels, with those within structures.
    pub(super) fn channels(&mut self, first: u64, found: &mut Found, depth: usize) -> Result<()> {
        let mut next = first;
        while let Some(block) = self.block(next, b"##CN")? {
            next = block.link(0);
            self.channels += 1;
            if self.channels > MOST_CHANNELS {
                let expected = format!("at most {MOST_CHANNELS}");
                return Err(self.file.error("too many channels", &expected));
            }
            let is_array = self.channel(&block, found)?;
            let inside = block.link(1);
            if inside != 0 && !is_array && depth < DEEPEST {
                self.channels(inside, found, depth + 1)?;
            }
        }
        Ok(())
    }

    /// Reads a channel. Returns true for an array.
    fn channel(&mut self, block: &Block, found: &mut Found) -> Result<bool> {
        let name = self.text(block.link(2))?;
        let data = self.file.data(block)?;
        let Some(head) = ChannelHead::read(&data) else {
            let problem = self.file.error("a channel without its fields", "72 bytes");
            self.unless_damaged::<()>(Err(problem))?;
            return Ok(false);
        };
        if matches!(head.kind, MASTER | VIRTUAL_MASTER) {
            found.time = self.time(block, head)?;
            return Ok(false);
        }
        let is_frame = FRAMES.iter().any(|frame| name.starts_with(frame));
        let is_bus_event = found.head.flags & BUS_EVENT != 0;
        if is_frame || (is_bus_event && EVENTS.iter().any(|event| name.starts_with(event))) {
            found.has_frames |= is_frame && name.contains('.');
            return Ok(false);
        }
        if name.is_empty() {
            return Ok(false); // No mapping can name it.
        }
        let is_array = self.is_array(block)?;
        let mut problem = problem_of(head, is_array);
        let mut conversion = Arc::new(Conversion::None);
        if problem.is_none() {
            let read = self.conversions.read(self.file, block.link(4));
            match self.unless_damaged(read)? {
                Some(read) => conversion = read,
                None => problem = Some(Problem::Unreadable("has a damaged conversion".to_owned())),
            }
            problem = problem.or_else(|| conversion.problem().map(Problem::Unreadable));
        }
        found.channels.push(Channel {
            unit: self.unit(block)?,
            name,
            place: if head.kind == VIRTUAL {
                Place::Index
            } else {
                Place::Field(head.field)
            },
            conversion,
            invalid: invalid_of(&data, &found.head, found.is_columns),
            problem,
        });
        Ok(is_array)
    }

    fn is_array(&mut self, block: &Block) -> Result<bool> {
        let inside = block.link(1);
        if inside == 0 {
            return Ok(false);
        }
        let read = self.file.block(inside);
        Ok(self
            .unless_damaged(read)?
            .is_none_or(|block| block.id != *b"##CN"))
    }

    /// Returns the unit of a channel, or of its conversion.
    fn unit(&mut self, block: &Block) -> Result<String> {
        let unit = self.text(block.link(6))?;
        if !unit.is_empty() || block.link(4) == 0 {
            return Ok(unit);
        }
        let conversion = self.file.described(block.link(4), b"##CC");
        match conversion {
            Ok(conversion) => self.text(conversion.link(1)),
            // It is told already.
            Err(_) => Ok(unit),
        }
    }

    fn time(&mut self, block: &Block, head: ChannelHead) -> Result<Time> {
        if !SECONDS.contains(&head.sync) {
            return Ok(Time::None(
                "its group counts in another quantity than time".to_owned(),
            ));
        }
        let field = (head.kind == MASTER).then_some(head.field);
        let clock = Clock::read(self.file, block, field);
        Ok(match self.unless_damaged(clock)? {
            Some(Some(clock)) => Time::Clock(clock),
            _ => Time::None("the times of its group cannot be read".to_owned()),
        })
    }
}

/// Returns why a channel is not read.
fn problem_of(head: ChannelHead, is_array: bool) -> Option<Problem> {
    if is_array {
        return Some(Problem::NoSignal("is an array"));
    }
    match head.kind {
        VIRTUAL => None,
        FIXED_LENGTH if head.field.is_number() => None,
        FIXED_LENGTH => Some(match head.field.data_type {
            0..=5 => {
                let bits = head.field.bits;
                Problem::Unreadable(format!("has numbers of {bits} bits"))
            }
            6..=9 => Problem::NoSignal("is a text"),
            _ => Problem::NoSignal("has bytes that are no number"),
        }),
        _ => Some(Problem::NoSignal("has values of variable length")),
    }
}

/// Returns the marks of a channel, in the record or in bytes of their own.
fn invalid_of(data: &[u8], head: &GroupHead, is_columns: bool) -> Invalid {
    let mut invalid = Invalid::default();
    let data_bytes = if is_columns {
        0
    } else {
        head.data_bytes as usize
    };
    invalid.note(data, data_bytes);
    invalid
}
