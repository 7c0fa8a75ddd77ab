//! Runs one case in this process, and judges what it leaves.

use super::commands::Case;
use super::damage::damage;
use clap::Parser;
use host_sim::cli::Cli;
use host_sim::error::Error;
use host_sim::files::parquet::is_parquet;
use host_sim::files::run;
use host_sim::map::{read_map_ways, read_store};
use host_sim::terminal::print::note;
use rand::RngExt;
use std::collections::BTreeMap;
use std::fs;
use std::os::unix::fs::MetadataExt;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};

/// Inputs that a command may replace, and what it may write beside them.
const UPDATED: [&str; 4] = ["store.csv", "store_net.csv", "kept", ".previous"];

/// Returns the files below a folder, relative to it, sorted.
pub fn files_below(folder: &Path) -> Vec<PathBuf> {
    let found = walkdir::WalkDir::new(folder).sort_by_file_name();
    let files = found
        .into_iter()
        .flatten()
        .filter(|entry| !entry.file_type().is_dir());
    let relative = |entry: walkdir::DirEntry| entry.path().strip_prefix(folder).unwrap().to_owned();
    files.map(relative).collect()
}

/// Puts the good files into a folder, as links: a program replaces files and never changes them.
/// Those that are damaged are files of their own.
pub fn lay_out(case: &mut Case, good: &Path, files: &[PathBuf], folder: &Path) {
    for file in files {
        let path = folder.join(file);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        if !case.damaged.contains(file) {
            fs::hard_link(good.join(file), path).unwrap();
            continue;
        }
        let mut content = fs::read(good.join(file)).unwrap();
        for _ in 0..case.random.random_range(1..3) {
            damage(file, &mut content, &mut case.random);
        }
        fs::write(path, &content).unwrap();
    }
}

/// How a command ended.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum End {
    Done,
    Refused,
    WrongUsage,
}

/// Runs the command of a case in the current folder; the error is what is wrong.
pub fn run(case: &Case) -> Result<End, String> {
    let before = identities();
    let words = ["roadgrade"]
        .into_iter()
        .chain(case.words.iter().map(String::as_str));
    let Ok(cli) = Cli::try_parse_from(words) else {
        return Ok(End::WrongUsage);
    };
    let Ok(result) = catch_unwind(AssertUnwindSafe(|| cli.run())) else {
        return Err("a panic".to_owned());
    };
    let after = identities();
    if let Some(gone) = before.keys().find(|path| !after.contains_key(*path)) {
        return Err(format!("{} is gone", gone.display()));
    }
    let changed = after
        .iter()
        .filter(|(path, identity)| before.get(*path) != Some(identity));
    for path in changed.map(|(path, _)| path) {
        let name = path.to_string_lossy();
        if path
            .file_name()
            .is_some_and(|name| name.to_string_lossy().starts_with('.'))
        {
            return Err(format!("{name} is left behind"));
        }
        let is_updated = UPDATED.iter().any(|updated| name.ends_with(updated));
        if before.contains_key(path) && !is_updated {
            return Err(format!("the input {name} is changed"));
        }
        if result.is_err() && !is_updated {
            return Err(format!("{name} is written in spite of an error"));
        }
        flaw_of(path)?;
    }
    Ok(match result {
        Ok(()) => End::Done,
        Err(Error::Usage(_)) => End::WrongUsage,
        Err(e) => {
            note(format_args!("roadgrade: {e}"));
            End::Refused
        }
    })
}

/// Returns what changes if a file is written: its number and its size.
fn identities() -> BTreeMap<PathBuf, (u64, u64)> {
    let files = files_below(Path::new(".")).into_iter();
    let identity = |path: PathBuf| {
        let found = path.symlink_metadata().ok()?;
        Some((path, (found.ino(), found.len())))
    };
    files.filter_map(identity).collect()
}

/// Returns a page without its scripts, whose data are `script type=...`; any other text as it is.
fn without_scripts(text: &str) -> String {
    let mut parts = text.split("<script>");
    let first = parts.next().unwrap_or_default().to_owned();
    parts.fold(first, |rest, part| {
        rest + part.split_once("</script>").map_or("", |(_, after)| after)
    })
}

/// Returns what is wrong with a file that was written.
fn flaw_of(path: &Path) -> Result<(), String> {
    if is_parquet(path) {
        // Both readers check the ranges of all columns.
        let is_sound = run::read_cells(path).is_ok() || read_map_ways(path).is_ok();
        let is_placed = path.to_string_lossy().contains("road=");
        return (is_sound || is_placed)
            .then_some(())
            .ok_or(format!("{}: cannot be read", path.display()));
    }
    let Ok(text) = String::from_utf8(fs::read(path).unwrap_or_default()) else {
        return Ok(());
    };
    if text.starts_with("# roadgrade sums") {
        read_store(path).map_err(|e| format!("a store that cannot be read: {e}"))?;
    }
    let is_none = |word: &str| {
        let word = word.trim_start_matches(['-', '+']).to_ascii_lowercase();
        ["nan", "inf", "infinity"].contains(&&*word)
    };
    let text = without_scripts(&text);
    let mut words = text.split([',', ' ', '\n', ':', '[', ']', '"', '>', '<', ';', '\t']);
    match words.find(|word| is_none(word)) {
        Some(word) => Err(format!("{}: {word}", path.display())),
        None => Ok(()),
    }
}
