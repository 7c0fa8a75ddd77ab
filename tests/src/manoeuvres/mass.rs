//! The gross mass that the live estimate states: how far off it is, and whether its sigma knows.
//!
//! No message reports the mass, and the vehicle file is wrong by up to a factor of 2.5. Half-way the
//! truck stops for a minute, and its load changes.

use super::drives::{BenchTruck, Plan};
use super::road::BenchRoad;
use super::signals::Edit;
use super::truth::When;
use estimator_core::{Estimator, Step, Tuning, Uncertain};
use host_sim::error::Result;
use host_sim::simulator::manoeuvre_file::Stop;
use host_sim::terminal::table::text_table;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use std::fmt::Write;

/// Gross masses of the trucks, from empty to full, kg.
const LOADS_KG: [(f64, f64); 2] = [(15_000.0, 40_000.0), (8_000.0, 18_000.0)];
/// Largest ratio of the file's mass to the true one, or of the true one to the file's.
const FILE_FACTOR: f64 = 2.5;
/// Place of the stop, m from the start.
const STOP_M: f64 = 17_000.0;
/// Distances driven after which the mass is judged, m from the start and from the stop.
const JUDGED_M: [f64; 2] = [10_000.0, 5_000.0];
/// The bars: error after each of them as a part of the mass (root mean square; 90th percentile).
const BARS: [f64; 2] = [0.06, 0.1];

/// A drive.
#[derive(Clone, Debug)]
pub struct MassPlan {
    plan: Plan,
    file_factor: f64,
}

/// The stated mass over the true one, after the start and after the stop.
#[derive(Clone, Copy, Debug)]
pub struct MassRow {
    truck: BenchTruck,
    loads_kg: [f64; 2],
    file_factor: f64,
    stated: [Uncertain; 2],
}

/// Draws drives; the same for the same seed.
#[must_use]
pub fn drawn(count: usize, seed: u64) -> Vec<MassPlan> {
    (0..count)
        .map(|index| {
            let mut rng = ChaCha8Rng::seed_from_u64(seed);
            rng.set_stream(index as u64);
            let truck = BenchTruck::ALL[index % BenchTruck::ALL.len()];
            let (empty, full): (f64, f64) = LOADS_KG[index % BenchTruck::ALL.len()];
            let mut load_kg = || empty * (full / empty).powf(rng.random_range(0.0..1.0));
            let [first, then] = [load_kg(), load_kg()];
            let mut plan = Plan::new("mass", truck, 1 + index as u64);
            plan.mass_kg = Some(first);
            let mut stop = Stop::new(STOP_M, 60.0);
            stop.mass_kg = Some(then);
            plan.stops.push(stop);
            plan.edits.push((When::Always, Edit::MassUntold));
            MassPlan {
                plan,
                file_factor: FILE_FACTOR.powf(rng.random_range(-1.0..1.0)),
            }
        })
        .collect()
}

/// Drives all.
///
/// # Errors
/// Returns an error if a truck gets stuck.
pub fn bench(road: &BenchRoad, plans: &[MassPlan]) -> Result<Vec<MassRow>> {
    plans.par_iter().map(|plan| driven(road, plan)).collect()
}

fn driven(road: &BenchRoad, drive: &MassPlan) -> Result<MassRow> {
    let MassPlan { plan, file_factor } = drive;
    let driven = plan.driven(&road.road)?;
    let mut model = driven.vehicle.model.clone();
    model.vehicle.mass_kg *= *file_factor as f32;
    let mut estimator =
        Estimator::<f32>::new(model, Tuning::default()).expect("the simulator's vehicles can be");
    let judged_m = [JUDGED_M[0], STOP_M + JUDGED_M[1]];
    let mut stated = [None; 2];
    for frame in driven.received(&plan.edits) {
        estimator.on_frame(frame.time, &frame.frame);
        while let Some(step) = estimator.step() {
            while estimator.next_cell().is_some() {}
            if step != Step::Moved {
                continue;
            }
            let Some(live) = estimator.live() else {
                continue;
            };
            for (stated, at_m) in stated.iter_mut().zip(judged_m) {
                if stated.is_none() && live.end.distance_m() >= at_m {
                    *stated = Some(live.estimate.mass_kg);
                }
            }
        }
    }
    let true_kg = driven.masses_kg;
    let relative = |index: usize| {
        let stated: Uncertain = stated[index].expect("the drive is long enough");
        let true_kg = true_kg[index] as f32;
        Uncertain {
            value: stated.value / true_kg,
            sigma: stated.sigma / true_kg,
        }
    };
    Ok(MassRow {
        truck: plan.truck,
        loads_kg: true_kg,
        file_factor: *file_factor,
        stated: [relative(0), relative(1)],
    })
}

/// Returns the table and the totals beside their bars.
#[must_use]
pub fn table(rows: &[MassRow]) -> String {
    let header = [
        "truck",
        "load t",
        "then t",
        "file over truth",
        "stated over truth after 10 km",
        "5 km after the stop",
    ];
    let stated = |of: Uncertain| format!("{:.3} ± {:.3}", of.value, of.sigma);
    let lines: Vec<Vec<String>> = rows
        .iter()
        .map(|row| {
            vec![
                row.truck.name().to_owned(),
                format!("{:.1}", 1e-3 * row.loads_kg[0]),
                format!("{:.1}", 1e-3 * row.loads_kg[1]),
                format!("{:.2}", row.file_factor),
                stated(row.stated[0]),
                stated(row.stated[1]),
            ]
        })
        .collect();
    let mut text = text_table(&header, &lines, 1).to_string();
    for (index, what) in ["after 10 km", "5 km after the stop"].iter().enumerate() {
        let Totals {
            rms,
            p90,
            nees,
            sigma,
        } = Totals::of(rows, index);
        let _ = write!(
            text,
            "\n\n{what}: rms {:.1} %, 90 % of drives within {:.1} %, mean sigma {:.1} %, NEES {nees:.2}; \
             bar {:.0} %",
            100.0 * rms,
            100.0 * p90,
            100.0 * sigma,
            100.0 * BARS[index],
        );
    }
    text
}

/// What drives have in common.
struct Totals {
    rms: f64,
    p90: f64,
    nees: f64,
    sigma: f64,
}

impl Totals {
    fn of(rows: &[MassRow], index: usize) -> Self {
        let count = rows.len().max(1) as f64;
        let error = |row: &MassRow| f64::from(row.stated[index].value) - 1.0;
        let sigma = |row: &MassRow| f64::from(row.stated[index].sigma);
        let mut sizes: Vec<f64> = rows.iter().map(|row| error(row).abs()).collect();
        sizes.sort_by(f64::total_cmp);
        let mean = |of: &dyn Fn(&MassRow) -> f64| rows.iter().map(of).sum::<f64>() / count;
        Self {
            rms: mean(&|row| error(row).powi(2)).sqrt(),
            p90: sizes.get(9 * sizes.len() / 10).copied().unwrap_or(0.0),
            nees: mean(&|row| (error(row) / sigma(row)).powi(2)),
            sigma: mean(&sigma),
        }
    }
}
