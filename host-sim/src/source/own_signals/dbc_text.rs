//! The statements of a `.dbc` file that say where signals are, without all others.
//!
//! Files of the trade have sections that no parser knows in full. What is not of use here is blanked
//! before parsing, so that it is no reason to refuse a file; lines keep their numbers.

use std::borrow::Cow;
use std::collections::BTreeSet;

/// Statements that are kept: messages, signals, kinds of floating-point numbers, multiplexers.
const KEPT: [&str; 4] = ["BO_ ", "SG_ ", "SIG_VALTYPE_ ", "SG_MUL_VAL_ "];
/// Of these, statements that name a message by its number.
const NUMBERED: [&str; 3] = ["BO_ ", "SIG_VALTYPE_ ", "SG_MUL_VAL_ "];
/// The attribute that tells parameter groups of J1939, and its value for them (Vector's templates).
const FRAME_FORMAT: &str = "BA_ \"VFrameFormat\" BO_ ";
const J1939_FORMAT: &str = "3";
/// The bit of a number that marks 29-bit identifiers, and the greatest 11-bit identifier.
pub(super) const EXTENDED: u32 = 1 << 31;
const LARGEST_STANDARD: u32 = 0x7ff;

/// The statements of a file.
#[derive(Debug, Default)]
pub(super) struct Statements {
    /// The kept statements, each in its line.
    pub text: String,
    /// Numbers of the messages that are parameter groups of J1939.
    pub j1939: BTreeSet<u32>,
}

impl Statements {
    /// Finds the statements. The bytes are UTF-8 or the one-byte code of Western Europe, in which
    /// most tools write.
    pub(super) fn of(bytes: &[u8]) -> Self {
        let text = match str::from_utf8(bytes) {
            Ok(text) => Cow::Borrowed(text.trim_start_matches('\u{feff}')),
            Err(_) => bytes.iter().copied().map(char::from).collect(),
        };
        let mut found = Self::default();
        let mut is_within_quotes = false;
        for line in text.lines() {
            if !is_within_quotes {
                found.take(line.trim());
            }
            found.text.push('\n');
            let quotes = line.replace("\\\"", "").matches('"').count();
            is_within_quotes ^= quotes % 2 == 1;
        }
        found
    }

    fn take(&mut self, line: &str) {
        // Between a keyword and its number are any blanks.
        let line = line.split_whitespace().collect::<Vec<_>>().join(" ");
        if let Some(format) = line.strip_prefix(FRAME_FORMAT) {
            let mut words = format.trim_end_matches([';', ' ']).split(' ');
            let number = words.next().and_then(|number| number.parse().ok());
            if let (Some(number), Some(J1939_FORMAT)) = (number, words.next()) {
                self.j1939.insert(marked(number));
            }
        }
        if KEPT.iter().any(|keyword| line.starts_with(keyword)) {
            // A signal belongs to the message above it by its indentation.
            self.text.push(' ');
            self.text.push_str(&with_marked_number(&line));
        }
    }
}

/// Returns the number of a message with the mark of a 29-bit identifier, which some tools forget.
const fn marked(number: u32) -> u32 {
    if number > LARGEST_STANDARD {
        number | EXTENDED
    } else {
        number
    }
}

fn with_marked_number(line: &str) -> Cow<'_, str> {
    let keyword = NUMBERED.iter().find(|keyword| line.starts_with(**keyword));
    let rest = keyword.and_then(|keyword| line.strip_prefix(keyword));
    let numbered = rest.and_then(|rest| rest.split_once(' '));
    match (keyword, numbered) {
        (Some(keyword), Some((number, rest))) => match number.parse() {
            Ok(number) => Cow::Owned(format!("{keyword}{} {rest}", marked(number))),
            Err(_) => Cow::Borrowed(line),
        },
        _ => Cow::Borrowed(line),
    }
}
