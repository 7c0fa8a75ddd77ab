//! One CSV file for each way of a map.

use super::map_file;
use crate::error::{Error, Result};
use crate::files::object_storage;
use crate::files::temporary::TemporaryFolder;
use crate::map::fusion::map_row::WayRows;
use crate::map::geometry::way_name::{WayDirection, WayName};
use same_file::is_same_file;
use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

/// Writes the files into a folder, all or none; of objects, those before an error. The file of a
/// single road has the name of the map.
pub fn write(folder: &Path, map: &Path, ways: &[WayRows]) -> Result<()> {
    fs::create_dir_all(folder).map_err(Error::io(folder))?;
    // Staged within the folder: a folder beside it may be on another file system, and a file cannot
    // be renamed across file systems.
    let complete = TemporaryFolder::create_in(folder).map_err(Error::io(folder))?;
    let mut names = BTreeSet::new();
    for way in ways {
        let name = file_name(way.name.as_ref(), map, &mut names);
        map_file::write(&complete.path().join(name), &way.rows)?;
    }
    if let Some(name) = names
        .iter()
        .find(|name| is_same_file(folder.join(name), map).unwrap_or(false))
    {
        let problem = "is the map too; expected another folder for its ways";
        return Err(Error::content(&folder.join(name), problem));
    }
    for name in &names {
        let path = folder.join(name);
        fs::rename(complete.path().join(name), &path).map_err(Error::io(&path))?;
        object_storage::send(&path)?;
    }
    Ok(())
}

/// Returns a name that is not in `taken`, and adds it to `taken`.
fn file_name(name: Option<&WayName>, map: &Path, taken: &mut BTreeSet<String>) -> String {
    let stem = match name {
        None => map.file_stem().unwrap_or_default().to_string_lossy().into(),
        Some(WayName { way, direction }) => {
            let safe = |c: char| c.is_alphanumeric() || matches!(c, '-' | '_' | '.');
            let stem = way.replace(|c| !safe(c), "_");
            // The file must not be hidden, and must not leave the folder.
            let stem = match stem.strip_prefix('.') {
                Some(rest) => format!("_{rest}"),
                None => stem,
            };
            match direction {
                WayDirection::Forward => stem,
                WayDirection::Backward => format!("{stem}.backward"),
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
