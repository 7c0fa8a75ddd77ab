//! Places in a text, for messages.

use std::ops::Range;

/// Returns the line, from 1, in which a part of a text begins.
pub(in super::super) fn line_of(text: &str, span: &Range<usize>) -> u64 {
    let before = text.as_bytes().get(..span.start).unwrap_or_default();
    1 + before.iter().filter(|byte| **byte == b'\n').count() as u64
}
