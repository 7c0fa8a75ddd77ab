//! One self-contained HTML page: sections of words, tables and inline SVG.

use super::plot::Plot;
use crate::error::Result;
use crate::output::write_whole;
use askama::Template;
use std::path::Path;

/// A page.
#[derive(Clone, Debug, Template)]
#[template(path = "page.html")]
pub struct Page {
    /// Its title.
    pub title: String,
    /// What it is about, a sentence or two.
    pub lead: String,
    /// Its parts.
    pub sections: Vec<Section>,
}

/// A part of a page.
#[derive(Clone, Debug)]
pub struct Section {
    /// Its heading.
    pub heading: String,
    /// What it shows, in words.
    pub words: String,
    /// A table, if there is one.
    pub table: Option<Table>,
    /// Figures.
    pub figures: Vec<Figure>,
}

/// A table: a header and rows of the same length.
#[derive(Clone, Debug, Default)]
pub struct Table {
    /// Names of the columns with their units.
    pub header: Vec<String>,
    /// Rows; numbers as text.
    pub rows: Vec<Vec<String>>,
}

/// A plot with its caption.
#[derive(Clone, Debug)]
pub struct Figure {
    /// The SVG text.
    pub svg: String,
    /// What is to be seen in it.
    pub caption: String,
}

impl Figure {
    /// Draws a plot.
    pub fn new(plot: &Plot, caption: impl Into<String>) -> Self {
        Self {
            svg: plot.to_svg(),
            caption: caption.into(),
        }
    }
}

impl Page {
    /// Writes the page.
    ///
    /// # Errors
    /// What the file system says.
    pub fn write(&self, path: &Path) -> Result<()> {
        write_whole(path, |out| {
            let html = self.render().map_err(std::io::Error::other)?;
            out.write_all(html.as_bytes())
        })
    }
}
