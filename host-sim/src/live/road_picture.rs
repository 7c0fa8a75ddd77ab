//! The road ahead as text: its climb as a skyline, its grades below.

use super::road_view::{RoadState, RoadView, STEP_M};
use estimator_core::Uncertain;
use std::fmt::Write as _;

/// Lines of the skyline, and the characters of one, from empty to full.
const LINES: usize = 4;
const LEVELS: [char; 9] = [' ', '▁', '▂', '▃', '▄', '▅', '▆', '▇', '█'];
/// Climbs less than this do not fill the skyline, m: a flat road looks flat.
const LEAST_RANGE_M: f32 = 10.0;
/// Steps of the road between two numbers of the scale.
const STEPS_A_NUMBER: usize = 10;
/// Width of the names of lines.
const INDENT: usize = 10;

/// Returns the lines of the panel for the map.
#[must_use]
pub fn road_lines(road: &RoadView) -> String {
    let mut out = String::new();
    let known = |name: &str, grade: Option<Uncertain>| {
        grade.map_or(String::new(), |grade| {
            format!("   {name} {:+.2} % ± {:.2}", grade.value, grade.sigma)
        })
    };
    let words = match road.state {
        RoadState::On => "on the map",
        RoadState::LeftOut => "left out: it differs from the estimate",
        RoadState::Unclear => "place not clear",
        RoadState::Off => "not on the map",
    };
    let (map, own) = (
        known("map", road.map_percent),
        known("without", road.own_percent),
    );
    let _ = writeln!(out, "map       {words}{map}{own}");
    if let Some(climbs) = climbs_m(&road.ahead_percent) {
        skyline(&mut out, &climbs);
        scale(&mut out, &road.ahead_percent);
    }
    for fork in &road.forks {
        let (from_m, percent) = (fork.from_m, 100.0 * fork.probability);
        let _ = writeln!(out, "fork      in {from_m:.0} m, taken with {percent:.0} %");
    }
    out
}

/// Returns the climb from the vehicle to the end of each step, m; `None` if no step has a grade.
fn climbs_m(ahead_percent: &[Option<Uncertain>]) -> Option<Vec<Option<f32>>> {
    let mut climb_m = 0.0;
    let mut climbs = Vec::new();
    for pair in ahead_percent.windows(2) {
        let both = pair[0].zip(pair[1]);
        climbs.push(both.map(|(a, b)| {
            climb_m += 0.005 * (a.value + b.value) * STEP_M;
            climb_m
        }));
    }
    climbs.iter().any(Option::is_some).then_some(climbs)
}

/// Appends the skyline. Steps without a grade stay empty.
fn skyline(out: &mut String, climbs: &[Option<f32>]) {
    let known = climbs.iter().flatten().copied().chain([0.0]);
    let (low, high) = known.fold((0.0_f32, 0.0_f32), |(low, high), climb| {
        (low.min(climb), high.max(climb))
    });
    let range_m = (high - low).max(LEAST_RANGE_M);
    let levels = LINES * (LEVELS.len() - 1);
    let filled = |climb: f32| {
        // The lowest place has a level, so that it is told from one that is not known.
        let level = 1.0 + (climb - low) / range_m * (levels - 1) as f32;
        level.round() as usize
    };
    for line in (0..LINES).rev() {
        let label = match line {
            0 => format!("{low:+.0} m"),
            _ if line + 1 == LINES => format!("{:+.0} m", low + range_m),
            _ => String::new(),
        };
        let name = if line + 1 == LINES { "ahead" } else { "" };
        let _ = write!(out, "{name:<5}{label:>7} ");
        for climb in climbs {
            let above = climb.map_or(0, |climb| {
                filled(climb).saturating_sub(line * (LEVELS.len() - 1))
            });
            out.push(LEVELS[above.min(LEVELS.len() - 1)]);
        }
        out.push('\n');
    }
}

/// Appends the distances and the mean grades between them.
fn scale(out: &mut String, ahead_percent: &[Option<Uncertain>]) {
    let (mut distances, mut grades) = (String::new(), String::new());
    for (index, part) in ahead_percent.chunks(STEPS_A_NUMBER).enumerate() {
        let from_m = STEP_M * (index * STEPS_A_NUMBER) as f32;
        let _ = write!(distances, "{:<STEPS_A_NUMBER$}", format!("{from_m:.0} m"));
        let known: Vec<f32> = part.iter().flatten().map(|grade| grade.value).collect();
        if part.len() < STEPS_A_NUMBER {
            continue;
        }
        let mean = known.iter().sum::<f32>() / known.len() as f32;
        let mean = if known.is_empty() {
            "-".to_owned()
        } else {
            format!("{mean:+.1} %")
        };
        let _ = write!(grades, "{mean:<STEPS_A_NUMBER$}");
    }
    for line in [distances, grades] {
        let _ = writeln!(
            out,
            "{:indent$}{}",
            "",
            line.trim_end(),
            indent = INDENT + 3
        );
    }
}
