//! Pages in Markdown: headings, links, and code.

use pulldown_cmark::{CodeBlockKind, Event, Options, Parser, Tag, TagEnd};
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use walkdir::{DirEntry, WalkDir};

/// A page.
#[derive(Debug)]
pub struct Page {
    /// Its file.
    pub path: PathBuf,
    /// Its text.
    pub text: String,
    /// Anchors of its headings.
    pub anchors: Vec<String>,
    /// Targets of its links, with their lines.
    pub links: Vec<(usize, String)>,
    /// Code within text, with its lines.
    pub code: Vec<(usize, String)>,
    /// Blocks of code, each with its first line.
    pub blocks: Vec<(usize, String)>,
}

impl Page {
    /// Reads a page.
    pub fn read(path: &Path) -> Self {
        let text = fs::read_to_string(path).unwrap();
        let mut page = Self {
            path: path.to_owned(),
            text: text.clone(),
            anchors: Vec::new(),
            links: Vec::new(),
            code: Vec::new(),
            blocks: Vec::new(),
        };
        let mut heading: Option<String> = None;
        let mut block: Option<(usize, String)> = None;
        let mut seen = BTreeMap::new();
        for (event, range) in Parser::new_ext(&text, Options::ENABLE_TABLES).into_offset_iter() {
            let line = text[..range.start].lines().count().max(1);
            match event {
                Event::Start(Tag::Heading { .. }) => heading = Some(String::new()),
                Event::End(TagEnd::Heading(_)) => {
                    let name = anchor(&heading.take().unwrap_or_default());
                    let count = seen.entry(name.clone()).or_insert(0);
                    page.anchors.push(match *count {
                        0 => name,
                        count => format!("{name}-{count}"),
                    });
                    *count += 1;
                }
                Event::Start(Tag::Link { dest_url, .. } | Tag::Image { dest_url, .. }) => {
                    page.links.push((line, dest_url.to_string()));
                }
                Event::Start(Tag::CodeBlock(kind)) => {
                    // The fence is a line of its own.
                    let fence = usize::from(matches!(kind, CodeBlockKind::Fenced(_)));
                    block = Some((line + fence, String::new()));
                }
                Event::End(TagEnd::CodeBlock) => page.blocks.extend(block.take()),
                Event::Code(code) => {
                    if let Some(heading) = &mut heading {
                        heading.push_str(&code);
                    }
                    page.code.push((line, code.to_string()));
                }
                Event::Text(words) => {
                    if let Some(heading) = &mut heading {
                        heading.push_str(&words);
                    }
                    if let Some((_, code)) = &mut block {
                        code.push_str(&words);
                    }
                }
                _ => {}
            }
        }
        page
    }
}

/// Returns the anchor of a heading, as GitHub makes it.
fn anchor(heading: &str) -> String {
    let kept = |of: &char| of.is_alphanumeric() || matches!(of, ' ' | '-' | '_');
    let letters = heading.chars().filter(kept).flat_map(char::to_lowercase);
    letters
        .map(|letter| if letter == ' ' { '-' } else { letter })
        .collect()
}

/// Returns all files below a folder that are part of the repository, in order.
pub fn files(folder: &Path) -> Vec<PathBuf> {
    // Left out: built files, inputs found by fuzzing, and files of others.
    let is_foreign = |entry: &DirEntry| {
        let name = entry.file_name().to_string_lossy();
        name.starts_with('.') || ["target", "corpus", "artifacts"].contains(&&*name)
    };
    WalkDir::new(folder)
        .sort_by_file_name()
        .into_iter()
        .filter_entry(|entry| entry.depth() == 0 || !is_foreign(entry))
        .map(Result::unwrap)
        .filter(|entry| entry.file_type().is_file())
        .map(DirEntry::into_path)
        .collect()
}

#[test]
fn anchors_are_those_of_github() {
    assert_eq!(anchor("How to add …"), "how-to-add-");
    assert_eq!(anchor("… a `state`"), "-a-state");
    assert_eq!(anchor("vehicle.toml"), "vehicletoml");
    assert_eq!(anchor("Q, term by term"), "q-term-by-term");
}
