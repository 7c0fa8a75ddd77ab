//! A log as input of the diagnosis: the core's samples, and the place of each cell.

use super::collector::Collector;
use crate::error::{Error, Result};
use crate::inertial_judge::InertialProfile;
use crate::map::{
    MatchedPlace, Network, RoadLine, RoadPoint, match_track, road_of_run, track_of_run,
};
use crate::recorder::{Recorder, SmoothedRun};
use crate::source::input::{LogInput, for_each_input};
use crate::source::log_report::LogReport;
use crate::source::read_options::ReadOptions;
use estimator_core::sample::Sample;
use estimator_core::{Model, Signal, Tuning};
use std::path::Path;

/// One log, read with a vehicle.
#[derive(Debug)]
pub struct LoggedDrive {
    /// The core's samples, one for each row of the run.
    pub samples: Vec<Sample>,
    /// The estimate.
    pub run: SmoothedRun,
    /// What the reading of the log told.
    pub log: LogReport,
    /// Speed and accelerometer, if they were asked for and the log has both. The estimate does not
    /// see the accelerometer then.
    pub accelerometer: Option<InertialProfile>,
}

impl LoggedDrive {
    /// Reads a log.
    ///
    /// # Errors
    /// Returns an error, with file and line, if the log cannot be read; if the vehicle is
    /// impossible; or if the log has no movement.
    pub fn read(
        path: &Path,
        model: &Model,
        tuning: &Tuning,
        options: &ReadOptions,
    ) -> Result<Self> {
        Self::read_beside(path, model, tuning, options, None)
    }

    /// Reads a log with its accelerometer beside the estimate.
    ///
    /// # Errors
    /// Returns the errors of [`read`](Self::read).
    pub fn read_with_accelerometer(
        path: &Path,
        model: &Model,
        tuning: &Tuning,
        options: &ReadOptions,
    ) -> Result<Self> {
        Self::read_beside(path, model, tuning, options, Some(Collector::default()))
    }

    fn read_beside(
        path: &Path,
        model: &Model,
        tuning: &Tuning,
        options: &ReadOptions,
        mut collector: Option<Collector>,
    ) -> Result<Self> {
        let mut recorder = Recorder::<f32>::new(model.clone(), tuning.clone())
            .map_err(|e| Error::content(path, e.to_string()))?;
        recorder.read_as(options);
        if collector.is_some() {
            recorder.ignore(&[Signal::LongitudinalAcceleration]);
        }
        let take = |input: LogInput| {
            if let Some(collector) = &mut collector {
                collector.on_input(&input);
            }
            recorder.on_input(&input);
        };
        let log = for_each_input(path, options, |_| (), take)?;
        let (run, samples) = recorder.finish_with_samples()?;
        if run.rows.is_empty() {
            return Err(Error::content(
                path,
                "the vehicle does not move in it; expected a drive".to_owned(),
            ));
        }
        Ok(Self {
            samples,
            run,
            log,
            accelerometer: collector.and_then(Collector::profile),
        })
    }
}

/// Place of a cell on a common road, and its direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RoadPlace {
    /// Distance along the road, m.
    pub at_m: f64,
    /// Whether the cell is driven in the road's direction.
    pub forward: bool,
}

/// A road that is driven in both directions.
#[derive(Debug)]
pub struct CommonRoad {
    ways: [Network; 2],
    end_m: f64,
}

impl CommonRoad {
    /// Creates the road of the longest of these drives; `None` if none has positions.
    #[must_use]
    pub fn of(drives: &[LoggedDrive]) -> Option<Self> {
        let longest = drives.iter().max_by_key(|drive| drive.run.rows.len())?;
        Self::through(road_of_run(&longest.run.rows)?)
    }

    /// Creates the road through these points; `None` if they make none.
    #[must_use]
    pub fn through(points: Vec<RoadPoint>) -> Option<Self> {
        let end_m = points.last()?.distance_m;
        let back = points.iter().rev().map(|point| RoadPoint {
            distance_m: end_m - point.distance_m,
            ..*point
        });
        let back = RoadLine::new(back.collect()).ok()?.into();
        let ways = [RoadLine::new(points).ok()?.into(), back];
        Some(Self { ways, end_m })
    }

    /// Returns its length, m.
    #[must_use]
    pub const fn length_m(&self) -> f64 {
        self.end_m
    }

    /// Returns latitude and longitude (deg) at a distance (m).
    #[must_use]
    pub fn position_at(&self, at_m: f64) -> (f64, f64) {
        self.ways[0].ways()[0].line.position_at(at_m)
    }

    /// Returns the place of each sample of a drive.
    #[must_use]
    pub fn places(&self, drive: &LoggedDrive) -> Vec<Option<RoadPlace>> {
        let track = track_of_run(&drive.run.rows);
        let [there, back] = [&self.ways[0], &self.ways[1]].map(|way| match_track(way, &track));
        there
            .iter()
            .zip(&back)
            .map(|(there, back)| match (there, back) {
                (
                    MatchedPlace::OnRoad {
                        distance_m: at_m, ..
                    },
                    _,
                ) => Some(RoadPlace {
                    at_m: *at_m,
                    forward: true,
                }),
                (
                    _,
                    MatchedPlace::OnRoad {
                        distance_m: at_m, ..
                    },
                ) => Some(RoadPlace {
                    at_m: self.end_m - at_m,
                    forward: false,
                }),
                _ => None,
            })
            .collect()
    }
}
