//! The test functions of the repository, by file.

use crate::files::{Result, problem, root, text};
use std::path::Path;
use walkdir::WalkDir;

/// A test function.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct TestFunction {
    /// Path of its file from the root of the repository.
    pub file: String,
    /// Its name.
    pub name: String,
}

/// Returns the test functions below a folder, in the order of their files.
///
/// # Errors
/// The folder or a file in it cannot be read.
pub fn test_functions(folder: &str) -> Result<Vec<TestFunction>> {
    let top = root().join(folder);
    let mut functions = Vec::new();
    for entry in WalkDir::new(&top).sort_by_file_name() {
        let entry = entry.map_err(|error| problem(&top, error))?;
        let path = entry.path();
        if path.extension().is_none_or(|extension| extension != "rs") {
            continue;
        }
        let text = text(path)?;
        let file = path.strip_prefix(root()).unwrap_or(path);
        functions.extend(in_source(file, &text));
    }
    Ok(functions)
}

/// Returns the functions behind `#[test]`. Property tests stand within a macro, where only the text
/// shows them.
fn in_source(file: &Path, text: &str) -> Vec<TestFunction> {
    let mut is_test = false;
    let mut functions = Vec::new();
    for line in text.lines() {
        let line = line.trim();
        is_test |= line == "#[test]";
        let name = line
            .strip_prefix("fn ")
            .and_then(|line| line.split('(').next());
        if let (true, Some(name)) = (is_test, name) {
            functions.push(TestFunction {
                file: file.display().to_string(),
                name: name.to_owned(),
            });
            is_test = false;
        }
    }
    functions
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn functions_behind_the_attribute_are_tests() {
        let text = "#[test]\n#[ignore]\nfn a() {}\nfn b() {}\nproptest! {\n    #[test]\n    fn c(x in 0..1) {}\n}\n";
        let names = in_source(Path::new("f.rs"), text)
            .into_iter()
            .map(|of| of.name);
        assert_eq!(names.collect::<Vec<_>>(), ["a", "c"]);
    }
}
