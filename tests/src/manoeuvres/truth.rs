//! What was true of a drive, and its frames.

use super::signals::Edit;
use crate::faults::{Frames, Window, seconds};
use estimator_core::Instant;
use host_sim::error::Result;
use host_sim::files::vehicle::VehicleFile;
use host_sim::numeric::series::linear;
use host_sim::simulator::Recording;
use host_sim::simulator::road::Road;
use host_sim::simulator::scenario::Scenario;
use host_sim::source::can_frame::TimedFrame;
use std::ops::Range;
use test_kit::simulated::without_sessions;

/// Time between two moments of the truth, s.
const MOMENT_S: f64 = 0.1;
/// Time that a fault of unlimited length lasts, s.
const FOR_EVER_S: f64 = 1e6;

/// When something is wrong. Distances are places, m from the start of the drive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum When {
    /// All the time.
    Always,
    /// Between two places.
    Way(f64, f64),
    /// For some seconds from a place on.
    Seconds(f64, f64),
    /// While the vehicle stands or reverses at its stop of this number.
    Stop(usize),
}

/// What is true at one time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moment {
    /// Time since the first frame, s.
    pub time_s: f64,
    /// Place on the road, m from the start of the drive.
    pub place_m: f64,
    /// Distance driven forwards, m from the start of the drive.
    pub driven_m: f64,
    /// Grade in the forward direction, %.
    pub grade_percent: f64,
    /// True at standstill.
    pub stands: bool,
    /// True while the vehicle moves backwards.
    pub reverses: bool,
}

/// A simulated drive.
#[derive(Debug)]
pub struct Driven {
    /// The vehicle file.
    pub vehicle: VehicleFile,
    /// Start of the drive on the road, m.
    pub start_m: f64,
    /// The road.
    pub road: Road,
    first: Instant,
    frames: Vec<TimedFrame>,
    /// The truth, in order of time.
    pub moments: Vec<Moment>,
    /// Gross mass at the start and at the end, kg.
    pub masses_kg: [f64; 2],
}

impl Driven {
    /// Simulates the first run of a scenario.
    ///
    /// # Errors
    /// Returns an error if the truck gets stuck.
    pub fn simulated(scenario: &Scenario) -> Result<Self> {
        let run = &scenario.runs[0];
        let recording = Recording::new(scenario, 0)?;
        let frames = without_sessions(recording.frames().collect());
        let first = frames.first().map_or(Instant::ZERO, |timed| timed.time);
        let first_s = first.micros() as f64 * 1e-6 - run.start_time_s;
        let drive = recording.drive();
        let start_m = run.start_distance_m;
        let count = ((drive.duration_s() - first_s) / MOMENT_S) as usize + 1;
        let moments = (0..count)
            .map(|index| {
                let time_s = index as f64 * MOMENT_S;
                let state = drive.at(first_s + time_s);
                Moment {
                    time_s,
                    place_m: state.distance_m - start_m,
                    driven_m: state.driven_m() - start_m,
                    grade_percent: 100.0 * drive.road.grade(state.distance_m),
                    stands: state.speed_mps == 0.0,
                    reverses: state.is_reversing(),
                }
            })
            .collect();
        Ok(Self {
            vehicle: run.vehicle.clone(),
            start_m,
            road: scenario.road.clone(),
            first,
            frames,
            moments,
            masses_kg: [
                run.truck.mass_kg,
                run.stops
                    .iter()
                    .rev()
                    .find_map(|stop| stop.mass_kg)
                    .unwrap_or(run.truck.mass_kg),
            ],
        })
    }

    /// Returns the frames as the estimator receives them.
    #[must_use]
    pub fn received(&self, edits: &[(When, Edit)]) -> Frames<'_> {
        let mut frames: Frames<'_> = Box::new(self.frames.iter().copied());
        for (when, edit) in edits {
            let Range { start, end } = self.times_s(*when);
            let at = |since_s: f64| self.first + seconds(since_s);
            let window: Window = at(start)..at(end);
            frames = edit.applied(frames, window);
        }
        frames
    }

    /// Returns from when to when something is wrong, s from the first frame on.
    #[must_use]
    pub fn times_s(&self, when: When) -> Range<f64> {
        match when {
            When::Always => 0.0..FOR_EVER_S,
            When::Way(from_m, to_m) => self.passed_s(from_m)..self.passed_s(to_m),
            When::Seconds(from_m, for_s) => {
                let from_s = self.passed_s(from_m);
                from_s..from_s + for_s
            }
            When::Stop(number) => self.stop_s(number),
        }
    }

    /// Returns when a place is passed first, s; never is far in the future.
    fn passed_s(&self, place_m: f64) -> f64 {
        let mut moments = self.moments.iter();
        moments
            .find(|moment| moment.place_m >= place_m)
            .map_or(FOR_EVER_S, |moment| moment.time_s)
    }

    /// Returns the time of a stop, from standstill until the vehicle drives on, s.
    fn stop_s(&self, number: usize) -> Range<f64> {
        let still = |moment: &Moment| moment.stands || moment.reverses;
        let mut stops = self
            .moments
            .chunk_by(|a, b| still(a) == still(b))
            .filter(|part| still(&part[0]));
        stops
            .nth(number)
            .and_then(|part| Some(part.first()?.time_s..part.last()?.time_s))
            .unwrap_or(FOR_EVER_S..FOR_EVER_S)
    }

    /// Returns what is true at a time; `None` beyond the drive.
    #[must_use]
    pub fn at(&self, time_s: f64) -> Option<Moment> {
        let index = (time_s / MOMENT_S) as usize;
        let (from, to) = (self.moments.get(index)?, self.moments.get(index + 1)?);
        let pair = |of: fn(&Moment) -> f64| [(from.time_s, of(from)), (to.time_s, of(to))];
        let between = |of| linear(&pair(of), time_s.clamp(from.time_s, to.time_s));
        Some(Moment {
            time_s,
            place_m: between(|m| m.place_m)?,
            driven_m: between(|m| m.driven_m)?,
            grade_percent: between(|m| m.grade_percent)?,
            ..*from
        })
    }
}
