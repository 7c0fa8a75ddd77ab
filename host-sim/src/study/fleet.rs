//! Accuracy of maps of several runs, and whether their sigmas are consistent. Runs of one day share
//! their errors; a light truck has larger errors.

pub mod road;

use super::definition::{Setting, Study, StudyOutcome};
use crate::error::Result;
use crate::map::PlacedRun;
use crate::numeric::statistics::mean;
use crate::report::page::{Section, Table};
use crate::score::{END_CUT_M, ScoreRow};
use crate::simulator::truck::Preset;
use crate::terminal::progress;
use rayon::prelude::*;
use road::{FleetRoad, as_if_independent};

/// The study, for the list.
pub const STUDY: Study = Study {
    name: "fleet",
    about: "maps of several runs, trucks and days: errors, and whether the stated sigmas know them",
    run,
};

/// Number of roads.
const ROADS: u64 = 24;
/// The days of a road: the truck, and its number of runs.
const DAYS: [(Preset, usize); 5] = [
    (Preset::A, 12),
    (Preset::A, 3),
    (Preset::A, 3),
    (Preset::B, 2),
    (Preset::B, 2),
];
/// The maps, and the number of runs of each day in them.
const MAPS: [(&str, [usize; DAYS.len()]); 6] = [
    ("one run of A", [1, 0, 0, 0, 0]),
    ("three runs of A, one day", [3, 0, 0, 0, 0]),
    ("twelve runs of A, one day", [12, 0, 0, 0, 0]),
    ("three of A, two of B", [3, 0, 0, 2, 0]),
    ("three of A, two of A on another day", [3, 2, 0, 0, 0]),
    ("three days of three A, two days of two B", [3, 3, 3, 2, 2]),
];
/// Indices of the map of heavy trucks alone, and of the maps with two more runs.
const ALONE: usize = 1;
const BESIDE: [(&str, usize); 2] = [("two of B", 3), ("two of A on another day", 4)];

/// Score of one map, and its score if runs were independent.
type ScorePair = [ScoreRow; 2];

fn run(setting: &Setting) -> Result<StudyOutcome> {
    let bar = progress::count(ROADS * DAYS.len() as u64, "days");
    let roads = (0..ROADS)
        .into_par_iter()
        .map(|i| {
            let road = FleetRoad::new(setting.seed.wrapping_add(i))?;
            let mut days = Vec::new();
            for (number, (truck, runs)) in DAYS.into_iter().enumerate() {
                days.push(road.day(number, truck, runs)?);
                bar.inc(1);
            }
            scores(&road, &days)
        })
        .collect::<Result<Vec<_>>>()?;
    bar.finish_and_clear();
    Ok(StudyOutcome::Done(Section {
        heading: "Maps of a fleet".to_owned(),
        words: vec![format!(
            "{ROADS} roads of 20 km. Mass, drag and rolling resistance are wrong by 10 % (1 \
             sigma), torque by 4 %, by the same amounts all day. Tyres begin with 30 % more \
             resistance; a wind of 2 m/s has slow gusts of 0.3. The first and last {END_CUT_M:.0} \
             m are left out."
        )],
        tables: vec![maps_table(&roads), beside_table(&roads)],
        ..Section::default()
    }))
}

fn scores(road: &FleetRoad, days: &[Vec<PlacedRun>]) -> Result<Vec<ScorePair>> {
    let score = |(_, counts): &(_, [usize; DAYS.len()])| {
        let counted = days.iter().zip(counts);
        let taken: Vec<&[PlacedRun]> = counted.map(|(runs, &count)| &runs[..count]).collect();
        let map = road.map(&taken).rows();
        let independent = as_if_independent(&map, taken.into_iter().flatten());
        Ok([road.score(&map)?, road.score(&independent)?])
    };
    MAPS.iter().map(score).collect()
}

fn maps_table(roads: &[Vec<ScorePair>]) -> Table {
    let rows = MAPS.iter().enumerate().map(|(map, (words, _))| {
        let each = |value: fn(&ScorePair) -> f64| {
            mean(&roads.iter().map(|of| value(&of[map])).collect::<Vec<f64>>())
        };
        vec![
            (*words).to_owned(),
            format!("{:.4}", each(|[fused, _]| fused.rmse_percent)),
            format!("{:.2}", each(|[fused, _]| fused.nees)),
            format!("{:.2}", each(|[_, independent]| independent.nees)),
        ]
    });
    Table::new(
        "fleet_maps",
        "Maps of a road by their runs: means over roads of RMSE of grade (%) and of normalised \
         squared errors (NEES, 1 if the stated sigmas are consistent); NEES also of the mean \
         weighted by inverse variances alone, as if no two runs shared an error.",
        &["map of", "RMSE %", "NEES", "NEES if independent"],
    )
    .with_rows(rows)
}

fn beside_table(roads: &[Vec<ScorePair>]) -> Table {
    let rmse = |map: usize| roads.iter().map(move |of| of[map][0].rmse_percent);
    let pooled = |map| mean(&rmse(map).map(|rmse| rmse * rmse).collect::<Vec<f64>>()).sqrt();
    let rows = BESIDE.map(|(words, map)| {
        let ratios = || rmse(map).zip(rmse(ALONE)).map(|(with, alone)| with / alone);
        let worse = ratios().filter(|ratio| *ratio > 1.0).count();
        let in_percent = |ratio: f64| format!("{:+.1}", 100.0 * (ratio - 1.0));
        vec![
            words.to_owned(),
            format!("{:.4}", pooled(ALONE)),
            format!("{:.4}", pooled(map)),
            in_percent(pooled(map) / pooled(ALONE)),
            worse.to_string(),
            in_percent(ratios().fold(0.0, f64::max)),
        ]
    });
    Table::new(
        "fleet_beside",
        format!(
            "Three runs of truck A of one day, and two more: RMSE of grade (%) over all {ROADS} \
             roads without and with them, the number of roads on which the map is worse, and by \
             how much on the worst. On one road chance decides."
        ),
        &[
            "added",
            "RMSE % without",
            "with",
            "change %",
            "roads worse",
            "most %",
        ],
    )
    .with_rows(rows)
}
