//! The road for the fusion.

use super::inputs::Inputs;
use crate::error::{Error, Result, on_one_line};
use crate::files::run;
use crate::map::geometry::network::Network;
use crate::map::io::network_file::{read, road_through};
use crate::map::io::store::MapStore;
use crate::map::matching::track::road_of_run;
use crate::terminal::print::alert;
use std::path::Path;

/// The sums of earlier runs, and their file.
pub(super) struct Stored<'a> {
    pub(super) path: &'a Path,
    pub(super) store: MapStore,
}

/// Returns the road or the network: the file `given`, else the road of the store, else the track of
/// the first run. A single road has a point for each of its cells, whether it comes from a store or
/// not, so that later runs are placed identically.
///
/// # Errors
/// Returns an error if a file cannot be read, if it has another road than the store, or if the runs
/// have no positions.
pub(super) fn road(
    given: Option<&Path>,
    inputs: &Inputs,
    stored: Option<&Stored>,
) -> Result<Network> {
    let given = given.map(read).transpose()?;
    let Some(Stored { path, store }) = stored else {
        return given.map_or_else(|| road_from_runs(inputs), Ok);
    };
    if given.as_ref().is_some_and(|road| !store.is_of(road)) {
        let problem = "the store has another road; expected the one of --road, or no --road";
        return Err(Error::content(path, problem));
    }
    match (store.road(), given) {
        (Some(points), _) => road_through(path, points.to_vec()),
        (None, Some(network)) => Ok(network),
        (None, None) => {
            let problem = "the store has a network; give the file of the network with --road";
            Err(Error::content(path, problem))
        }
    }
}

/// Returns the road of the first run that has a track.
fn road_from_runs(inputs: &Inputs) -> Result<Network> {
    let mut damage = None;
    for input in &inputs.runs {
        let path = &input.path;
        let track = match run::read_cells(path) {
            Ok((cells, _)) => road_of_run(&cells),
            // The error is reported when the run is added, if another run gives the road.
            Err(e) if input.found => {
                damage.get_or_insert(e);
                continue;
            }
            Err(e) => return Err(e),
        };
        match track {
            Some(track) => return road_through(path, track),
            None => alert(format_args!(
                "warning: {}: no positions to take the road from",
                on_one_line(path)
            )),
        }
    }
    let first = inputs.runs.first();
    Err(damage.unwrap_or_else(|| {
        Error::content(
            first.map_or(Path::new(""), |input| &input.path),
            "no positions, nor in any other run; expected latitude_deg and longitude_deg in the \
             rows",
        )
    }))
}
