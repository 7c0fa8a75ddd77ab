//! The live view as text: a panel, lines, or JSON.

use super::road_picture::road_lines;
use super::road_view::{RoadView, STEP_M};
use super::view::{InterfaceView, LiveView, MemoryView};
use crate::terminal::counters::events;
use crate::terminal::disagreements::words_of;
use estimator_core::Uncertain;
use estimator_core::cell::CELL_LENGTH_M;
use serde_json::{Value, json};
use std::fmt::Write as _;

/// Columns of [`line`]: name, width, and decimals of its number.
const COLUMNS: [(&str, usize); 16] = [
    ("time_s", 9),
    ("distance_m", 11),
    ("speed_mps", 9),
    ("grade_percent", 13),
    ("sigma_percent", 13),
    ("mode", 16),
    ("bias_percent", 12),
    ("scale", 6),
    ("cells", 7),
    ("frames_per_s", 12),
    ("lost", 6),
    ("events", 6),
    ("mass_kg", 7),
    ("consistent", 10),
    ("map", 8),
    ("map_percent", 11),
];
/// Placeholder for an unknown value.
const UNKNOWN: &str = "-";

/// Returns the header of the lines.
#[must_use]
pub fn header() -> String {
    joined(&COLUMNS.map(|(name, _)| name.to_owned()))
}

/// Returns one line, in the columns of [`header`]. Fields are separated by blanks; `-` is an
/// unknown value.
#[must_use]
pub fn line(view: &LiveView) -> String {
    let (live, road) = (view.live.as_ref(), view.road.as_ref());
    let number = |value: Option<f32>, decimals: usize, signed: bool| match value {
        Some(value) if signed => format!("{value:+.decimals$}"),
        Some(value) => format!("{value:.decimals$}"),
        None => UNKNOWN.to_owned(),
    };
    let estimate = live.map(|live| &live.estimate);
    let distance_m = live.map_or(UNKNOWN.to_owned(), |live| {
        format!("{:.1}", live.end.distance_m())
    });
    joined(&[
        format!("{:.1}", view.time_s),
        distance_m,
        number(estimate.map(|e| e.speed_mps), 2, false),
        number(estimate.map(|e| e.grade_percent.value), 3, true),
        number(estimate.map(|e| e.grade_percent.sigma), 3, false),
        view.mode(),
        number(estimate.map(|e| e.bias_percent.value), 3, true),
        number(estimate.map(|e| e.scale.value), 3, false),
        view.cells_finished.to_string(),
        format!("{:.0}", view.frames_per_s()),
        view.lost().to_string(),
        view.events().to_string(),
        number(estimate.map(|e| e.mass_kg.value), 0, false),
        live.map_or(UNKNOWN.to_owned(), |live| {
            u8::from(live.disagreement.is_none()).to_string()
        }),
        road.map_or(UNKNOWN, |road| road.state.word()).to_owned(),
        number(
            road.and_then(|road| road.map_percent).map(|map| map.value),
            3,
            true,
        ),
    ])
}

fn joined(cells: &[String; COLUMNS.len()]) -> String {
    let mut line = String::new();
    for (cell, (_, width)) in cells.iter().zip(COLUMNS) {
        let gap = if line.is_empty() { "" } else { " " };
        let _ = write!(line, "{gap}{cell:>width$}");
    }
    line
}

/// Returns the view as JSON.
#[must_use]
pub fn json(view: &LiveView) -> Value {
    let live = view.live.as_ref();
    json!({
        "time_s": view.time_s,
        "mode": view.mode(),
        "distance_m": live.map(|live| live.end.distance_m()),
        "speed_mps": live.map(|live| live.estimate.speed_mps),
        "grade_percent": live.map(|live| uncertain(live.estimate.grade_percent)),
        "altitude_m": live.and_then(|live| live.estimate.altitude_m).map(uncertain),
        "bias_percent": live.map(|live| uncertain(live.estimate.bias_percent)),
        "scale": live.map(|live| uncertain(live.estimate.scale)),
        "mass_kg": live.map(|live| uncertain(live.estimate.mass_kg)),
        "consistent": live.map(|live| live.disagreement.is_none()),
        "disagreements": live.map(|live| words_of(live.disagreement)),
        "map": view.road.as_ref().map(road_json),
        "memory": view.memory.as_ref().map(memory_json),
        "cells": view.cells_finished,
        "interfaces": view.interfaces,
        "events": counts(view),
    })
}

fn uncertain(value: Uncertain) -> Value {
    json!({ "value": value.value, "sigma": value.sigma })
}

fn road_json(road: &RoadView) -> Value {
    let ahead = road.ahead_percent.iter().enumerate();
    let ahead: Vec<Value> = ahead
        .filter_map(|(index, grade)| {
            let ahead_m = STEP_M * index as f32;
            grade.map(|grade| json!({ "ahead_m": ahead_m, "grade_percent": uncertain(grade) }))
        })
        .collect();
    json!({
        "state": road.state,
        "grade_percent": road.map_percent.map(uncertain),
        "own_grade_percent": road.own_percent.map(uncertain),
        "cells": road.counters.cells_on_map,
        "times_left_out": road.counters.times_left_out,
        "ahead": ahead,
        "forks": road.forks,
    })
}

fn memory_json(memory: &MemoryView) -> Value {
    json!({
        "grade_percent": memory.grade_percent.map(uncertain),
        "known_km": km(memory.counters.cells_fused),
        "new_km": km(memory.counters.cells_new),
    })
}

fn memory_line(memory: &MemoryView) -> String {
    let grade = memory
        .grade_percent
        .map_or("not known here".to_owned(), |grade| {
            format!("{:+.2} % ± {:.2}", grade.value, grade.sigma)
        });
    let (known_km, new_km) = (
        km(memory.counters.cells_fused),
        km(memory.counters.cells_new),
    );
    format!("memory    {grade}   {known_km:.1} km known before, {new_km:.1} km new\n")
}

fn km(cells: u32) -> f32 {
    cells as f32 * CELL_LENGTH_M * 1e-3
}

/// Returns the counters of the core and of this program, by their keys.
fn counts(view: &LiveView) -> Value {
    let mut counts: serde_json::Map<String, Value> = events(&view.counters)
        .into_iter()
        .map(|event| (event.key.to_owned(), event.count.into()))
        .collect();
    for (name, count) in own_counts(view) {
        counts.insert(name.to_owned(), count.into());
    }
    counts.into()
}

fn own_counts(view: &LiveView) -> Vec<(&'static str, u64)> {
    let mut counts = Vec::new();
    if view.untimed > 0 {
        counts.push(("frames without a log time", view.untimed));
    }
    if let Some(unpublished) = view.unpublished.filter(|count| *count > 0) {
        counts.push(("frames not published", unpublished));
    }
    counts
}

/// Returns the panel, several lines of text.
#[must_use]
pub fn panel(view: &LiveView) -> String {
    let mut out = String::new();
    let _ = writeln!(out, "time      {}   {}", clock(view.time_s), view.mode());
    match &view.live {
        None => {
            let _ = writeln!(out, "grade     not available: no speed received yet");
        }
        Some(live) => {
            let e = &live.estimate;
            let (grade, sigma) = (e.grade_percent.value, e.grade_percent.sigma);
            let (distance, speed) = (live.end.distance_m() * 1e-3, e.speed_mps * 3.6);
            let bar = gauge(grade);
            let _ = writeln!(out, "grade     {grade:+7.2} % ± {sigma:.2}   {bar}");
            let altitude = e.altitude_m.map_or("not known".to_owned(), |z| {
                format!("{:.1} m ± {:.1}", z.value, z.sigma)
            });
            let _ = writeln!(out, "place     {distance:.3} km   altitude {altitude}");
            let _ = writeln!(out, "speed     {speed:.1} km/h");
            let (bias, scale) = (e.bias_percent, e.scale);
            let _ = writeln!(
                out,
                "model     bias {:+.2} % ± {:.2}   scale {:.3} ± {:.3}",
                bias.value, bias.sigma, scale.value, scale.sigma
            );
            let mass = e.mass_kg;
            let _ = writeln!(out, "mass      {:.0} kg ± {:.0}", mass.value, mass.sigma);
            let words = words_of(live.disagreement);
            let verdict = if words.is_empty() {
                "consistent".to_owned()
            } else {
                format!("suspect: {}", words.join("; "))
            };
            let _ = writeln!(out, "signals   {verdict}");
        }
    }
    if let Some(road) = &view.road {
        out.push_str(&road_lines(road));
    }
    if let Some(memory) = &view.memory {
        out.push_str(&memory_line(memory));
    }
    let newest = view
        .newest_cell_percent
        .map_or(String::new(), |(grade, sigma)| {
            format!("   newest {grade:+.2} % ± {sigma:.2}")
        });
    let _ = writeln!(out, "cells     {} finished{newest}", view.cells_finished);
    for interface in &view.interfaces {
        let _ = writeln!(out, "{}", of_interface(interface));
    }
    let words: Vec<String> = events(&view.counters)
        .into_iter()
        .map(|event| (event.name, event.count))
        .chain(own_counts(view))
        .map(|(name, count)| format!("{count} {name}"))
        .collect();
    let words = if words.is_empty() {
        "none".to_owned()
    } else {
        words.join(", ")
    };
    let _ = write!(out, "events    {words}");
    out
}

fn of_interface(interface: &InterfaceView) -> String {
    let InterfaceView {
        name,
        frames,
        frames_per_s,
        lost,
        events,
    } = interface;
    let mut line = format!("{name:<9} {frames_per_s:.0} frames/s   {frames} in total, {lost} lost");
    for (event, count) in events {
        let _ = write!(line, ", {count} × {}", event.words());
    }
    line
}

/// Half the width of the gauge, in characters of half a percent each.
const HALF_GAUGE: usize = 16;

/// Returns the grade, from -8 to 8 %, as a bar from the middle of the gauge.
fn gauge(grade_percent: f32) -> String {
    let signs = (grade_percent.abs() * 2.0).round() as usize;
    let filled = signs.min(HALF_GAUGE);
    let (bar, space) = ("=".repeat(filled), " ".repeat(HALF_GAUGE - filled));
    let empty = " ".repeat(HALF_GAUGE);
    if grade_percent < 0.0 {
        format!("[{space}{bar}|{empty}]")
    } else {
        format!("[{empty}|{bar}{space}]")
    }
}

fn clock(seconds: f64) -> String {
    let seconds = seconds as u64;
    let (hours, minutes) = (seconds / 3600, seconds / 60 % 60);
    format!("{hours:02}:{minutes:02}:{:02}", seconds % 60)
}
