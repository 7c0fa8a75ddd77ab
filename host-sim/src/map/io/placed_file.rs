//! Placed runs: the cells of a run on its road or network, from which SQL computes the map
//! (`host-sim/sql/fuse.sql`).

use super::way_file::{DIRECTION, WAY};
use crate::error::Result;
use crate::files::object_storage;
use crate::files::output::Staged;
use crate::files::parquet::{ParquetColumn, open, stage as stage_parquet};
use crate::files::run::RunIdentity;
use crate::map::geometry::network::Network;
use crate::map::geometry::way_name::WayName;
use crate::map::matching::placing::PlacedCell;
use std::path::{Path, PathBuf};
use xxhash_rust::xxh3::Xxh3;

/// Version of the columns, in the metadata of the files.
const SCHEMA: &str = "placed 2";
/// Key of the mark of the road, in the metadata of the files.
const ROAD: &str = "road";

/// The folder of the runs that are placed on one road or network.
#[derive(Clone, Debug)]
pub struct PlacedFolder {
    folder: PathBuf,
    /// Hash of the road.
    mark: String,
}

impl PlacedFolder {
    /// Returns the folder for runs on this road in Hive's layout: the road is a column with its
    /// value in the folder's name.
    #[must_use]
    pub fn new(below: &Path, road: &str, network: &Network) -> Self {
        Self {
            folder: below.join(format!("road={road}")),
            mark: mark_of(network),
        }
    }

    /// Returns true if the run is there, placed on this very road.
    ///
    /// # Errors
    /// Returns the error of object storage.
    pub fn has(&self, run: RunIdentity) -> Result<bool> {
        let path = self.path_of(run);
        object_storage::bring(&path)?;
        let is_of_road = || open(&path).is_ok_and(|file| file.metadata(ROAD) == Some(&self.mark));
        Ok(path.exists() && is_of_road())
    }

    /// Writes the cells of a run to a file that appears when it is committed: `session` (null for a
    /// run without one), `way` and `direction` (null on a single road), `cell` (distance along the
    /// way over 2.5 m), grade and altitude with their variances. The name of the file is that of the
    /// run, so that a run that is placed again replaces itself.
    ///
    /// # Errors
    /// Returns the error of the file system.
    pub fn stage(
        &self,
        run: RunIdentity,
        session: Option<&str>,
        network: &Network,
        cells: &[PlacedCell],
    ) -> Result<Staged> {
        let name = |of: fn(&WayName) -> &str| {
            let ways = network.ways();
            cells
                .iter()
                .map(move |cell| ways[cell.way].name.as_ref().map(of))
        };
        let altitude =
            |of: fn((f64, f64)) -> f64| cells.iter().map(move |cell| cell.altitude.map(of));
        let columns = vec![
            ParquetColumn::text("session", session, cells.len()),
            ParquetColumn::texts(WAY, name(|name| &name.way)),
            ParquetColumn::texts(DIRECTION, name(|name| name.direction.word())),
            ParquetColumn::whole("cell", cells.iter().map(|cell| cell.number)),
            ParquetColumn::numbers("grade_percent", cells.iter().map(|cell| cell.grade_percent)),
            ParquetColumn::numbers(
                "grade_variance_percent2",
                cells.iter().map(|cell| cell.grade_variance),
            ),
            ParquetColumn::optional("altitude_m", altitude(|known| known.0)),
            ParquetColumn::optional("altitude_variance_m2", altitude(|known| known.1)),
        ];
        let metadata = [("schema", SCHEMA.to_owned()), (ROAD, self.mark.clone())];
        stage_parquet(&self.path_of(run), columns, &metadata)
    }

    fn path_of(&self, run: RunIdentity) -> PathBuf {
        self.folder.join(format!("{run}.parquet"))
    }
}

/// Returns a hash of the names and points of all ways.
fn mark_of(network: &Network) -> String {
    let mut hash = Xxh3::default();
    for way in network.ways() {
        let name = way.name.as_ref().map(ToString::to_string);
        hash.update(name.unwrap_or_default().as_bytes());
        for point in way.line.points() {
            let values = [point.distance_m, point.latitude_deg, point.longitude_deg];
            for value in values {
                hash.update(&value.to_le_bytes());
            }
        }
    }
    format!("{:032x}", hash.digest128())
}
