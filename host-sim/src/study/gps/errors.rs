//! Series of altitude errors to train the chain on, one value every 2.5 m.

use crate::comparison::STEP_M;
use crate::error::{Error, Result};
use crate::map::{MatchedPlace, Network, RoadLine, RoadPoint, TrackPoint, match_track};
use crate::numeric::series::linear;
use crate::simulator::random::{OrnsteinUhlenbeck, Purpose, stream};
use crate::simulator::sensor_file::GnssErrors;
use crate::source::ztbus::{Mission, MissionRow, PassDirection};
use crate::study::windows::forward;
use crate::study::ztbus::mission_file;
use std::ops::Range;
use std::path::Path;

/// Speed that converts time of simulated errors to distance, m/s: the thesis's 80 km/h.
pub const SPEED_MPS: f64 = 80.0 / 3.6;
/// Length of a simulated series, m.
const LENGTH_M: f64 = 40_000.0;
/// Number of simulated series, as many as the thesis has drives.
const RUNS: usize = 10;
/// Smallest distance between vertices of a road made from raw fixes, m; larger than their noise.
const VERTEX_M: f64 = 10.0;

/// Returns the errors of this project's own simulator, resampled at [`SPEED_MPS`]. The receiver's
/// white noise is left out: interpolation between fixes a second apart would correlate it.
#[must_use]
pub fn simulated(seed: u64) -> Vec<Vec<f64>> {
    let errors = GnssErrors::default();
    (0..RUNS)
        .map(|run| {
            let mut rng = stream(seed, run, Purpose::Gnss);
            let mut slow =
                OrnsteinUhlenbeck::new(errors.altitude_sigma_m, errors.altitude_time_s, &mut rng);
            (0..(LENGTH_M / STEP_M) as usize)
                .map(|_| slow.advance(STEP_M / SPEED_MPS, &mut rng))
                .collect()
        })
        .collect()
}

/// Returns [`measured`] of the first mission in the data folder; `None` if there is none.
///
/// # Errors
/// Returns the errors of [`measured`].
pub fn of_data(data: &Path) -> Result<Option<Vec<Vec<f64>>>> {
    mission_file(data).as_deref().map(measured).transpose()
}

/// Returns the errors of a measured mission, converted to distance at [`SPEED_MPS`]. An error is a
/// pass's raw altitude less the mean over the passes in its direction at the same place.
///
/// The conversion is by time, not by the bus's own distance. Atmosphere, multipath and the
/// receiver's filter change with time; at a bus's 5 m/s the same error would change five times as
/// fast for a truck. Errors while the bus stands are included.
///
/// The mean of N passes holds a part 1/N of each pass's own error. The differences are therefore
/// too small by √(1 - 1/N), and are scaled back.
///
/// # Errors
/// Returns an error if the mission cannot be read or its passes have no common road.
pub fn measured(mission_file: &Path) -> Result<Vec<Vec<f64>>> {
    let mission = Mission::read(mission_file)?;
    let passes = mission.passes();
    let mut series = Vec::new();
    for direction in [PassDirection::Outbound, PassDirection::Inbound] {
        let tracks: Vec<Vec<AltitudeFix>> = passes
            .iter()
            .filter(|pass| pass.direction == direction)
            .map(|pass| fixes(&mission, pass.rows.clone()))
            .collect();
        if tracks.len() < 2 {
            continue;
        }
        let road = RoadLine::new(vertices(&tracks[0]))
            .map(Network::from)
            .map_err(|problem| Error::content(mission_file, problem.to_string()))?;
        let placed: Vec<Vec<MatchedFix>> = tracks.iter().map(|track| place(&road, track)).collect();
        series.extend(deviations(&placed));
    }
    if series.is_empty() {
        return Err(Error::content(
            mission_file,
            "no two passes in one direction on a common road; expected a mission of several \
             round trips",
        ));
    }
    Ok(series)
}

/// One row with position and altitude.
struct AltitudeFix {
    time_s: f64,
    track: TrackPoint,
    altitude_m: f64,
}

/// A fix on the road.
struct MatchedFix {
    time_s: f64,
    distance_m: f64,
    altitude_m: f64,
}

fn fixes(mission: &Mission, rows: Range<usize>) -> Vec<AltitudeFix> {
    let odometer_m = &mission.odometer_m()[rows.clone()];
    let fix = |(row, &odometer_m): (&MissionRow, &f64)| {
        Some(AltitudeFix {
            time_s: row.time_s,
            track: TrackPoint {
                odometer_m,
                position: Some(row.position_deg()?),
            },
            altitude_m: row.altitude_m?,
        })
    };
    mission.rows()[rows]
        .iter()
        .zip(odometer_m)
        .filter_map(fix)
        .collect()
}

fn vertices(track: &[AltitudeFix]) -> Vec<RoadPoint> {
    let mut road: Vec<RoadPoint> = Vec::new();
    for TrackPoint {
        odometer_m,
        position,
    } in track.iter().map(|fix| fix.track)
    {
        let far = |last: &RoadPoint| odometer_m - last.distance_m >= VERTEX_M;
        if let Some((latitude_deg, longitude_deg)) = position
            && road.last().is_none_or(far)
        {
            road.push(RoadPoint {
                distance_m: odometer_m,
                latitude_deg,
                longitude_deg,
            });
        }
    }
    road
}

fn place(road: &Network, track: &[AltitudeFix]) -> Vec<MatchedFix> {
    let points: Vec<TrackPoint> = track.iter().map(|fix| fix.track).collect();
    match_track(road, &points)
        .into_iter()
        .zip(track)
        .filter_map(|(place, fix)| match place {
            MatchedPlace::OnRoad { distance_m, .. } => Some(MatchedFix {
                time_s: fix.time_s,
                distance_m,
                altitude_m: fix.altitude_m,
            }),
            _ => None,
        })
        .collect()
}

/// Returns each pass's altitude less the mean of all passes, at the places that all passed.
fn deviations(passes: &[Vec<MatchedFix>]) -> Vec<Vec<f64>> {
    let profiles: Vec<Vec<(f64, f64)>> = passes
        .iter()
        .map(|pass| forward(pass.iter().map(|fix| (fix.distance_m, fix.altitude_m))))
        .collect();
    let n = passes.len() as f64;
    let mean = |at_m| -> Option<f64> {
        let sum: Option<f64> = profiles.iter().map(|profile| linear(profile, at_m)).sum();
        Some(sum? / n)
    };
    let scale = (n / (n - 1.0)).sqrt();
    passes
        .iter()
        .map(|pass| {
            let errors = forward(pass.iter().filter_map(|fix| {
                Some((fix.time_s, scale * (fix.altitude_m - mean(fix.distance_m)?)))
            }));
            by_way(&errors)
        })
        .filter(|series| series.len() > 1)
        .collect()
}

/// Converts errors over time to one error for each step of a drive at [`SPEED_MPS`].
fn by_way(errors: &[(f64, f64)]) -> Vec<f64> {
    let start_s = errors.first().map_or(0.0, |first| first.0);
    (0..)
        .map_while(|step| linear(errors, start_s + f64::from(step) * STEP_M / SPEED_MPS))
        .collect()
}
