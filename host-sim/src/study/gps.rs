//! The error of GNSS altitude as a Markov chain: training, and verification of the series that it
//! generates (thesis section 5).

pub mod errors;

use super::definition::{Setting, Study, StudyOutcome};
use super::distance_drive::{self, Belief, Disturbances};
use super::experiments::measure::rmse;
use crate::comparison::STEP_M;
use crate::comparison::markov::{BIN_M, Chain, STATES, centred, error_of};
use crate::comparison::original::{self, NoiseSigmas};
use crate::error::Result;
use crate::report::page::{Figure, Section, Table};
use crate::report::plot::{Mark, Plot, Series, colour};
use crate::simulator::random::{Purpose, stream};
use crate::simulator::road_generator::{RoadShape, generate};
use crate::simulator::truck::Preset;

/// Header comment of the committed chain.
pub const ORIGIN: &str = "\
Transitions between errors of GNSS altitude over 2.5 m of way at 80 km/h, counted.
Trained on one mission of the ZTBus data set (F. Widmer, A. Ritter, C. H. Onder, Scientific Data
10:687, 2023; CC BY 4.0): bus 183, 2021-07-26, six passes, each less the mean over the passes in
its direction. Made by host-sim/src/study/gps; host-sim/tests/simulator/gps_chain.rs compares.";

/// Lengths over which an altitude error is converted to a grade error, m.
const GRADE_BASES_M: [f64; 3] = [500.0, 1_250.0, 3_000.0];
/// Distances at which the autocorrelation is listed, m.
const LAGS_M: [f64; 3] = [100.0, 500.0, 1_250.0];
/// Longest distance of the autocorrelation plot, m.
const LONGEST_LAG_M: f64 = 3_000.0;
/// Noise of wheel speed in the drives of the verification, m/s.
const SPEED_NOISE_MPS: f64 = 0.013;

/// The study, for the list.
pub const STUDY: Study = Study {
    name: "gps",
    about: "GPS altitude error as a Markov chain, trained and verified (section 5)",
    run,
};

/// One source of errors, and the series of its chain.
struct ErrorSource {
    /// Name in words.
    name: &'static str,
    /// Name in names of files.
    key: &'static str,
    /// Series that the chain was trained on; empty if they are not available.
    training: Vec<Vec<f64>>,
    /// The same number of generated series.
    generated: Vec<Vec<f64>>,
    chain: Chain,
}

fn run(setting: &Setting) -> Result<StudyOutcome> {
    let mut words = vec![
        "Sixty-one states stand for -15 m to +15 m in steps of 0.5 m; one step is a distance of \
         2.5 m at 80 km/h. Each run's mean is removed, its errors are rounded to states, \
         transitions are counted and each row is normalised. The printed formula divides by a \
         column's sum, which gives no probabilities; the text next to it does. A state without \
         transitions goes one step towards no error. A series starts in a state drawn from the \
         frequencies of the training, and passes two moving means of 150 m."
            .to_owned(),
    ];
    let mut sources = Vec::new();
    match errors::of_data(&setting.data)? {
        Some(training) => sources.push(ErrorSource::new(
            "measured bus",
            "measured",
            &training,
            setting.seed,
        )),
        None => words.push(format!(
            "No measured mission in {}/ztbus: of the measured errors only the committed chain is \
             shown.",
            setting.data.display()
        )),
    }
    if sources.is_empty() {
        sources.push(ErrorSource::committed(setting.seed));
    }
    sources.push(ErrorSource::new(
        "simulator",
        "simulated",
        &errors::simulated(setting.seed),
        setting.seed,
    ));
    words.push(
        "A chain with a memory of one step does not distinguish a rise from a fall. The measured \
         error keeps its direction for some seconds, so its chain has too little grade error over \
         500 m. The simulator's error changes by less than half a metre a step; rounding makes \
         that too much. The thesis found its chain to be pessimistic; ours of the measured bus is \
         not. It depends on how fast the errors of the training change."
            .to_owned(),
    );
    let mut figures = Vec::new();
    for source in &sources {
        figures.extend(source.figures());
    }
    Ok(StudyOutcome::Done(Section {
        heading: "GPS altitude error as a Markov chain (section 5)".to_owned(),
        words,
        tables: vec![statistics(&sources), effect(&sources, setting.seed)],
        figures,
        ..Section::default()
    }))
}

impl ErrorSource {
    fn new(name: &'static str, key: &'static str, training: &[Vec<f64>], seed: u64) -> Self {
        let chain = Chain::train(training);
        let lengths: Vec<usize> = training.iter().map(Vec::len).collect();
        Self {
            name,
            key,
            training: training.iter().map(|series| centred(series)).collect(),
            generated: generated(&chain, &lengths, seed),
            chain,
        }
    }

    fn committed(seed: u64) -> Self {
        let chain = Chain::measured();
        Self {
            name: "measured bus",
            key: "measured",
            training: Vec::new(),
            generated: generated(&chain, &[14_000; 6], seed),
            chain,
        }
    }

    /// Returns the training and the generated series, each with its name.
    fn kinds(&self) -> impl Iterator<Item = (String, &[Vec<f64>])> {
        [("training", &self.training), ("generated", &self.generated)]
            .into_iter()
            .filter(|(_, series)| !series.is_empty())
            .map(|(kind, series)| (format!("{}, {kind}", self.name), series.as_slice()))
    }

    fn figures(&self) -> [Figure; 3] {
        [self.matrix(), self.series(), self.autocorrelations()]
    }

    fn matrix(&self) -> Figure {
        let shades = [
            ("up to 3 %", 0.0, colour::GREY),
            ("3 to 30 %", 0.03, colour::BLUE),
            ("over 30 %", 0.3, colour::ORANGE),
        ];
        let mut plot = Plot::new("error (m)", "its change over 2.5 m (m)");
        for (k, &(name, above, colour)) in shades.iter().enumerate() {
            let upto = shades.get(k + 1).map_or(f64::INFINITY, |next| next.1);
            let dots = (0..STATES * STATES).filter_map(|cell| {
                let (from, to) = (cell / STATES, cell % STATES);
                let g = self.chain.probability(from, to);
                let shown = self.chain.visits(from) > 0 && g > above && g <= upto;
                shown.then(|| (error_of(from), error_of(to) - error_of(from)))
            });
            plot = plot.with(Series::line(name, colour, dots).drawn(Mark::Dots));
        }
        let trained = (0..STATES).filter(|&state| self.chain.visits(state) > 0);
        Figure::new(
            format!("gps_matrix_{}", self.key),
            &plot,
            format!(
                "Probability matrix G of the chain of the {}, rotated so that its diagonal is \
                 horizontal: a dot for each counted transition, coloured by its probability. {} \
                 of {STATES} states have data.",
                self.name,
                trained.count()
            ),
        )
    }

    fn series(&self) -> Figure {
        let mut plot = Plot::new("distance (km)", "altitude error (m)");
        for ((name, series), colour) in self.kinds().zip(kind_colours(self)) {
            let points = series[0].iter().enumerate();
            let points = points.map(|(k, error)| (k as f64 * STEP_M * 1e-3, *error));
            plot = plot.with(Series::line(name, colour, points));
        }
        Figure::new(
            format!("gps_series_{}", self.key),
            &plot,
            "The first series, less its mean, and a generated one of equal length.",
        )
    }

    fn autocorrelations(&self) -> Figure {
        let mut plot = Plot::new("distance between (m)", "autocorrelation");
        for ((name, series), colour) in self.kinds().zip(kind_colours(self)) {
            let lags = (0..=(LONGEST_LAG_M / STEP_M) as usize).step_by(10);
            let points = lags.map(|lag| (lag as f64 * STEP_M, autocorrelation(series, lag)));
            plot = plot.with(Series::line(name, colour, points));
        }
        Figure::new(
            format!("gps_autocorrelation_{}", self.key),
            &plot,
            "Autocorrelation over all series.",
        )
    }
}

fn kind_colours(source: &ErrorSource) -> impl Iterator<Item = plotters::style::RGBColor> {
    [colour::BLUE, colour::ORANGE]
        .into_iter()
        .skip(usize::from(source.training.is_empty()))
}

fn generated(chain: &Chain, lengths: &[usize], seed: u64) -> Vec<Vec<f64>> {
    let series = lengths.iter().enumerate().map(|(run, &length)| {
        // Streams of their own: the streams of the first runs made the simulated training series.
        let mut rng = stream(seed, 1_000 + run, Purpose::Gnss);
        centred(&chain.generate(length, &mut rng))
    });
    series.collect()
}

/// Returns the mean of f over all pairs `lag` apart in all series.
fn mean_of_pairs(series: &[Vec<f64>], lag: usize, f: impl Fn(f64, f64) -> f64) -> f64 {
    let (mut sum, mut count) = (0.0, 0.0);
    for one in series {
        for (a, b) in one.iter().zip(one.iter().skip(lag)) {
            sum += f(*a, *b);
            count += 1.0;
        }
    }
    sum / count
}

fn sigma(series: &[Vec<f64>]) -> f64 {
    mean_of_pairs(series, 0, |a, _| a * a).sqrt()
}

fn autocorrelation(series: &[Vec<f64>], lag: usize) -> f64 {
    mean_of_pairs(series, lag, |a, b| a * b) / sigma(series).powi(2)
}

/// Returns the root mean square of the change over a length, as grade, %.
fn grade_percent(series: &[Vec<f64>], length_m: f64) -> f64 {
    let lag = (length_m / STEP_M) as usize;
    100.0 / length_m * mean_of_pairs(series, lag, |a, b| (b - a).powi(2)).sqrt()
}

fn statistics(sources: &[ErrorSource]) -> Table {
    let header = [
        "series",
        "sigma m",
        "correlation at 100 m",
        "at 500 m",
        "at 1250 m",
        "grade over 500 m %",
        "over 1250 m %",
        "over 3000 m %",
    ];
    let caption = format!(
        "Altitude errors of {BIN_M} m chains, training and generated: standard deviation, \
         autocorrelation, and the root mean square of their change over a length, as grade."
    );
    let rows = sources
        .iter()
        .flat_map(ErrorSource::kinds)
        .map(|(name, series)| {
            let mut row = vec![name, format!("{:.2}", sigma(series))];
            row.extend(
                LAGS_M.map(|lag_m| {
                    format!("{:.2}", autocorrelation(series, (lag_m / STEP_M) as usize))
                }),
            );
            row.extend(GRADE_BASES_M.map(|base_m| format!("{:.3}", grade_percent(series, base_m))));
            row
        });
    Table::new("gps_statistics", caption, &header).with_rows(rows)
}

/// Estimates the same drive with each series of errors, as in section 5.2.2.
fn effect(sources: &[ErrorSource], seed: u64) -> Table {
    let header = ["GPS error", "runs", "mean RMSE %", "least %", "largest %"];
    let caption = "RMSE of the original filter's grade on one simulated drive of vehicle A with \
                   true parameters and noisy wheel speed, with each series as the error of GPS \
                   altitude; the first and last 200 points are left out. Thesis 5.2.2: generated \
                   errors typically give a larger RMSE than measured ones, and the same largest \
                   RMSE.";
    let none = ("none".to_owned(), vec![vec![0.0; 12_000]]);
    let kinds = sources.iter().flat_map(ErrorSource::kinds);
    let kinds = kinds.map(|(name, series)| (name, series.to_vec()));
    let rows = std::iter::once(none).chain(kinds).map(|(name, series)| {
        let found: Vec<f64> = series
            .iter()
            .map(|error| estimation_rmse(error, seed))
            .collect();
        let mean = found.iter().sum::<f64>() / found.len() as f64;
        let least = found.iter().copied().fold(f64::INFINITY, f64::min);
        let largest = found.iter().copied().fold(0.0, f64::max);
        vec![
            name,
            found.len().to_string(),
            format!("{mean:.3}"),
            format!("{least:.3}"),
            format!("{largest:.3}"),
        ]
    });
    Table::new("gps_effect", caption, &header).with_rows(rows)
}

fn estimation_rmse(gps_m: &[f64], seed: u64) -> f64 {
    let shape = RoadShape {
        length_m: gps_m.len() as f64 * STEP_M,
        ..RoadShape::default()
    };
    let road = generate(&shape, seed);
    let grades: Vec<f64> = (0..gps_m.len())
        .map(|k| 100.0 * road.grade(k as f64 * STEP_M))
        .collect();
    let errors = Disturbances {
        speed_mps: SPEED_NOISE_MPS,
        gps_m,
        ..Disturbances::default()
    };
    let mut rng = stream(seed, 0, Purpose::Sensors);
    let vehicle = Preset::A.parameters();
    let run = distance_drive::simulate(&grades, &vehicle, &Belief::TRUTH, &errors, &mut rng)
        .expect("the preset has an engine and a gearbox");
    let estimate = original::estimate(&run.drive, &NoiseSigmas::ORIGINAL).grade_percent;
    rmse(&grades, &estimate)
}
