//! How a map improves with the number of runs in it (thesis section 6.3, figures 10 and 11).

pub mod curve;

use super::definition::{Setting, Study, StudyOutcome};
use super::distance_drive::{self, Belief, DistanceDrive, Disturbances};
use super::experiments::campaign::Campaign;
use super::experiments::heading::Heading;
use super::experiments::measure::rmse;
use crate::comparison::markov::Chain;
use crate::comparison::original::{self, NoiseSigmas};
use crate::comparison::{STEP_M, pointwise};
use crate::error::Result;
use crate::numeric::statistics::mean;
use crate::report::page::{Figure, Section, Table};
use crate::report::plot::{Mark, Plot, Series, colour};
use crate::simulator::random::{Purpose, normal, stream};
use crate::simulator::truck::Preset;
use crate::terminal::print::note;
use crate::terminal::progress;
use curve::{PowerLaw, floor_percent};
use estimator_core::VehicleParameters;
use rayon::prelude::*;
use std::time::Instant;

/// Standard deviation of the factors on mass, drag, rolling resistance and torque (section 4.3).
const PARAMETER_SIGMA: f64 = 0.2;
/// Limits of the factors, three standard deviations from 1. They keep the mass well above zero. Of
/// a thousand draws, about three are clamped.
const FACTOR_LIMITS: (f64, f64) = (0.4, 1.6);
/// Mean standard deviation of the pointwise error of vehicle A, runs 1-3 of tables 2 and 3, %.
pub const POINTWISE_SIGMA_PERCENT: f64 =
    (1.6817 + 1.6369 + 1.5805 + 1.6973 + 1.6426 + 1.6420) / 6.0;
/// Number of runs at the start of the curve to which N^-c is fitted, as in the thesis.
const FITTED: usize = 10;

/// The study, for the list.
pub const STUDY: Study = Study {
    name: "convergence",
    about: "RMSE of a map against the number of runs in it, 800 runs (figures 10 and 11)",
    run,
};

/// Extent of the simulation.
#[derive(Clone, Copy, Debug)]
pub struct Extent {
    /// Number of maps.
    pub sets: usize,
    /// Number of runs in each map.
    pub runs: usize,
}

/// The thesis's 800 runs.
pub const THESIS: Extent = Extent { sets: 20, runs: 40 };

/// Conditions that all runs share.
#[derive(Clone, Debug)]
pub struct Conditions {
    /// True grade every 2.5 m, %.
    pub grade_percent: Vec<f64>,
    /// The vehicle.
    pub vehicle: VehicleParameters,
    /// Noise of wheel speed, m/s.
    pub speed_noise_mps: f64,
    /// Errors of GPS altitude.
    pub chain: Chain,
    /// Seed of every random number.
    pub seed: u64,
}

/// Result of one set.
#[derive(Clone, Debug, PartialEq)]
pub struct Set {
    /// RMSE of the map after each run, %.
    pub rmse_percent: Vec<f64>,
    /// RMSE of each run alone, %.
    pub single_rmse_percent: Vec<f64>,
    /// Standard deviation of each run's pointwise error where the model holds, %.
    pub pointwise_sigma_percent: Vec<f64>,
}

impl Conditions {
    /// Returns the conditions for vehicle A on a road of these grades (%, every 2.5 m), with
    /// calibrated speed noise and measured GPS errors.
    ///
    /// Speed noise adds its variance to that of the pointwise error. Two drives with true
    /// parameters, one without speed noise and one with it, give both variances.
    #[must_use]
    pub fn calibrated(grade_percent: Vec<f64>, seed: u64) -> Self {
        const PROBE_MPS: f64 = 0.01;
        let mut conditions = Self {
            grade_percent,
            vehicle: Preset::A.parameters(),
            speed_noise_mps: 0.0,
            chain: Chain::measured(),
            seed,
        };
        let without = pointwise_sigma(&conditions.drive(0, &Belief::TRUTH, &[]));
        conditions.speed_noise_mps = PROBE_MPS;
        let with = pointwise_sigma(&conditions.drive(0, &Belief::TRUTH, &[]));
        let wanted = POINTWISE_SIGMA_PERCENT.powi(2) - without.powi(2);
        conditions.speed_noise_mps *= (wanted / (with.powi(2) - without.powi(2))).max(0.0).sqrt();
        conditions
    }

    fn drive(&self, index: usize, belief: &Belief, gps_m: &[f64]) -> DistanceDrive {
        let errors = Disturbances {
            speed_mps: self.speed_noise_mps,
            gps_m,
            ..Disturbances::default()
        };
        let mut rng = stream(self.seed, index, Purpose::Sensors);
        distance_drive::simulate(
            &self.grade_percent,
            &self.vehicle,
            belief,
            &errors,
            &mut rng,
        )
        .expect("the preset has an engine and a gearbox")
    }

    /// Returns a run with its own false parameters and errors.
    #[must_use]
    pub fn disturbed_drive(&self, index: usize) -> DistanceDrive {
        let mut rng = stream(self.seed, index, Purpose::Parameters);
        let mut factor =
            || (1.0 + PARAMETER_SIGMA * normal(&mut rng)).clamp(FACTOR_LIMITS.0, FACTOR_LIMITS.1);
        let belief = Belief {
            mass: factor(),
            drag: factor(),
            rolling: factor(),
            torque: factor(),
        };
        let mut rng = stream(self.seed, index, Purpose::Gnss);
        let gps_m = self.chain.generate(self.grade_percent.len(), &mut rng);
        self.drive(index, &belief, &gps_m)
    }

    /// Returns the RMSE (%) of the filter on an undisturbed run: no noise, no GPS error, true
    /// parameters.
    #[must_use]
    pub fn undisturbed_rmse(&self) -> f64 {
        let quiet = Self {
            speed_noise_mps: 0.0,
            ..self.clone()
        };
        let gps_m = vec![0.0; self.grade_percent.len()];
        let run = quiet.drive(0, &Belief::TRUTH, &gps_m);
        let profile = original::estimate(&run.drive, &NoiseSigmas::ORIGINAL);
        rmse(&self.grade_percent, &profile.grade_percent)
    }

    /// Simulates, estimates, smooths and fuses the runs of each set; calls `done` after each run.
    ///
    /// Sets are independent. Each set is summed in its own order, so the result does not depend on
    /// the number of threads.
    #[must_use]
    pub fn converge(&self, extent: Extent, done: impl Fn() + Sync) -> Vec<Set> {
        (0..extent.sets)
            .into_par_iter()
            .map(|set| self.converge_set(set * extent.runs, extent.runs, &done))
            .collect()
    }

    fn converge_set(&self, first: usize, runs: usize, done: &impl Fn()) -> Set {
        let points = self.grade_percent.len();
        // Sums of w g and of w, w = 1/P (section 3).
        let (mut sums, mut weights) = (vec![0.0; points], vec![0.0; points]);
        let mut set = Set {
            rmse_percent: Vec::with_capacity(runs),
            single_rmse_percent: Vec::with_capacity(runs),
            pointwise_sigma_percent: Vec::with_capacity(runs),
        };
        for index in first..first + runs {
            let run = self.disturbed_drive(index);
            set.pointwise_sigma_percent.push(pointwise_sigma(&run));
            let profile = original::estimate(&run.drive, &NoiseSigmas::ORIGINAL);
            let single = rmse(&self.grade_percent, &profile.grade_percent);
            set.single_rmse_percent.push(single);
            for k in 0..points {
                let weight = profile.sigma_percent[k].powi(-2);
                sums[k] += weight * profile.grade_percent[k];
                weights[k] += weight;
            }
            let map: Vec<f64> = sums.iter().zip(&weights).map(|(s, w)| s / w).collect();
            set.rmse_percent.push(rmse(&self.grade_percent, &map));
            done();
        }
        set
    }
}

/// Returns the standard deviation of the pointwise error where the model is valid, %.
fn pointwise_sigma(run: &DistanceDrive) -> f64 {
    let errors: Vec<f64> = pointwise::grade_percent(&run.drive)
        .iter()
        .zip(&run.true_grade_percent)
        .zip(&run.drive.points)
        .filter(|(_, point)| point.is_valid())
        .map(|((found, truth), _)| found - truth)
        .collect();
    let mu = mean(&errors);
    mean(&errors.iter().map(|e| (e - mu).powi(2)).collect::<Vec<_>>()).sqrt()
}

fn run(setting: &Setting) -> Result<StudyOutcome> {
    let road = Campaign::new(setting.seed).road(Heading::North).to_vec();
    let conditions = Conditions::calibrated(road, setting.seed);
    let total = THESIS.sets * THESIS.runs;
    let bar = progress::count(total as u64, "runs");
    let start = Instant::now();
    let sets = conditions.converge(THESIS, || bar.inc(1));
    bar.finish_and_clear();
    let seconds = start.elapsed().as_secs_f64();
    note(format_args!(
        "{total} runs in {seconds:.1} s: {:.1} runs/s on {} threads",
        total as f64 / seconds,
        rayon::current_num_threads()
    ));
    Ok(StudyOutcome::Done(section(&conditions, &sets)))
}

/// Returns the RMSE after each run, mean over sets.
fn mean_curve(sets: &[&Set]) -> Vec<f64> {
    let after = |n: usize| sets.iter().map(|set| set.rmse_percent[n]).sum::<f64>();
    (0..THESIS.runs)
        .map(|n| after(n) / sets.len() as f64)
        .collect()
}

/// Returns the standard error of the exponent, by the jackknife over sets.
fn exponent_sigma(sets: &[Set]) -> f64 {
    let without: Vec<f64> = (0..sets.len())
        .map(|left_out| {
            let others = sets.iter().enumerate().filter(|(k, _)| *k != left_out);
            let curve = mean_curve(&others.map(|(_, set)| set).collect::<Vec<_>>());
            PowerLaw::fit(&curve[..FITTED]).exponent
        })
        .collect();
    let (centre, n) = (mean(&without), without.len() as f64);
    ((n - 1.0) / n * without.iter().map(|c| (c - centre).powi(2)).sum::<f64>()).sqrt()
}

fn section(conditions: &Conditions, sets: &[Set]) -> Section {
    let mean_curve = mean_curve(&sets.iter().collect::<Vec<_>>());
    let law = PowerLaw::fit(&mean_curve[..FITTED]);
    let floor = floor_percent(&mean_curve, FITTED);
    let length_km = conditions.grade_percent.len() as f64 * STEP_M * 1e-3;
    Section {
        heading: "Convergence over many runs (section 6.3, figures 10 and 11)".to_owned(),
        words: vec![
            format!(
                "Vehicle A drives {length_km:.0} km northbound {} times, on a generated road in \
                 place of the thesis's measured one. In each run the assumed mass, drag, rolling \
                 resistance and torque are wrong by factors from N(1, 0.2), limited to three \
                 standard deviations. Wheel speed has white noise of {:.4} m/s, calibrated to the \
                 width of the pointwise errors of runs 1-3 in tables 2 and 3. GPS altitude has \
                 errors from the chain trained on the measured bus. The original filter, \
                 smoothed, estimates each run; maps are fused by 1/P.",
                THESIS.sets * THESIS.runs,
                conditions.speed_noise_mps
            ),
            "Some sets have a large first error, because the assumed torque of their first run is \
             too high and the assumed mass too low, by up to a factor of four between the two. \
             Normal factors of 0.2 allow such runs; experiments do not. The thesis calls them an \
             overestimation. The mean over the sets contains them, so the exponent depends on \
             which runs come first (the jackknife over sets shows how much). The median of the \
             runs does not."
                .to_owned(),
            "The error that remains with any number of runs is common to all runs: the filter's \
             low-pass, brakes and gear shifts at the same places of the road, and the mean grade \
             error of the random factors. Torque over mass is above one in the mean even if both \
             are one in the mean."
                .to_owned(),
        ],
        tables: vec![numbers(conditions, sets, &mean_curve, law, floor)],
        figures: vec![
            figure_10(sets, &mean_curve, law),
            figure_11(&mean_curve, law),
        ],
        ..Section::default()
    }
}

fn numbers(
    conditions: &Conditions,
    sets: &[Set],
    mean_curve: &[f64],
    law: PowerLaw,
    floor: f64,
) -> Table {
    let header = ["", "ours", "thesis"];
    let widths: Vec<f64> = sets
        .iter()
        .flat_map(|set| set.pointwise_sigma_percent.iter().copied())
        .collect();
    let row =
        |name: &str, ours: String, thesis: &str| vec![name.to_owned(), ours, thesis.to_owned()];
    let percent = |value: f64| format!("{value:.4}");
    let mut singles: Vec<f64> = sets
        .iter()
        .flat_map(|set| set.single_rmse_percent.iter().copied())
        .collect();
    singles.sort_by(f64::total_cmp);
    let wanted = percent(POINTWISE_SIGMA_PERCENT);
    let after = |n: usize| percent(mean_curve[n - 1]);
    Table::new(
        "convergence",
        "Mean over 20 sets. The thesis draws its curves and prints only the exponent; its single \
         runs of vehicle A are those of the experiments (tables 7 and 8).",
        &header,
    )
    .with_rows([
        row(
            "pointwise sigma of a run, mean, %",
            percent(mean(&widths)),
            &wanted,
        ),
        row(
            "exponent c over the first ten runs",
            format!("{:.2} ± {:.2}", law.exponent, exponent_sigma(sets)),
            "about 0.5",
        ),
        row(
            "RMSE of one run, median of all runs, %",
            percent(singles[singles.len() / 2]),
            "0.17 to 0.29",
        ),
        row("RMSE with 1 run, mean of the sets, %", after(1), "-"),
        row("RMSE with 10 runs, %", after(10), "-"),
        row("RMSE with 40 runs, %", after(THESIS.runs), "-"),
        row(
            "floor fitted to more than 10 runs, %",
            percent(floor),
            "above 0",
        ),
        row(
            "error of the filter with nothing wrong, %",
            percent(conditions.undisturbed_rmse()),
            "-",
        ),
    ])
}

fn by_number(rmse_percent: &[f64]) -> impl Iterator<Item = (f64, f64)> {
    (1..).map(f64::from).zip(rmse_percent.iter().copied())
}

fn figure_10(sets: &[Set], mean_curve: &[f64], law: PowerLaw) -> Figure {
    let mut plot = Plot::new("runs in the map", "RMSE (% grade)");
    plot.height = 480;
    for (k, set) in sets.iter().enumerate() {
        let name = if k == 0 { "each set" } else { "" };
        plot = plot.with(Series::line(
            name,
            colour::GREY,
            by_number(&set.rmse_percent),
        ));
    }
    let fitted = (1..=THESIS.runs).map(|n| (n as f64, law.at(n)));
    plot = plot
        .with(Series::line("mean", colour::BLUE, by_number(mean_curve)))
        .with(Series::line("fitted to 1-10", colour::ORANGE, fitted).drawn(Mark::Dashed));
    Figure::new(
        "convergence_10",
        &plot,
        format!(
            "Figure 10: RMSE of the map after each run, 20 sets of 40 runs, and {:.3} N^-{:.3} \
             fitted to the first ten of their mean.",
            law.first_percent, law.exponent
        ),
    )
}

fn figure_11(mean_curve: &[f64], law: PowerLaw) -> Figure {
    let log = |(x, y): (f64, f64)| (x.log10(), y.log10());
    let fitted = (1..=THESIS.runs).map(|n| log((n as f64, law.at(n))));
    let theory = [1, THESIS.runs].map(|n| log((n as f64, law.first_percent / (n as f64).sqrt())));
    let plot = Plot::new(
        "logarithm (base 10) of the runs in the map",
        "logarithm of RMSE (% grade)",
    )
    .with(Series::line("N^-0.5", colour::GREY, theory))
    .with(Series::line(
        "mean",
        colour::BLUE,
        by_number(mean_curve).map(log),
    ))
    .with(Series::line("fitted to 1-10", colour::ORANGE, fitted).drawn(Mark::Dashed));
    Figure::new(
        "convergence_11",
        &plot,
        "Figure 11: the same with both axes logarithmic, and the theoretical slope of -0.5.",
    )
}
