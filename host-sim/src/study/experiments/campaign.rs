//! A replica of each experiment: a simulated drive with errors as the thesis reports them.
//!
//! Two numbers of each run are fitted to tables 2 and 3. A constant model error gives the mean
//! pointwise error; noise on wheel speed gives its RMSE. Everything else follows from the text of
//! the thesis or from physics, and is the same for every run of a truck. The first version took GPS
//! errors from a process of 3 m over 300 s; the trained chain has replaced it. The rest is
//! unchanged.

use super::experiment::Experiment;
use super::heading::Heading;
use super::measure;
use super::replica::{Fitted, Replica, Sources};
use crate::comparison::markov::Chain;
use crate::comparison::{G, STEP_M, pointwise};
use crate::simulator::driver::SET_SPEED_MPS;
use crate::simulator::random::{OrnsteinUhlenbeck, Purpose, stream};
use crate::simulator::road_generator::{RoadShape, generate};
use crate::study::distance_drive::{Belief, Disturbances, simulate};
use estimator_core::vehicle::STANDARD_AIR_DENSITY;
use rayon::prelude::*;

/// Length of either road, m. It includes the GPS error at 42 km.
pub const LENGTH_M: f64 = 47_000.0;
/// Standard length of a large GPS error, which has the shape of a bump, m.
const BUMP_M: f64 = 200.0;
/// Wind along the road: standard deviation, m/s, and correlation length, m ("slow").
const WIND: (f64, f64) = (1.5, 2_000.0);
/// Cold tyres: rolling resistance above its final value, as a fraction of it, and the distance over
/// which that excess falls to 1/e, m.
const COLD_TYRES: (f64, f64) = (0.5, 15_000.0);
/// Rounds of fitting; the mean and the RMSE hardly depend on each other.
const ROUNDS: usize = 4;

/// The two roads, and the experiments on them.
#[derive(Clone, Debug)]
pub struct Campaign {
    seed: u64,
    south: Vec<f64>,
    north: Vec<f64>,
}

impl Campaign {
    /// Creates the roads of a seed.
    #[must_use]
    pub fn new(seed: u64) -> Self {
        let road = |seed| {
            let shape = RoadShape {
                length_m: LENGTH_M,
                ..RoadShape::default()
            };
            let road = generate(&shape, seed);
            let points = (LENGTH_M / STEP_M) as usize;
            (0..points)
                .map(|k| 100.0 * road.grade(k as f64 * STEP_M))
                .collect()
        };
        Self {
            seed,
            south: road(seed),
            north: road(seed.wrapping_add(1)),
        }
    }

    /// Creates a campaign on one road, southbound in the order of its points and northbound against
    /// it. `southbound` has the true grade every 2.5 m, %.
    #[must_use]
    pub fn on(southbound: Vec<f64>, seed: u64) -> Self {
        Self {
            seed,
            north: southbound.iter().rev().map(|grade| -grade).collect(),
            south: southbound,
        }
    }

    /// Returns the true grade in a direction, %.
    #[must_use]
    pub fn road(&self, heading: Heading) -> &[f64] {
        match heading {
            Heading::South => &self.south,
            Heading::North => &self.north,
        }
    }

    /// Returns the ten experiments, fitted and driven.
    #[must_use]
    pub fn replicas(&self) -> Vec<Replica> {
        Experiment::all()
            .into_par_iter()
            .map(|experiment| self.fit(experiment))
            .collect()
    }

    /// Returns one run with its fitted numbers, with each disturbance scaled by its factor.
    #[must_use]
    pub fn drive(&self, experiment: Experiment, fitted: Fitted, sources: Sources) -> Replica {
        let truth = self.road(experiment.heading);
        let truck = experiment.preset().parameters();
        let mut gps = self.gps_error_m(experiment);
        gps.iter_mut().for_each(|error_m| *error_m *= sources.gps);
        let model = self.model_error_percent(experiment, fitted, sources);
        let belief = Belief {
            torque: 1.0 + sources.torque * (experiment.belief().torque - 1.0),
            ..Belief::TRUTH
        };
        let errors = Disturbances {
            speed_mps: sources.speed * fitted.speed_mps,
            gps_m: &gps,
            model_percent: &model,
        };
        let mut rng = stream(self.seed, experiment.index(), Purpose::Sensors);
        let run = simulate(truth, &truck, &belief, &errors, &mut rng)
            .expect("both presets have an engine, and the roads have points");
        Replica {
            experiment,
            fitted,
            drive: run.drive,
            truth: run.true_grade_percent,
        }
    }

    /// Fits a constant to the run's mean error and speed noise to its RMSE.
    fn fit(&self, experiment: Experiment) -> Replica {
        let [mu, _, rmse] = experiment.pointwise();
        let mut fitted = Fitted {
            constant_percent: 0.0,
            speed_mps: 0.01,
        };
        let found = |fitted, sources| {
            let run = self.drive(experiment, fitted, sources);
            measure::errors(&run, &pointwise::grade_percent(&run.drive))
        };
        for _ in 0..ROUNDS {
            let all = found(fitted, Sources::ALL);
            let silent = Sources {
                speed: 0.0,
                ..Sources::ALL
            };
            let rest = found(fitted, silent).sigma.powi(2);
            // The part of the mean square error due to speed noise: now, and as it should be.
            let now = all.sigma.powi(2) - rest;
            let wanted = rmse * rmse - mu * mu - rest;
            fitted.speed_mps *= (wanted / now).sqrt();
            fitted.constant_percent += mu - all.mu;
        }
        self.drive(experiment, fitted, Sources::ALL)
    }

    /// Returns the GPS altitude error at each point, m: from the chain of section 5, trained on
    /// measured errors, and the large errors that the thesis shows.
    fn gps_error_m(&self, experiment: Experiment) -> Vec<f64> {
        let mut rng = stream(self.seed, experiment.index(), Purpose::Gnss);
        let mut error_m = Chain::measured().generate(self.road(experiment.heading).len(), &mut rng);
        for (k, error) in error_m.iter_mut().enumerate() {
            for (centre_m, height_m) in experiment.gps_bumps() {
                let away = (k as f64 * STEP_M - centre_m) / BUMP_M;
                *error += height_m * (-0.5 * away * away).exp();
            }
        }
        error_m
    }

    /// Returns the error of the vehicle model at each point, %.
    fn model_error_percent(
        &self,
        experiment: Experiment,
        fitted: Fitted,
        sources: Sources,
    ) -> Vec<f64> {
        let truck = experiment.preset().parameters();
        let weight_n = f64::from(truck.mass_kg) * G;
        let air = 0.5 * f64::from(STANDARD_AIR_DENSITY) * f64::from(truck.drag_area_m2);
        let mut rng = stream(self.seed, experiment.index(), Purpose::Parameters);
        let mut wind = OrnsteinUhlenbeck::new(WIND.0, WIND.1, &mut rng);
        (0..self.road(experiment.heading).len())
            .map(|k| {
                let against_mps = sources.wind * wind.advance(STEP_M, &mut rng);
                let force_n = air * against_mps * (2.0 * SET_SPEED_MPS + against_mps);
                let mut error = sources.constant * fitted.constant_percent;
                error += 100.0 * force_n / weight_n;
                if experiment.is_morning() {
                    let left = (-(k as f64) * STEP_M / COLD_TYRES.1).exp();
                    let cold = COLD_TYRES.0 * f64::from(truck.rolling_resistance) * left;
                    error += 100.0 * sources.warm_up * cold;
                }
                error
            })
            .collect()
    }
}
