//! A piece of the data of a group or of a channel.

use crate::error::Error;

/// What comes next of some data.
pub(in crate::source) enum Piece {
    /// Bytes that follow those before.
    Bytes,
    /// So many bytes are lost (0 if that is not known), with what is wrong and how many bytes of the
    /// file that takes.
    Lost {
        bytes: u64,
        problem: Error,
        in_file: u64,
    },
    /// The file ends within a block.
    CutOff(Error),
    End,
}
