//! The oracle file of a simulated run: the true vehicle and the true noise levels.

use super::recording::Recording;
use super::surroundings_file::Wind;
use crate::files::oracle::{
    ColdTyres, Headwind, LONGEST_TIME_S, OracleFile, OracleNoise, SlowAltitude,
};
use crate::files::vehicle::VehicleFile;
use crate::numeric::rounding::round;
use estimator_core::Model;

/// Time between two samples of the course of the road, s.
const COURSE_STEP_S: f64 = 1.0;

impl Recording<'_> {
    /// Returns the true vehicle and noise levels of this run.
    ///
    /// Faults of the GNSS receiver (steps, ramps, outages) are events, not noise, and are not
    /// included. Rounding on the bus is negligible.
    #[must_use]
    pub fn oracle(&self) -> OracleFile {
        let scenario = self.scenario;
        let run = &scenario.runs[self.index];
        let gnss = &scenario.gnss;
        let tyres = scenario.tyres;
        let cold_amount = tyres.cold_amount * (-run.tyres_driven_s / tyres.cold_time_s).exp();
        OracleFile {
            vehicle: VehicleFile {
                name: run.vehicle.name.clone(),
                model: Model {
                    vehicle: run.true_parameters.clone(),
                    effects: run.vehicle.model.effects.clone(),
                },
            },
            noise: OracleNoise {
                speed_sigma_mps: scenario.noise.speed_sigma_mps,
                gnss_white_sigma_m: gnss.altitude_white_sigma_m,
                gnss_latency_s: 1e-3 * scenario.latency_ms.gnss,
                force_white_sigma_n: 0.0,
                gnss_slow: SlowAltitude {
                    sigma_m: gnss.altitude_sigma_m,
                    time_s: gnss.altitude_time_s,
                },
                force_slow: None,
                headwind: self.headwind(&run.wind),
                cold_tyres: (tyres.cold_amount > 0.0).then_some(ColdTyres {
                    amount: cold_amount,
                    time_s: tyres.cold_time_s,
                }),
            },
        }
    }

    /// Returns the steady headwind along the road and the gusts as one process with the same
    /// variance and rate of change. The steady part changes where the road bends.
    fn headwind(&self, wind: &Wind) -> Option<Headwind> {
        let samples = (self.drive.duration_s() / COURSE_STEP_S) as usize + 1;
        let from_rad = wind.from_deg.to_radians();
        let steady: Vec<f64> = (0..samples)
            .map(|sample| {
                let place_m = self.drive.at(sample as f64 * COURSE_STEP_S).distance_m;
                wind.speed_mps * (from_rad - self.drive.road.course_rad(place_m)).cos()
            })
            .collect();
        let gusts = wind.gust_sigma_mps * wind.gust_sigma_mps;
        let variance = mean_square(steady.iter().copied()) + gusts;
        // Mean squared change over half of the run, as that of a random walk.
        let half = (samples / 2).max(1);
        let changes = steady.iter().zip(&steady[half.min(samples)..]);
        let change = mean_square(changes.map(|(before, after)| after - before));
        let per_s = change / (2.0 * half as f64 * COURSE_STEP_S) + gusts / wind.gust_time_s;
        (variance > 0.0).then(|| Headwind {
            sigma_mps: round(variance.sqrt(), 3),
            time_s: round((variance / per_s).min(LONGEST_TIME_S), 1),
        })
    }
}

fn mean_square(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0.0), |(sum, n), value| (sum + value * value, n + 1.0));
    sum / f64::max(count, 1.0)
}
