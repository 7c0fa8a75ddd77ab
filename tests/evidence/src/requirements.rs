//! The requirements, and the tests that hold each.

use crate::files::{Result, evidence, problem, root, text};
use crate::test_functions::{TestFunction, test_functions};
use serde::Deserialize;
use std::collections::BTreeSet;
use std::fs;

/// Folders of which each test belongs to a requirement.
const OF_THE_CORE: [&str; 5] = [
    "estimator-core/src",
    "estimator-core/tests",
    "firmware/c/tests",
    "tests/evidence",
    "tests/tests",
];
/// Folders in which requirements may name tests besides.
const BESIDES: [&str; 1] = ["host-sim/tests"];

/// The table of requirements.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Requirements {
    requirement: Vec<Requirement>,
    #[serde(default)]
    without_requirement: Vec<WithoutRequirement>,
}

/// A requirement.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Requirement {
    /// Its number, which it keeps.
    pub id: String,
    /// What must hold.
    pub text: String,
    /// The page and the heading that state it.
    pub stands: String,
    /// Files of tests, for all in them, or `file::function`.
    #[serde(default)]
    pub tests: Vec<String>,
    /// Names of checks of `tests/run`.
    #[serde(default)]
    pub checks: Vec<String>,
}

/// Tests that belong to no requirement of the core.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct WithoutRequirement {
    reason: String,
    tests: Vec<String>,
}

impl Requirements {
    /// Reads the committed table.
    ///
    /// # Errors
    /// The file cannot be read, or is not a table of requirements.
    pub fn read() -> Result<Self> {
        evidence("requirements.toml")
    }

    /// Returns all requirements.
    pub fn iter(&self) -> impl Iterator<Item = &Requirement> {
        self.requirement.iter()
    }

    /// Returns the files with tests of the core, each with the numbers of its requirements.
    ///
    /// # Errors
    /// The tests cannot be read.
    pub fn by_file(&self) -> Result<Vec<(String, Vec<&str>)>> {
        let mut files: Vec<String> = tests_of(&OF_THE_CORE)?
            .into_iter()
            .map(|of| of.file)
            .collect();
        files.dedup();
        let rows = files.into_iter().map(|file| {
            let names_file = |name: &String| file_of(name) == file;
            let of = self.iter().filter(|of| of.tests.iter().any(names_file));
            let ids = of.map(|of| of.id.as_str()).collect();
            (file, ids)
        });
        Ok(rows.collect())
    }

    /// Returns what is missing or wrong, a line each.
    ///
    /// # Errors
    /// Tests or checks cannot be read.
    pub fn problems(&self) -> Result<Vec<String>> {
        let core = tests_of(&OF_THE_CORE)?;
        let mut all = tests_of(&BESIDES)?;
        all.extend(core.iter().cloned());
        let checks = checks()?;
        let mut problems = Vec::new();
        let mut known = BTreeSet::new();
        for Requirement {
            id,
            tests,
            checks: named,
            ..
        } in self.iter()
        {
            if !known.insert(id) {
                problems.push(format!("{id}: a number is given once"));
            }
            if tests.is_empty() && named.is_empty() {
                problems.push(format!("{id}: no test and no check"));
            }
            let missing = tests
                .iter()
                .filter(|name| !all.iter().any(|test| is_named(test, name)));
            problems.extend(missing.map(|name| format!("{id}: no test {name}")));
            let missing = named.iter().filter(|name| !checks.contains(*name));
            problems.extend(missing.map(|name| format!("{id}: no check {name}")));
        }
        for WithoutRequirement { reason, tests } in &self.without_requirement {
            let missing = tests
                .iter()
                .filter(|name| !all.iter().any(|test| is_named(test, name)));
            problems.extend(missing.map(|name| format!("{reason}: no test {name}")));
        }
        let lost = core.iter().filter(|test| !self.names(test));
        problems.extend(lost.map(|TestFunction { file, name }| {
            format!("{file}::{name}: no requirement names this test")
        }));
        Ok(problems)
    }

    /// Returns whether a requirement, or the list of tests without one, names a test.
    fn names(&self, test: &TestFunction) -> bool {
        let without = self.without_requirement.iter().flat_map(|of| &of.tests);
        let named = self.iter().flat_map(|of| &of.tests);
        named.chain(without).any(|name| is_named(test, name))
    }
}

fn is_named(test: &TestFunction, name: &str) -> bool {
    match name.split_once("::") {
        Some((file, function)) => test.file == file && test.name == function,
        None => test.file == name,
    }
}

fn file_of(name: &str) -> &str {
    name.split("::").next().unwrap_or(name)
}

fn tests_of(folders: &[&str]) -> Result<Vec<TestFunction>> {
    let mut tests = Vec::new();
    for folder in folders {
        tests.extend(test_functions(folder)?);
    }
    Ok(tests)
}

/// Returns the names of the checks of `tests/run`: its functions `check_NAME`.
fn checks() -> Result<BTreeSet<String>> {
    let folder = root().join("tests/checks");
    let mut names = BTreeSet::new();
    for entry in fs::read_dir(&folder).map_err(|error| problem(&folder, error))? {
        let path = entry.map_err(|error| problem(&folder, error))?.path();
        let text = text(&path)?;
        let functions = text.lines().filter_map(|line| line.strip_prefix("check_"));
        names.extend(functions.filter_map(|line| Some(line.split_once("()")?.0.to_owned())));
    }
    Ok(names)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table(text: &str) -> Vec<String> {
        toml::from_str::<Requirements>(text)
            .unwrap()
            .problems()
            .unwrap()
    }

    #[test]
    fn what_does_not_exist_is_named() {
        let problems = table(
            r#"
            [[requirement]]
            id = "A-1"
            text = ""
            stands = ""
            tests = ["estimator-core/tests/nothing.rs", "tests/tests/licences.rs::nothing"]
            checks = ["nothing"]
            [[requirement]]
            id = "A-1"
            text = ""
            stands = ""
            "#,
        );
        for problem in [
            "A-1: no test estimator-core/tests/nothing.rs",
            "A-1: no test tests/tests/licences.rs::nothing",
            "A-1: no check nothing",
            "A-1: a number is given once",
            "A-1: no test and no check",
            "tests/tests/floors/main.rs::known_imports_are_found: no requirement names this test",
        ] {
            assert!(
                problems.iter().any(|of| of == problem),
                "{problem}: {problems:#?}"
            );
        }
    }
}
