//! Maps of trucks whose receivers are late by unknown times: errors of the grade, and how far along
//! the road the map lies from where it belongs.

pub mod campaign;

use super::convergence::curve::floor_and_slope;
use super::definition::{Setting, Study, StudyOutcome};
use crate::error::Result;
use crate::numeric::statistics::{error_of_mean, mean};
use crate::report::page::{Section, Table};
use crate::simulator::truck::Preset;
use crate::terminal::progress;
use campaign::{Campaign, CampaignRun, Stretch, Vehicle};
use estimator_core::Tuning;
use std::path::Path;

/// The study, for the list.
pub const STUDY: Study = Study {
    name: "alignment",
    about: "maps of trucks with unknown delays of GNSS: errors of grade and of place along the road",
    run,
};

/// Number of campaigns, each with other delays, parameters, winds and noise.
const CAMPAIGNS: u64 = 9;
/// Length of the whole measured profile, m.
const LENGTH_M: f64 = 118_848.0;
/// The vehicles of a campaign.
const VEHICLES: [Vehicle; 2] = [
    Vehicle {
        truck: Preset::A,
        runs: 6,
        gnss_late_ms: None,
    },
    Vehicle {
        truck: Preset::B,
        runs: 6,
        gnss_late_ms: None,
    },
];
/// The maps, and the number of runs of each vehicle in them.
const MAPS: [(&str, [usize; VEHICLES.len()]); 8] = [
    ("one run of A", [1, 0]),
    ("one run of B", [0, 1]),
    ("four runs of A", [4, 0]),
    ("four runs of B", [0, 4]),
    ("one of A, one of B", [1, 1]),
    ("two of A, two of B", [2, 2]),
    ("three of A, three of B", [3, 3]),
    ("six of A, six of B", [6, 6]),
];

/// An evidence for another delay that no drive reaches: nothing is learned.
const NEVER: f32 = 1e9;

/// Figures of one map.
#[derive(Clone, Copy, Debug)]
struct MapFigures {
    rmse_percent: f64,
    nees: f64,
    moved_rmse_percent: f64,
    moved_m: f64,
    truly_placed_rmse_percent: f64,
    /// If the latency of the tuning counts, whatever the speeds show.
    assumed_rmse_percent: f64,
    /// Mean size of the runs' errors along the road, m.
    misplaced_m: f64,
}

fn run(setting: &Setting) -> Result<StudyOutcome> {
    let road = match setting.e4_road() {
        Ok(road) => road,
        Err(skipped) => return Ok(skipped),
    };
    let runs: usize = VEHICLES.iter().map(|vehicle| vehicle.runs).sum();
    let bar = progress::count(2 * CAMPAIGNS * runs as u64, "runs");
    let mut figures = Vec::new();
    let mut vehicles = Vec::new();
    for number in 0..CAMPAIGNS {
        let (of_maps, of_vehicles) = campaign(setting.seed.wrapping_add(number), &road, || {
            bar.inc(1);
        })?;
        figures.push(of_maps);
        vehicles.extend(of_vehicles);
    }
    bar.finish_and_clear();
    Ok(StudyOutcome::Done(Section {
        heading: "Maps of trucks with unknown delays of GNSS".to_owned(),
        words: vec![format!(
            "{CAMPAIGNS} campaigns on the measured profile of the E4. Two trucks, whose fixes are 0 \
             to 400 ms old when they arrive. Mass, drag and rolling resistance are wrong by 10 % (1 \
             sigma), torque by 4 %, in each run anew; every second run has a wind \
             of 3 m/s from any direction. Each run is a session of its own."
        )],
        tables: vec![
            maps_table(&figures),
            floor_table(&figures),
            vehicles_table(&vehicles),
        ],
        ..Section::default()
    }))
}

/// Delay of a vehicle's fixes, ms, and how much too far its runs are placed, m: mean and mean size.
type VehicleFigures = (String, f64, f64, f64);

fn campaign(
    seed: u64,
    road: &Path,
    done: impl Fn() + Sync,
) -> Result<(Vec<MapFigures>, Vec<VehicleFigures>)> {
    let stretch = Stretch {
        road: Some(std::path::absolute(road).map_err(crate::error::Error::io(road))?),
        from_m: 0.0,
        length_m: LENGTH_M,
    };
    let campaign = Campaign::new(seed, stretch)?;
    let tuning = Tuning::default();
    let runs = campaign.drive(&VEHICLES, &tuning, &done)?;
    let mut assumed = tuning;
    assumed.detection.delay_evidence = NEVER;
    let assumed = campaign.drive(&VEHICLES, &assumed, &done)?;
    let misplaced: Vec<(f64, f64)> = runs.iter().map(|run| campaign.misplaced_m(run)).collect();
    let first_of =
        |vehicle: usize| -> usize { VEHICLES[..vehicle].iter().map(|earlier| earlier.runs).sum() };
    let mut maps = Vec::new();
    for (_, counts) in MAPS {
        let indices: Vec<usize> = (0..VEHICLES.len())
            .flat_map(|vehicle| first_of(vehicle)..first_of(vehicle) + counts[vehicle])
            .collect();
        let of_map: Vec<&CampaignRun> = indices.iter().map(|&index| &runs[index]).collect();
        let map = campaign.map(&of_map);
        let score = campaign.score(&map)?;
        let (moved, moved_m) = campaign.score_moved(&map)?;
        let truly: Vec<CampaignRun> = of_map
            .iter()
            .map(|run| campaign.truly_placed(run))
            .collect();
        let truly = campaign.map(&truly.iter().collect::<Vec<_>>());
        let assumed: Vec<&CampaignRun> = indices.iter().map(|&index| &assumed[index]).collect();
        let assumed = campaign.score(&campaign.map(&assumed))?;
        let sizes: Vec<f64> = indices.iter().map(|&index| misplaced[index].1).collect();
        maps.push(MapFigures {
            rmse_percent: score.rmse_percent,
            nees: score.nees,
            moved_rmse_percent: moved.rmse_percent,
            moved_m,
            truly_placed_rmse_percent: campaign.score(&truly)?.rmse_percent,
            assumed_rmse_percent: assumed.rmse_percent,
            misplaced_m: mean(&sizes),
        });
    }
    let vehicles = VEHICLES.iter().enumerate().map(|(number, vehicle)| {
        let of = first_of(number)..first_of(number) + vehicle.runs;
        let means: Vec<f64> = misplaced[of.clone()].iter().map(|m| m.0).collect();
        let sizes: Vec<f64> = misplaced[of.clone()].iter().map(|m| m.1).collect();
        let late_ms = runs[of.start].gnss_late_ms;
        let name = format!("{seed}, {}", vehicle.truck.name());
        (name, late_ms, mean(&means), mean(&sizes))
    });
    Ok((maps, vehicles.collect()))
}

fn maps_table(campaigns: &[Vec<MapFigures>]) -> Table {
    let rows = MAPS.iter().enumerate().map(|(map, (words, _))| {
        let of = |value: fn(&MapFigures) -> f64| -> Vec<f64> {
            campaigns.iter().map(|maps| value(&maps[map])).collect()
        };
        let rmse = of(|map| map.rmse_percent);
        vec![
            (*words).to_owned(),
            format!("{:.4} ± {:.4}", mean(&rmse), error_of_mean(&rmse)),
            format!("{:.4}", rmse.iter().copied().fold(0.0, f64::max)),
            format!("{:.2}", mean(&of(|map| map.nees))),
            format!("{:.4}", mean(&of(|map| map.moved_rmse_percent))),
            format!("{:.2}", mean(&of(|map| map.moved_m.abs()))),
            format!("{:.4}", mean(&of(|map| map.truly_placed_rmse_percent))),
            format!("{:.4}", mean(&of(|map| map.assumed_rmse_percent))),
            format!("{:.2}", mean(&of(|map| map.misplaced_m))),
        ]
    });
    Table::new(
        "alignment_maps",
        "Means over campaigns of RMSE of grade (%) with its standard error, its largest value, normalised squared errors \
         (NEES), RMSE of the same map moved along the road by the best single distance, that \
         distance (m), RMSE if all positions were true, RMSE \
         if a latency of 150 ms is assumed, and the mean size of the runs' errors along the road (m).",
        &[
            "map of",
            "RMSE %",
            "largest",
            "NEES",
            "RMSE % if moved",
            "moved m",
            "RMSE % if truly placed",
            "RMSE % if 150 ms are assumed",
            "runs misplaced m",
        ],
    )
    .with_rows(rows)
}

/// The error of maps of equally many runs of both trucks against their number, and its floor.
fn floor_table(campaigns: &[Vec<MapFigures>]) -> Table {
    let of = |value: fn(&MapFigures) -> f64| -> (f64, f64) {
        let equal = MAPS.iter().enumerate().filter(|(_, (_, [a, b]))| a == b);
        let points = equal.map(|(map, (_, counts))| {
            let squares: Vec<f64> = campaigns
                .iter()
                .map(|maps| value(&maps[map]).powi(2))
                .collect();
            (counts.iter().sum::<usize>() as f64, mean(&squares))
        });
        floor_and_slope(&points.collect::<Vec<_>>())
    };
    let row = |words: &str, (floor, slope): (f64, f64)| {
        vec![
            words.to_owned(),
            format!("{:.4}", slope.max(0.0).sqrt()),
            format!("{:.4}", floor.max(0.0).sqrt()),
        ]
    };
    Table::new(
        "alignment_floor",
        "Maps of n runs, half of each truck: their mean square errors are those of a run over n and a \
         floor, which is the same for any number of runs. Both as RMSE (%), as the runs are placed and \
         if all positions were true or 150 ms were assumed: the difference is what places cost, the rest of the floor is what \
         all runs get wrong alike (crests and changes of slope that the estimator rounds).",
        &["runs", "of a run %", "floor %"],
    )
    .with_rows([
        row("as placed", of(|map| map.rmse_percent)),
        row("truly placed", of(|map| map.truly_placed_rmse_percent)),
        row("150 ms assumed", of(|map| map.assumed_rmse_percent)),
    ])
}

fn vehicles_table(vehicles: &[VehicleFigures]) -> Table {
    let row = |(name, late_ms, mean_m, size_m): &VehicleFigures| {
        vec![
            name.clone(),
            format!("{late_ms:.0}"),
            format!("{mean_m:+.2}"),
            format!("{size_m:.2}"),
        ]
    };
    Table::new(
        "alignment_vehicles",
        "Delay of the fixes of each vehicle (ms), and by how much its runs are placed too far along \
         the road (m): mean, and mean size.",
        &["campaign, truck", "late ms", "mean m", "mean size m"],
    )
    .with_rows(vehicles.iter().map(row))
}
