//! Trucks drawn at random, their vehicle file withheld: the estimate with the identified file against the
//! one with the right file.

use super::trucks::{Truck, simulate, without};
use super::vehicles::{identify, scores};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use test_kit::command::folder;

/// A drive that identifies a truck, m, and where the live estimate begins to count.
const LENGTH_M: f64 = 40_000.0;
const LEARNED_M: f64 = 10_000.0;
/// Mass (CVW), EC1 and its transport, gear (ETC2) and brakes (EBC5), which many buses do not have.
const LEFT_OUT: [&str; 5] = ["FE70", "ECFF", "EBFF", "F005", "FDC4"];
/// Largest error with the identified file over that with the right one: smoothed, and live.
const BARS: [f64; 2] = [1.2, 1.3];

/// Draws a truck of 9 to 60 t with 4 to 16 gears.
fn drawn(random: &mut ChaCha8Rng) -> Truck {
    let mass_kg = 9_000.0 * (60.0_f32 / 9.0).powf(random.random_range(0.0..1.0));
    let is_heavy = mass_kg > 18_000.0;
    let gears: i32 = [4, 6, 8, 9, 12, 14, 16][random.random_range(0..7)];
    let smallest = if random.random_bool(0.6) {
        1.0
    } else {
        random.random_range(0.7..0.83)
    };
    let spread = 3.9 + 0.75 * gears as f32;
    let wheel_radius_m = random.random_range(0.4..0.53);
    // Engine speed in the highest gear at 80 km/h.
    let cruising_rpm: f32 = if is_heavy {
        random.random_range(1_100.0..1_700.0)
    } else {
        random.random_range(1_500.0..2_000.0)
    };
    let turns_per_m = cruising_rpm * std::f32::consts::PI / 30.0 / (80.0 / 3.6);
    let nm_per_kg: f32 = if is_heavy {
        random.random_range(0.045..0.1)
    } else {
        random.random_range(0.07..0.16)
    };
    Truck {
        name: "drawn",
        mass_kg,
        drag_area_m2: random.random_range(if is_heavy { 4.8..7.0 } else { 3.8..6.2 }),
        rolling_resistance: random.random_range(0.0048..0.0075),
        wheel_radius_m,
        reference_torque_nm: (mass_kg * nm_per_kg).clamp(700.0, 3_500.0).round(),
        final_drive_ratio: turns_per_m * wheel_radius_m / smallest,
        ratios: (spread * smallest * random.random_range(0.85..1.1), smallest),
        gears,
    }
}

/// Runs `TRUCKS` trucks of seed `TRUCKS_SEED`; without these variables, one.
#[test]
fn estimates_of_drawn_trucks_are_as_good_as_with_the_right_file() {
    let of = |name: &str, usual: u64| {
        let text = std::env::var(name).ok();
        text.map_or(usual, |text| text.parse().expect("a number"))
    };
    let (trucks, seed) = (of("TRUCKS", 1), of("TRUCKS_SEED", 1));
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut missed = 0;
    for number in 0..trucks {
        let truck = drawn(&mut random);
        let folder = folder();
        let path = folder.path();
        simulate(path, &[&truck], LENGTH_M, false);
        without(path, "drawn.log", "bare.log", &LEFT_OUT);
        for log in ["drawn.log", "bare.log"] {
            identify(path, "found.toml", &[log]);
            let of = |vehicle: &str| scores(path, vehicle, log, "drawn", LEARNED_M);
            let (right, found) = (of("drawn.vehicle.toml"), of("found.toml"));
            let ratios = [0, 1].map(|estimate| found[estimate].0 / right[estimate].0);
            missed += u32::from(ratios.iter().zip(BARS).any(|(ratio, bar)| *ratio > bar));
            println!(
                "drawn,{number},{log},{:.0},{},{:.3},{:.2},{:.3},{:.2},{:.2},{:.2}",
                truck.mass_kg,
                truck.gears,
                right[0].0,
                ratios[0],
                right[1].0,
                ratios[1],
                found[0].1,
                found[1].1,
            );
        }
    }
    assert_eq!(missed, 0, "of {trucks} trucks with both logs");
}
