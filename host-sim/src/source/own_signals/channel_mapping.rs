//! A mapping of channels, which a log names itself.

use super::mapping_file::MappingFile;
use crate::error::Result;
use std::path::Path;

/// A `SIGNALS.toml` without a description of a bus: it maps the channels of a log.
#[derive(Clone, Debug, PartialEq)]
pub struct ChannelMapping(MappingFile);

impl ChannelMapping {
    /// Reads a `SIGNALS.toml`.
    ///
    /// # Errors
    /// Names the line, the key and what was expected, with names that are spelt alike.
    pub fn read(path: &Path) -> Result<Self> {
        MappingFile::read(path).map(Self)
    }

    /// Returns its entries.
    pub(in crate::source) const fn file(&self) -> &MappingFile {
        &self.0
    }
}
