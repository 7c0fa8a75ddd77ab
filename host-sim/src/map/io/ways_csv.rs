//! A CSV file for each way of a map.

use super::map_file;
use crate::error::{Error, Result};
use crate::map::fusion::map_row::WayRows;
use crate::map::geometry::way_name::{Direction, WayName};
use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

/// Writes the files into a folder, all or, if one cannot be written, none. A single road's is named
/// as the map.
pub fn write(folder: &Path, map: &Path, ways: &[WayRows]) -> Result<()> {
    fs::create_dir_all(folder).map_err(Error::io(folder))?;
    // Within it: what is beside may be another file system, to which nothing can be renamed.
    let complete = tempfile::tempdir_in(folder).map_err(Error::io(folder))?;
    let mut names = BTreeSet::new();
    for way in ways {
        let name = file_name(way.name.as_ref(), map, &mut names);
        map_file::write(&complete.path().join(name), &way.rows)?;
    }
    for name in &names {
        let path = folder.join(name);
        fs::rename(complete.path().join(name), &path).map_err(Error::io(&path))?;
    }
    Ok(())
}

/// A name that no way before had; `taken` also has this one then.
fn file_name(name: Option<&WayName>, map: &Path, taken: &mut BTreeSet<String>) -> String {
    let stem = match name {
        None => map.file_stem().unwrap_or_default().to_string_lossy().into(),
        Some(WayName { way, direction }) => {
            let safe = |c: char| c.is_alphanumeric() || matches!(c, '-' | '_' | '.');
            let stem = way.replace(|c| !safe(c), "_");
            // A file is not to be hidden, nor is a folder to be left.
            let stem = match stem.strip_prefix('.') {
                Some(rest) => format!("_{rest}"),
                None => stem,
            };
            match direction {
                Direction::Forward => stem,
                Direction::Backward => format!("{stem}.backward"),
            }
        }
    };
    let numbered = (2..).map(|number| format!("{stem}-{number}.csv"));
    let free = std::iter::once(format!("{stem}.csv"))
        .chain(numbered)
        .find(|name| !taken.contains(name))
        .unwrap_or_default();
    taken.insert(free.clone());
    free
}
