//! Errors of the host as exceptions of Python, with the same text.

use host_sim::error;
use pyo3::exceptions::{PyException, PyKeyboardInterrupt, PyValueError};
use pyo3::prelude::*;
use pyo3::{create_exception, intern};
use std::path::Path;

create_exception!(
    roadgrade,
    Error,
    PyException,
    "An input cannot be used. The text names the file, the line if there is one, and what was \
     expected. `path` and `line` have the same as values, or None."
);

/// Adds what every error has to the class.
pub fn begin(module: &Bound<'_, PyModule>) -> PyResult<()> {
    let class = module.getattr("Error")?;
    class.setattr("path", module.py().None())?;
    class.setattr("line", module.py().None())
}

/// Returns the exception of an error. Wrong arguments are a `ValueError`.
pub fn exception(py: Python<'_>, error: &error::Error) -> PyErr {
    let text = error.to_string();
    match error {
        error::Error::Usage(_) => PyValueError::new_err(text),
        error::Error::Stopped => PyKeyboardInterrupt::new_err(text),
        error::Error::Storage { url, .. } => of_file(py, text, Path::new(url), None),
        error::Error::Line { path, line, .. } => of_file(py, text, path, Some(*line)),
        error::Error::Io { path, .. }
        | error::Error::Key { path, .. }
        | error::Error::Content { path, .. } => of_file(py, text, path, None),
    }
}

fn of_file(py: Python<'_>, text: String, path: &Path, line: Option<u64>) -> PyErr {
    let error = Error::new_err(text);
    let value = error.value(py);
    let named = value
        .setattr(intern!(py, "path"), path)
        .and_then(|()| value.setattr(intern!(py, "line"), line));
    named.map_or_else(|other| other, |()| error)
}
