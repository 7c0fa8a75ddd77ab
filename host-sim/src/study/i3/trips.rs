//! The trips of the data folder, estimated without their accelerometer.

use super::bare;
use super::means::{RunSums, grade_of_climb};
use crate::error::{Error, Result};
use crate::files::run::RunRow;
use crate::inertial_judge::{InertialProfile, Window, windows_of};
use crate::recorder::estimate_log;
use crate::score::END_CUT_M;
use crate::source::i3::{Trip, TripRow};
use crate::source::read_options::ReadOptions;
use estimator_core::{Model, Signal, Tuning};
use std::fs;
use std::path::{Path, PathBuf};

/// Below this mean ambient temperature, °C, a trip counts as one in winter.
const WINTER_CELSIUS: f64 = 12.0;
/// A trip is fast if this part of its way ...
const FAST_PART: f64 = 0.45;
/// ... is above this speed, m/s: a motorway.
const FAST_MPS: f64 = 80.0 / 3.6;

/// What is compared with the judge.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Smoothed,
    Lagged,
    Live,
    Bare,
    Elevation,
}

impl Kind {
    /// The first of [`Self::ALL`]: what the estimator says, with a sigma.
    pub(super) const ESTIMATES: [Self; 3] = [Self::Smoothed, Self::Lagged, Self::Live];

    pub(super) const ALL: [Self; 5] = [
        Self::Smoothed,
        Self::Lagged,
        Self::Live,
        Self::Bare,
        Self::Elevation,
    ];

    pub(super) const fn word(self) -> &'static str {
        match self {
            Self::Smoothed => "smoothed",
            Self::Lagged => "lagged",
            Self::Live => "live",
            Self::Bare => "bare model",
            Self::Elevation => "elevation",
        }
    }
}

/// A trip with what judges and what is judged.
#[derive(Clone, Debug)]
pub(super) struct JudgedTrip {
    pub(super) name: String,
    pub(super) ambient_celsius: Option<f64>,
    pub(super) length_m: f64,
    pub(super) is_fast: bool,
    pub(super) profile: InertialProfile,
    /// Measured elevations over time.
    pub(super) elevations: Vec<(f64, f64)>,
    bare: Vec<(f64, f64)>,
    /// With published parameters.
    pub(super) published: Estimates,
    /// With the effects that were found.
    pub(super) with_effects: Estimates,
}

/// What the estimator says of a trip without its accelerometer.
#[derive(Clone, Debug)]
pub(super) struct Estimates {
    /// Of each of [`Kind::ESTIMATES`].
    runs: [RunSums; Kind::ESTIMATES.len()],
    /// Mean bias of the vehicle model, smoothed, %.
    pub(super) bias_percent: f64,
}

impl Estimates {
    fn new(run: &[RunRow]) -> Self {
        let cells = run.len().max(1) as f64;
        Self {
            runs: [
                RunSums::new(run, |row| (row.grade_percent, row.grade_sigma_percent)),
                RunSums::new(run, |row| {
                    (row.lagged_grade_percent, row.lagged_grade_sigma_percent)
                }),
                RunSums::new(run, |row| {
                    (row.live_grade_percent, row.live_grade_sigma_percent)
                }),
            ],
            bias_percent: run.iter().map(|row| row.bias_percent).sum::<f64>() / cells,
        }
    }

    /// Returns mean grade and mean sigma in a window, %, of one of [`Kind::ESTIMATES`].
    pub(super) fn grade(&self, at: usize, window: &Window) -> Option<(f64, f64)> {
        self.runs[at].mean(window.from_s, window.to_s)
    }
}

impl JudgedTrip {
    pub(super) fn is_winter(&self) -> bool {
        self.ambient_celsius
            .is_some_and(|celsius| celsius < WINTER_CELSIUS)
    }

    /// Returns the judge's windows, without the first and last 500 m.
    pub(super) fn windows(&self, window_m: f64) -> Vec<Window> {
        let end_m = self.profile.points().last().map_or(0.0, |p| p.distance_m);
        let mut windows = windows_of(&self.profile, window_m);
        windows.retain(|of| of.from_m >= END_CUT_M && of.to_m <= end_m - END_CUT_M);
        windows
    }

    /// Returns the mean grade of a window and its sigma, %; the sigma is 0 where none is told.
    pub(super) fn grade(&self, kind: Kind, window: &Window) -> Option<(f64, f64)> {
        let times = (window.from_s, window.to_s);
        let length_m = window.to_m - window.from_m;
        match kind {
            Kind::Smoothed => self.published.grade(0, window),
            Kind::Lagged => self.published.grade(1, window),
            Kind::Live => self.published.grade(2, window),
            Kind::Bare => Some((grade_of_climb(&self.bare, times, length_m)?, 0.0)),
            Kind::Elevation => Some((grade_of_climb(&self.elevations, times, length_m)?, 0.0)),
        }
    }
}

/// Returns the files of the data folder, by name.
pub(super) fn files(data: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(data.join("i3")).into_iter().flatten();
    let mut files: Vec<PathBuf> = entries
        .filter_map(|entry| Some(entry.ok()?.path()))
        .collect();
    files.retain(|path| {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        name.starts_with("Trip") && (name.ends_with(".csv") || name.ends_with(".csv.gz"))
    });
    files.sort();
    files
}

/// Reads a trip, and estimates its grade as a user would, without the accelerometer: with the published
/// model, and with that of the effects. Returns `None` for a trip that has no accelerometer.
pub(super) fn judged(
    file: &Path,
    published: &Model,
    with_effects: &Model,
) -> Result<Option<JudgedTrip>> {
    let trip = Trip::read(file)?;
    let rows = trip.rows();
    if rows.iter().all(|row| row.acceleration_mps2.is_none()) {
        return Ok(None);
    }
    Ok(Some(JudgedTrip {
        name: trip.name().to_owned(),
        ambient_celsius: trip.ambient_celsius(),
        length_m: trip.length_m(),
        is_fast: fast_part(rows) > FAST_PART,
        profile: profile(rows),
        elevations: elevations(rows),
        bare: bare::climbs(rows, &published.vehicle),
        published: estimated(&trip, published)?,
        with_effects: estimated(&trip, with_effects)?,
    }))
}

fn estimated(trip: &Trip, model: &Model) -> Result<Estimates> {
    let folder = tempfile::tempdir().map_err(Error::io(Path::new("temporary folder")))?;
    let table = folder.path().join("trip.csv");
    trip.write(&table)?;
    let options = ReadOptions {
        ignore: vec![Signal::LongitudinalAcceleration],
        ..ReadOptions::default()
    };
    let run = estimate_log::<f32>(model, &Tuning::default(), None, &table, &options, |_| ())?;
    Ok(Estimates::new(&run.in_memory()?.rows))
}

fn profile(rows: &[TripRow]) -> InertialProfile {
    let column = |of: fn(&TripRow) -> Option<f64>| -> Vec<f64> {
        rows.iter().map(|row| of(row).unwrap_or(f64::NAN)).collect()
    };
    InertialProfile::new(
        &column(|row| Some(row.time_s)),
        &column(|row| row.speed_mps),
        &column(|row| row.acceleration_mps2),
    )
}

fn elevations(rows: &[TripRow]) -> Vec<(f64, f64)> {
    rows.iter()
        .filter_map(|row| Some((row.time_s, row.altitude_m?)))
        .collect()
}

fn fast_part(rows: &[TripRow]) -> f64 {
    let speeds = || rows.iter().filter_map(|row| row.speed_mps);
    let fast: f64 = speeds().filter(|mps| *mps > FAST_MPS).sum();
    fast / speeds().sum::<f64>()
}
