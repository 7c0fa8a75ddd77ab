//! Plots: series over a common axis, as data. `svg.rs` and `chart_data.rs` draw them.

pub use super::colour;
use super::digits::rounded;
use plotters::style::RGBColor;

/// Digits of numbers in files.
const FILE_DIGITS: i32 = 9;

/// Style of a series.
#[derive(Clone, Debug, PartialEq)]
pub enum Mark {
    /// A line through the points.
    Line,
    /// A dashed line.
    Dashed,
    /// A dot at each point.
    Dots,
    /// A bar from zero to each point. Its width is the distance between points.
    Bars,
    /// An area between `y` and the given lower edge, without outline.
    Band(Vec<f64>),
}

/// One series of points.
#[derive(Clone, Debug)]
pub struct Series {
    /// Name in the legend; if empty, the legend leaves the series out.
    pub name: String,
    /// (x, y) in the units of the axes; x ascending for lines and bands. A line has a gap where y
    /// is not finite.
    pub points: Vec<(f64, f64)>,
    /// Its colour.
    pub colour: RGBColor,
    /// Style.
    pub mark: Mark,
}

impl Series {
    /// Creates a line.
    pub fn line(
        name: impl Into<String>,
        colour: RGBColor,
        points: impl IntoIterator<Item = (f64, f64)>,
    ) -> Self {
        Self {
            name: name.into(),
            points: points.into_iter().collect(),
            colour,
            mark: Mark::Line,
        }
    }

    /// Creates a band of two standard deviations about a line.
    pub fn two_sigma(
        name: impl Into<String>,
        colour: RGBColor,
        points: impl IntoIterator<Item = (f64, f64, f64)>,
    ) -> Self {
        let (upper, lower) = points
            .into_iter()
            .map(|(x, y, sigma)| ((x, y + 2.0 * sigma), y - 2.0 * sigma))
            .unzip();
        Self {
            name: name.into(),
            points: upper,
            colour,
            mark: Mark::Band(lower),
        }
    }

    /// Returns the series in another style.
    #[must_use]
    pub fn drawn(mut self, mark: Mark) -> Self {
        self.mark = mark;
        self
    }
}

/// One plot.
#[derive(Clone, Debug, Default)]
pub struct Plot {
    /// Name of the x axis with its unit.
    pub x_label: String,
    /// Name of the y axis with its unit.
    pub y_label: String,
    /// Series, from back to front.
    pub series: Vec<Series>,
    /// Ranges of x with a grey background.
    pub shaded: Vec<(f64, f64)>,
    /// Positions of short vertical lines on the x axis.
    pub ticks: Vec<f64>,
    /// Range of y; `None` for that of the data.
    pub y_range: Option<(f64, f64)>,
    /// Height, pixels.
    pub height: u32,
    /// Name of what x runs along, e.g. a way. Figures of a page with the same name share hover and
    /// zoom. Empty: on its own.
    pub link: String,
}

impl Plot {
    /// Creates a plot with these axis labels and the default height.
    pub fn new(x_label: impl Into<String>, y_label: impl Into<String>) -> Self {
        Self {
            x_label: x_label.into(),
            y_label: y_label.into(),
            height: 320,
            ..Self::default()
        }
    }

    /// Returns the plot with one more series, in front of the others.
    #[must_use]
    pub fn with(mut self, series: Series) -> Self {
        self.series.push(series);
        self
    }

    /// Returns the plot with hover and zoom shared with the page's other figures of this name.
    #[must_use]
    pub fn linked(mut self, link: impl Into<String>) -> Self {
        self.link = link.into();
        self
    }

    /// Returns the number of points beyond the range of y.
    #[must_use]
    pub fn beyond(&self) -> usize {
        let Some((low, high)) = self.y_range else {
            return 0;
        };
        let points = self.series.iter().flat_map(|series| &series.points);
        points.filter(|(_, y)| *y < low || *y > high).count()
    }

    /// Returns the data as CSV: series, x, y, and the lower edge of bands.
    ///
    /// # Panics
    /// Never: writing to memory has no error.
    #[must_use]
    pub fn to_csv(&self) -> String {
        let mut writer = csv::Writer::from_writer(Vec::new());
        let header = ["series", &self.x_label, &self.y_label, "lower"];
        writer.write_record(header).expect("memory");
        for series in &self.series {
            let known = series.points.iter().enumerate();
            for (k, (x, y)) in known.filter(|(_, point)| point.1.is_finite()) {
                let lower = match &series.mark {
                    Mark::Band(lower) => lower.get(k).map(|of| text(*of)).unwrap_or_default(),
                    _ => String::new(),
                };
                let row = [&series.name, &text(*x), &text(*y), &lower];
                writer.write_record(row).expect("memory");
            }
        }
        String::from_utf8(writer.into_inner().expect("memory")).expect("made of strings")
    }
}

/// Returns a number as the files of charts have it.
fn text(value: f64) -> String {
    rounded(value, FILE_DIGITS).to_string()
}

/// Joins neighbouring cells that are set into x ranges to shade.
#[must_use]
pub fn shaded_ranges(cells: impl IntoIterator<Item = (f64, bool)>) -> Vec<(f64, f64)> {
    let mut found: Vec<(f64, f64)> = Vec::new();
    let mut was_on = false;
    let mut before = f64::NAN;
    for (x, is_on) in cells {
        match (is_on, was_on, found.last_mut()) {
            (true, true, Some(last)) => last.1 = x,
            (true, ..) => found.push((if before.is_nan() { x } else { before }, x)),
            _ => {}
        }
        was_on = is_on;
        before = x;
    }
    found
}
