//! Runs: estimated from a log.

use crate::convert::to_python;
use crate::errors::exception;
use crate::identify::{Paths, Vehicle, found};
use crate::reading::Reading;
use crate::table::Table;
use crate::work::in_background;
use estimator_core::roadmap::PackedMap;
use estimator_core::{Scalar, Tuning};
use host_sim::error::{Error, Result};
use host_sim::files::data_set::check_day;
use host_sim::files::run::{self, Origin, RunRow};
use host_sim::files::tuning;
use host_sim::files::vehicle::VehicleFile;
use host_sim::identify::Request;
use host_sim::map::open_packed_map;
use host_sim::recorder::{LongRun, Recorder, RunSummary, check_inputs, record_log, record_logs};
use host_sim::source::read_options::ReadOptions;
use pyo3::prelude::*;
use pyo3::types::{PyCapsule, PyDict};
use std::path::{Path, PathBuf};

/// A run: one drive with its grade. It is itself a table of its cells.
#[pyclass(frozen, module = "roadgrade")]
pub struct Run {
    rows: Vec<RunRow>,
    origin: Origin,
    summary: RunSummary,
    cells: Table,
    vehicle: Py<Vehicle>,
}

impl Run {
    /// Returns the rows, and where they come from.
    pub fn rows(&self) -> (Vec<RunRow>, Origin) {
        (self.rows.clone(), self.origin.clone())
    }
}

#[pymethods]
impl Run {
    /// Cells of 2.5 m, with the columns of RUN.csv: the grade smoothed over the whole run, lagged by
    /// 500 m, and live, each with its standard deviation.
    #[getter]
    fn cells(&self) -> Table {
        self.cells.clone()
    }

    /// Whether the signals agree: "consistent", or "suspect: " and why.
    #[getter]
    fn verdict(&self) -> &str {
        &self.summary.verdict
    }

    /// What happened, as counts by name; only those that are not zero.
    #[getter]
    fn counters<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.summary(py)?.get_item("events")
    }

    /// What is not plausible about the input, a dict each: code, message, advice.
    #[getter]
    fn warnings<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.summary(py)?.get_item("warnings")
    }

    /// Summary of the drive, as `roadgrade estimate --json` prints it.
    #[getter]
    fn summary<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        to_python(py, &self.summary)
    }

    /// The vehicle that drove.
    #[getter]
    fn vehicle(&self, py: Python<'_>) -> Py<Vehicle> {
        self.vehicle.clone_ref(py)
    }

    /// Write the run as `roadgrade estimate` does: Parquet if the name ends in .parquet, else CSV.
    fn save(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        py.detach(|| run::write_from(&path, &self.rows, &self.origin))
            .map_err(|e| exception(py, &e))
    }

    fn __len__(&self) -> usize {
        self.rows.len()
    }

    fn __repr__(&self) -> String {
        let km = self.summary.distance_km;
        format!("<roadgrade.Run of {km:.3} km, {}>", self.summary.verdict)
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

/// Estimate the grade of one recorded drive.
///
/// log: a log of frames or a signal table; several paths are consecutive parts of one drive.
/// vehicle: a vehicle file, a dict with its tables, or a `Vehicle`; identified from the log if None.
/// day: day of the drive, YYYY-MM-DD; vehicle and day together name the session for `fuse`.
/// map: a packed map; the live grade is combined with its grade.
/// tuning: a tuning file.
/// double: compute in double precision instead of single precision.
/// strict, interfaces, ignore, dbc, signals: as in `read_log`.
///
/// The cells are those of `roadgrade estimate`, bit for bit. Raises `Error`, with file and line, for
/// an input that cannot be used, or that names the signal that the log lacks.
#[pyfunction]
#[pyo3(signature = (log, vehicle=None, *, day=None, map=None, tuning=None, double=false, strict=false,
    interfaces=None, ignore=None, dbc=None, signals=None))]
#[expect(clippy::too_many_arguments, reason = "keywords of Python")]
pub fn estimate(
    py: Python<'_>,
    log: Paths,
    vehicle: Option<GivenVehicle<'_>>,
    day: Option<String>,
    map: Option<PathBuf>,
    tuning: Option<PathBuf>,
    double: bool,
    strict: bool,
    interfaces: Option<Vec<String>>,
    ignore: Option<Vec<String>>,
    dbc: Option<PathBuf>,
    signals: Option<PathBuf>,
) -> PyResult<Run> {
    let reading = Reading {
        strict,
        interfaces,
        ignore,
        dbc,
        signals,
    };
    let given = vehicle.map(|given| given.vehicle(py)).transpose()?;
    let file = given.as_ref().map(|vehicle| vehicle.get().file.clone());
    let (made, identified) = in_background(py, move |stop| {
        let logs: Vec<PathBuf> = log.into();
        let day = day.map(|day| check_day(&day).map_err(|e| Error::Usage(format!("day: {e}"))));
        let day = day.transpose()?;
        let tuning = tuning::read_or_default(tuning.as_deref())?;
        let options = reading.options(stop)?;
        let (vehicle, identified) = match file {
            Some(vehicle) => (vehicle, None),
            None => {
                let request = Request {
                    logs: logs.clone(),
                    like: None,
                    tuning: tuning.clone(),
                    options: options.clone(),
                };
                let found = found(&request, stop)?;
                (found.vehicle.clone(), Some(found))
            }
        };
        let drive = Drive {
            logs,
            vehicle,
            tuning,
            map: map.as_deref().map(open_packed_map).transpose()?,
            options,
        };
        let run = if double {
            drive.estimated::<f64>()?
        } else {
            drive.estimated::<f32>()?
        };
        Ok((Made::new(run, &drive.vehicle, day)?, identified))
    })?;
    let vehicle = match (given, identified) {
        (Some(vehicle), _) => vehicle,
        (None, Some(found)) => Py::new(py, Vehicle::of_logs(found))?,
        (None, None) => unreachable!("without a vehicle it is identified"),
    };
    Ok(made.with_vehicle(vehicle))
}

/// A vehicle in any form.
#[derive(FromPyObject)]
pub enum GivenVehicle<'py> {
    Vehicle(Py<Vehicle>),
    Tables(Bound<'py, PyDict>),
    File(PathBuf),
}

impl GivenVehicle<'_> {
    fn vehicle(self, py: Python<'_>) -> PyResult<Py<Vehicle>> {
        let vehicle = match self {
            Self::Vehicle(vehicle) => return Ok(vehicle),
            Self::Tables(tables) => Vehicle::from_dict(&tables)?,
            Self::File(path) => Vehicle::read(py, path)?,
        };
        Py::new(py, vehicle)
    }
}

/// A drive to estimate.
struct Drive {
    logs: Vec<PathBuf>,
    vehicle: VehicleFile,
    tuning: Tuning,
    map: Option<PackedMap<'static>>,
    options: ReadOptions,
}

impl Drive {
    fn estimated<S: Scalar>(&self) -> Result<LongRun> {
        let first = self.logs.first().map_or(Path::new(""), PathBuf::as_path);
        let recorder = Recorder::<S>::resume(&self.vehicle.model, &self.tuning, None);
        let mut recorder = recorder.map_err(|e| Error::content(first, e.to_string()))?;
        if let Some(map) = self.map {
            recorder.follow(map);
        }
        let run = match &self.logs[..] {
            [log] => record_log(recorder, log, &self.options, |_| ())?,
            parts => record_logs(recorder, parts, &self.options)?.0,
        };
        self.options.stop.check()?;
        check_inputs(first, &self.vehicle, &run, &self.options)?;
        Ok(run)
    }
}

/// A run without what belongs to Python.
struct Made {
    rows: Vec<RunRow>,
    origin: Origin,
    summary: RunSummary,
    cells: Table,
}

impl Made {
    fn new(mut run: LongRun, vehicle: &VehicleFile, day: Option<String>) -> Result<Self> {
        let origin = Origin {
            vehicle: Some(vehicle.name.clone()),
            day,
            start_utc: run.start_utc.clone(),
        };
        let summary = RunSummary::new(&mut run)?;
        let rows = run.in_memory()?.rows;
        let cells = Table::new(run::table(&mut &*rows, &origin)?);
        Ok(Self {
            rows,
            origin,
            summary,
            cells,
        })
    }

    fn with_vehicle(self, vehicle: Py<Vehicle>) -> Run {
        let Self {
            rows,
            origin,
            summary,
            cells,
        } = self;
        Run {
            rows,
            origin,
            summary,
            cells,
            vehicle,
        }
    }
}
