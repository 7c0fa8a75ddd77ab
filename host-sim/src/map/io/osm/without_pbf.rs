//! OpenStreetMap files in PBF where a program does not read them: each is refused.

use super::roads::Roads;
use crate::error::{Error, Result};
use std::path::Path;

/// Refuses a file.
///
/// # Errors
/// Returns an error always.
pub(super) fn read_ways(path: &Path, _roads: &mut Roads) -> Result<()> {
    Err(without(path))
}

/// Refuses a file.
///
/// # Errors
/// Returns an error always.
pub(super) fn read_nodes(path: &Path, _roads: &mut Roads) -> Result<()> {
    Err(without(path))
}

/// Refuses a file.
///
/// # Errors
/// Returns an error always.
pub(super) fn for_each_node(
    path: &Path,
    _take: impl FnMut(i64, Option<i32>, &mut dyn Iterator<Item = (&str, &str)>),
) -> Result<()> {
    Err(without(path))
}

fn without(path: &Path) -> Error {
    let problem = "an OpenStreetMap file in PBF, which this program is built without; build it with \
                   --features osm-pbf, or give the extract as .osm (osmium cat)";
    Error::content(path, problem)
}
