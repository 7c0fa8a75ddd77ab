//! The files in a folder and its subfolders.

use super::lock::is_lock;
use super::temporary::is_temporary;
use crate::error::{Error, Result, on_one_line};
use std::path::{Path, PathBuf};
use walkdir::WalkDir;

/// Most files that a folder may have.
const MOST_FILES: usize = 1_000_000;
/// Names that a message lists.
const FEW: usize = 3;

/// What a folder and its subfolders have.
#[derive(Debug, Default)]
pub struct Folder {
    /// Files that are wanted, by name.
    pub files: Vec<PathBuf>,
    /// What looks like one, or leads to one, and cannot be read.
    pub unreadable: Vec<Error>,
    /// Names that begin with `.` or `_`: no data, as in Spark and Hive.
    hidden: Vec<PathBuf>,
    /// Other files.
    others: Vec<PathBuf>,
}

impl Folder {
    /// Looks for files, by their names or contents.
    ///
    /// # Errors
    /// Returns the error of the file system, and an error for a folder with too many files.
    pub fn read(folder: &Path, is_wanted: impl Fn(&Path) -> bool) -> Result<Self> {
        let mut found = Self::default();
        let mut entries = WalkDir::new(folder)
            .follow_links(true)
            .sort_by_file_name()
            .into_iter();
        while let Some(entry) = entries.next() {
            let entry = match entry {
                Ok(entry) => entry,
                Err(e) => {
                    found.take_error(folder, e, &is_wanted)?;
                    continue;
                }
            };
            let path = entry.path();
            let name = entry.file_name().to_string_lossy();
            if entry.depth() > 0 && name.starts_with(['.', '_']) {
                if entry.file_type().is_dir() {
                    entries.skip_current_dir();
                }
                if !is_temporary(path) && !is_lock(path) {
                    found.hidden.push(path.to_owned());
                }
            } else if entry.file_type().is_dir() {
            } else if !entry.file_type().is_file() {
                let problem = "a pipe or a device; expected a file";
                found.unreadable.push(Error::content(path, problem));
            } else if is_wanted(path) {
                found.files.push(path.to_owned());
            } else {
                found.others.push(path.to_owned());
            }
            if found.files.len() + found.others.len() > MOST_FILES {
                let problem = format!("more than {MOST_FILES} files; expected a smaller folder");
                return Err(Error::content(folder, problem));
            }
        }
        Ok(found)
    }

    /// Takes an error of the walk: a loop of links, and a link to nowhere, are left out.
    fn take_error(
        &mut self,
        folder: &Path,
        e: walkdir::Error,
        is_wanted: impl Fn(&Path) -> bool,
    ) -> Result<()> {
        let path = e.path().unwrap_or(folder).to_owned();
        if let Some(ancestor) = e.loop_ancestor() {
            let ancestor = on_one_line(ancestor);
            let problem = format!("a link back to {ancestor}; expected folders without a loop");
            self.unreadable.push(Error::content(&path, problem));
            return Ok(());
        }
        let e = Error::io(&path)(e.into());
        if !path.is_symlink() {
            return Err(e);
        }
        if is_wanted(&path) {
            self.unreadable.push(e);
        }
        Ok(())
    }

    /// Returns how many names were skipped, with the first of them, in words.
    #[must_use]
    pub fn hidden(&self, folder: &Path) -> Option<String> {
        let why = "skipped, since the name begins with . or _";
        words(folder, &self.hidden, why)
    }

    /// Returns how many files are no `what`, with the first of them, in words.
    #[must_use]
    pub fn others(&self, folder: &Path, what: &str) -> Option<String> {
        words(folder, &self.others, &format!("skipped: no {what}"))
    }
}

fn words(folder: &Path, paths: &[PathBuf], why: &str) -> Option<String> {
    let first: Vec<String> = paths
        .iter()
        .take(FEW)
        .map(|path| on_one_line(path))
        .collect();
    let more = if paths.len() > FEW { ", …" } else { "" };
    let (folder, count) = (on_one_line(folder), paths.len());
    (count > 0).then(|| format!("{folder}: {count} {why}: {}{more}", first.join(", ")))
}
