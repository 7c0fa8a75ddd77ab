//! Steps through a packet capture, in either form.

use super::super::byte_file::LeftOut;
use super::super::line_problem::LineProblem;
use super::packet::Link;
use crate::source::interfaces::InterfaceIndex;
use std::ops::Range;

/// A captured packet.
pub(super) struct Captured {
    pub micros: i64,
    pub link: Link,
    /// The interface, if the file has several.
    pub interface: Option<InterfaceIndex>,
    pub whole_bytes: u32,
    /// Where it stands in the bytes that were read.
    pub data: Range<usize>,
    pub is_big_endian: bool,
}

/// What a step through the file comes upon.
pub(super) enum Step {
    Packet(Captured),
    /// A block that has no packet.
    Other,
    /// A whole block that cannot be used.
    Unreadable(LineProblem),
    /// Bytes that are no packet.
    Damaged(LineProblem, LeftOut),
    /// Damage without whose content the rest cannot be read.
    Refused(LineProblem),
    CutOff,
    End,
}

impl Step {
    /// Returns the step over a packet that is longer than the file: if nothing comes behind its beginning,
    /// the file is cut off, else its length is wrong.
    pub(super) fn or_cut_off(self) -> Self {
        match self {
            Self::Damaged(_, left_out) if left_out.is_rest => Self::CutOff,
            Self::Refused(_) => Self::CutOff,
            other => other,
        }
    }
}
