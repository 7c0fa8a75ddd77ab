//! Roads whose grade is known by formula, and runs over them.

pub mod network;

use host_sim::files::run::RunRow;
use host_sim::map::{self, Fusion, Network, RoadPoint, RoadRow, SessionRun};
use map_3d::Ellipsoid::WGS84;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

const ORIGIN_DEG: (f64, f64) = (47.4, 8.5);
const ALTITUDE_M: f64 = 400.0;
const STEP_M: f64 = 2.5;

/// One point of a drive.
#[derive(Clone, Copy, Debug)]
pub struct Spot {
    pub distance_m: f64,
    pub east_m: f64,
    pub north_m: f64,
    pub altitude_m: f64,
    pub grade_percent: f64,
}

impl Spot {
    pub fn latitude_longitude_deg(&self) -> (f64, f64) {
        let (latitude, longitude) = (ORIGIN_DEG.0.to_radians(), ORIGIN_DEG.1.to_radians());
        // Lengths are driven at the road's altitude, not on the ellipsoid.
        let (latitude, longitude, _) = map_3d::enu2geodetic(
            self.east_m,
            self.north_m,
            self.altitude_m - ALTITUDE_M,
            latitude,
            longitude,
            ALTITUDE_M,
            WGS84,
        );
        (latitude.to_degrees(), longitude.to_degrees())
    }
}

/// Returns a drive from `(east, north)`. The functions return the compass course (deg) and the
/// grade (%) for each driven distance (m along the slope).
pub fn drive(
    from_m: (f64, f64),
    length_m: f64,
    course_deg: impl Fn(f64) -> f64,
    grade_percent: impl Fn(f64) -> f64,
) -> Vec<Spot> {
    const PARTS: usize = 25;
    let part_m = STEP_M / PARTS as f64;
    let mut spot = Spot {
        distance_m: 0.0,
        east_m: from_m.0,
        north_m: from_m.1,
        altitude_m: ALTITUDE_M,
        grade_percent: grade_percent(0.0),
    };
    let mut spots = vec![spot];
    for i in 1..=(length_m / STEP_M) as usize {
        for part in 0..PARTS {
            let middle_m = spot.distance_m + (part as f64 + 0.5) * part_m;
            let course = course_deg(middle_m).to_radians();
            let slope = (grade_percent(middle_m) / 100.0).atan();
            spot.east_m += part_m * slope.cos() * course.sin();
            spot.north_m += part_m * slope.cos() * course.cos();
            spot.altitude_m += part_m * slope.sin();
        }
        spot.distance_m = i as f64 * STEP_M;
        spot.grade_percent = grade_percent(spot.distance_m);
        spots.push(spot);
    }
    spots
}

/// Returns a drive of 6 km with bends of 1.1 km radius and hills of 3 %.
pub fn hills() -> Vec<Spot> {
    drive(
        (0.0, 0.0),
        6000.0,
        |s| 40.0 + 40.0 * (s / 800.0).sin(),
        hill_percent,
    )
}

pub fn hill_percent(distance_m: f64) -> f64 {
    3.0 * (distance_m / 300.0).sin()
}

/// Returns the drive in the opposite direction.
pub fn reversed(spots: &[Spot]) -> Vec<Spot> {
    let end_m = spots[spots.len() - 1].distance_m;
    spots
        .iter()
        .rev()
        .map(|spot| Spot {
            distance_m: end_m - spot.distance_m,
            grade_percent: -spot.grade_percent,
            ..*spot
        })
        .collect()
}

/// Returns the drive moved as a whole.
pub fn moved(spots: &[Spot], east_m: f64, north_m: f64) -> Vec<Spot> {
    spots
        .iter()
        .map(|spot| Spot {
            east_m: spot.east_m + east_m,
            north_m: spot.north_m + north_m,
            ..*spot
        })
        .collect()
}

/// Returns a run without errors over these spots at 20 m/s, with a stated sigma of 0.1 %.
pub fn run(spots: &[Spot]) -> Vec<RunRow> {
    spots
        .iter()
        .map(|spot| {
            let (latitude_deg, longitude_deg) = spot.latitude_longitude_deg();
            RunRow {
                time_s: spot.distance_m / 20.0,
                distance_m: spot.distance_m,
                latitude_deg: Some(latitude_deg),
                longitude_deg: Some(longitude_deg),
                altitude_m: Some(spot.altitude_m),
                altitude_sigma_m: Some(1.0),
                grade_percent: spot.grade_percent,
                grade_sigma_percent: 0.1,
                lagged_grade_percent: spot.grade_percent,
                lagged_grade_sigma_percent: 0.1,
                live_grade_percent: spot.grade_percent,
                live_grade_sigma_percent: 0.1,
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

/// Returns the road under these spots, with its grade.
pub fn road(spots: &[Spot]) -> Vec<RoadRow> {
    spots
        .iter()
        .map(|spot| {
            let (latitude_deg, longitude_deg) = spot.latitude_longitude_deg();
            RoadRow {
                distance_m: spot.distance_m,
                latitude_deg,
                longitude_deg,
                altitude_m: Some(spot.altitude_m),
                grade_percent: Some(spot.grade_percent),
            }
        })
        .collect()
}

pub fn points(spots: &[Spot]) -> Vec<RoadPoint> {
    road(spots).iter().map(RoadRow::point).collect()
}

/// Adds to the positions an error of `sigma_m` in east and north with correlation length `fade_m`.
pub fn with_position_noise(spots: &[Spot], sigma_m: f64, fade_m: f64, seed: u64) -> Vec<Spot> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let keep = (-STEP_M / fade_m).exp();
    let mut draw = move || -> f64 { StandardNormal.sample(&mut random) };
    let mut error = [sigma_m * draw(), sigma_m * draw()];
    spots
        .iter()
        .map(|spot| {
            for value in &mut error {
                *value = keep * *value + sigma_m * (1.0 - keep * keep).sqrt() * draw();
            }
            Spot {
                east_m: spot.east_m + error[0],
                north_m: spot.north_m + error[1],
                ..*spot
            }
        })
        .collect()
}

/// Fuses runs, each a session of its own.
pub fn fuse<'a>(road: &'a Network, runs: &[&[RunRow]]) -> Fusion<'a> {
    let runs: Vec<SessionRun> = runs.iter().map(|rows| alone(rows)).collect();
    map::fuse(road, &runs)
}

/// Returns a run as a session of its own.
pub fn alone(rows: &[RunRow]) -> SessionRun<'_> {
    SessionRun {
        session: None,
        rows,
    }
}
