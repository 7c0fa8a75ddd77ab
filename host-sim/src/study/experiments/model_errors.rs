//! Errors of the vehicle model (section 7, figures 12-14).

use super::campaign::Campaign;
use super::experiment::Experiment;
use super::heading::Heading;
use super::measure::inner;
use super::replica::Replica;
use crate::comparison::original::{self, NoiseSigmas};
use crate::comparison::{STEP_M, pointwise};
use crate::error::Result;
use crate::numeric::robust_line::{RobustLine, fit};
use crate::numeric::statistics::mean;
use crate::report::page::{Figure, Section, Table};
use crate::report::plot::{Mark, Plot, Series, colour};
use crate::study::definition::{Setting, Study, StudyOutcome};

/// Points of a segment: 1250 m.
const SEGMENT: usize = 500;
/// Length of the low-pass filter on speed in figure 12, m. Without it only noise is visible.
const LOW_PASS_M: f64 = 100.0;

/// The study, for the list.
pub const STUDY: Study = Study {
    name: "model_errors",
    about: "thesis figures 12-14: warm-up, bias over segments, error that goes with the grade",
    run,
};

/// Means over one segment.
#[derive(Clone, Copy, Debug)]
struct SegmentMeans {
    middle_km: f64,
    true_grade: f64,
    found_grade: f64,
    true_error: f64,
    found_error: f64,
}

/// A run's segments with the lines through them.
struct Segments {
    experiment: Experiment,
    all: Vec<SegmentMeans>,
    found_drift: Option<RobustLine>,
    true_drift: Option<RobustLine>,
    found_slope: Option<RobustLine>,
    true_slope: Option<RobustLine>,
}

fn run(setting: &Setting) -> Result<StudyOutcome> {
    let runs = Campaign::new(setting.seed).replicas();
    let each: Vec<Segments> = runs.iter().map(segments).collect();
    let is = |e: Experiment, heading, number| (e.heading, e.number) == (heading, number);
    let mut figures = Vec::new();
    for (run, segments) in runs.iter().zip(&each) {
        if is(run.experiment, Heading::South, 4) {
            figures.extend(warm_up(run));
            figures.push(bias_figure(segments));
        }
        if is(run.experiment, Heading::North, 1) {
            figures.push(slope_figure(segments));
        }
    }
    Ok(StudyOutcome::Done(Section {
        heading: "Errors of the vehicle model (thesis 7)".to_owned(),
        words: vec![
            "The mean errors of table 4 are with the pointwise grade. Over segments of 1250 m, \
             the vehicle model's error is estimated without a reference, as pointwise grade less \
             a GPS-heavy estimate, and compared with the true one. Points with shifts or braking \
             are left out of the means. The replicas have a torque error of 5 % in A and none in \
             B. The rest of the true slopes is chance, from wind and warm-up that are correlated \
             with the grade."
                .to_owned(),
        ],
        tables: vec![table(&each)],
        figures,
        ..Section::default()
    }))
}

fn segments(run: &Replica) -> Segments {
    let grade = pointwise::grade_percent(&run.drive);
    let gps_heavy = original::estimate(&run.drive, &NoiseSigmas::GPS_HEAVY).grade_percent;
    let all: Vec<SegmentMeans> = (0..run.truth.len() / SEGMENT)
        .filter_map(|segment| {
            let cells = segment * SEGMENT..(segment + 1) * SEGMENT;
            let valid: Vec<usize> = cells
                .filter(|k| inner(run).contains(k) && run.drive.points[*k].is_valid())
                .collect();
            if valid.is_empty() {
                return None;
            }
            let over = |values: &[f64]| mean(&valid.iter().map(|&k| values[k]).collect::<Vec<_>>());
            let (true_grade, found_grade) = (over(&run.truth), over(&gps_heavy));
            let model = over(&grade);
            Some(SegmentMeans {
                middle_km: (segment as f64 + 0.5) * SEGMENT as f64 * STEP_M * 1e-3,
                true_grade,
                found_grade,
                true_error: model - true_grade,
                found_error: model - found_grade,
            })
        })
        .collect();
    let line = |x: fn(&SegmentMeans) -> f64, y: fn(&SegmentMeans) -> f64| {
        fit(all.iter().map(|s| (x(s), y(s))))
    };
    Segments {
        experiment: run.experiment,
        found_drift: line(|s| s.middle_km, |s| s.found_error),
        true_drift: line(|s| s.middle_km, |s| s.true_error),
        found_slope: line(|s| s.found_grade, |s| s.found_error),
        true_slope: line(|s| s.true_grade, |s| s.true_error),
        all,
    }
}

fn table(each: &[Segments]) -> Table {
    let header = [
        "run",
        "drift found %/10 km",
        "true",
        "error over grade found",
        "± 2σ",
        "true",
        "planted",
    ];
    let caption = "Lines through segments of 1250 m: error against distance, and against grade.";
    Table::new("model_errors", caption, &header).with_rows(each.iter().map(|segments| {
        let text = |line: Option<RobustLine>, of: fn(&RobustLine) -> f64| {
            line.map_or("-".to_owned(), |line| format!("{:+.3}", of(&line)))
        };
        vec![
            format!(
                "{} {}",
                segments.experiment.heading.word(),
                segments.experiment.number
            ),
            text(segments.found_drift, |line| 10.0 * line.slope),
            text(segments.true_drift, |line| 10.0 * line.slope),
            text(segments.found_slope, |line| line.slope),
            text(segments.found_slope, |line| 2.0 * line.slope_sigma),
            text(segments.true_slope, |line| line.slope),
            format!("{:+.3}", segments.experiment.belief().torque - 1.0),
        ]
    }))
}

/// Plots figure 12.
fn warm_up(run: &Replica) -> Vec<Figure> {
    let smooth = pointwise::with_smooth_speed(&run.drive, LOW_PASS_M);
    [
        (
            "fig12_top",
            pointwise::grade_percent(&smooth),
            "Figure 12, top: error of the vehicle model alone, southbound 4, speed averaged over \
             100 m. It drifts down as the tyres warm up. Near braking, the averaged speed is \
             wrong.",
        ),
        (
            "fig12_bottom",
            original::estimate(&run.drive, &NoiseSigmas::ORIGINAL).grade_percent,
            "Figure 12, bottom: error of the original estimation on the same run.",
        ),
    ]
    .into_iter()
    .map(|(name, grade, caption)| {
        let points = inner(run)
            .filter(|&k| run.drive.points[k].is_valid())
            .map(|k| (k as f64 * STEP_M * 1e-3, grade[k] - run.truth[k]));
        let mut plot = Plot::new("distance (km)", "grade error (%)").with(Series::line(
            "",
            colour::BLUE,
            points,
        ));
        plot.y_range = Some((-1.5, 1.5));
        plot.height = 240;
        Figure::new(name, &plot, caption)
    })
    .collect()
}

/// Plots figure 13.
fn bias_figure(segments: &Segments) -> Figure {
    let dots = |y: fn(&SegmentMeans) -> f64| segments.all.iter().map(move |s| (s.middle_km, y(s)));
    let ends = ends(&segments.all, |s| s.middle_km);
    let mut plot = Plot::new("distance (km)", "grade error (%)")
        .with(Series::line("found", colour::BLUE, dots(|s| s.found_error)).drawn(Mark::Dots))
        .with(Series::line("true", colour::ORANGE, dots(|s| s.true_error)).drawn(Mark::Dots));
    plot = with_line(
        plot,
        "line found",
        colour::BLUE,
        segments.found_drift,
        ends,
        Mark::Line,
    );
    plot = with_line(
        plot,
        "true line",
        colour::ORANGE,
        segments.true_drift,
        ends,
        Mark::Dashed,
    );
    Figure::new(
        "fig13",
        &plot,
        "Figure 13: error of the vehicle model over segments of 1250 m, southbound 4, against the \
         GPS-heavy estimate and against the truth. The two differ at the large GPS error at 25 km.",
    )
}

/// Plots figure 14.
fn slope_figure(segments: &Segments) -> Figure {
    let found = segments.all.iter().map(|s| (s.found_grade, s.found_error));
    let truth = segments.all.iter().map(|s| (s.true_grade, s.true_error));
    let ends = ends(&segments.all, |s| s.true_grade);
    let mut plot = Plot::new("mean grade of the segment (%)", "grade error (%)")
        .with(Series::line("found", colour::BLUE, found).drawn(Mark::Dots))
        .with(Series::line("true", colour::ORANGE, truth).drawn(Mark::Dots));
    plot = with_line(
        plot,
        "robust line k",
        colour::BLUE,
        segments.found_slope,
        ends,
        Mark::Line,
    );
    plot = with_line(
        plot,
        "true line",
        colour::ORANGE,
        segments.true_slope,
        ends,
        Mark::Dashed,
    );
    for (name, sign) in [("k ± 2σ", 1.0), ("", -1.0)] {
        // Turned about the segments' mean, where the line has its smallest variance.
        let turned = segments.found_slope.map(|line| {
            let grades: Vec<f64> = segments.all.iter().map(|s| s.found_grade).collect();
            let turn = 2.0 * sign * line.slope_sigma;
            RobustLine {
                slope: line.slope + turn,
                offset: line.offset - turn * mean(&grades),
                ..line
            }
        });
        plot = with_line(plot, name, colour::GREEN, turned, ends, Mark::Dashed);
    }
    Figure::new(
        "fig14",
        &plot,
        "Figure 14: error of the vehicle model against grade over segments of 1250 m, northbound 1 \
         (truck A). The mass is corrected only if zero is outside k ± 2σ.",
    )
}

fn ends(segments: &[SegmentMeans], x: fn(&SegmentMeans) -> f64) -> (f64, f64) {
    let all = segments.iter().map(x);
    all.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| {
        (low.min(x), high.max(x))
    })
}

fn with_line(
    plot: Plot,
    name: &str,
    colour: plotters::style::RGBColor,
    line: Option<RobustLine>,
    ends: (f64, f64),
    mark: Mark,
) -> Plot {
    match line {
        Some(line) => {
            let points = [ends.0, ends.1].map(|x| (x, line.at(x)));
            plot.with(Series::line(name, colour, points).drawn(mark))
        }
        None => plot,
    }
}
