//! The generated parts of the pages of the evidence.

use crate::calls::{CALLS, CallBounds, committed_calls};
use crate::files::{Result, problem, root, text};
use crate::requirements::{Requirement, Requirements};
use std::path::PathBuf;

const REQUIREMENTS: &str = "docs/evidence/requirements.toml";

/// A page as it is committed, and as it should be.
#[derive(Clone, Debug)]
pub struct Page {
    /// Its file.
    pub path: PathBuf,
    /// Its committed text.
    pub committed: String,
    /// Its text of the current sources.
    pub current: String,
}

/// Makes the generated parts of all pages again.
///
/// # Errors
/// A file cannot be read, or a page lacks a mark.
pub fn pages() -> Result<Vec<Page>> {
    let requirements = Requirements::read()?;
    let calls = CallBounds::read(&committed_calls())?;
    let of_requirements = [
        ("requirements", REQUIREMENTS, by_requirement(&requirements)),
        ("tests", REQUIREMENTS, by_file(&requirements)?),
    ];
    let of_calls = [("calls", CALLS, stacks(&calls))];
    Ok(vec![
        page("docs/evidence/requirements.md", &of_requirements)?,
        page("docs/evidence.md", &of_calls)?,
    ])
}

/// Makes the blocks of a page again: name, source and content of each.
fn page(path: &str, blocks: &[(&str, &str, String)]) -> Result<Page> {
    let path = root().join(path);
    let committed = text(&path)?;
    let mut current = committed.clone();
    for (name, from, content) in blocks {
        current = fill(&current, name, from, content).map_err(|why| problem(&path, why))?;
    }
    Ok(Page {
        path,
        committed,
        current,
    })
}

/// Replaces what stands between the marks of a block.
fn fill(page: &str, name: &str, from: &str, content: &str) -> Result<String> {
    let begin = format!("<!-- begin: {name} (from {from}) -->\n");
    let end = format!("<!-- end: {name} -->");
    let missing = |mark: &str| format!("no `{}`", mark.trim_end());
    let (before, rest) = page.split_once(&begin).ok_or_else(|| missing(&begin))?;
    let (_, after) = rest.split_once(&end).ok_or_else(|| missing(&end))?;
    Ok(format!("{before}{begin}\n{content}\n{end}{after}"))
}

fn stacks(bounds: &CallBounds) -> String {
    let header = "| call | stack, bytes, at most | instructions, at most |\n|---|---|---|\n";
    let mut table = header.to_owned();
    for (call, bound) in &bounds.calls {
        let instructions = bound.instructions.map(|of| of.to_string());
        let instructions = instructions.as_deref().unwrap_or("—");
        let (call, bytes) = (call.replace('_', " "), bound.stack_bytes);
        table += &format!("| {call} | {bytes} | {instructions} |\n");
    }
    let (functions, loops) = (bounds.functions, bounds.loops);
    table + &format!("\nThe calls reach {functions} functions with {loops} loops.\n")
}

fn by_requirement(requirements: &Requirements) -> String {
    let mut table = "| number | what must hold | tests and checks |\n|---|---|---|\n".to_owned();
    for Requirement {
        id,
        text,
        stands,
        tests,
        checks,
    } in requirements.iter()
    {
        // The page is one folder below the others.
        let link = stands.replacen("docs/", "../", 1);
        let tests = tests.iter().map(|name| in_words(name));
        let checks = checks.iter().map(|name| format!("`tests/run {name}`"));
        let held: Vec<String> = tests.chain(checks).collect();
        let held = held.join("<br>");
        table += &format!("| {id} | [{text}]({link}) | {held} |\n");
    }
    table
}

fn in_words(name: &str) -> String {
    match name.split_once("::") {
        Some((file, function)) => format!("`{file}`: {}", function.replace('_', " ")),
        None => format!("`{name}`: all"),
    }
}

fn by_file(requirements: &Requirements) -> Result<String> {
    let mut table = "| tests | requirements |\n|---|---|\n".to_owned();
    for (file, ids) in requirements.by_file()? {
        let ids = if ids.is_empty() {
            "—".to_owned()
        } else {
            ids.join(", ")
        };
        table += &format!("| `{file}` | {ids} |\n");
    }
    Ok(table)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_block_is_replaced_and_nothing_else() {
        let page = "a\n<!-- begin: x (from y) -->\nold\n<!-- end: x -->\nb\n";
        let new = "a\n<!-- begin: x (from y) -->\n\nnew\n\n<!-- end: x -->\nb\n";
        assert_eq!(fill(page, "x", "y", "new\n").unwrap(), new);
        let problem = fill("a", "x", "y", "new").unwrap_err();
        assert_eq!(problem, "no `<!-- begin: x (from y) -->`");
    }
}
