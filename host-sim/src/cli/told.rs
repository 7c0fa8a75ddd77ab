//! The last words of a command that wrote a file: a line, or JSON.

use crate::error::{Result, on_one_line};
use crate::terminal::print::{note, print};
use serde_json::Value;
use std::path::Path;

/// What was written, in words and as JSON.
pub(super) struct Told {
    /// Words, behind the name of the file.
    pub words: String,
    /// The same numbers: an object.
    pub json: Value,
}

impl Told {
    /// Prints the object with the name of the output, or the line.
    pub fn tell(mut self, out: &Path, is_json: bool) -> Result<()> {
        if !is_json {
            note(format_args!("{}: {}", on_one_line(out), self.words));
            return Ok(());
        }
        self.json["out"] = out.to_string_lossy().into();
        print(&format!("{:#}\n", self.json))
    }
}
