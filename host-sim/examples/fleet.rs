//! Writes a fleet's runs over one road, to measure fusion with:
//!
//! ```text
//! cargo run --profile dist -p host-sim --example fleet -- FOLDER CELLS [SEED [KM]]
//! roadgrade fuse --out map.parquet --road FOLDER/road.csv FOLDER/runs
//! roadgrade fuse --out map.parquet --road FOLDER/network.geojson FOLDER/runs
//! ```
//!
//! The road winds over 100 km (or KM), 40,001 cells. A truck drives it ten times a day, once without saying
//! that it is the same session; of the error of a run a part is its truck's on that day, the rest
//! its own and slow, as fusion expects it. What fusion does not read is the same in all cells: it
//! takes no time, and no room on the disk.

#[path = "fleet/network.rs"]
mod network;

use host_sim::files::csv::write_csv;
use host_sim::files::data_set;
use host_sim::files::run::{Origin, RunRow, write_from};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use rayon::prelude::*;
use std::error::Error;
use std::path::Path;

const STEP_M: f64 = 2.5;
const CELLS_A_KM: usize = 400;
const RUNS_A_SESSION: usize = 10;
const DAYS: usize = 28;

/// One cell of the road as it is.
#[derive(Clone, Copy, serde::Serialize)]
struct FleetSpot {
    distance_m: f64,
    latitude_deg: f64,
    longitude_deg: f64,
    altitude_m: f64,
    grade_percent: f64,
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let (folder, cells, seed, km) = match &arguments[..] {
        [folder, cells] => (folder, cells, 1, 100),
        [folder, cells, seed] => (folder, cells, seed.parse()?, 100),
        [folder, cells, seed, km] => (folder, cells, seed.parse()?, km.parse()?),
        _ => return Err("expected FOLDER CELLS [SEED [KM]]".into()),
    };
    let folder = Path::new(folder);
    let road = road(km * CELLS_A_KM + 1);
    write_csv(&folder.join("road.csv"), road.iter())?;
    let network = network::geojson(&road).to_string();
    std::fs::write(folder.join("network.geojson"), network)?;
    let runs = cells.parse::<usize>()?.div_ceil(road.len());
    (0..runs).into_par_iter().try_for_each(|number| {
        let (truck, day) = (number / RUNS_A_SESSION, number / RUNS_A_SESSION % DAYS + 1);
        let day = format!("2026-11-{day:02}");
        let is_last = number % RUNS_A_SESSION == RUNS_A_SESSION - 1;
        let origin = Origin {
            vehicle: Some(format!("truck {truck:04}")),
            day: (!is_last).then(|| day.clone()),
            ..Origin::default()
        };
        let rows = run(&road, seed, truck as u64, number as u64);
        let name = format!("truck{truck:04}-{:02}", number % RUNS_A_SESSION);
        let path = data_set::run_path(&folder.join("runs"), &mut &rows[..], &day, &name)?;
        write_from(&path, &rows, &origin)
    })?;
    eprintln!("{runs} runs of {} cells", road.len());
    Ok(())
}

fn road(cells: usize) -> Vec<FleetSpot> {
    const EARTH_M: f64 = 6_371_000.0;
    let mut spot = FleetSpot {
        distance_m: 0.0,
        latitude_deg: 47.4,
        longitude_deg: 8.1,
        altitude_m: 400.0,
        grade_percent: 0.0,
    };
    let mut spots = Vec::with_capacity(cells);
    for i in 0..cells {
        spot.distance_m = i as f64 * STEP_M;
        spot.grade_percent =
            3.0 * (spot.distance_m / 300.0).sin() + 1.5 * (spot.distance_m / 1700.0).cos();
        spots.push(spot);
        let course = (60.0 + 50.0 * (spot.distance_m / 900.0).sin()).to_radians();
        let (north, east) = (
            STEP_M * course.cos() / EARTH_M,
            STEP_M * course.sin() / EARTH_M,
        );
        spot.latitude_deg += north.to_degrees();
        spot.longitude_deg += east.to_degrees() / spot.latitude_deg.to_radians().cos();
        spot.altitude_m += STEP_M * spot.grade_percent / 100.0;
    }
    spots
}

/// Noise of unit variance that forgets over this distance, m.
fn slow(rng: &mut ChaCha8Rng, length_m: f64) -> impl Iterator<Item = f64> {
    let keep = (-STEP_M / length_m).exp();
    let fresh = (1.0 - keep * keep).sqrt();
    let mut state: f64 = StandardNormal.sample(rng);
    StandardNormal.sample_iter(rng).map(move |white: f64| {
        state = keep * state + fresh * white;
        state
    })
}

fn run(road: &[FleetSpot], seed: u64, truck: u64, number: u64) -> Vec<RunRow> {
    let random = |stream: u64| {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        rng.set_stream(stream);
        rng
    };
    // Streams of trucks and of runs do not meet.
    let errors = |stream: u64, length_m: f64| -> Vec<f64> {
        slow(&mut random(stream), length_m)
            .take(road.len())
            .collect()
    };
    let common = errors(truck << 1, 1000.0);
    let own = errors(number << 3 | 1, 1000.0);
    let east = errors(number << 3 | 3, 80.0);
    let north = errors(number << 3 | 5, 80.0);
    let height = errors(number << 3 | 7, 1000.0);
    (0..road.len())
        .map(|i| {
            let spot = &road[i];
            let grade_sigma_percent = 0.1 + (30.0 * (spot.distance_m / 5e3).sin()).round() * 1e-3;
            let error = 0.5 * common[i] + 0.75_f64.sqrt() * own[i];
            let grade_percent = spot.grade_percent + grade_sigma_percent * error;
            RunRow {
                time_s: 0.0,
                distance_m: spot.distance_m,
                latitude_deg: Some(spot.latitude_deg + 1.5e-5 * north[i]),
                longitude_deg: Some(spot.longitude_deg + 2.0e-5 * east[i]),
                altitude_m: Some(spot.altitude_m + 1.2 * height[i]),
                altitude_sigma_m: Some(1.2),
                grade_percent,
                grade_sigma_percent,
                lagged_grade_percent: 0.0,
                lagged_grade_sigma_percent: 1.0,
                live_grade_percent: 0.0,
                live_grade_sigma_percent: 1.0,
                speed_mps: 20.0,
                bias_percent: 0.0,
                scale: 1.0,
                valid: 1,
                mass_kg: Some(12_000.0),
                mass_sigma_kg: Some(500.0),
                consistent: 1,
                lagged_consistent: 1,
                live_consistent: 1,
                map_grade_percent: None,
                map_grade_sigma_percent: None,
            }
        })
        .collect()
}
