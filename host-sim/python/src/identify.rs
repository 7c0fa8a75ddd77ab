//! Vehicles: identified, read, written.

use crate::convert::{to_python, toml_table};
use crate::errors::exception;
use crate::reading::Reading;
use crate::work::in_background;
use host_sim::error::Result;
use host_sim::files::output::write_whole;
use host_sim::files::stop::Stop;
use host_sim::files::tuning;
use host_sim::files::vehicle::VehicleFile;
use host_sim::identify::{Identified, Like, Request, annotated, identify as identify_vehicle};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::path::{Path, PathBuf};

/// A vehicle: its parameters, and where they come from if it was identified.
#[pyclass(frozen, module = "roadgrade")]
pub struct Vehicle {
    pub file: VehicleFile,
    identified: Option<Identified>,
}

impl Vehicle {
    pub const fn of_file(file: VehicleFile) -> Self {
        Self {
            file,
            identified: None,
        }
    }

    pub fn of_logs(found: Identified) -> Self {
        Self {
            file: found.vehicle.clone(),
            identified: Some(found),
        }
    }

    fn text(&self) -> String {
        let found = self.identified.as_ref();
        found.map_or_else(|| self.file.to_toml(), annotated::text)
    }
}

#[pymethods]
impl Vehicle {
    /// Read a vehicle file.
    ///
    /// Raises `Error` that names each key that is unknown, missing or impossible.
    #[staticmethod]
    pub fn read(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        let file = VehicleFile::read(&path).map_err(|e| exception(py, &e))?;
        Ok(Self::of_file(file))
    }

    /// Make a vehicle from a dict with the tables of a vehicle file.
    ///
    /// Raises `Error` as `read` does.
    #[staticmethod]
    pub fn from_dict(tables: &Bound<'_, PyDict>) -> PyResult<Self> {
        let table = toml_table(tables)?;
        let file = VehicleFile::from_table(table, Path::new("vehicle"));
        let file = file.map_err(|e| exception(tables.py(), &e))?;
        Ok(Self::of_file(file))
    }

    /// Name of the vehicle.
    #[getter]
    fn name(&self) -> &str {
        &self.file.name
    }

    /// Text of the vehicle file. If the vehicle was identified, each value has a comment: read,
    /// measured with its standard deviation, or assumed.
    #[getter]
    fn toml(&self) -> String {
        self.text()
    }

    /// Values that were identified, a dict each: key, value, sigma, origin. Empty for a vehicle that
    /// was read.
    #[getter]
    fn values<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let found = self.identified.as_ref();
        to_python(py, &found.map_or(&[][..], |found| &found.values))
    }

    /// What cannot be known from the logs, a dict each: what, advice.
    #[getter]
    fn unknown<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let found = self.identified.as_ref();
        to_python(py, &found.map_or(&[][..], |found| &found.unknown))
    }

    /// Return the tables of the vehicle file as a dict.
    fn to_dict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let table: toml::Table = self.file.to_toml().parse().expect("it was written as TOML");
        to_python(py, &table)
    }

    /// Write the vehicle file, as `roadgrade identify` does.
    fn save(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        let text = self.text();
        write_whole(&path, |out| out.write_all(text.as_bytes())).map_err(|e| exception(py, &e))
    }

    fn __repr__(&self) -> String {
        format!("<roadgrade.Vehicle {:?}>", self.file.name)
    }
}

/// Identify the vehicle that these logs ask for.
///
/// logs: drives of one vehicle: a path, or several. Two are better than one.
/// like: what the vehicle is like: a class, or another vehicle file; by default recognised by its mass.
/// tuning: a tuning file.
/// strict, interfaces, ignore, dbc, signals: as in `read_log`.
///
/// Raises `Error` for a log that cannot be read, or that names the signal that all of them lack.
#[pyfunction]
#[pyo3(signature = (logs, *, like=None, tuning=None, strict=false, interfaces=None, ignore=None,
    dbc=None, signals=None))]
#[expect(clippy::too_many_arguments, reason = "keywords of Python")]
pub fn identify(
    py: Python<'_>,
    logs: Paths,
    like: Option<PathBuf>,
    tuning: Option<PathBuf>,
    strict: bool,
    interfaces: Option<Vec<String>>,
    ignore: Option<Vec<String>>,
    dbc: Option<PathBuf>,
    signals: Option<PathBuf>,
) -> PyResult<Vehicle> {
    let reading = Reading {
        strict,
        interfaces,
        ignore,
        dbc,
        signals,
    };
    in_background(py, move |stop| {
        let like = like.map(|name| Like::named(&name.to_string_lossy()));
        let request = Request {
            logs: logs.into(),
            like: like.transpose()?,
            tuning: tuning::read_or_default(tuning.as_deref())?,
            options: reading.options(stop)?,
        };
        found(&request, stop).map(Vehicle::of_logs)
    })
}

/// Identifies, unless it is asked to stop between two steps.
pub fn found(request: &Request, stop: &Stop) -> Result<Identified> {
    let found = identify_vehicle(request, |_| ())?;
    stop.check()?;
    Ok(found)
}

/// A path, or several.
#[derive(FromPyObject)]
pub enum Paths {
    One(PathBuf),
    Several(Vec<PathBuf>),
}

impl From<Paths> for Vec<PathBuf> {
    fn from(paths: Paths) -> Self {
        match paths {
            Paths::One(path) => vec![path],
            Paths::Several(paths) => paths,
        }
    }
}
