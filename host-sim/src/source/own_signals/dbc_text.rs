//! The statements of a `.dbc` file that say where signals are, without all others.
//!
//! Files of the trade have sections that no parser knows in full. What is not of use here is passed by,
//! so that it is no reason to refuse a file.

use std::borrow::Cow;

/// The bit of a number that marks 29-bit identifiers, and the greatest 11-bit identifier.
pub(super) const EXTENDED: u32 = 1 << 31;
const LARGEST_STANDARD: u32 = 0x7ff;

/// Returns the text of a file. The bytes are UTF-8 or the one-byte code of Western Europe, in which most
/// tools write.
pub(super) fn decoded(bytes: &[u8]) -> Cow<'_, str> {
    match str::from_utf8(bytes) {
        Ok(text) => Cow::Borrowed(text.trim_start_matches('\u{feff}')),
        Err(_) => bytes.iter().copied().map(char::from).collect(),
    }
}

/// Returns the lines that begin a statement, with their numbers; not those within quotes.
pub(super) fn statements(text: &str) -> impl Iterator<Item = (u64, &str)> {
    let mut is_within_quotes = false;
    (1..).zip(text.lines()).filter_map(move |(number, line)| {
        let is_statement = !is_within_quotes;
        let quotes = line.replace("\\\"", "").matches('"').count();
        is_within_quotes ^= quotes % 2 == 1;
        is_statement.then(|| (number, line.trim()))
    })
}

/// Returns what stands behind a keyword and a blank.
pub(super) fn behind<'t>(line: &'t str, keyword: &str) -> Option<&'t str> {
    let rest = line.strip_prefix(keyword)?;
    rest.starts_with(char::is_whitespace).then(|| rest.trim())
}

/// Returns the number of a message with the mark of a 29-bit identifier, which some tools forget.
pub(super) const fn marked(number: u32) -> u32 {
    if number > LARGEST_STANDARD {
        number | EXTENDED
    } else {
        number
    }
}

/// Takes a word, in quotes or not, from the head of a text.
pub(super) fn word<'t>(text: &mut &'t str) -> Option<&'t str> {
    let trimmed = text.trim_start();
    let (word, rest) = match trimmed.strip_prefix('"') {
        Some(quoted) => quoted.split_once('"')?,
        None => {
            let is_end = |c: char| c.is_whitespace() || matches!(c, ';' | ',' | ':');
            let end = trimmed.find(is_end).unwrap_or(trimmed.len());
            trimmed.split_at(end)
        }
    };
    *text = rest.trim_start_matches([' ', '\t', ':', ',']);
    (!word.is_empty() || trimmed.starts_with('"')).then_some(word)
}
