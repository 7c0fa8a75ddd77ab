//! The grade ahead, along a whole log.

use super::drive_recorder::Recorder;
use crate::error::{Error, Result};
use crate::numeric::rounding::round;
use crate::source::input::for_each_input;
use crate::source::read_options::ReadOptions;
use estimator_core::roadmap::{Horizon, MapMatch, PackedMap};
use estimator_core::{Instant, Model, Tuning};
use serde::Serialize;
use std::path::Path;

/// Distance between two points ahead, m.
const STEP_M: f32 = 25.0;

/// A row of HORIZON.csv: a place ahead of the vehicle.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct HorizonRow {
    /// Time since the first frame of the log, s.
    pub time_s: f64,
    /// Driven distance, m.
    pub distance_m: f64,
    /// Number of the branch; 0 is the most probable path.
    pub branch: usize,
    /// Probability of the branch.
    pub probability: f64,
    /// Distance from the vehicle, m.
    pub ahead_m: f64,
    /// Grade there, %; empty where the map has none.
    pub grade_percent: Option<f64>,
    /// Its standard deviation, %.
    pub grade_sigma_percent: Option<f64>,
}

/// Passes the grade ahead to `take`, once for each second of a log in which the place on the map is
/// known.
///
/// # Errors
/// Returns an error for invalid parameters, and, with file and line, for a log that cannot be read
/// to its end; also the first error of `take`.
pub fn horizons_of_log(
    model: &Model,
    map: PackedMap<'static>,
    length_m: f32,
    log: &Path,
    options: &ReadOptions,
    progress: impl Fn(u64),
    mut take: impl FnMut(&HorizonRow) -> Result<()>,
) -> Result<()> {
    let mut recorder = Recorder::<f32>::new(model.clone(), Tuning::default())
        .map_err(|e| Error::content(log, e.to_string()))?;
    recorder.read_as(options);
    recorder.follow(map);
    let mut taken = Ok(());
    let (mut start, mut next_s) = (None, 0.0);
    for_each_input(log, options, progress, |input| {
        let start: Instant = *start.get_or_insert(input.time());
        recorder.on_input(&input);
        let Some(live) = recorder.estimator().live() else {
            return;
        };
        let time_s = live.end.time.since(start).as_secs_f64();
        if time_s < next_s {
            return;
        }
        next_s = time_s.floor() + 1.0;
        let Some(MapMatch::On(place)) = recorder.map().map(|map| map.matcher().place()) else {
            return;
        };
        let Ok(horizon) = Horizon::new(map, &place, length_m) else {
            return;
        };
        for (number, branch) in horizon.branches().iter().enumerate() {
            let mut rows = horizon.points(branch, STEP_M).map(|point| HorizonRow {
                time_s: round(time_s, 3),
                distance_m: live.end.distance_m(),
                branch: number,
                probability: round(branch.probability.into(), 4),
                ahead_m: point.ahead_m.into(),
                grade_percent: point.grade_percent.map(|g| round(g.value.into(), 4)),
                grade_sigma_percent: point.grade_percent.map(|g| round(g.sigma.into(), 4)),
            });
            if taken.is_ok() {
                taken = rows.try_for_each(|row| take(&row));
            }
        }
    })?;
    taken
}
