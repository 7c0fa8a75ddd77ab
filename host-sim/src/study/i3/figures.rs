//! The figures of the study.

use super::found::{Found, WINDOWS_M};
use super::trips::Kind;
use crate::report::page::Figure;
use crate::report::plot::{Mark, Plot, Series, colour};

/// The bare model's offset over the temperature, and the longest trip of each season.
pub(super) fn figures(found: &[Found]) -> Vec<Figure> {
    let longest = |is_winter: bool| {
        let of_season = found.iter().filter(|of| of.trip.is_winter() == is_winter);
        of_season.max_by(|a, b| a.trip.length_m.total_cmp(&b.trip.length_m))
    };
    let grades = [false, true].into_iter().filter_map(longest).map(grades);
    std::iter::once(offsets(found)).chain(grades).collect()
}

fn offsets(found: &[Found]) -> Figure {
    let points = |is_fast: bool| {
        let of_kind = found.iter().filter(move |of| of.trip.is_fast == is_fast);
        of_kind
            .filter_map(|of| {
                let bare = of.differences[1][3]?.offset_percent;
                Some((of.trip.ambient_celsius?, bare))
            })
            .collect::<Vec<_>>()
    };
    let plot = Plot::new("ambient temperature (°C)", "bare model less judge (%)")
        .with(Series::line("slow", colour::CYCLE[0], points(false)).drawn(Mark::Dots))
        .with(Series::line("fast", colour::CYCLE[1], points(true)).drawn(Mark::Dots));
    Figure::new(
        "i3_offsets",
        &plot,
        "Mean difference of the bare force model from the accelerometer, a point a trip.",
    )
}

fn grades(of: &Found) -> Figure {
    let windows = &of.windows[1];
    let middle_km = |from_m: f64, to_m: f64| 0.5e-3 * (from_m + to_m);
    let line = |kind: Kind| {
        windows
            .iter()
            .filter_map(|window| {
                let (grade_percent, _) = of.trip.grade(kind, window)?;
                Some((middle_km(window.from_m, window.to_m), grade_percent))
            })
            .collect::<Vec<_>>()
    };
    let judged = windows
        .iter()
        .map(|of| (middle_km(of.from_m, of.to_m), of.grade_percent));
    let plot = Plot::new("distance (km)", "grade (%)")
        .with(
            Series::line("elevation", colour::CYCLE[2], line(Kind::Elevation)).drawn(Mark::Dashed),
        )
        .with(Series::line("accelerometer", colour::BLACK, judged))
        .with(Series::line(
            "smoothed",
            colour::CYCLE[0],
            line(Kind::Smoothed),
        ));
    let name = &of.trip.name;
    Figure::new(
        format!("i3_{name}"),
        &plot,
        format!(
            "{name}: mean grades over {:.0} m, the judge's offset included.",
            WINDOWS_M[1]
        ),
    )
}
