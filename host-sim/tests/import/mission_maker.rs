//! Makes missions in the form of the ZTBus files: a bus that drives along lines on a plane.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::f64::consts::TAU;
use std::fmt::Write;

pub const HEADER: &str = "time_iso,time_unix,electric_powerDemand,gnss_altitude,gnss_course,\
    gnss_latitude,gnss_longitude,itcs_busRoute,itcs_numberOfPassengers,itcs_stopName,\
    odometry_vehicleSpeed,status_haltBrakeIsActive,status_parkBrakeIsActive,\
    temperature_ambient,traction_brakePressure,traction_tractionForce";

/// A position east and north, m.
pub type Point = (f64, f64);

const EARTH_M: f64 = 6_371_000.0;
const ORIGIN_RAD: Point = (0.826, 0.148);
const LANE_M: f64 = 3.0;

pub struct MissionMaker {
    text: String,
    random: ChaCha8Rng,
    seconds: u32,
    first_fix_s: u32,
    at: Point,
    heading: Point,
}

impl MissionMaker {
    /// Creates a bus that stands at `at`. Its receiver has the first fix after `first_fix_s`.
    pub fn new(at: Point, first_fix_s: u32) -> Self {
        Self {
            text: format!("{HEADER}\n"),
            random: ChaCha8Rng::seed_from_u64(7),
            seconds: 0,
            first_fix_s,
            at,
            heading: (1.0, 0.0),
        }
    }

    /// Stands still, and reports the number of passengers at the end.
    pub fn wait(mut self, seconds: u32, passengers: u32) -> Self {
        for second in 1..=seconds {
            let count = (second == seconds).then_some(passengers);
            self.row(0.0, count);
        }
        self
    }

    /// Drives along straight lines to the last of `corners` without a stop.
    pub fn drive(mut self, corners: &[Point]) -> Self {
        let mut line = vec![self.at];
        line.extend(corners);
        let length_m: f64 = line
            .windows(2)
            .map(|ends| distance_m(ends[0], ends[1]))
            .sum();
        let (mut driven_m, mut speed_mps) = (0.0, 0.0_f64);
        while length_m - driven_m > 0.2 {
            let braking_mps = (2.0 * 0.8 * (length_m - driven_m)).sqrt() - 0.4;
            let next_mps = (speed_mps + 1.0).min(braking_mps).clamp(0.1, 11.0);
            driven_m = length_m.min(driven_m + 0.5 * (speed_mps + next_mps));
            speed_mps = next_mps;
            (self.at, self.heading) = along(&line, driven_m);
            self.row(speed_mps, None);
        }
        self.wait(1, 0)
    }

    pub fn text(self) -> String {
        self.text
    }

    fn row(&mut self, speed_mps: f64, passengers: Option<u32>) {
        let mut noise_m = || self.random.random_range(-5.0..5.0);
        let east_m = self.at.0 + LANE_M * self.heading.1 + noise_m();
        let north_m = self.at.1 - LANE_M * self.heading.0 + noise_m();
        let fix = if self.seconds < self.first_fix_s {
            "NaN,NaN,NaN,NaN".to_owned()
        } else {
            format!(
                "{:.2},{:.4},{:.7},{:.7}",
                400.0 + 0.02 * self.at.0,
                self.heading.0.atan2(self.heading.1).rem_euclid(TAU),
                ORIGIN_RAD.0 + north_m / EARTH_M,
                ORIGIN_RAD.1 + east_m / (EARTH_M * ORIGIN_RAD.0.cos()),
            )
        };
        let count = passengers.map_or("NaN".to_owned(), |n| n.to_string());
        let stands = speed_mps == 0.0;
        writeln!(
            self.text,
            "\"2021-07-26T03:53:27Z\",{},1594.8,{fix},\"-\",{count},\"-\",{speed_mps:.5},{},0,\
             295.15,{},{}",
            1_600_000_000 + self.seconds,
            u8::from(stands),
            if stands { 240_000 } else { 0 },
            if stands { "-0" } else { "2500.5" },
        )
        .unwrap();
        self.seconds += 1;
    }
}

fn distance_m(a: Point, b: Point) -> f64 {
    (a.0 - b.0).hypot(a.1 - b.1)
}

fn along(line: &[Point], driven_m: f64) -> (Point, Point) {
    let mut left_m = driven_m;
    for (index, ends) in line.windows(2).enumerate() {
        let length_m = distance_m(ends[0], ends[1]);
        if left_m <= length_m || index + 2 == line.len() {
            let heading = (
                (ends[1].0 - ends[0].0) / length_m,
                (ends[1].1 - ends[0].1) / length_m,
            );
            let at = (
                ends[0].0 + left_m * heading.0,
                ends[0].1 + left_m * heading.1,
            );
            return (at, heading);
        }
        left_m -= length_m;
    }
    unreachable!("a line has at least two points")
}
