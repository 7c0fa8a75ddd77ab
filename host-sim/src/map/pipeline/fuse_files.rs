//! Fusion of run files into a map file.

use super::inputs::Inputs;
use super::intake::RunIntake;
use super::road::{Stored, road};
use crate::error::{Error, Result};
use crate::map::fusion::grade_map::{FusedMap, GradeMap};
use crate::map::geometry::way_index::Way;
use crate::map::io::run_list::RunList;
use crate::map::io::{map_file, store};
use std::path::{Path, PathBuf};

/// Runs of one vehicle in one named session.
#[derive(Clone, Debug)]
pub struct NamedSession {
    /// Name of the session.
    pub name: String,
    /// Run files, or folders of them.
    pub runs: Vec<PathBuf>,
}

/// Options of a fusion.
#[derive(Clone, Copy, Debug)]
pub struct FuseRequest<'a> {
    /// Run files, or folders of them; each run is a session of its own unless it names one.
    pub runs: &'a [PathBuf],
    /// Runs of named sessions.
    pub sessions: &'a [NamedSession],
    /// File of the road or the network.
    pub road: Option<&'a Path>,
    /// File of the sums: read if it exists, and written.
    pub store: Option<&'a Path>,
    /// Folder for the placed runs.
    pub placed: Option<&'a Path>,
    /// File of the map.
    pub out: &'a Path,
    /// True if a damaged file in a folder is an error.
    pub strict: bool,
}

/// Fuses runs into a map; writes the map and its sums.
///
/// # Errors
/// Returns an error if a file cannot be read or used, or if the map has no cell. Nothing is then
/// written, except sums of runs that were added before.
pub fn fuse_files(request: &FuseRequest) -> Result<FusedMap> {
    let mut inputs = request.inputs()?;
    if inputs.runs.is_empty() && !inputs.damaged.is_empty() {
        return Err(inputs.damaged.swap_remove(0));
    }
    let stored = request.stored(inputs.runs.is_empty())?;
    let road = road(request.road, &inputs, stored.as_ref())?;
    if let (Some(_), Some(path), [Way { name: Some(_), .. }, ..]) =
        (request.placed, request.road, road.ways())
    {
        let problem = "a network; expected a single road with --placed";
        return Err(Error::content(path, problem));
    }
    let (sums, runs) = match &stored {
        Some(Stored { store, .. }) => (store.resume(&road), store.runs.clone()),
        None => (GradeMap::new(&road), RunList::default()),
    };
    let first = inputs.runs.first().map(|input| input.path.clone());
    let mut intake = RunIntake::new(sums, runs, request.store, request.placed_folder());
    intake.add(inputs, request.strict)?;
    let fused = intake.sums.fused();
    if fused.ways.is_empty() {
        let path = first.as_deref().or(request.store).unwrap_or(request.out);
        let problem = "no cell of the road is covered; expected runs on it, in its direction";
        return Err(Error::content(path, problem));
    }
    let map = map_file::stage_ways(request.out, &fused.ways)?;
    let sums = match request.store {
        Some(path) if intake.tally.added > 0 => {
            Some(store::stage(path, &intake.sums, &intake.runs)?)
        }
        _ => None,
    };
    map.commit()?;
    if let Some(sums) = sums {
        // Last: if it fails, the runs are not in the store and can be added again.
        sums.commit()?;
    }
    Ok(fused)
}

impl<'a> FuseRequest<'a> {
    fn inputs(&self) -> Result<Inputs> {
        let mut inputs = Inputs::default();
        for path in self.runs {
            inputs.add(path, None)?;
        }
        for session in self.sessions {
            for path in &session.runs {
                inputs.add(path, Some(&session.name))?;
            }
        }
        inputs.sort();
        Ok(inputs)
    }

    /// Returns the folder of the placed runs in Hive's layout: the road is a column with its value
    /// in the folder's name.
    fn placed_folder(&self) -> Option<PathBuf> {
        let road = self.out.file_stem().unwrap_or_default().to_string_lossy();
        Some(self.placed?.join(format!("road={road}")))
    }

    /// Reads the sums; if `required`, they must exist.
    fn stored(&self, required: bool) -> Result<Option<Stored<'a>>> {
        match self.store {
            Some(path) if required || path.exists() => {
                let store = store::read(path)?;
                Ok(Some(Stored { path, store }))
            }
            _ => Ok(None),
        }
    }
}
