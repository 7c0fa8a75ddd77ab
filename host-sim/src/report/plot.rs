//! Line plots as SVG text.

use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;
use std::error::Error;

/// Colours that differ in print and for the colour-blind (Okabe and Ito).
pub mod colour {
    use plotters::style::RGBColor;
    /// Truth or reference.
    pub const BLACK: RGBColor = RGBColor(0x22, 0x22, 0x22);
    /// Main estimate.
    pub const BLUE: RGBColor = RGBColor(0x00, 0x72, 0xb2);
    /// Compared estimate.
    pub const ORANGE: RGBColor = RGBColor(0xd5, 0x5e, 0x00);
    /// Third series.
    pub const GREEN: RGBColor = RGBColor(0x00, 0x9e, 0x73);
    /// Fourth series.
    pub const PURPLE: RGBColor = RGBColor(0xcc, 0x79, 0xa7);
    /// Background.
    pub const GREY: RGBColor = RGBColor(0x99, 0x99, 0x99);
    /// Colours of the runs, in order.
    pub const CYCLE: [RGBColor; 5] = [BLUE, ORANGE, GREEN, PURPLE, GREY];
}

/// Style of a series.
#[derive(Clone, Debug, PartialEq)]
pub enum Mark {
    /// A line through the points.
    Line,
    /// A dashed line.
    Dashed,
    /// Thick lines. Each starts at one of these points, by index, and ends at the next.
    Lines(Vec<usize>),
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
    /// (x, y) in the units of the axes; x ascending for lines and bands.
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
    /// Whether one metre has the same length in x and y.
    pub equal_scales: bool,
    /// Height, pixels; the width is [`WIDTH`].
    pub height: u32,
}

/// Width of every plot, pixels.
pub const WIDTH: u32 = 960;
/// Height of a tick, as a fraction of the plot's height.
const TICK_PART: f64 = 0.08;
/// Longest line that is drawn in full. Of a longer line only the extremes in each column are drawn.
const MOST_POINTS: usize = 2 * WIDTH as usize;

type Drawing<'a> = DrawingArea<SVGBackend<'a>, plotters::coord::Shift>;
type Chart<'a, 'b> = ChartContext<'a, SVGBackend<'b>, Cartesian2d<RangedCoordf64, RangedCoordf64>>;

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

    /// Returns the SVG text.
    ///
    /// # Panics
    /// Never: drawing into a string has no error.
    #[must_use]
    pub fn to_svg(&self) -> String {
        let mut text = String::new();
        {
            let area = SVGBackend::with_string(&mut text, (WIDTH, self.height)).into_drawing_area();
            self.draw(&area).expect("a string takes every drawing");
        }
        text
    }

    /// Returns the drawn data as CSV: series, x, y, and the lower edge of bands.
    ///
    /// # Panics
    /// Never: writing to memory has no error.
    #[must_use]
    pub fn to_csv(&self) -> String {
        let mut writer = csv::Writer::from_writer(Vec::new());
        let header = ["series", &self.x_label, &self.y_label, "lower"];
        writer.write_record(header).expect("memory");
        for series in &self.series {
            for (k, (x, y)) in series.points.iter().enumerate() {
                let lower = match &series.mark {
                    Mark::Band(lower) => lower.get(k).map(f64::to_string).unwrap_or_default(),
                    _ => String::new(),
                };
                let row = [&series.name, &x.to_string(), &y.to_string(), &lower];
                writer.write_record(row).expect("memory");
            }
        }
        String::from_utf8(writer.into_inner().expect("memory")).expect("made of strings")
    }

    fn draw(&self, area: &Drawing<'_>) -> Result<(), Box<dyn Error + 'static>> {
        let (x, y) = self.ranges();
        let legend_px = self.draw_legend(area)?;
        let mut chart = ChartBuilder::on(area)
            .margin(8)
            .margin_top(8 + legend_px)
            .margin_right(18)
            .x_label_area_size(44)
            .y_label_area_size(64)
            .build_cartesian_2d(x.0..x.1, y.0..y.1)
            .map_err(|e| e.to_string())?;
        chart
            .configure_mesh()
            .x_desc(&self.x_label)
            .y_desc(&self.y_label)
            .axis_desc_style(("sans-serif", 15))
            .label_style(("sans-serif", 13))
            .light_line_style(WHITE.mix(0.0))
            .bold_line_style(BLACK.mix(0.12))
            .x_label_formatter(&|v| short(*v))
            .y_label_formatter(&|v| short(*v))
            .draw()
            .map_err(|e| e.to_string())?;
        for &(from, to) in &self.shaded {
            let grey = colour::GREY.mix(0.25).filled();
            chart
                .draw_series([Rectangle::new([(from, y.0), (to, y.1)], grey)])
                .map_err(|e| e.to_string())?;
        }
        for series in &self.series {
            draw_series(&mut chart, series)?;
        }
        let tick_top = y.0 + TICK_PART * (y.1 - y.0);
        for &at in &self.ticks {
            let tick = PathElement::new([(at, y.0), (at, tick_top)], colour::BLACK);
            chart.draw_series([tick]).map_err(|e| e.to_string())?;
        }
        area.present().map_err(|e| e.to_string())?;
        Ok(())
    }

    /// Draws the names of the series in rows above the plot, where they do not hide data. Returns
    /// the height of the rows in pixels.
    fn draw_legend(&self, area: &Drawing<'_>) -> Result<i32, Box<dyn Error>> {
        const ROW_PX: i32 = 20;
        const LEFT_PX: i32 = 72;
        let (mut x, mut y) = (LEFT_PX, 8);
        let named: Vec<&Series> = self.series.iter().filter(|s| !s.name.is_empty()).collect();
        for series in &named {
            // About the width of 13 px sans-serif.
            let width = 30 + 7 * series.name.chars().count() as i32 + 16;
            if x + width > WIDTH as i32 && x > LEFT_PX {
                (x, y) = (LEFT_PX, y + ROW_PX);
            }
            let middle = y + ROW_PX / 2;
            let (half, strength) = match series.mark {
                Mark::Band(_) | Mark::Bars => (6, 0.3),
                Mark::Dots => (2, 1.0),
                Mark::Line | Mark::Dashed => (1, 1.0),
                Mark::Lines(_) => (2, 1.0),
            };
            for (from, to) in match series.mark {
                Mark::Dashed => vec![(x, x + 9), (x + 14, x + 23)],
                Mark::Dots => vec![(x + 3, x + 7), (x + 14, x + 18)],
                Mark::Line | Mark::Lines(_) | Mark::Bars | Mark::Band(_) => vec![(x, x + 23)],
            } {
                let key = Rectangle::new(
                    [(from, middle - half), (to, middle + half)],
                    series.colour.mix(strength).filled(),
                );
                area.draw(&key).map_err(|e| e.to_string())?;
            }
            let style = ("sans-serif", 13).into_font().color(&colour::BLACK);
            let text = Text::new(series.name.clone(), (x + 30, middle - 7), style);
            area.draw(&text).map_err(|e| e.to_string())?;
            x += width;
        }
        Ok(if named.is_empty() { 0 } else { y + ROW_PX - 8 })
    }

    fn ranges(&self) -> ((f64, f64), (f64, f64)) {
        let points = || self.series.iter().flat_map(|series| &series.points);
        let lower = self.series.iter().flat_map(|series| match &series.mark {
            Mark::Band(lower) => lower.as_slice(),
            _ => &[],
        });
        let mut x = spread(points().map(|p| p.0), 0.0);
        let mut y = self
            .y_range
            .unwrap_or_else(|| spread(points().map(|p| p.1).chain(lower.copied()), 0.05));
        if self.equal_scales {
            let (wide, high) = (f64::from(WIDTH - 90), f64::from(self.height - 60));
            let metre = ((x.1 - x.0) / wide).max((y.1 - y.0) / high) * 1.05;
            for (range, pixels) in [(&mut x, wide), (&mut y, high)] {
                let middle = 0.5 * (range.0 + range.1);
                *range = (middle - 0.5 * metre * pixels, middle + 0.5 * metre * pixels);
            }
        }
        (x, y)
    }
}

/// Returns the range of the values, widened on either side by a fraction `margin` of it.
fn spread(values: impl Iterator<Item = f64>, margin: f64) -> (f64, f64) {
    let (low, high) = values
        .filter(|v| v.is_finite())
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| {
            (low.min(v), high.max(v))
        });
    if low > high {
        return (0.0, 1.0);
    }
    let pad = ((high - low) * margin).max(if high > low { 0.0 } else { 0.5 });
    (low - pad, high + pad)
}

/// Returns a number without trailing zeros.
fn short(value: f64) -> String {
    let text = format!("{value:.3}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" {
        "0".to_owned()
    } else {
        text.to_owned()
    }
}

fn draw_series(chart: &mut Chart<'_, '_>, series: &Series) -> Result<(), Box<dyn Error>> {
    let colour = series.colour;
    match &series.mark {
        Mark::Dots => {
            let dots = series
                .points
                .iter()
                .map(|point| Circle::new(*point, 2, colour.filled()));
            chart.draw_series(dots).map_err(|e| e.to_string())?;
        }
        Mark::Bars => {
            let apart = series.points.windows(2).next();
            let half = apart.map_or(0.5, |pair| 0.5 * (pair[1].0 - pair[0].0));
            let bars = series.points.iter().map(|(x, y)| {
                let corners = [(x - half, 0.0), (x + half, *y)];
                Rectangle::new(corners, colour.mix(0.3).filled())
            });
            chart.draw_series(bars).map_err(|e| e.to_string())?;
        }
        Mark::Line => {
            let line = LineSeries::new(thinned(&series.points), colour.stroke_width(2));
            chart.draw_series(line).map_err(|e| e.to_string())?;
        }
        Mark::Lines(begins) => {
            let last = series.points.len();
            let ends = begins.iter().copied().skip(1).chain([last]);
            let lines = begins.iter().zip(ends).map(|(&begin, end)| {
                PathElement::new(&series.points[begin..end], colour.stroke_width(3))
            });
            chart.draw_series(lines).map_err(|e| e.to_string())?;
        }
        Mark::Dashed => {
            let points = thinned(&series.points);
            let line = DashedLineSeries::new(points, 6, 4, colour.stroke_width(2));
            chart.draw_series(line).map_err(|e| e.to_string())?;
        }
        Mark::Band(lower) => {
            let points = series.points.iter().zip(lower);
            let lower: Vec<_> = points.map(|(point, y)| (point.0, *y)).collect();
            let mut outline = thinned(&series.points);
            outline.extend(thinned(&lower).into_iter().rev());
            let band = Polygon::new(outline, colour.mix(0.2).filled());
            chart.draw_series([band]).map_err(|e| e.to_string())?;
        }
    }
    Ok(())
}

/// Returns the extremes of a long line in each column of pixels.
fn thinned(points: &[(f64, f64)]) -> Vec<(f64, f64)> {
    if points.len() <= MOST_POINTS {
        return points.to_vec();
    }
    let group = points.len().div_ceil(MOST_POINTS / 2);
    points
        .chunks(group)
        .flat_map(|chunk| {
            let by_y = |a: &&(f64, f64), b: &&(f64, f64)| a.1.total_cmp(&b.1);
            let low = chunk.iter().min_by(by_y).copied();
            let high = chunk.iter().max_by(by_y).copied();
            let (a, b) = (low.unwrap_or_default(), high.unwrap_or_default());
            if a.0 <= b.0 { [a, b] } else { [b, a] }
        })
        .collect()
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
