//! `SIGNALS.toml`: which signals of a `.dbc` file, or channels of a log, become signals of ours.

use super::lines::line_of;
use crate::error::{Error, Result};
use crate::files::limits::read_text;
use crate::files::nearest::nearest_in_words;
use estimator_core::Signal;
use std::ops::Range;
use std::path::{Path, PathBuf};
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// The keys of an entry.
const KEYS: [&str; 6] = ["message", "signal", "scale", "offset", "invalid", "values"];

/// What is expected of two of them.
pub(super) const MESSAGE: &str = "name, identifier or PGN of a message";
const SOURCE: &str = "the name of a signal of the message";

/// A `SIGNALS.toml`.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::source) struct MappingFile {
    pub path: PathBuf,
    /// In the order of [`Signal`].
    pub entries: Vec<MappingEntry>,
}

/// A part of the file with its line.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::source) struct Located<T> {
    pub value: T,
    pub line: u64,
}

/// One signal of ours.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::source) struct MappingEntry {
    pub signal: Signal,
    pub line: u64,
    /// Name, identifier or PGN of the message; name of the group of a channel.
    pub message: Option<Located<String>>,
    /// Name of its signal.
    pub source: Located<String>,
    pub scale: Option<f64>,
    pub offset: Option<f64>,
    pub invalid: Vec<i64>,
    pub values: Vec<(i64, f64)>,
}

impl MappingFile {
    /// Reads a file.
    ///
    /// # Errors
    /// Names the line, the key and what was expected, with names that are spelt alike.
    pub(super) fn read(path: &Path) -> Result<Self> {
        let text = read_text(path)?;
        let reader = Reader { path, text: &text };
        let document = DeTable::parse(&text).map_err(|error| {
            let line = error.span().map_or(1, |span| line_of(&text, &span));
            Error::line(path, line, error.message(), "TOML, as in docs/formats.md")
        })?;
        let mut entries = reader.entries(document.get_ref())?;
        entries.sort_by_key(|entry| entry.signal);
        Ok(Self {
            path: path.to_owned(),
            entries,
        })
    }

    /// Returns an error at a part of the file.
    pub(in crate::source) fn error(
        &self,
        line: u64,
        problem: impl Into<String>,
        expected: impl Into<String>,
    ) -> Error {
        Error::line(&self.path, line, problem, expected)
    }
}

/// The text of a file, for its errors.
struct Reader<'a> {
    path: &'a Path,
    text: &'a str,
}

type Value<'t> = Spanned<DeValue<'t>>;

impl Reader<'_> {
    fn error(
        &self,
        span: &Range<usize>,
        problem: impl Into<String>,
        expected: impl Into<String>,
    ) -> Error {
        Error::line(self.path, line_of(self.text, span), problem, expected)
    }

    fn entries(&self, document: &DeTable) -> Result<Vec<MappingEntry>> {
        let mut entries = Vec::new();
        for (key, value) in document {
            if key.get_ref() != "signals" {
                let problem = format!("unknown table `{}`", key.get_ref().escape_debug());
                return Err(self.error(
                    &key.span(),
                    problem,
                    "tables such as \
                    [signals.wheel_speed_mps]",
                ));
            }
            let Some(signals) = value.get_ref().as_table() else {
                let expected = "tables such as [signals.wheel_speed_mps]";
                return Err(self.error(&value.span(), "signals is no table", expected));
            };
            for (name, value) in signals {
                entries.push(self.entry(name.get_ref(), &name.span(), value)?);
            }
        }
        if entries.is_empty() {
            let problem = "no signal; expected tables such as [signals.wheel_speed_mps]";
            return Err(Error::content(self.path, problem));
        }
        Ok(entries)
    }

    fn entry(&self, name: &str, span: &Range<usize>, value: &Value) -> Result<MappingEntry> {
        let Some(signal) = Signal::from_column(name) else {
            let known = Signal::ALL.iter().map(|signal| signal.column());
            let alike = nearest_in_words(name, known);
            let problem = format!("signals.{}: unknown signal", name.escape_debug());
            let expected = format!("a name such as {alike}; `roadgrade columns` lists all");
            return Err(self.error(span, problem, expected));
        };
        let Some(table) = value.get_ref().as_table() else {
            let problem = format!("signals.{name} is no table");
            let expected = format!("[signals.{name}] with message and signal");
            return Err(self.error(&value.span(), problem, expected));
        };
        for (key, _) in table {
            if !KEYS.contains(&&**key.get_ref()) {
                let problem = format!(
                    "signals.{name}.{}: unknown key",
                    key.get_ref().escape_debug()
                );
                let alike = nearest_in_words(key.get_ref(), KEYS);
                return Err(self.error(&key.span(), problem, format!("a key such as {alike}")));
            }
        }
        let keys = Keys {
            reader: self,
            name,
            span,
            table,
        };
        let scale = keys.number("scale")?;
        if scale == Some(0.0) {
            return Err(keys.error("scale", "is 0", "a number other than 0"));
        }
        let source = keys.text("signal", SOURCE)?;
        Ok(MappingEntry {
            signal,
            line: line_of(self.text, span),
            message: keys.text("message", MESSAGE)?,
            source: source.ok_or_else(|| keys.error("signal", "is missing", SOURCE))?,
            scale,
            offset: keys.number("offset")?,
            invalid: keys.codes()?,
            values: keys.values()?,
        })
    }
}

/// The keys of one entry.
struct Keys<'a, 't> {
    reader: &'a Reader<'a>,
    name: &'a str,
    span: &'a Range<usize>,
    table: &'a DeTable<'t>,
}

impl<'t> Keys<'_, 't> {
    fn find(&self, key: &str) -> Option<&Value<'t>> {
        let found = self.table.iter().find(|(of, _)| of.get_ref() == key);
        found.map(|(_, value)| value)
    }

    fn error(&self, key: &str, problem: &str, expected: &str) -> Error {
        let span = self
            .find(key)
            .map_or_else(|| self.span.clone(), Spanned::span);
        let problem = format!("signals.{}.{key} {problem}", self.name);
        self.reader.error(&span, problem, expected)
    }

    /// Returns a text. Integers are texts too: identifiers and PGNs.
    fn text(&self, key: &str, expected: &str) -> Result<Option<Located<String>>> {
        let Some(found) = self.find(key) else {
            return Ok(None);
        };
        let value = match found.get_ref() {
            DeValue::String(text) => text.clone().into_owned(),
            DeValue::Integer(number) => number.to_string(),
            _ => return Err(self.error(key, "is no text", expected)),
        };
        let line = line_of(self.reader.text, &found.span());
        Ok(Some(Located { value, line }))
    }

    fn number(&self, key: &str) -> Result<Option<f64>> {
        let expected = "a finite number";
        self.find(key)
            .map(|found| {
                number_of(found.get_ref()).ok_or_else(|| self.error(key, "is no number", expected))
            })
            .transpose()
    }

    fn codes(&self) -> Result<Vec<i64>> {
        let Some(found) = self.find("invalid") else {
            return Ok(Vec::new());
        };
        let codes = found.get_ref().as_array().map(|codes| {
            let codes = codes.iter().map(|code| integer_of(code.get_ref()));
            codes.collect::<Option<Vec<i64>>>()
        });
        let expected = "a list of raw numbers, integers such as [255]";
        codes
            .flatten()
            .ok_or_else(|| self.error("invalid", "is no list of integers", expected))
    }

    fn values(&self) -> Result<Vec<(i64, f64)>> {
        let Some(found) = self.find("values") else {
            return Ok(Vec::new());
        };
        let pair = |(raw, value): (&Spanned<toml::de::DeString>, &Value)| {
            Some((code_of(raw.get_ref())?, number_of(value.get_ref())?))
        };
        let pairs = found.get_ref().as_table();
        let pairs = pairs.and_then(|pairs| pairs.iter().map(pair).collect());
        let expected = "raw numbers with their values, such as { \"7\" = -1 }";
        pairs.ok_or_else(|| self.error("values", "is no table of numbers", expected))
    }
}

fn integer_of(value: &DeValue) -> Option<i64> {
    match value {
        DeValue::Integer(number) => i64::from_str_radix(number.as_str(), number.radix()).ok(),
        _ => None,
    }
}

fn number_of(value: &DeValue) -> Option<f64> {
    let number = match value {
        DeValue::Integer(_) => integer_of(value)? as f64,
        DeValue::Float(number) => number.as_str().parse().ok()?,
        _ => return None,
    };
    number.is_finite().then_some(number)
}

/// Returns an integer, decimal or, after `0x`, hexadecimal.
pub(super) fn code_of(text: &str) -> Option<i64> {
    match text.strip_prefix("0x").or_else(|| text.strip_prefix("0X")) {
        Some(digits) => i64::from_str_radix(digits, 16).ok(),
        None => text.parse().ok(),
    }
}
