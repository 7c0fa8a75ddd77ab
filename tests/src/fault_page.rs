//! `tests/faults.md`: the outcomes of all faults and manoeuvres.

use crate::faults::matrix::{FaultRow, matrix};
use crate::faults::table::table;
use crate::image::root;
use crate::manoeuvres::page::{self, page};
use crate::manoeuvres::road::BenchRoad;
use host_sim::error::{Error, Result};
use std::fs;
use std::path::PathBuf;

/// The page: faults, which are the same everywhere, and manoeuvres, which need the measured road.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FaultPage {
    /// The table of the faults.
    pub faults: String,
    /// The tables of the manoeuvres.
    pub manoeuvres: String,
}

/// Returns the path of the committed page.
#[must_use]
pub fn committed_file() -> PathBuf {
    root().join("tests/faults.md")
}

impl FaultPage {
    /// Reads the committed page.
    ///
    /// # Errors
    /// Returns an error if it cannot be read.
    pub fn committed() -> Result<Self> {
        let path = committed_file();
        let text = fs::read_to_string(&path).map_err(Error::io(&path))?;
        let at = text.find(page::HEADING).unwrap_or(text.len());
        let (faults, manoeuvres) = text.split_at(at);
        Ok(Self {
            faults: faults.trim_end().to_owned() + "\n",
            manoeuvres: manoeuvres.to_owned(),
        })
    }

    /// Returns the text of the page.
    #[must_use]
    pub fn text(&self) -> String {
        format!("{}\n{}", self.faults, self.manoeuvres)
    }
}

/// Runs the faults, and returns their part of the page and the requirements that are not met although
/// nothing says so.
///
/// # Errors
/// Returns the errors of the simulator.
pub fn faults() -> Result<(String, Vec<String>)> {
    let rows = matrix(&[])?;
    Ok((table(&rows), rows.iter().flat_map(named).collect()))
}

fn named(row: &FaultRow) -> impl Iterator<Item = String> {
    let complaints = row.complaints().into_iter();
    complaints.map(|complaint| format!("{}: {complaint}", row.fault.name))
}

/// Runs the manoeuvres, and returns their part of the page; `None` if the measured road is absent.
///
/// # Errors
/// Returns an error if the road's file is damaged.
pub fn manoeuvres() -> Result<Option<String>> {
    let road = BenchRoad::load()?;
    if !road.is_measured {
        eprintln!("SKIPPED: the manoeuvres of tests/faults.md, whose measured road is absent");
        return Ok(None);
    }
    Ok(Some(page(&road)))
}
