//! Plots as SVG text, for papers and for this project's own pages.

use super::plot::{Mark, Plot, Series, colour};
use super::thin::{Points, runs, thinned};
use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;
use std::error::Error;

/// Width of every plot, pixels.
pub const WIDTH: u32 = 960;
/// Height of a tick, as a fraction of the plot's height.
const TICK_PART: f64 = 0.08;
/// Longest line that is drawn in full. Of a longer line only the extremes in each column are drawn.
const MOST_POINTS: usize = 2 * WIDTH as usize;
/// Colour of the text and of the frame.
const INK: RGBColor = colour::BLACK;

type Drawing<'a> = DrawingArea<SVGBackend<'a>, plotters::coord::Shift>;
type Chart<'a, 'b> = ChartContext<'a, SVGBackend<'b>, Cartesian2d<RangedCoordf64, RangedCoordf64>>;
type Outcome<T = ()> = Result<T, Box<dyn Error>>;

impl Plot {
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

    fn draw(&self, area: &Drawing<'_>) -> Outcome {
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
            draw_beyond(&mut chart, series, y)?;
        }
        let tick_top = y.0 + TICK_PART * (y.1 - y.0);
        for &at in &self.ticks {
            let tick = PathElement::new([(at, y.0), (at, tick_top)], INK);
            chart.draw_series([tick]).map_err(|e| e.to_string())?;
        }
        area.present().map_err(|e| e.to_string())?;
        Ok(())
    }

    /// Draws the names of the series in rows above the plot, where they do not hide data. Returns
    /// the height of the rows in pixels.
    fn draw_legend(&self, area: &Drawing<'_>) -> Outcome<i32> {
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
            };
            for (from, to) in match series.mark {
                Mark::Dashed => vec![(x, x + 9), (x + 14, x + 23)],
                Mark::Dots => vec![(x + 3, x + 7), (x + 14, x + 18)],
                Mark::Line | Mark::Bars | Mark::Band(_) => vec![(x, x + 23)],
            } {
                let key = Rectangle::new(
                    [(from, middle - half), (to, middle + half)],
                    series.colour.mix(strength).filled(),
                );
                area.draw(&key).map_err(|e| e.to_string())?;
            }
            let style = ("sans-serif", 13).into_font().color(&INK);
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
        let x = spread(points().map(|p| p.0), 0.0);
        let data = || spread(points().map(|p| p.1).chain(lower.copied()), 0.05);
        (x, self.y_range.unwrap_or_else(data))
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

fn draw_series(chart: &mut Chart<'_, '_>, series: &Series) -> Outcome {
    let colour = series.colour;
    match &series.mark {
        Mark::Dots => {
            let known = series.points.iter().filter(|point| point.1.is_finite());
            let dots = known.map(|point| Circle::new(*point, 2, colour.filled()));
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
        Mark::Line | Mark::Dashed | Mark::Band(_) => draw_runs(chart, series)?,
    }
    Ok(())
}

/// Draws each run of points between gaps.
fn draw_runs(chart: &mut Chart<'_, '_>, series: &Series) -> Outcome {
    let colour = series.colour;
    let drawn = thinned(&Points::of(series), MOST_POINTS);
    for range in runs(&drawn.points) {
        let points = drawn.points[range.clone()].to_vec();
        match &series.mark {
            Mark::Dashed => {
                let line = DashedLineSeries::new(points, 6, 4, colour.stroke_width(2));
                chart.draw_series(line).map_err(|e| e.to_string())?;
            }
            Mark::Band(_) => {
                let lower = points.iter().zip(&drawn.lower[range]);
                let lower: Vec<_> = lower.map(|(point, y)| (point.0, *y)).collect();
                let mut outline = points;
                outline.extend(lower.into_iter().rev());
                let band = Polygon::new(outline, colour.mix(0.2).filled());
                chart.draw_series([band]).map_err(|e| e.to_string())?;
            }
            _ => {
                let line = LineSeries::new(points, colour.stroke_width(2));
                chart.draw_series(line).map_err(|e| e.to_string())?;
            }
        }
    }
    Ok(())
}

/// Marks with a triangle at the edge where a series leaves the range of y: one for each stay
/// beyond it.
fn draw_beyond(chart: &mut Chart<'_, '_>, series: &Series, (low, high): (f64, f64)) -> Outcome {
    if matches!(series.mark, Mark::Band(_)) {
        return Ok(());
    }
    for (edge, sign, is_beyond) in [
        (high, 1, (&|y| y > high) as &dyn Fn(f64) -> bool),
        (low, -1, &|y| y < low),
    ] {
        let mut was_beyond = false;
        for &(x, y) in &series.points {
            let is = is_beyond(y);
            if is && !was_beyond {
                let corners = vec![(0, sign), (-5, 9 * sign), (5, 9 * sign)];
                let triangle = Polygon::new(corners, series.colour.filled());
                let mark = EmptyElement::at((x, edge)) + triangle;
                chart.draw_series([mark]).map_err(|e| e.to_string())?;
            }
            was_beyond = is;
        }
    }
    Ok(())
}
