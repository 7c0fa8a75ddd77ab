//! A summary of a drive.

use super::long_run::LongRun;
use super::plausibility::Warning;
use super::roads::LearnedRoads;
use super::roadway_grade::RoadwayComparison;
use super::verdict::{DisagreementStretch, stretches, verdict};
use crate::error::Result;
use crate::files::run::RunRows;
use crate::source::damage::Damage;
use crate::terminal::counters::{CountedEvent, events};
use crate::terminal::table::text_table;
use comfy_table::Table;
use estimator_core::roadmap::MapCounters;
use estimator_core::{CELL_LENGTH_M, VehicleParameters};
use serde::{Serialize, Serializer};

/// Masses of vehicles of one file, over the file's: a tractor alone, and a heavy road train.
const LOADS: std::ops::RangeInclusive<f64> = 0.12..=4.0;
/// Part of a drive that is most of it.
const MOSTLY: f64 = 0.5;
/// Relative sigma below which a mass is known.
const KNOWN_PART: f64 = 0.2;

/// Summary of a drive.
#[derive(Debug, Default, Serialize)]
pub struct RunSummary {
    /// Driven distance, km.
    pub distance_km: f64,
    duration_s: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    start_utc: Option<String>,
    cells: usize,
    /// Part of valid cells, %.
    pub valid_percent: f64,
    /// Mean standard deviation of the smoothed grade, %.
    pub grade_sigma_percent: f64,
    lagged_grade_sigma_percent: f64,
    live_grade_sigma_percent: f64,
    climb_m: f64,
    bias_percent: f64,
    scale: f64,
    /// Gross mass at the end, kg.
    pub mass_kg: Option<f64>,
    /// Its standard deviation, kg.
    pub mass_sigma_kg: Option<f64>,
    /// Whether the signals agree.
    pub verdict: String,
    /// Way of the cells that are marked as suspect, km.
    pub suspect_km: f64,
    disagreements: Vec<DisagreementStretch>,
    /// What is not plausible about the input.
    pub warnings: Vec<Warning>,
    damage: Damage,
    #[serde(skip_serializing_if = "Option::is_none")]
    map: Option<MapSummary>,
    #[serde(skip_serializing_if = "Option::is_none")]
    memory: Option<MemorySummary>,
    roadway_grade: Option<RoadwayComparison>,
    #[serde(serialize_with = "by_key")]
    events: Vec<CountedEvent>,
}

fn by_key<S: Serializer>(events: &[CountedEvent], to: S) -> std::result::Result<S::Ok, S::Error> {
    to.collect_seq(events.iter().map(|event| (event.key, event.count)))
}

/// Use of a map.
#[derive(Debug, Serialize)]
struct MapSummary {
    /// Distance with a known place on the map, km.
    on_map_km: f64,
    /// Distance over which the map was left out because it differs from the estimate, km.
    left_out_km: f64,
    left_out: u32,
}

impl From<MapCounters> for MapSummary {
    fn from(counters: MapCounters) -> Self {
        Self {
            on_map_km: km(counters.cells_on_map),
            left_out_km: km(counters.cells_left_out),
            left_out: counters.times_left_out,
        }
    }
}

/// Use of a road memory.
#[derive(Debug, Serialize)]
struct MemorySummary {
    #[serde(flatten)]
    on_roads: MapSummary,
    /// Distance that was added to known roads, km.
    known_km: f64,
    /// Distance on roads that were driven for the first time, km.
    new_km: f64,
    /// Distance that was not learned, km: the place was not clear, or there was no room.
    not_learned_km: f64,
    writes: u32,
}

impl From<&LearnedRoads> for MemorySummary {
    fn from(learned: &LearnedRoads) -> Self {
        let counters = learned.counters();
        Self {
            on_roads: MapSummary::from(*learned.on_roads()),
            known_km: km(counters.cells_fused),
            new_km: km(counters.cells_new),
            not_learned_km: km(counters.cells_left_out),
            writes: counters.writes,
        }
    }
}

fn km(cells: u32) -> f64 {
    f64::from(cells) * f64::from(CELL_LENGTH_M) * 1e-3
}

impl RunSummary {
    /// Computes the summary of a run.
    ///
    /// # Errors
    /// Returns an error if its rows cannot be read.
    pub fn new(run: &mut LongRun) -> Result<Self> {
        let mut sums = Self {
            cells: run.rows.count(),
            scale: 1.0,
            disagreements: stretches(&run.disagreements),
            warnings: run.warnings.clone(),
            start_utc: run.start_utc.clone(),
            events: events(&run.counters),
            damage: run.log.damage.clone(),
            map: run.map.map(MapSummary::from),
            memory: run.memory.as_ref().map(MemorySummary::from),
            roadway_grade: run.roadway_grade,
            ..Self::default()
        };
        let (mut first_m, mut last_m) = (None, None);
        let mut marked = 0;
        run.rows.each(&mut |row| {
            sums.distance_km = row.distance_m * 1e-3;
            sums.duration_s = row.time_s;
            sums.valid_percent += f64::from(row.valid);
            sums.grade_sigma_percent += row.grade_sigma_percent;
            sums.lagged_grade_sigma_percent += row.lagged_grade_sigma_percent;
            sums.live_grade_sigma_percent += row.live_grade_sigma_percent;
            sums.bias_percent += row.bias_percent;
            sums.scale = row.scale;
            (sums.mass_kg, sums.mass_sigma_kg) = (row.mass_kg, row.mass_sigma_kg);
            marked += usize::from(row.consistent == 0);
            first_m = first_m.or(row.altitude_m);
            last_m = row.altitude_m.or(last_m);
            Ok(())
        })?;
        sums.warnings.extend(sums.other_mass(&run.model.vehicle));
        let count = sums.cells.max(1) as f64;
        Ok(Self {
            valid_percent: 100.0 * (sums.valid_percent / count),
            grade_sigma_percent: sums.grade_sigma_percent / count,
            lagged_grade_sigma_percent: sums.lagged_grade_sigma_percent / count,
            live_grade_sigma_percent: sums.live_grade_sigma_percent / count,
            climb_m: last_m.unwrap_or(0.0) - first_m.unwrap_or(0.0),
            bias_percent: sums.bias_percent / count,
            verdict: verdict(sums.cells, marked, &sums.disagreements, &sums.warnings),
            suspect_km: marked as f64 * f64::from(CELL_LENGTH_M) * 1e-3,
            ..sums
        })
    }

    /// Returns true if the estimate is not to be trusted over most of the drive.
    #[must_use]
    pub fn is_mostly_suspect(&self) -> bool {
        let is_spoilt = self.warnings.iter().any(|warning| warning.spoils.is_some());
        is_spoilt || self.suspect_km > MOSTLY * self.distance_km
    }

    /// Returns a warning if the mass is known, and that of another kind of vehicle than the file's.
    fn other_mass(&self, vehicle: &VehicleParameters) -> Option<Warning> {
        let (kg, sigma_kg) = (self.mass_kg?, self.mass_sigma_kg?);
        let file_kg = f64::from(vehicle.mass_kg);
        let factor = kg / file_kg;
        let is_known = sigma_kg < KNOWN_PART * kg;
        (is_known && !LOADS.contains(&factor)).then(|| {
            Warning::major(
                "other_mass",
                "a mass that no such vehicle has",
                format!(
                    "the drive shows a mass of {kg:.0} kg, the vehicle file has {file_kg:.0} kg"
                ),
                "look at units and signs of torque and speed, or give the file of this vehicle",
            )
        })
    }

    /// Returns the table of the summary for a terminal.
    #[must_use]
    pub fn table(&self) -> Table {
        let mut rows = Vec::new();
        let mut line = |name: &str, value: String, unit: &str| {
            rows.push(vec![name.to_owned(), unit.to_owned(), value]);
        };
        line("verdict", self.verdict.clone(), "");
        line("suspect", format!("{:.2}", self.suspect_km), "km");
        line("distance", format!("{:.3}", self.distance_km), "km");
        if let Some(start) = &self.start_utc {
            line("start", start.clone(), "UTC");
        }
        line("duration", format!("{:.1}", self.duration_s), "s");
        line("cells", self.cells.to_string(), "");
        line("valid", format!("{:.1}", self.valid_percent), "%");
        if let Some(map) = &self.map {
            line("on the map", format!("{:.3}", map.on_map_km), "km");
            line("map left out", format!("{:.3}", map.left_out_km), "km");
        }
        if let Some(memory) = &self.memory {
            let left_out_km = memory.on_roads.left_out_km;
            line(
                "on learned roads",
                format!("{:.3}", memory.on_roads.on_map_km),
                "km",
            );
            line("learned roads left out", format!("{left_out_km:.3}"), "km");
            line("learned again", format!("{:.3}", memory.known_km), "km");
            line("learned newly", format!("{:.3}", memory.new_km), "km");
            line("not learned", format!("{:.3}", memory.not_learned_km), "km");
        }
        if let Some(other) = &self.roadway_grade {
            line("PCC1 less live grade", other.words(), "%");
        }
        line("climb", format!("{:.1}", self.climb_m), "m");
        let grade = "% grade";
        line(
            "sigma, smoothed",
            format!("{:.3}", self.grade_sigma_percent),
            grade,
        );
        line(
            "sigma, lagged",
            format!("{:.3}", self.lagged_grade_sigma_percent),
            grade,
        );
        line(
            "sigma, live",
            format!("{:.3}", self.live_grade_sigma_percent),
            grade,
        );
        line(
            "model bias, mean",
            format!("{:+.3}", self.bias_percent),
            grade,
        );
        line("traction scale, end", format!("{:.3}", self.scale), "");
        if let (Some(mass_kg), Some(sigma_kg)) = (self.mass_kg, self.mass_sigma_kg) {
            line(
                "gross mass, end",
                format!("{mass_kg:.0} ± {sigma_kg:.0}"),
                "kg",
            );
        }
        for DisagreementStretch { what, from_m, to_m } in &self.disagreements {
            let stretch = format!("{:.2} to {:.2}", from_m * 1e-3, to_m * 1e-3);
            line(what, stretch, "km");
        }
        for event in &self.events {
            line(event.name, event.count.to_string(), "");
        }
        text_table(&["", "unit", "value"], &rows, 2)
    }
}
