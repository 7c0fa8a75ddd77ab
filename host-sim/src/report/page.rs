//! One self-contained HTML page: sections of text, tables, charts and plans.

use super::chart_data::Drawn;
pub use super::figure::Figure;
pub use super::section::{Note, Section};
pub use super::table::Table;
use crate::error::{Error, Result};
use crate::files::output::{Staged, stage_text};
use askama::Template;
use std::path::{Path, PathBuf};

/// File name of a page.
pub const PAGE: &str = "report.html";
/// Points of curves that a page can hold without being slow or large (about 20 bytes each) ...
const MOST_POINTS: usize = 60_000;
/// ... and the least and the most of them for a curve.
const POINTS_OF_A_CURVE: (usize, usize) = (1_000, 10_000);

/// A page.
#[derive(Clone, Debug, Default, Template)]
#[template(path = "page.html")]
pub struct Page {
    /// Title.
    pub title: String,
    /// Subject of the page, in a sentence or two.
    pub lead: String,
    /// Sections.
    pub sections: Vec<Section>,
}

impl Page {
    /// Creates a page without sections.
    pub fn new(title: impl Into<String>, lead: impl Into<String>) -> Self {
        Self {
            title: title.into(),
            lead: lead.into(),
            sections: Vec::new(),
        }
    }

    /// Returns the page with one more section.
    #[must_use]
    pub fn with(mut self, section: Section) -> Self {
        self.sections.push(section);
        self
    }

    /// Writes `report.html` into a folder, with each table as NAME.csv and each plot as NAME.svg
    /// and NAME.csv beside it. Returns the path of the page.
    ///
    /// # Errors
    /// Returns an error if a file cannot be written.
    pub fn write(&self, folder: &Path) -> Result<PathBuf> {
        for file in self.stage(folder)? {
            file.commit()?;
        }
        Ok(folder.join(PAGE))
    }

    /// Returns the files that [`Self::write`] writes.
    #[must_use]
    pub fn files(&self, folder: &Path) -> Vec<PathBuf> {
        let of_section = |section: &Section| {
            let tables = section.tables.iter();
            let tables = tables.map(|table| format!("{}.csv", table.name));
            let figures = section.figures.iter().flat_map(Figure::file_names);
            tables.chain(figures).collect::<Vec<_>>()
        };
        let names = self.sections.iter().flat_map(of_section);
        names
            .chain([PAGE.to_owned()])
            .map(|name| folder.join(name))
            .collect()
    }

    /// Writes the page alone to a file that appears when it is committed.
    ///
    /// # Errors
    /// Returns an error if the file cannot be written.
    pub fn stage_alone(&self, path: &Path) -> Result<Staged> {
        let html = self.render().map_err(std::io::Error::other);
        stage_text(path, &html.map_err(Error::io(path))?)
    }

    /// Writes the files of [`Self::write`]; they appear when they are committed.
    ///
    /// # Errors
    /// Returns an error if a file cannot be written.
    pub fn stage(&self, folder: &Path) -> Result<Vec<Staged>> {
        let mut files = Vec::new();
        for section in &self.sections {
            for table in &section.tables {
                let path = folder.join(format!("{}.csv", table.name));
                files.push(stage_text(&path, &table.to_csv())?);
            }
            for (name, text) in section.figures.iter().flat_map(Figure::files) {
                files.push(stage_text(&folder.join(name), &text)?);
            }
        }
        files.push(self.stage_alone(&folder.join(PAGE))?);
        Ok(files)
    }

    fn has_figures(&self) -> bool {
        self.sections
            .iter()
            .any(|section| !section.figures.is_empty())
    }

    /// Returns a figure for the page's script.
    fn drawn(&self, figure: &Figure) -> Drawn {
        let curves: usize = self
            .sections
            .iter()
            .flat_map(|section| &section.figures)
            .map(Figure::curves)
            .sum();
        let (least, most) = POINTS_OF_A_CURVE;
        figure.drawn((MOST_POINTS / curves.max(1)).clamp(least, most))
    }
}
