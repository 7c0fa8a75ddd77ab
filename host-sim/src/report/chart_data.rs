//! Plots as JSON for the script that draws them in a browser.

use super::colour::for_both_themes;
use super::digits::{place_of, rounded, to_place};
use super::plot::{Mark, Plot, Series};
use super::thin::{Points, thinned};
use serde_json::{Value, json};

/// Significant digits of drawn numbers. A pixel needs four; hover shows more.
const DIGITS: i32 = 6;
/// Decimals of x, from the first digit of the axis's length on: a cell of 2.5 m in 1,000 km.
const AXIS_DIGITS: i32 = 6;

/// A figure as a page embeds it.
#[derive(Clone, Debug)]
pub struct Drawn {
    /// Content of the JSON element.
    pub json: String,
    /// What was left out for drawing, as sentences; empty if nothing was.
    pub words: String,
}

impl Drawn {
    /// Creates it of JSON data, with the text that stands in its place without scripts.
    pub fn new(value: &Value, words: String) -> Self {
        // No text can end the element early.
        let json = value.to_string().replace('<', "\\u003c");
        Self { json, words }
    }
}

/// Returns the chart with at most about `most` points in each series.
pub fn chart(plot: &Plot, most: usize) -> Drawn {
    let mut thinner = false;
    let mut axes: Vec<Vec<f64>> = Vec::new();
    let series: Vec<Value> = plot
        .series
        .iter()
        .map(|series| {
            let points = in_order(series);
            let kept = match series.mark {
                Mark::Line | Mark::Dashed | Mark::Band(_) => thinned(&points, most),
                Mark::Dots | Mark::Bars => points.clone(),
            };
            thinner |= kept.points.len() < points.points.len();
            series_json(series, &kept, &mut axes)
        })
        .collect();
    let words = if thinner {
        "Long curves are drawn by the least and the greatest of neighbouring points.".to_owned()
    } else {
        String::new()
    };
    let value = json!({
        "kind": "chart",
        "x": plot.x_label,
        "y": plot.y_label,
        "link": plot.link,
        "height": plot.height,
        "range": plot.y_range.map(|(low, high)| [number(low), number(high)]),
        "shaded": plot.shaded,
        "ticks": plot.ticks,
        "axes": axes,
        "series": series,
    });
    Drawn::new(&value, words)
}

/// Returns the points sorted by x: dots may come in any order.
fn in_order(series: &Series) -> Points {
    let mut points = Points::of(series);
    if series.mark == Mark::Dots {
        points.points.sort_by(|a, b| a.0.total_cmp(&b.0));
    }
    points
}

/// Series with the same x share an axis: `axis` is its index.
fn series_json(series: &Series, kept: &Points, axes: &mut Vec<Vec<f64>>) -> Value {
    let x = strictly_ascending(kept.points.iter().map(|point| point.0));
    let axis = axes.iter().position(|axis| *axis == x);
    let axis = axis.unwrap_or_else(|| {
        axes.push(x);
        axes.len() - 1
    });
    let mark = match series.mark {
        Mark::Line => "line",
        Mark::Dashed => "dashed",
        Mark::Dots => "dots",
        Mark::Bars => "bars",
        Mark::Band(_) => "band",
    };
    json!({
        "name": series.name,
        "colour": for_both_themes(series.colour),
        "mark": mark,
        "axis": axis,
        "y": kept.points.iter().map(|point| number(point.1)).collect::<Vec<_>>(),
        "lower": kept.lower.iter().map(|y| number(*y)).collect::<Vec<_>>(),
    })
}

/// Rounds x; points at the same x follow each other at a distance that no screen shows, because the
/// library holds one point at each x.
fn strictly_ascending(values: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut all: Vec<f64> = values.collect();
    let span = all.last().unwrap_or(&0.0) - all.first().unwrap_or(&0.0);
    let span = if span > 0.0 { span } else { 1.0 };
    for x in &mut all {
        *x = to_place(*x, place_of(span) - AXIS_DIGITS);
    }
    let step = (1e-9 * span).max(f64::MIN_POSITIVE);
    for i in 1..all.len() {
        if all[i] <= all[i - 1] {
            all[i] = (all[i - 1] + step).max(all[i - 1].next_up());
        }
    }
    all
}

/// Returns a rounded number; `null` if it is not finite, which is a gap.
pub fn number(value: f64) -> Value {
    serde_json::Number::from_f64(rounded(value, DIGITS)).map_or(Value::Null, Value::Number)
}
