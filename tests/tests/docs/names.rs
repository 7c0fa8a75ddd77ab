//! Paths and names in code that pages mention exist.

use super::markdown::files;
use super::{pages, place, root};
use estimator_core::Tuning;
use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

/// Page about earlier releases, whose names may no longer exist.
const HISTORY: &str = "CHANGELOG.md";
/// Folders to which paths in pages may be relative.
const USUAL: [&str; 6] = [
    "",
    "docs",
    "estimator-core/src",
    "estimator-core/src/filter",
    "estimator-core/dbc",
    "host-sim/src",
];
/// Names of other projects: of tools, and of functions that the reader of an example writes.
const OF_OTHERS: [&str; 6] = [
    "read_parquet",
    "hive_partitioning",
    "use_now",
    "spark_sql",
    "arrow_schema",
    "osm_id",
];

#[test]
fn paths_exist() {
    let mut problems = Vec::new();
    let mut count = 0;
    for page in pages().iter().filter(|page| !page.path.ends_with(HISTORY)) {
        for (line, code) in &page.code {
            if is_path(code) {
                count += 1;
                let path = code.trim_end_matches('/');
                if !USUAL
                    .iter()
                    .any(|usual| root().join(usual).join(path).exists())
                {
                    problems.push(format!(
                        "{}: no file or folder `{code}`",
                        place(&page.path, *line)
                    ));
                }
            }
        }
    }
    assert!(count > 100, "{count} paths");
    assert!(problems.is_empty(), "{}", problems.join("\n"));
}

#[test]
fn names_exist() {
    let known = words_of_the_source();
    let mut problems = Vec::new();
    let mut count = 0;
    for page in pages().iter().filter(|page| !page.path.ends_with(HISTORY)) {
        for (line, code) in &page.code {
            if is_path(code) {
                continue;
            }
            for name in names(code) {
                count += 1;
                if !known.contains(name) && !OF_OTHERS.contains(&name) {
                    problems.push(format!(
                        "{}: no `{name}` in the source",
                        place(&page.path, *line)
                    ));
                }
            }
        }
    }
    assert!(count > 300, "{count} names");
    assert!(problems.is_empty(), "{}", problems.join("\n"));
}

/// Returns whether code is a path of this repository: of a file of a kind that it has, or a folder.
fn is_path(code: &str) -> bool {
    let has_ending = code.ends_with(".rs");
    let is_in_a_part = [
        "docs/",
        "estimator-core/",
        "firmware/",
        "host-sim/",
        "tests/",
    ]
    .iter()
    .any(|part| code.starts_with(part));
    let is_folder = code.ends_with('/') && !code.contains("://");
    !code.contains([' ', '*', '…', '{']) && (has_ending || is_in_a_part || is_folder)
}

/// Returns the words in code that are names in a program: with an underscore or an inner capital, or
/// parts of a path. Symbols of mathematics (`c_d`, `s_road`) begin with a single letter.
fn names(code: &str) -> impl Iterator<Item = &str> {
    let is_qualified = code.contains("::");
    code.split(|of: char| !(of.is_ascii_alphanumeric() || of == '_'))
        .filter(move |word| {
            let first = word.split('_').next().unwrap_or_default();
            let is_snake = word.contains('_') && first.len() > 1 && !word.ends_with('_');
            let is_camel = word.starts_with(|of: char| of.is_ascii_uppercase())
                && word.chars().skip(1).any(|of| of.is_ascii_lowercase())
                && word.chars().skip(1).any(|of| of.is_ascii_uppercase());
            is_snake || is_camel || (is_qualified && word.len() > 1)
        })
}

/// Returns every word of the repository's source: code, layouts, tables, statements and scripts.
fn words_of_the_source() -> BTreeSet<String> {
    // A macro makes the keys of durations.
    let mut words: BTreeSet<String> = Tuning::PARAMETERS
        .iter()
        .map(|of| of.key.to_owned())
        .collect();
    let this_test = root().join("tests/tests/docs");
    for file in files(&root()) {
        let is_prose = file.extension().is_some_and(|of| of == "md" || of == "svg");
        // A third-party library's names are not ours.
        let is_third_party = file.components().any(|of| of.as_os_str() == "uplot");
        if is_prose || is_third_party || file.starts_with(&this_test) {
            continue;
        }
        // Binary files have no names.
        if let Ok(text) = fs::read_to_string(&file) {
            words.extend(
                text.split(|of: char| !(of.is_ascii_alphanumeric() || of == '_'))
                    .map(str::to_owned),
            );
        }
        if let Some(name) = file.file_stem().and_then(|name| name.to_str()) {
            words.insert(name.to_owned());
        }
        if let Some(folder) = file.parent().and_then(Path::file_name) {
            words.insert(folder.to_string_lossy().into_owned());
        }
    }
    words
}

#[test]
fn names_are_distinguished_from_mathematics() {
    let of = |code| names(code).collect::<Vec<_>>();
    assert_eq!(of("`(100 c_r cold_tyre_rolling)²"), ["cold_tyre_rolling"]);
    assert_eq!(of("Estimator::restore"), ["Estimator", "restore"]);
    assert!(of("s_road ≈ (1 + κ) ℓ − 100 c_r").is_empty());
    assert!(is_path("filter/state.rs") && is_path("altitude_gate/") && !is_path("x / y"));
}
