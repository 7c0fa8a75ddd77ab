//! Fusion of run files into a map file.

use super::inputs::{Inputs, NamedSession};
use super::intake::RunIntake;
use super::road::{Stored, road};
use crate::error::{Error, Result, on_one_line};
use crate::files::output::Staged;
use crate::files::same::handle;
use crate::files::stop::Stop;
use crate::map::fusion::grade_map::{FusedMap, GradeMap};
use crate::map::geometry::network::Network;
use crate::map::io::placed_file::PlacedFolder;
use crate::map::io::run_list::RunList;
use crate::map::io::store_file::StoreFile;
use crate::map::io::{map_file, store};
use std::path::{Path, PathBuf};

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
    /// File of the map; without one it is only returned.
    pub out: Option<&'a Path>,
    /// True if a damaged file in a folder is an error.
    pub strict: bool,
    /// Stops the fusion.
    pub stop: &'a Stop,
}

/// Fuses runs into a map; writes the map and its sums.
///
/// # Errors
/// Returns an error if a file cannot be read or used, or if the map has no cell. Nothing is then
/// written, except sums of runs that were added before.
pub fn fuse_files(request: &FuseRequest) -> Result<FusedMap> {
    let mut inputs = Inputs::of(request.runs, request.sessions)?;
    request.check_outputs(&inputs)?;
    if inputs.runs.is_empty() && !inputs.damaged.is_empty() {
        return Err(inputs.damaged.swap_remove(0));
    }
    let (mut file, stored) = request.stored(inputs.runs.is_empty())?.unzip();
    let stored = stored.flatten();
    let road = road(request.road, &inputs, stored.as_ref())?;
    let (sums, runs) = match &stored {
        Some(Stored { store, .. }) => (store.resume(&road), store.runs.clone()),
        None => (GradeMap::new(&road), RunList::default()),
    };
    let first = inputs.runs.first().map(|input| input.path.clone());
    let mut intake = RunIntake::new(sums, runs, file.as_mut(), request.placed_folder(&road));
    intake.add(inputs, request.strict, request.stop)?;
    let fused = intake.sums.fused();
    if fused.ways.is_empty() {
        let path = first.as_deref().or(request.store).or(request.out);
        let path = path.unwrap_or(Path::new(""));
        let problem = "no cell of the road is covered; expected runs on it, in its direction";
        return Err(Error::content(path, problem));
    }
    let map = request
        .out
        .map(|out| map_file::stage_ways(out, &fused.ways))
        .transpose()?;
    let RunIntake {
        sums,
        runs,
        store: file,
        tally,
        ..
    } = intake;
    let staged = match file {
        Some(file) if tally.added > 0 => Some((store::stage(file.path(), &sums, &runs)?, file)),
        _ => None,
    };
    map.map_or(Ok(()), Staged::commit)?;
    if let Some((staged, file)) = staged {
        // Last: if it fails, the runs are not in the store and can be added again.
        file.replace(staged)?;
    }
    Ok(fused)
}

impl<'a> FuseRequest<'a> {
    /// Checks that neither map nor store would replace a run or the other. A map may replace the
    /// map that it takes its road from.
    fn check_outputs(&self, inputs: &Inputs) -> Result<()> {
        let refuse = |out: &Path, what: &str, path: &Path| {
            let path = on_one_line(path);
            let problem = format!("is {what} too ({path}); expected another file for the output");
            Err(Error::content(out, problem))
        };
        for out in [self.out, self.store].into_iter().flatten() {
            let Some(own) = handle(out) else {
                continue;
            };
            let is_own = |path: &Path| handle(path).is_some_and(|other| other == own);
            let same = inputs.runs.iter().find(|input| is_own(&input.path));
            // A map or a store in a folder of runs is no run, and is left out.
            if let Some(input) = same.filter(|input| !input.found || input.is_readable()) {
                return refuse(out, "a run", &input.path);
            }
        }
        match self.store.zip(self.out) {
            Some((store, out)) if handle(store).is_some_and(|own| Some(own) == handle(out)) => {
                refuse(out, "the store", store)
            }
            _ => Ok(()),
        }
    }

    /// Returns the folder of the placed runs, named by the map.
    fn placed_folder(&self, network: &Network) -> Option<PlacedFolder> {
        let road = self.out.and_then(Path::file_stem).unwrap_or_default();
        let road = road.to_string_lossy();
        Some(PlacedFolder::new(self.placed?, &road, network))
    }

    /// Opens the file of the sums and reads it. If there are no runs to add, it must exist.
    fn stored(&self, without_runs: bool) -> Result<Option<(StoreFile, Option<Stored<'a>>)>> {
        let Some(path) = self.store else {
            return Ok(None);
        };
        let file = if without_runs {
            StoreFile::of(path)
        } else {
            StoreFile::lock(path)?
        };
        let exists = without_runs || file.path().exists();
        let store = exists.then(|| file.read()).transpose()?;
        Ok(Some((file, store.map(|store| Stored { path, store }))))
    }
}
