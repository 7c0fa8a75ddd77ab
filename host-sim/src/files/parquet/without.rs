//! Tables where a program is built without Parquet: each is refused.

use crate::error::Result;
use crate::files::output::Staged;
use std::convert::Infallible;
use std::marker::PhantomData;
use std::path::Path;

/// An open file: there is none.
pub struct Opened<'a>(Infallible, PhantomData<&'a Path>);

/// Rows of a file, batch by batch: there are none.
pub struct NumberBatches(Infallible);

/// A column of a batch: there is none.
pub struct NumberColumn<'a>(Infallible, PhantomData<&'a [f64]>);

/// A table that is written: there is none.
pub struct TableWriter(Infallible);

/// A column that is not written.
#[derive(Debug)]
pub struct ParquetColumn;

/// Refuses a file.
///
/// # Errors
/// Returns an error always.
pub fn open(path: &Path) -> Result<Opened<'_>> {
    Err(super::without(path))
}

/// Refuses to write a file.
///
/// # Errors
/// Returns an error always.
pub fn stage(path: &Path, _: Vec<ParquetColumn>, _: &[(&str, String)]) -> Result<Staged> {
    Err(super::without(path))
}

impl<'a> Opened<'a> {
    /// Never called.
    #[must_use]
    pub const fn with_most_rows(self, _: usize) -> Self {
        match self.0 {}
    }

    /// Never called.
    #[must_use]
    pub const fn metadata(&self, _: &str) -> Option<&'a str> {
        match self.0 {}
    }

    /// Never called.
    #[must_use]
    pub const fn number_names(&self) -> Vec<String> {
        match self.0 {}
    }

    /// Never called.
    pub const fn column_names(&self) -> std::slice::Iter<'a, &'a str> {
        match self.0 {}
    }

    /// Never called.
    #[must_use]
    pub const fn rows(&self) -> usize {
        match self.0 {}
    }

    /// Never called.
    #[must_use]
    pub const fn has_column(&self, _: &str) -> bool {
        match self.0 {}
    }

    /// Never called.
    ///
    /// # Errors
    /// Returns none.
    pub fn read_newer<const N: usize, const M: usize>(
        self,
        _: [&str; N],
        _: [&str; M],
        _: impl FnMut([Option<f64>; N], [Option<f64>; M]) -> Result<()>,
    ) -> Result<()> {
        match self.0 {}
    }

    /// Never called.
    ///
    /// # Errors
    /// Returns none.
    pub fn read_batches<const N: usize, const M: usize>(
        self,
        _: [&str; N],
        _: [&str; M],
        _: impl FnMut(usize, &[NumberColumn<'_>; N], &[NumberColumn<'_>; M]) -> Result<()>,
    ) -> Result<()> {
        match self.0 {}
    }

    /// Never called.
    ///
    /// # Errors
    /// Returns none.
    pub fn read_texts<const N: usize, const M: usize>(
        self,
        _: [&str; N],
        _: [&str; M],
        _: impl FnMut([Option<f64>; N], [Option<&str>; M]) -> Result<()>,
    ) -> Result<()> {
        match self.0 {}
    }

    /// Never called.
    ///
    /// # Errors
    /// Returns none.
    pub fn batches(self, _: Vec<String>) -> Result<NumberBatches> {
        match self.0 {}
    }
}

impl NumberBatches {
    /// Never called.
    #[must_use]
    pub const fn path(&self) -> &Path {
        match self.0 {}
    }

    /// Never called.
    ///
    /// # Errors
    /// Returns none.
    pub const fn next_batch(&mut self) -> Result<Option<Vec<Vec<Option<f64>>>>> {
        match self.0 {}
    }
}

impl<'a> NumberColumn<'a> {
    /// Never called.
    #[must_use]
    pub const fn at(&self, _: usize) -> Option<f64> {
        match self.0 {}
    }

    /// Never called.
    #[must_use]
    pub const fn plain(&self) -> Option<&'a [f64]> {
        match self.0 {}
    }
}

impl TableWriter {
    /// Refuses to write a file.
    ///
    /// # Errors
    /// Returns an error always.
    pub fn begin(path: &Path, _: &[ParquetColumn], _: &[(&str, String)]) -> Result<Self> {
        Err(super::without(path))
    }

    /// Never called.
    ///
    /// # Errors
    /// Returns none.
    pub fn write(&mut self, _: Vec<ParquetColumn>) -> Result<()> {
        match self.0 {}
    }

    /// Never called.
    ///
    /// # Errors
    /// Returns none.
    pub fn finish(self) -> Result<Staged> {
        match self.0 {}
    }
}

impl ParquetColumn {
    /// Returns a column that is not written.
    pub fn numbers(_: &'static str, _: impl Iterator<Item = f64>) -> Self {
        Self
    }

    /// Returns a column that is not written.
    pub fn optional(_: &'static str, _: impl Iterator<Item = Option<f64>>) -> Self {
        Self
    }

    /// Returns a column that is not written.
    pub fn whole(_: &'static str, _: impl Iterator<Item = i64>) -> Self {
        Self
    }

    /// Returns a column that is not written.
    #[must_use]
    pub const fn text(_: &'static str, _: Option<&str>, _: usize) -> Self {
        Self
    }

    /// Returns a column that is not written.
    pub fn texts<'t>(_: &'static str, _: impl Iterator<Item = Option<&'t str>>) -> Self {
        Self
    }

    /// Returns a column that is not written.
    pub fn geometries(_: &'static str, _: impl Iterator<Item = Vec<u8>>) -> Self {
        Self
    }
}
