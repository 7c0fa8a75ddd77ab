//! Plain values of Python, and what the host has in their place.

use arrow_array::RecordBatch;
use host_sim::source::log_report::LogReport;
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict, PyFloat, PyInt, PyList, PyString};
use serde::Serialize;
use std::collections::HashMap;
use std::sync::Arc;

/// Returns a value of the host as Python's own types.
pub fn to_python<'py>(py: Python<'py>, value: &impl Serialize) -> PyResult<Bound<'py, PyAny>> {
    let text = serde_json::to_string(value).expect("numbers are JSON");
    py.import("json")?.call_method1("loads", (text,))
}

/// Returns a table with what the reading of its log found, as JSON in its metadata.
pub fn with_report(table: RecordBatch, report: &LogReport) -> RecordBatch {
    let report = serde_json::to_string(report).expect("texts are JSON");
    let metadata = HashMap::from([("roadgrade.report".to_owned(), report)]);
    let schema = table.schema().as_ref().clone().with_metadata(metadata);
    table
        .with_schema(Arc::new(schema))
        .expect("only the metadata differ")
}

/// Returns a dictionary as the table of a TOML file.
///
/// # Errors
/// Returns a `TypeError` that names a key whose value TOML does not have.
pub fn toml_table(dict: &Bound<'_, PyDict>) -> PyResult<toml::Table> {
    let mut table = toml::Table::new();
    for (key, value) in dict {
        let key: String = key.extract()?;
        let value = toml_value(&key, &value)?;
        table.insert(key, value);
    }
    Ok(table)
}

fn toml_value(key: &str, value: &Bound<'_, PyAny>) -> PyResult<toml::Value> {
    if let Ok(dict) = value.cast::<PyDict>() {
        return toml_table(dict).map(toml::Value::Table);
    }
    if let Ok(list) = value.cast::<PyList>() {
        let values = list.iter().map(|value| toml_value(key, &value));
        return values.collect::<PyResult<_>>().map(toml::Value::Array);
    }
    // Switches are whole numbers in Python too.
    if value.is_instance_of::<PyBool>() {
        return value.extract().map(toml::Value::Boolean);
    }
    if value.is_instance_of::<PyInt>() {
        return value.extract().map(toml::Value::Integer);
    }
    if value.is_instance_of::<PyFloat>() {
        return value.extract().map(toml::Value::Float);
    }
    if value.is_instance_of::<PyString>() {
        return value.extract().map(toml::Value::String);
    }
    // Numbers of NumPy.
    if let Ok(number) = value.extract() {
        return Ok(toml::Value::Float(number));
    }
    let kind = value.get_type().name()?;
    Err(PyTypeError::new_err(format!(
        "{key}: is a {kind}; expected a number, a text, a list or a dict"
    )))
}
