//! Lines and branches that no test reaches, and mutants that no test catches, each with its reason.

use crate::files::{Result, evidence, root, source};
use serde::Deserialize;
use std::collections::{BTreeMap, BTreeSet};

/// What tests of the core do not reach.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Coverage {
    /// Lines.
    #[serde(default)]
    line: Vec<Places>,
    /// Lines with a branch that is taken in one direction only.
    #[serde(default)]
    branch: Vec<Places>,
}

/// Mutants of the core that no test catches.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Mutants {
    #[serde(default)]
    survivor: Vec<Survivor>,
}

/// Lines of a file with one reason. A line is named by its text and that of the line above, so that it
/// is found where others move.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Places {
    file: String,
    /// Why no test reaches them. What begins with "open" has no reason yet.
    reason: String,
    /// Whether the compiler counts them as reached in one build and not in another.
    #[serde(default)]
    varies: bool,
    lines: Vec<String>,
}

/// Begin of the reason of what nobody has argued yet.
const OPEN: &str = "open";

/// Numbers of exceptions.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ExceptionCount {
    /// Those with a reason.
    pub argued: usize,
    /// Those without.
    pub open: usize,
}

impl ExceptionCount {
    fn of(places: &[Places]) -> Self {
        let count = |is_open: bool| {
            let places = places
                .iter()
                .filter(|of| of.reason.starts_with(OPEN) == is_open);
            places.map(|of| of.lines.len()).sum()
        };
        Self {
            argued: count(false),
            open: count(true),
        }
    }
}

/// Returns the name of a line of a source: its text, behind that of the line above.
fn name_of(source: &[&str], number: usize) -> Option<String> {
    let text = source.get(number.checked_sub(1)?)?.trim();
    let above = number.checked_sub(2).and_then(|above| source.get(above));
    Some(format!(
        "{} | {text}",
        above.map_or("", |above| above.trim())
    ))
}

/// A mutant, as cargo-mutants names it behind the line and the column.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Survivor {
    file: String,
    mutant: String,
    reason: String,
}

/// Lines and branches of a measurement.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Measured {
    /// Number of lines, and of those that ran.
    pub lines: (usize, usize),
    /// Number of directions of branches, and of those that were taken.
    pub branches: (usize, usize),
    /// Lines that did not run, by file and number.
    missed_lines: Missed,
    /// Lines with a direction that was not taken.
    missed_branches: Missed,
}

/// Files and numbers of lines.
type Missed = BTreeSet<(String, usize)>;

/// Counts by file, number of the line, and numbers of the branch. What several test programs contain is
/// recorded several times.
type Counts = BTreeMap<(String, Vec<usize>), usize>;

impl Measured {
    /// Reads the records of a file in the format of lcov, for the files below `folder`.
    #[must_use]
    pub fn of_lcov(text: &str, folder: &str) -> Self {
        let (mut lines, mut branches) = (Counts::new(), Counts::new());
        let mut file = None;
        for line in text.lines() {
            if let Some(path) = line.strip_prefix("SF:") {
                let place = path.find(folder);
                file = place.map(|place| path[place..].to_owned());
            }
            let Some(file) = &file else { continue };
            let (records, fields) = match (line.strip_prefix("DA:"), line.strip_prefix("BRDA:")) {
                (Some(fields), _) => (&mut lines, fields),
                (_, Some(fields)) => (&mut branches, fields),
                _ => continue,
            };
            // `-` is a branch that nothing came to.
            let fields = fields.split(',').map(|field| field.parse().unwrap_or(0));
            let mut place: Vec<usize> = fields.collect();
            let count = place.pop().unwrap_or(0);
            *records.entry((file.clone(), place)).or_default() += count;
        }
        Self {
            lines: reached(&lines),
            branches: reached(&branches),
            missed_lines: missed(&lines),
            missed_branches: missed(&branches),
        }
    }
}

/// Returns how many there are, and how many of them were reached.
fn reached(counts: &Counts) -> (usize, usize) {
    let reached = counts.values().filter(|count| **count > 0);
    (counts.len(), reached.count())
}

fn missed(counts: &Counts) -> Missed {
    let missed = counts.iter().filter(|(_, count)| **count == 0);
    missed
        .filter_map(|((file, place), _)| Some((file.clone(), *place.first()?)))
        .collect()
}

impl Coverage {
    /// Reads the committed exceptions.
    ///
    /// # Errors
    /// The file cannot be read, or is not a list of exceptions.
    pub fn read() -> Result<Self> {
        evidence("coverage.toml")
    }

    /// Returns the numbers of exceptions: lines, and lines with a branch.
    #[must_use]
    pub fn count(&self) -> (ExceptionCount, ExceptionCount) {
        (
            ExceptionCount::of(&self.line),
            ExceptionCount::of(&self.branch),
        )
    }

    /// Returns the exceptions without a reason, or of which the source has no such line.
    ///
    /// # Errors
    /// A file cannot be read.
    pub fn problems(&self) -> Result<Vec<String>> {
        let mut problems = Vec::new();
        for Places {
            file,
            reason,
            lines,
            ..
        } in self.line.iter().chain(&self.branch)
        {
            let text = source(file)?;
            let text: Vec<&str> = text.lines().collect();
            let known: BTreeSet<String> = (1..=text.len())
                .filter_map(|number| name_of(&text, number))
                .collect();
            let lost = lines.iter().filter(|line| !known.contains(*line));
            problems.extend(lost.map(|line| format!("{file}: no line `{line}`")));
            if reason.is_empty() {
                problems.push(format!("{file}: no reason"));
            }
        }
        Ok(problems)
    }

    /// Returns what a measurement missed and no exception has: a line each.
    ///
    /// # Errors
    /// A file cannot be read.
    pub fn beyond(&self, measured: &Measured) -> Result<Vec<String>> {
        let mut beyond = Vec::new();
        for (kind, known, missed) in self.beside(measured) {
            let known = names(known.iter());
            for (file, number, name) in named(missed)? {
                if !known.contains(&(file.clone(), name.clone())) {
                    beyond.push(format!("{kind} {file}:{number}: {name}"));
                }
            }
        }
        Ok(beyond)
    }

    /// Returns the exceptions that a measurement did not miss: a line each.
    ///
    /// # Errors
    /// A file cannot be read.
    pub fn needless(&self, measured: &Measured) -> Result<Vec<String>> {
        let mut needless = Vec::new();
        for (kind, known, missed) in self.beside(measured) {
            let missed = named(missed)?.into_iter();
            let missed: Names = missed.map(|(file, _, name)| (file, name)).collect();
            let known = names(known.iter().filter(|of| !of.varies));
            let reached = known.difference(&missed);
            needless.extend(reached.map(|(file, name)| format!("{kind} {file}: {name}")));
        }
        Ok(needless)
    }

    /// Returns the exceptions and what was missed, by kind.
    fn beside<'a>(&'a self, measured: &'a Measured) -> [(&'a str, &'a [Places], &'a Missed); 2] {
        [
            ("line", &self.line, &measured.missed_lines),
            ("branch", &self.branch, &measured.missed_branches),
        ]
    }
}

/// Files and names of lines.
type Names = BTreeSet<(String, String)>;

fn names<'a>(places: impl Iterator<Item = &'a Places>) -> Names {
    let names = places.flat_map(|of| of.lines.iter().map(|name| (of.file.clone(), name.clone())));
    names.collect()
}

/// Returns the file, the number and the name of each line.
fn named(missed: &Missed) -> Result<Vec<(String, usize, String)>> {
    let name = |(file, number): &(String, usize)| {
        let text = source(file)?;
        let text: Vec<&str> = text.lines().collect();
        let name = name_of(&text, *number).unwrap_or_default();
        Ok((file.clone(), *number, name))
    };
    missed.iter().map(name).collect()
}

impl Mutants {
    /// Reads the committed list.
    ///
    /// # Errors
    /// The file cannot be read, or is not a list of mutants.
    pub fn read() -> Result<Self> {
        evidence("mutants.toml")
    }

    /// Returns the number of survivors with a reason.
    #[must_use]
    pub fn count(&self) -> usize {
        self.survivor.len()
    }

    /// Returns the survivors without a reason, and those in files that do not exist.
    #[must_use]
    pub fn problems(&self) -> Vec<String> {
        let is_wrong = |of: &&Survivor| of.reason.is_empty() || !root().join(&of.file).is_file();
        let wrong = self.survivor.iter().filter(is_wrong);
        wrong
            .map(|of| format!("{}: {}: no such file, or no reason", of.file, of.mutant))
            .collect()
    }

    /// Returns the lines of a list of missed mutants that no reason is given for.
    #[must_use]
    pub fn beyond<'a>(&self, missed: &'a str) -> Vec<&'a str> {
        let is_known = |line: &&str| {
            self.survivor.iter().any(|of| {
                let words = line.strip_prefix(&*of.file);
                words.is_some_and(|words| words.ends_with(&format!(": {}", of.mutant)))
            })
        };
        missed.lines().filter(|line| !is_known(line)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_and_branches_of_the_core_are_read() {
        let text = "SF:/a/estimator-core/src/lib.rs\nDA:1,4\nDA:2,0\nBRDA:1,0,0,3\nBRDA:1,0,1,-\nend_of_record\nSF:/a/other/src/lib.rs\nDA:7,0\nend_of_record\n";
        let measured = Measured::of_lcov(text, "estimator-core/src");
        assert_eq!((measured.lines, measured.branches), ((2, 1), (2, 1)));
        let beyond = Coverage::default().beyond(&measured).unwrap();
        assert_eq!(beyond.len(), 2, "{beyond:#?}");
        assert!(beyond[0].starts_with("line estimator-core/src/lib.rs:2: "));
    }

    #[test]
    fn a_survivor_is_known_wherever_its_line_is() {
        let mutants = Mutants {
            survivor: vec![Survivor {
                file: "a.rs".to_owned(),
                mutant: "replace + with - in f".to_owned(),
                reason: "equal".to_owned(),
            }],
        };
        let missed = "a.rs:7:4: replace + with - in f\nb.rs:1:1: replace + with - in f\n";
        assert_eq!(mutants.beyond(missed), ["b.rs:1:1: replace + with - in f"]);
    }
}
