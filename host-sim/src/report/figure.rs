//! Figures of a page: a chart or a plan with its caption.

use super::chart_data::{self, Drawn};
use super::plan::Plan;
use super::plot::Plot;

/// A drawing with its caption.
#[derive(Clone, Debug)]
pub struct Figure {
    /// Name of its files, without extension.
    pub name: String,
    /// What is drawn.
    pub drawing: Drawing,
    /// Caption.
    pub caption: String,
    /// An address to open, with its words.
    pub link: Option<(String, String)>,
}

/// What a figure draws.
#[derive(Clone, Debug)]
pub enum Drawing {
    /// Series over an axis.
    Chart(Plot),
    /// Lines seen from above.
    Plan(Plan),
}

impl Figure {
    /// Creates a figure of a plot. The caption tells where curves leave the axis.
    pub fn new(name: impl Into<String>, plot: &Plot, caption: impl Into<String>) -> Self {
        let mut caption = caption.into();
        if plot.beyond() > 0 {
            caption += " Triangles at the edge: the curve leaves the axis there.";
        }
        Self {
            name: name.into(),
            drawing: Drawing::Chart(plot.clone()),
            caption,
            link: None,
        }
    }

    /// Creates a figure of a plan.
    pub fn plan(name: impl Into<String>, plan: Plan, caption: impl Into<String>) -> Self {
        Self {
            name: name.into(),
            drawing: Drawing::Plan(plan),
            caption: caption.into(),
            link: None,
        }
    }

    /// Returns the figure with an address to open.
    #[must_use]
    pub fn with_link(mut self, url: impl Into<String>, words: impl Into<String>) -> Self {
        self.link = Some((url.into(), words.into()));
        self
    }

    /// Returns its files, as their names and contents: a plot as SVG, and its data as CSV. A plan
    /// has none.
    pub(super) fn files(&self) -> Vec<(String, String)> {
        let Drawing::Chart(plot) = &self.drawing else {
            return Vec::new();
        };
        let name = |ending: &str| format!("{}.{ending}", self.name);
        vec![(name("svg"), plot.to_svg()), (name("csv"), plot.to_csv())]
    }

    /// Returns the names of [`Self::files`].
    pub(super) fn file_names(&self) -> Vec<String> {
        match self.drawing {
            Drawing::Chart(_) => ["svg", "csv"]
                .map(|of| format!("{}.{of}", self.name))
                .into(),
            Drawing::Plan(_) => Vec::new(),
        }
    }

    /// Returns its number of curves.
    pub(super) fn curves(&self) -> usize {
        match &self.drawing {
            Drawing::Chart(plot) => plot.series.len(),
            Drawing::Plan(_) => 0,
        }
    }

    /// Returns the figure for the page's script; curves have about `most` points.
    pub(super) fn drawn(&self, most: usize) -> Drawn {
        match &self.drawing {
            Drawing::Chart(plot) => chart_data::chart(plot, most),
            Drawing::Plan(plan) => plan.drawn(),
        }
    }
}
