//! Tables for Arrow, by its PyCapsule interface
//! (<https://arrow.apache.org/docs/format/CDataInterface/PyCapsuleInterface.html>): pyarrow, polars,
//! pandas, DuckDB and others take them without a copy.

use arrow_array::ffi_stream::FFI_ArrowArrayStream;
use arrow_array::{RecordBatch, RecordBatchIterator};
use arrow_schema::ffi::FFI_ArrowSchema;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyCapsule;
use std::collections::HashMap;

/// Columns of numbers, texts and geometries, for any library that reads Arrow: `pyarrow.table(t)`,
/// `polars.from_arrow(t)`, `pandas.DataFrame.from_arrow(t)`. The memory is shared, not copied.
#[pyclass(frozen, module = "roadgrade")]
#[derive(Clone)]
pub struct Table(RecordBatch);

impl Table {
    /// Makes a table of Python from this one.
    pub const fn new(batch: RecordBatch) -> Self {
        Self(batch)
    }
}

#[pymethods]
impl Table {
    /// Names of the columns; each name of a number carries its unit.
    #[getter]
    fn column_names(&self) -> Vec<String> {
        let fields = self.0.schema();
        fields.fields().iter().map(|of| of.name().clone()).collect()
    }

    /// Number of rows.
    #[getter]
    fn num_rows(&self) -> usize {
        self.0.num_rows()
    }

    /// What is known of the table as a whole, as text by key.
    #[getter]
    fn metadata(&self) -> HashMap<String, String> {
        let schema = self.0.schema();
        let pairs = schema.metadata().iter();
        pairs
            .map(|(key, value)| (key.to_string(), value.to_string()))
            .collect()
    }

    fn __len__(&self) -> usize {
        self.0.num_rows()
    }

    fn __repr__(&self) -> String {
        let rows = self.0.num_rows();
        format!(
            "<roadgrade.Table of {rows} rows: {}>",
            self.column_names().join(", ")
        )
    }

    /// Returns the schema as Arrow's C data interface has it.
    fn __arrow_c_schema__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyCapsule>> {
        let schema = FFI_ArrowSchema::try_from(self.0.schema().as_ref())
            .map_err(|e| PyValueError::new_err(e.to_string()))?;
        PyCapsule::new_with_value(py, schema, c"arrow_schema")
    }

    /// Returns the rows as Arrow's C stream interface has them. Another schema cannot be asked for:
    /// the consumer converts.
    #[pyo3(signature = (requested_schema=None))]
    pub fn __arrow_c_stream__<'py>(
        &self,
        py: Python<'py>,
        requested_schema: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyCapsule>> {
        let _ = requested_schema;
        let rows = RecordBatchIterator::new([Ok(self.0.clone())], self.0.schema());
        let stream = FFI_ArrowArrayStream::new(Box::new(rows));
        PyCapsule::new_with_value(py, stream, c"arrow_array_stream")
    }
}
