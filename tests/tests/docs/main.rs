//! The documentation is correct: its links and names exist, and its tables are current.

mod commands;
mod markdown;
mod names;

use cross_tests::docs::{Cost, pages as generated};
use cross_tests::image::root;
use markdown::{Page, files};
use similar::TextDiff;
use std::path::Path;
use std::sync::LazyLock;

const REFRESH: &str =
    "to make them again: cargo run -p cross-tests --release --example docs -- --write";

/// Every page in Markdown of the repository.
fn pages() -> &'static [Page] {
    static PAGES: LazyLock<Vec<Page>> = LazyLock::new(|| {
        let files = files(&root());
        let pages = files
            .iter()
            .filter(|of| of.extension().is_some_and(|of| of == "md"));
        pages.map(|path| Page::read(path)).collect()
    });
    &PAGES
}

/// Returns the place of a line: path and line number.
fn place(path: &Path, line: usize) -> String {
    let path = path.strip_prefix(root()).unwrap_or(path);
    format!("{}:{line}", path.display())
}

#[test]
fn links_lead_to_files_and_headings() {
    let mut problems = Vec::new();
    let mut count = 0;
    for page in pages() {
        for (line, link) in &page.links {
            if link.contains("://") || link.starts_with("mailto:") {
                continue;
            }
            count += 1;
            let (file, heading) = link.split_once('#').unwrap_or((link, ""));
            let folder = page.path.parent().unwrap();
            let target = if file.is_empty() {
                page.path.clone()
            } else {
                folder.join(file)
            };
            let place = place(&page.path, *line);
            let Ok(target) = target.canonicalize() else {
                problems.push(format!("{place}: {link}: no such file"));
                continue;
            };
            if heading.is_empty() {
                continue;
            }
            let other = pages()
                .iter()
                .find(|of| of.path.canonicalize().is_ok_and(|of| of == target));
            if !other.is_some_and(|of| of.anchors.iter().any(|anchor| anchor == heading)) {
                problems.push(format!("{place}: {link}: no such heading"));
            }
        }
    }
    assert!(count > 100, "{count} links");
    assert!(problems.is_empty(), "{}", problems.join("\n"));
}

#[test]
fn every_page_of_the_book_is_in_its_summary() {
    let docs = root().join("docs");
    let summary = Page::read(&docs.join("SUMMARY.md"));
    for page in files(&docs) {
        let name = page.strip_prefix(&docs).unwrap().to_str().unwrap();
        if name.ends_with(".md") && name != "SUMMARY.md" {
            let is_listed = summary.links.iter().any(|(_, link)| link == name);
            assert!(is_listed, "{name} is not in docs/SUMMARY.md");
        }
    }
}

#[test]
fn every_test_program_is_in_the_table_of_tests() {
    let testing = Page::read(&root().join("docs/testing.md"));
    for folder in ["estimator-core/tests", "host-sim/tests", "tests/tests"] {
        for entry in std::fs::read_dir(root().join(folder)).unwrap() {
            let path = entry.unwrap().path();
            let name = path.file_stem().unwrap().to_str().unwrap();
            let is_program = path.join("main.rs").exists() || path.is_file();
            let is_listed = testing.code.iter().any(|(_, code)| code == name);
            assert!(
                is_listed || !is_program,
                "{folder}/{name} is not in docs/testing.md"
            );
        }
    }
}

#[test]
fn tables_are_current() {
    let made = generated(Cost::Seconds).unwrap();
    for block in &made.skipped {
        eprintln!("SKIPPED: the block {block}, whose measured data are absent");
    }
    for page in &made.pages {
        let diff = TextDiff::from_lines(&page.committed, &page.current);
        let changes = diff.unified_diff().to_string();
        assert!(
            changes.is_empty(),
            "{}\n{changes}\n{REFRESH}",
            page.path.display()
        );
    }
}

#[test]
fn the_readme_is_short() {
    let lines = Page::read(&root().join("README.md")).text.lines().count();
    assert!(lines <= 120, "{lines} lines: at most 120");
}

/// Bounds the words of README and docs. The goal is 40,000.
#[test]
fn the_pages_do_not_grow() {
    let is_read = |page: &&Page| {
        page.path.starts_with(root().join("docs")) || page.path == root().join("README.md")
    };
    let words = |page: &Page| page.text.split_whitespace().count();
    let words: usize = pages().iter().filter(is_read).map(words).sum();
    assert!(words <= 58_000, "{words} words: at most 58,000");
}
