//! `COLUMNS.toml`: which columns of a table become signals of ours.

use super::time_column::{TIME, TimeUnit};
use crate::error::{Error, Result};
use crate::files::limits::read_text;
use crate::files::nearest::nearest_in_words;
use crate::source::own_signals::{line_of, units};
use estimator_core::Signal;
use serde::Deserialize;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use toml::Spanned;

/// The file as it is written.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Written {
    columns: BTreeMap<String, Spanned<WrittenColumn>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct WrittenColumn {
    column: String,
    unit: Option<String>,
    scale: Option<f64>,
    offset: Option<f64>,
}

/// A mapping of the columns of a table.
#[derive(Clone, Debug, PartialEq)]
pub struct ColumnsFile {
    path: PathBuf,
    /// The column of the time, if it is mapped.
    pub(super) time: Option<Mapped<TimeUnit>>,
    /// The columns of signals.
    pub(super) signals: Vec<(Signal, Mapped<(f64, f64)>)>,
}

/// A column of the table, and how it becomes ours where that is said: else its header decides.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Mapped<T> {
    pub column: String,
    pub conversion: Option<T>,
    line: u64,
}

impl ColumnsFile {
    /// Reads a file.
    ///
    /// # Errors
    /// Names the line, the key and what was expected, with names that are spelt alike.
    pub fn read(path: &Path) -> Result<Self> {
        let text = read_text(path)?;
        let written: Written = toml::from_str(&text).map_err(|error| {
            let line = error.span().map_or(1, |span| line_of(&text, &span));
            Error::line(
                path,
                line,
                error.message(),
                "tables such as [columns.wheel_speed_mps] with column, and unit or scale and offset",
            )
        })?;
        let mut file = Self {
            path: path.to_owned(),
            time: None,
            signals: Vec::new(),
        };
        for (name, written) in written.columns {
            let line = line_of(&text, &written.span());
            file.take(&name, written.into_inner(), line)?;
        }
        Ok(file)
    }

    fn take(&mut self, name: &str, written: WrittenColumn, line: u64) -> Result<()> {
        let error = |key: &str, problem: &str, expected: String| {
            let problem = format!("columns.{}{key} {problem}", name.escape_debug());
            Error::line(&self.path, line, problem, expected)
        };
        let has_numbers = written.scale.is_some() || written.offset.is_some();
        let is_finite = |number: Option<f64>| number.is_none_or(f64::is_finite);
        if !is_finite(written.scale) || !is_finite(written.offset) || written.scale == Some(0.0) {
            let expected = "finite numbers; a scale other than 0";
            return Err(error(
                "",
                "has a wrong scale or offset",
                expected.to_owned(),
            ));
        }
        if written.unit.is_some() && has_numbers {
            let expected = "either unit, or scale and offset".to_owned();
            return Err(error("", "has a unit and a scale or offset", expected));
        }
        let column = written.column;
        if name == TIME {
            if has_numbers {
                let expected = "unit: s, ms, us, ns or iso".to_owned();
                return Err(error("", "has a scale or offset", expected));
            }
            let unit = written.unit.as_deref().map(|unit| {
                let expected = || "s, ms, us, ns or iso".to_owned();
                TimeUnit::named(unit)
                    .ok_or_else(|| error(".unit", "is no unit of time", expected()))
            });
            self.time = Some(Mapped {
                column,
                conversion: unit.transpose()?,
                line,
            });
            return Ok(());
        }
        let Some(signal) = Signal::from_column(name) else {
            let known = Signal::ALL.iter().map(|signal| signal.column());
            let alike = nearest_in_words(name, known.chain([TIME]));
            let expected = format!("a name such as {alike}; `roadgrade columns` lists all");
            return Err(error("", "is an unknown signal", expected));
        };
        let of_unit = written.unit.as_deref().map(|unit| {
            let expected = || format!("a unit that becomes that of {name}, or scale and offset");
            let problem = format!("is `{}`", unit.escape_debug());
            units::conversion(unit, signal).ok_or_else(|| error(".unit", &problem, expected()))
        });
        let given =
            has_numbers.then(|| (written.scale.unwrap_or(1.0), written.offset.unwrap_or(0.0)));
        let conversion = of_unit.transpose()?.or(given);
        let mapped = Mapped {
            column,
            conversion,
            line,
        };
        self.signals.push((signal, mapped));
        Ok(())
    }

    /// Returns the error for a column whose header has a unit that does not become ours.
    pub(super) fn unknown_unit<T>(&self, mapped: &Mapped<T>, signal: Signal, unit: &str) -> Error {
        let (column, unit) = (mapped.column.escape_debug(), unit.escape_debug());
        let name = signal.column();
        let problem = format!("column `{column}` is in `{unit}`, which does not become {name}");
        let expected = "unit, or scale and offset";
        Error::line(&self.path, mapped.line, problem, expected)
    }

    /// Returns the error for a column that a table lacks.
    pub(super) fn missing<T>(&self, mapped: &Mapped<T>, table: &Path, names: &[String]) -> Error {
        let column = mapped.column.escape_debug();
        let alike = nearest_in_words(&mapped.column, names.iter().map(String::as_str));
        let problem = format!("column `{column}` is not in {}", table.display());
        Error::line(
            &self.path,
            mapped.line,
            problem,
            format!("one such as {alike}"),
        )
    }
}
