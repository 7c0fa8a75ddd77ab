//! Maps: fused from runs, or read.

use crate::errors::exception;
use crate::estimate::Run;
use crate::table::Table;
use crate::work::in_background;
use arrow_array::RecordBatch;
use arrow_schema::Schema;
use host_sim::error::{Error, Result};
use host_sim::files::run::{self, Origin, RunRow};
use host_sim::map::pipeline::fuse_files::{FuseRequest, fuse_files};
use host_sim::map::pipeline::inputs::NamedSession;
use host_sim::map::{WayRows, check_session_name, map_table, read_map_ways, stage_map_ways};
use pyo3::prelude::*;
use pyo3::types::PyCapsule;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use tempfile::TempDir;

/// A map of grades. It is itself a table of its cells.
#[pyclass(frozen, module = "roadgrade")]
pub struct Map {
    ways: Vec<WayRows>,
    cells: Table,
}

impl Map {
    fn new(ways: Vec<WayRows>) -> Self {
        let cells = Table::new(for_geo_pandas(&map_table(&ways)));
        Self { ways, cells }
    }
}

#[pymethods]
impl Map {
    /// Cells of 2.5 m, with the columns of MAP.parquet. The column `geometry` has points as
    /// well-known binary, marked so that `geopandas.GeoDataFrame.from_arrow` takes them.
    #[getter]
    fn cells(&self) -> Table {
        self.cells.clone()
    }

    /// Write the map as `roadgrade fuse` does: GeoParquet if the name ends in .parquet, else CSV.
    fn save(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        py.detach(|| stage_map_ways(&path, &self.ways)?.commit())
            .map_err(|e| exception(py, &e))
    }

    fn __len__(&self) -> usize {
        self.ways.iter().map(|way| way.rows.len()).sum()
    }

    fn __repr__(&self) -> String {
        let cells = self.__len__();
        format!("<roadgrade.Map of {cells} cells, {} ways>", self.ways.len())
    }

    /// Returns the cells as Arrow's C stream interface has them.
    #[pyo3(signature = (requested_schema=None))]
    fn __arrow_c_stream__<'py>(
        &self,
        py: Python<'py>,
        requested_schema: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyCapsule>> {
        self.cells.__arrow_c_stream__(py, requested_schema)
    }
}

/// Marks the geometry as GeoArrow does (<https://geoarrow.org/extension-types>): without a type of
/// its own in Arrow it is bytes. The coordinates are those that GeoParquet assumes.
fn for_geo_pandas(table: &RecordBatch) -> RecordBatch {
    let schema = table.schema();
    let fields = schema.fields().iter().map(|field| {
        if field.name() != "geometry" {
            return field.clone();
        }
        let mut metadata = field.metadata().clone();
        for (key, value) in [
            ("name", "geoarrow.wkb"),
            (
                "metadata",
                r#"{"crs":"OGC:CRS84","crs_type":"authority_code"}"#,
            ),
        ] {
            metadata.insert(format!("ARROW:extension:{key}"), value.to_owned());
        }
        Arc::new(field.as_ref().clone().with_metadata(metadata))
    });
    let marked = Schema::new(fields.collect::<Vec<_>>()).with_metadata(schema.metadata().clone());
    let table = table.clone().with_schema(Arc::new(marked));
    table.expect("only the metadata differ")
}

/// A run in any form.
#[derive(FromPyObject)]
pub enum GivenRun {
    Run(Py<Run>),
    File(PathBuf),
}

/// A run, or several.
#[derive(FromPyObject)]
pub enum GivenRuns {
    One(GivenRun),
    Several(Vec<GivenRun>),
}

/// Fuse runs into a map.
///
/// runs: runs, files of runs, or folders of files; one or several. Without a road, the first one
///     decides where cells begin.
/// road: a file of a road or a network; by default the track of the first run.
/// sessions: further runs by name of their session; errors of runs of one session are correlated.
/// strict: raise for a damaged file in a folder, instead of leaving it out.
///
/// The map is that of `roadgrade fuse`, bit for bit. Raises `Error` for a file that cannot be used, and
/// if no cell of the road is covered.
#[pyfunction]
#[pyo3(signature = (runs, *, road=None, sessions=None, strict=false))]
pub fn fuse(
    py: Python<'_>,
    runs: GivenRuns,
    road: Option<PathBuf>,
    sessions: Option<BTreeMap<String, GivenRuns>>,
    strict: bool,
) -> PyResult<Map> {
    let runs = sources(runs);
    let sessions: Vec<_> = sessions
        .into_iter()
        .flatten()
        .map(|(name, runs)| (name, sources(runs)))
        .collect();
    in_background(py, move |stop| {
        let mut files = RunFiles::default();
        let runs = files.of(runs)?;
        let mut named = Vec::new();
        for (name, runs) in sessions {
            check_session_name(&name).map_err(|flaw| {
                Error::Usage(format!("{}; expected {}", flaw.problem, flaw.expected))
            })?;
            let runs = files.of(runs)?;
            named.push(NamedSession { name, runs });
        }
        let fused = fuse_files(&FuseRequest {
            runs: &runs,
            sessions: &named,
            road: road.as_deref(),
            store: None,
            placed: None,
            out: None,
            strict,
            stop,
        })?;
        Ok(Map::new(fused.ways))
    })
}

/// Read a map: CSV, Parquet, or packed as vehicles have it.
///
/// Raises `Error` with file and line.
#[pyfunction]
pub fn read_map(py: Python<'_>, path: PathBuf) -> PyResult<Map> {
    in_background(py, move |_| read_map_ways(&path).map(Map::new))
}

/// A run without what belongs to Python.
enum Source {
    Rows(Vec<RunRow>, Origin),
    File(PathBuf),
}

fn sources(runs: GivenRuns) -> Vec<Source> {
    let source = |run| match run {
        GivenRun::Run(run) => {
            let (rows, origin) = run.get().rows();
            Source::Rows(rows, origin)
        }
        GivenRun::File(path) => Source::File(path),
    };
    match runs {
        GivenRuns::One(run) => vec![source(run)],
        GivenRuns::Several(runs) => runs.into_iter().map(source).collect(),
    }
}

/// Files of runs: a fusion reads files, so that it may have more than memory holds.
#[derive(Default)]
struct RunFiles {
    folder: Option<TempDir>,
    written: usize,
}

impl RunFiles {
    fn of(&mut self, runs: Vec<Source>) -> Result<Vec<PathBuf>> {
        let mut files = Vec::with_capacity(runs.len());
        for run in runs {
            files.push(match run {
                Source::File(path) => path,
                Source::Rows(rows, origin) => self.write(&rows, &origin)?,
            });
        }
        Ok(files)
    }

    fn write(&mut self, rows: &[RunRow], origin: &Origin) -> Result<PathBuf> {
        let folder = match self.folder.take() {
            Some(folder) => folder,
            None => tempfile::tempdir().map_err(Error::io(Path::new("temporary folder")))?,
        };
        self.written += 1;
        let path = folder.path().join(format!("run {}.parquet", self.written));
        self.folder = Some(folder);
        run::write_from(&path, rows, origin)?;
        Ok(path)
    }
}
