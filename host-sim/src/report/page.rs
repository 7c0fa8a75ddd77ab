//! One self-contained HTML page: sections of text, tables and inline SVG.

use super::plot::Plot;
use crate::error::{Error, Result};
use crate::files::output::{Staged, stage_text};
use askama::Template;
use std::path::{Path, PathBuf};

/// File name of a page.
pub const PAGE: &str = "report.html";

/// A page.
#[derive(Clone, Debug, Template)]
#[template(path = "page.html")]
pub struct Page {
    /// Title.
    pub title: String,
    /// Subject of the page, in a sentence or two.
    pub lead: String,
    /// Sections.
    pub sections: Vec<Section>,
}

/// A section of a page.
#[derive(Clone, Debug, Default)]
pub struct Section {
    /// Heading.
    pub heading: String,
    /// Text; a paragraph each.
    pub words: Vec<String>,
    /// Tables.
    pub tables: Vec<Table>,
    /// Figures.
    pub figures: Vec<Figure>,
}

/// A table: a header and rows of the same length.
#[derive(Clone, Debug, Default)]
pub struct Table {
    /// Name of its file, without extension.
    pub name: String,
    /// Caption.
    pub caption: String,
    /// Names of the columns with their units.
    pub header: Vec<String>,
    /// Rows; numbers as text.
    pub rows: Vec<Vec<String>>,
}

/// A plot with its caption.
#[derive(Clone, Debug)]
pub struct Figure {
    /// Name of its files, without extension.
    pub name: String,
    /// The SVG text.
    pub svg: String,
    /// The drawn data as CSV.
    pub csv: String,
    /// Caption.
    pub caption: String,
}

impl Figure {
    /// Draws a plot.
    pub fn new(name: impl Into<String>, plot: &Plot, caption: impl Into<String>) -> Self {
        Self {
            name: name.into(),
            svg: plot.to_svg(),
            csv: plot.to_csv(),
            caption: caption.into(),
        }
    }
}

impl Table {
    /// Creates an empty table.
    pub fn new(name: impl Into<String>, caption: impl Into<String>, header: &[&str]) -> Self {
        Self {
            name: name.into(),
            caption: caption.into(),
            header: header.iter().map(|&name| name.to_owned()).collect(),
            rows: Vec::new(),
        }
    }

    /// Returns the table with these rows.
    #[must_use]
    pub fn with_rows(mut self, rows: impl IntoIterator<Item = Vec<String>>) -> Self {
        self.rows.extend(rows);
        self
    }

    /// Returns the table as CSV.
    fn to_csv(&self) -> String {
        let mut writer = csv::Writer::from_writer(Vec::new());
        for row in std::iter::once(&self.header).chain(&self.rows) {
            writer.write_record(row).expect("memory takes every row");
        }
        let bytes = writer.into_inner().expect("memory takes every row");
        String::from_utf8(bytes).expect("made of strings")
    }
}

impl Page {
    /// Writes `report.html` into a folder, with each table as NAME.csv and each figure as NAME.svg
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
            let tables = section
                .tables
                .iter()
                .map(|table| format!("{}.csv", table.name));
            let figures = section.figures.iter();
            let figures = figures.flat_map(|figure| {
                ["svg", "csv"].map(|ending| format!("{}.{ending}", figure.name))
            });
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
        let mut stage = |name: &str, text: &str| -> Result<()> {
            files.push(stage_text(&folder.join(name), text)?);
            Ok(())
        };
        for section in &self.sections {
            for table in &section.tables {
                stage(&format!("{}.csv", table.name), &table.to_csv())?;
            }
            for figure in &section.figures {
                stage(&format!("{}.svg", figure.name), &figure.svg)?;
                stage(&format!("{}.csv", figure.name), &figure.csv)?;
            }
        }
        files.push(self.stage_alone(&folder.join(PAGE))?);
        Ok(files)
    }
}
