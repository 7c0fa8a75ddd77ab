//! The measured bus: our map beside the slope of terrain. The truth is unknown.

use super::structures::CLAMP_PERCENT;
use crate::error::Result;
use crate::numeric::statistics::mean;
use crate::report::page::{Figure, Table};
use crate::report::plot::{Plot, Series, colour};
use crate::study::windows::GradeProfile;
use crate::study::ztbus::{self, DirectionProfiles};
use std::collections::BTreeMap;
use std::path::Path;

/// Distances over which terrain becomes a slope, m: of Valhalla, and one that evens its noise out.
const SLOPES_M: [f64; 2] = [60.0, 200.0];

/// Terrain and our map along the directions of the bus.
pub(super) struct Bus(Vec<Direction>);

/// One direction.
struct Direction {
    word: &'static str,
    /// Distance, m, and the grade of each pass there, %.
    passes: BTreeMap<i64, Vec<f64>>,
    /// Slope of terrain over each of [`SLOPES_M`].
    terrain: [GradeProfile; 2],
}

/// Returns the bus; `None` without its mission or its terrain.
pub(super) fn of_data(data: &Path) -> Result<Option<Bus>> {
    if !data.join("srtm").is_dir() {
        return Ok(None);
    }
    let profiles = ztbus::profiles(data)?;
    Ok(profiles.map(|profiles| Bus(profiles.iter().map(direction).collect())))
}

fn direction(profiles: &DirectionProfiles) -> Direction {
    let mut passes: BTreeMap<i64, Vec<f64>> = BTreeMap::new();
    for (_, rows) in &profiles.passes {
        for row in rows {
            let at = row.distance_m.round() as i64;
            passes.entry(at).or_default().push(row.grade_percent);
        }
    }
    let terrain = |base_m| GradeProfile::from_altitudes(profiles.terrain.iter().copied(), base_m);
    Direction {
        word: profiles.direction,
        passes,
        terrain: SLOPES_M.map(terrain),
    }
}

impl Direction {
    /// Returns distance, km, the mean of the passes, and the slope of terrain, %.
    fn pairs(&self, slope: usize) -> Vec<(f64, f64, f64)> {
        let pair = |(&at, grades): (&i64, &Vec<f64>)| {
            let terrain = self.terrain[slope].grade_percent(at as f64)?;
            Some((at as f64 * 1e-3, mean(grades), terrain))
        };
        self.passes.iter().filter_map(pair).collect()
    }

    /// Returns the standard deviation of single passes around their mean, %.
    fn spread_percent(&self) -> f64 {
        let squares: Vec<f64> = self
            .passes
            .values()
            .filter(|grades| grades.len() > 1)
            .map(|grades| {
                let middle = mean(grades);
                let sum: f64 = grades.iter().map(|grade| (grade - middle).powi(2)).sum();
                sum / (grades.len() - 1) as f64
            })
            .collect();
        mean(&squares).sqrt()
    }
}

impl Bus {
    pub(super) fn words(&self) -> String {
        "The measured bus has no truth. Its passes agree with each other far better than terrain does \
         with any of them, so the difference from terrain is terrain's, but for a part of the size of \
         the spread. Terrain is SRTM of 3 arc seconds, with roofs and trees."
            .to_owned()
    }

    pub(super) fn table(&self) -> Table {
        let header = [
            "direction",
            "slope over m",
            "terrain minus ours, RMS %",
            "largest %",
            "beyond 3 %: part of the way %",
            "clamped minus ours, RMS %",
            "spread of our passes %",
        ];
        let rows = self.0.iter().flat_map(|direction| {
            SLOPES_M.iter().enumerate().map(move |(slope, base_m)| {
                let pairs = direction.pairs(slope);
                let differences: Vec<f64> = pairs.iter().map(|(_, ours, t)| t - ours).collect();
                let clamped = pairs
                    .iter()
                    .map(|(_, ours, terrain)| terrain.clamp(-CLAMP_PERCENT, CLAMP_PERCENT) - ours);
                let beyond = differences.iter().filter(|d| d.abs() > 3.0).count();
                vec![
                    direction.word.to_owned(),
                    format!("{base_m:.0}"),
                    format!("{:.2}", rms(&differences)),
                    format!(
                        "{:.1}",
                        differences.iter().map(|d| d.abs()).fold(0.0, f64::max)
                    ),
                    format!("{:.1}", 100.0 * beyond as f64 / differences.len() as f64),
                    format!("{:.2}", rms(&clamped.collect::<Vec<_>>())),
                    format!("{:.2}", direction.spread_percent()),
                ]
            })
        });
        let caption = "Slope of terrain against the mean of our passes, and how far single passes are \
                       from that mean (1 sigma).";
        Table::new("bridges_bus", caption, &header).with_rows(rows)
    }

    pub(super) fn figures(&self) -> impl Iterator<Item = Figure> {
        self.0.iter().map(|direction| {
            let pairs = direction.pairs(0);
            let terrain = pairs.iter().map(|(km, _, terrain)| (*km, *terrain));
            let ours = pairs.iter().map(|(km, ours, _)| (*km, *ours));
            let mut plot = Plot::new("distance (km)", "grade (%)")
                .with(Series::line("terrain, over 60 m", colour::GREY, terrain))
                .with(Series::line("ours, mean of the passes", colour::BLUE, ours));
            plot.y_range = Some((-15.0, 15.0));
            let caption = format!("The measured bus, {}.", direction.word);
            Figure::new(format!("bridges_bus_{}", direction.word), &plot, caption)
        })
    }
}

fn rms(values: &[f64]) -> f64 {
    mean(&values.iter().map(|v| v * v).collect::<Vec<_>>()).sqrt()
}
