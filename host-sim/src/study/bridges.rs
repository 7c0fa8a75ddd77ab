//! Where terrain models fail: bridges, cuttings and tunnels. Our map beside the slope of terrain, and
//! beside what routers make of it, on simulated structures and on the measured bus.

mod bus;
mod drives;
mod structures;

use super::definition::{Setting, Study, StudyOutcome};
use crate::error::Result;
use crate::map::MapRow;
use crate::numeric::statistics::mean;
use crate::report::page::{Figure, Section, Table};
use crate::report::plot::{Mark, Plot, Series, colour};
use crate::simulator::truck::Preset;
use crate::terminal::progress;
use drives::{Campaign, MapError};
use rayon::prelude::*;
use structures::{CLAMP_PERCENT, STRUCTURES, Structure};

/// The study, for the list.
pub const STUDY: Study = Study {
    name: "bridges",
    about: "bridges, cuttings and tunnels: our map beside terrain, routers' clamp and straight lines",
    run,
};

/// Number of campaigns, each with another road, other parameters, winds and noise.
const CAMPAIGNS: u64 = 4;
/// The trucks.
const TRUCKS: [Preset; 2] = [Preset::A, Preset::B];
/// Runs of each truck in a campaign.
const RUNS: usize = 4;
/// Largest RMSE that one run may have in a tunnel, %.
const TUNNEL_BAR_PERCENT: f64 = 0.2;

/// Errors on one structure in one campaign, RMSE in %.
struct Errors {
    terrain: f64,
    terrain_largest: f64,
    clamped: f64,
    straight: f64,
    /// Of each truck: of each run alone, and of the map of all its runs.
    single: [Vec<MapError>; TRUCKS.len()],
    merged: [MapError; TRUCKS.len()],
}

/// What one campaign gives.
struct Outcome {
    errors: Vec<Errors>,
    figures: Vec<Figure>,
}

fn run(setting: &Setting) -> Result<StudyOutcome> {
    let bar = progress::count(CAMPAIGNS * (TRUCKS.len() * RUNS) as u64, "runs");
    let outcomes: Vec<Outcome> = (0..CAMPAIGNS)
        .into_par_iter()
        .map(|number| outcome(setting.seed.wrapping_add(number), || bar.inc(1)))
        .collect::<Result<_>>()?;
    bar.finish_and_clear();
    let bus = bus::of_data(&setting.data)?;
    let mut section = Section {
        heading: "Bridges, cuttings and tunnels".to_owned(),
        words: vec![words(), verdict(&outcomes)],
        tables: vec![terrain_table(&outcomes), ours_table(&outcomes)],
        figures: outcomes
            .into_iter()
            .next()
            .map_or_else(Vec::new, |first| first.figures),
        ..Section::default()
    };
    match bus {
        Some(bus) => {
            section.words.push(bus.words());
            section.tables.push(bus.table());
            section.figures.extend(bus.figures());
        }
        None => section.words.push(
            "The measured bus is left out: its mission or the terrain tiles are missing (--data DIR)."
                .to_owned(),
        ),
    }
    Ok(StudyOutcome::Done(section))
}

/// Returns the RMSE of one run of a truck through the longest tunnel, 2 km without GNSS, %.
///
/// # Errors
/// Returns an error if the drive cannot be simulated or stored.
pub fn tunnel_rmse_percent(seed: u64, truck: Preset) -> Result<f64> {
    let campaign = Campaign::new(seed)?;
    let runs = campaign.drive(truck, 1, || ())?;
    let map = campaign.map(&[&runs[0]]);
    let (_, tunnel) = structures::longest_tunnel();
    Ok(campaign.map_error(&map, &tunnel.range_m()).rmse_percent)
}

fn outcome(seed: u64, done: impl Fn() + Sync) -> Result<Outcome> {
    let campaign = Campaign::new(seed)?;
    let runs = TRUCKS
        .into_par_iter()
        .map(|truck| campaign.drive(truck, RUNS, &done))
        .collect::<Result<Vec<_>>>()?;
    let single: Vec<Vec<Vec<MapRow>>> = runs
        .iter()
        .map(|runs| runs.iter().map(|run| campaign.map(&[run])).collect())
        .collect();
    let merged: Vec<Vec<MapRow>> = runs
        .iter()
        .map(|runs| campaign.map(&runs.iter().collect::<Vec<_>>()))
        .collect();
    let errors = STRUCTURES.iter().map(|structure| {
        let range_m = structure.range_m();
        let terrain = campaign.terrain_errors(structure);
        Errors {
            terrain: terrain.rmse,
            terrain_largest: terrain.largest,
            clamped: terrain.clamped,
            straight: terrain.straight,
            single: [0, 1].map(|truck: usize| {
                let of = |map: &Vec<MapRow>| campaign.map_error(map, &range_m);
                single[truck].iter().map(of).collect()
            }),
            merged: [0, 1].map(|truck: usize| campaign.map_error(&merged[truck], &range_m)),
        }
    });
    Ok(Outcome {
        errors: errors.collect(),
        figures: figures(&campaign, &single[0][0]),
    })
}

fn words() -> String {
    format!(
        "Roads with the grades of a motorway, and under them ground that leaves them at bridges of 18 to \
         60 m, in cuttings, and above tunnels. Terrain is the best that a model can be: posts of 1 arc \
         second (30 m), whole metres, no other error, read every 60 m as Valhalla does. Routers clamp \
         what is too steep (here to ±{CLAMP_PERCENT} %), or draw a straight line from end to end where a tag \
         tells the structure. Ours is the map of one run, and of {RUNS} runs, of trucks A and B: mass, drag \
         and rolling resistance wrong by 10 %, torque by 4 % (1 sigma), wind of 2 m/s; in tunnels there is \
         no GNSS."
    )
}

/// Returns whether single runs meet the bar in the long tunnel.
fn verdict(outcomes: &[Outcome]) -> String {
    let (index, tunnel) = structures::longest_tunnel();
    let all: Vec<f64> = outcomes
        .iter()
        .flat_map(|outcome| outcome.errors[index].single.iter().flatten())
        .map(|error| error.rmse_percent)
        .collect();
    let within = all
        .iter()
        .filter(|rmse| **rmse <= TUNNEL_BAR_PERCENT)
        .count();
    let largest = all.iter().copied().fold(0.0, f64::max);
    format!(
        "One run through {:.0} km without GNSS has an RMSE of {:.3} % in the mean and {largest:.3} % at \
         most; {within} of {} runs have at most {TUNNEL_BAR_PERCENT} %.",
        tunnel.length_m / 1000.0,
        mean(&all),
        all.len()
    )
}

fn terrain_table(outcomes: &[Outcome]) -> Table {
    let header = [
        "structure",
        "length m",
        "ground m",
        "terrain %",
        "largest %",
        "clamped %",
        "straight line %",
        "A, one run %",
        "B, one run %",
    ];
    let caption = "RMSE of grade on the structure, mean over campaigns: slope of terrain, its largest \
                   error, terrain clamped, a straight line between the ends, and our map of one run. \
                   Ground is its height over the road.";
    let rows = STRUCTURES.iter().enumerate().map(|(index, structure)| {
        let of = |value: &dyn Fn(&Errors) -> f64| {
            let all: Vec<f64> = outcomes.iter().map(|o| value(&o.errors[index])).collect();
            mean(&all)
        };
        let single = |truck: usize| {
            let each = |errors: &Errors| -> Vec<f64> {
                errors.single[truck]
                    .iter()
                    .map(|e| e.rmse_percent)
                    .collect()
            };
            of(&|errors| mean(&each(errors)))
        };
        let mut row = structure_columns(structure);
        row.push(format!("{:+.0}", structure.ground_m));
        let numbers = [
            of(&|errors| errors.terrain),
            of(&|errors| errors.terrain_largest),
            of(&|errors| errors.clamped),
            of(&|errors| errors.straight),
            single(0),
            single(1),
        ];
        row.extend(numbers.map(|value| format!("{value:.3}")));
        row
    });
    Table::new("bridges_terrain", caption, &header).with_rows(rows)
}

fn ours_table(outcomes: &[Outcome]) -> Table {
    let header = [
        "structure",
        "length m",
        "truck",
        "one run %",
        "largest %",
        "NEES",
        "four runs %",
        "NEES of four",
    ];
    let caption = "Our map on the structure: RMSE of single runs, mean and largest, RMSE of the map of four \
                   runs, mean over campaigns, and normalised squared errors (1 if the sigmas are consistent).";
    let rows = STRUCTURES
        .iter()
        .enumerate()
        .flat_map(|(index, structure)| {
            TRUCKS.into_iter().enumerate().map(move |(truck, preset)| {
                let of = |outcome: &Outcome| outcome.errors[index].single[truck].clone();
                let single: Vec<MapError> = outcomes.iter().flat_map(of).collect();
                let merged: Vec<MapError> = outcomes
                    .iter()
                    .map(|outcome| outcome.errors[index].merged[truck])
                    .collect();
                let numbers = |errors: &[MapError], value: fn(&MapError) -> f64| -> Vec<f64> {
                    errors.iter().map(value).collect()
                };
                let rmse = numbers(&single, |error| error.rmse_percent);
                let mut row = structure_columns(structure);
                row.extend([
                    preset.name().to_owned(),
                    format!("{:.3}", mean(&rmse)),
                    format!("{:.3}", rmse.iter().copied().fold(0.0, f64::max)),
                    format!("{:.2}", mean(&numbers(&single, |error| error.nees))),
                    format!("{:.3}", mean(&numbers(&merged, |error| error.rmse_percent))),
                    format!("{:.2}", mean(&numbers(&merged, |error| error.nees))),
                ]);
                row
            })
        });
    Table::new("bridges_ours", caption, &header).with_rows(rows)
}

fn structure_columns(structure: &Structure) -> Vec<String> {
    vec![structure.name(), format!("{:.0}", structure.length_m)]
}

/// Returns the highest bridge and the longest tunnel, with what lies around them.
fn figures(campaign: &Campaign, map: &[MapRow]) -> Vec<Figure> {
    [structures::highest_bridge(), structures::longest_tunnel().1]
        .into_iter()
        .map(|structure| {
            let range_m = structure.range_m();
            let (from_m, to_m) = (range_m.start - 500.0, range_m.end + 500.0);
            let truth = campaign.grades(from_m..to_m, |at_m| Some(campaign.true_percent(at_m)));
            let terrain = campaign.grades(from_m..to_m, |at_m| campaign.terrain_percent(at_m));
            let clamped = terrain
                .iter()
                .map(|(km, grade)| (*km, grade.clamp(-CLAMP_PERCENT, CLAMP_PERCENT)));
            let rows = || {
                let inside = |row: &&MapRow| (from_m..to_m).contains(&row.distance_m);
                map.iter().filter(inside)
            };
            let ours = rows().map(|row| (row.distance_m * 1e-3, row.grade_percent));
            let band = rows().map(|row| {
                let km = row.distance_m * 1e-3;
                (km, row.grade_percent, row.grade_sigma_percent)
            });
            let mut plot = Plot::new("distance (km)", "grade (%)")
                .with(Series::two_sigma("ours, two sigmas", colour::BLUE, band))
                .with(Series::line("terrain", colour::GREY, terrain.clone()))
                .with(Series::line("terrain, clamped", colour::ORANGE, clamped))
                .with(Series::line("ours, one run", colour::BLUE, ours))
                .with(Series::line("truth", colour::BLACK, truth).drawn(Mark::Dashed));
            plot.shaded = vec![(range_m.start * 1e-3, range_m.end * 1e-3)];
            plot.y_range = Some((-10.0, 10.0));
            let name = format!("bridges_{}", structure.kind.word());
            let caption = format!(
                "A {}: grade of terrain, of routers, and of one run.",
                structure.name()
            );
            Figure::new(name, &plot, caption)
        })
        .collect()
}
