//! Logs with an undeclared effect, for a diagnosis to find.
//!
//! The simulator drives six runs over one road of 20 km, four to fit and two held out, half of
//! them in each direction. The vehicle file is right but for the planted effect. The amount of the
//! effect makes the requested grade error. Logs and vehicle file are in one folder, the truth is
//! in a folder beside it.

mod known;

use host_sim::error::{Error, Result};
use host_sim::files::output::write_whole;
use host_sim::files::truth;
use host_sim::simulator::scenario::Scenario;
use host_sim::simulator::{Recording, road_file};
use host_sim::source::candump_writer::write_frame;
use known::{COURSE_DEG, Known, known};
use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::{Path, PathBuf};

pub use known::FAN;

/// Effects of the estimator's catalogue.
pub const CATALOGUE: [&str; 13] = [
    "rolling_resistance",
    "tyre_warmup",
    "air_drag",
    "headwind",
    "cornering",
    "driveline_loss",
    "auxiliary_load",
    "mass",
    "torque_scale",
    "wheel_radius",
    "brake_drag",
    "road_surface",
    "tyre_temperature",
];
/// Effects outside the catalogue.
pub const OUTSIDE: [&str; 3] = ["torque_hysteresis", "side_resistance", "thermostat"];
/// No effect.
pub const CLEAN: &str = "clean";

/// The four runs to fit and the two held out: forward or not, the log's clock at the start, s (an
/// arbitrary time of day), how long the tyres have rolled before, s, and the air temperature where
/// that matters, °C.
const RUNS: [(&str, bool, u32, u32, i32); 6] = [
    ("fit1", true, 21_617, 0, -5),
    ("fit2", false, 34_241, 0, 12),
    ("fit3", true, 47_903, 7_200, 24),
    ("fit4", false, 61_379, 3_000, 3),
    ("held1", true, 28_051, 0, 0),
    ("held2", false, 72_463, 600, 18),
];
/// Number of runs to fit.
const FIT_RUNS: usize = 4;
/// Name of the scenario in messages.
const ORIGIN: &str = "bench";
/// Relative errors of the size: the one that the search aims at, and the largest accepted one. The
/// size jumps where another amount means another gear on a slope.
const CLOSE: (f64, f64) = (2e-3, 0.02);
/// Number of amounts tried. The size of every effect but hysteresis is nearly proportional to its
/// amount.
const TRIES: usize = 12;

/// A planted effect and its amount.
#[derive(Clone, Debug, PartialEq)]
pub struct Amount {
    /// Its name.
    pub effect: String,
    /// In the unit of the scenario's key (added rolling resistance for stretches of road, m/s of
    /// wind). For a key that is a factor: the factor minus 1.
    pub amount: f64,
}

/// The files for a diagnosis, and the truth.
#[derive(Clone, Debug)]
pub struct PlantedLogs {
    /// The assumed vehicle.
    pub vehicle: PathBuf,
    /// Two runs in each direction.
    pub fit: Vec<PathBuf>,
    /// One run in each direction.
    pub held_out: Vec<PathBuf>,
    /// The truth, not for the diagnosis.
    pub truth: PlantedTruth,
}

/// What was planted, to judge the diagnosis by.
#[derive(Clone, Debug)]
pub struct PlantedTruth {
    /// Folder of the files, outside the folder of the logs.
    pub folder: PathBuf,
    /// The scenario.
    pub scenario: PathBuf,
    /// The road in its forward direction (ROAD.csv with altitude and grade).
    pub road: PathBuf,
    /// TRUTH.csv of each run to fit.
    pub fit: Vec<PathBuf>,
    /// TRUTH.csv of each run held out.
    pub held_out: Vec<PathBuf>,
    /// The effects.
    pub amounts: Vec<Amount>,
}

/// Simulates runs of truck "A" or "B" with one effect of `size_percent`. With [`CLEAN`] or 0 %
/// nothing is planted; the road is that of the effect.
///
/// The size is the effect's force over the truck's weight in %, as RMS over the distance of all
/// six runs without shift or brake. For `wheel_radius` it is the error of the radius in %. A
/// negative size makes an effect of which [`can_be_less`] less than assumed; wind blows from the
/// other side.
///
/// The logs and `vehicle.toml` go into `folder`. The truth goes into the folder of the same name
/// with `.truth` appended.
///
/// # Errors
/// The effect or the truck is unknown, the size is impossible, or a file cannot be written.
pub fn logs(
    effect: &str,
    size_percent: f64,
    truck: &str,
    seed: u64,
    folder: &Path,
) -> Result<PlantedLogs> {
    logs_of(&[(effect, size_percent)], truck, seed, folder)
}

/// Simulates runs like [`logs`], with several effects, each of its own size.
///
/// # Errors
/// Returns the errors of [`logs`].
pub fn logs_of(
    effects: &[(&str, f64)],
    truck: &str,
    seed: u64,
    folder: &Path,
) -> Result<PlantedLogs> {
    let bench = Bench {
        truck,
        seed,
        curvy: effects.iter().any(|&(effect, _)| effect == "cornering"),
        weather: effects
            .iter()
            .any(|&(effect, _)| effect == "tyre_temperature"),
    };
    let mut amounts = Vec::new();
    for &(effect, size_percent) in effects.iter().filter(|&&(effect, _)| effect != CLEAN) {
        named(effect)?;
        if size_percent != 0.0 {
            amounts.push(bench.calibrated(effect, size_percent)?);
        }
    }
    let text = bench.text(&amounts)?;
    let scenario = parse(&text)?;
    let truth_folder = beside(folder);
    let scenario_path = truth_folder.join("scenario.toml");
    write_whole(&scenario_path, |out| out.write_all(text.as_bytes()))?;
    let road = truth_folder.join("road.csv");
    road_file::write(&road, &scenario.road)?;
    let vehicle = folder.join("vehicle.toml");
    scenario.runs[0].vehicle.write(&vehicle)?;
    let (mut files, mut truths) = (Vec::new(), Vec::new());
    for (index, run) in scenario.runs.iter().enumerate() {
        let recording = Recording::new(&scenario, index)?;
        let file = folder.join(format!("{}.log", run.name));
        write_whole(&file, |out| {
            recording
                .frames()
                .try_for_each(|frame| write_frame(out, &frame, "can0"))
        })?;
        files.push(file);
        let truth = truth_folder.join(format!("{}.truth.csv", run.name));
        truth::write(&truth, &recording.truth())?;
        truths.push(truth);
    }
    Ok(PlantedLogs {
        vehicle,
        held_out: files.split_off(FIT_RUNS),
        fit: files,
        truth: PlantedTruth {
            folder: truth_folder,
            scenario: scenario_path,
            road,
            held_out: truths.split_off(FIT_RUNS),
            fit: truths,
            amounts,
        },
    })
}

/// Returns whether there can be less of an effect than assumed.
#[must_use]
pub fn can_be_less(effect: &str) -> bool {
    known(effect).is_some_and(|known| known.or_less)
}

/// Returns the amount of `effect` that makes `size_percent` on the bench's runs.
///
/// # Errors
/// Returns the errors of [`logs`].
pub fn amount(effect: &str, size_percent: f64, truck: &str, seed: u64) -> Result<Amount> {
    let bench = Bench {
        truck,
        seed,
        curvy: effect == "cornering",
        weather: effect == "tyre_temperature",
    };
    bench.calibrated(effect, size_percent)
}

/// Returns what the assumed vehicle does not explain in all runs of a scenario, except gusts:
/// RMS over the distance driven without shift or brake, %.
///
/// # Errors
/// A truck gets stuck.
pub fn unmodelled_rms_percent(scenario: &Scenario) -> Result<f64> {
    let mut calm = scenario.clone();
    for run in &mut calm.runs {
        run.wind.gust_sigma_mps = 0.0;
    }
    let (mut squares, mut driven_m) = (0.0, 0.0);
    for index in 0..calm.runs.len() {
        let recording = Recording::new(&calm, index)?;
        for step in recording.unmodelled().filter(|step| step.valid) {
            squares += step.length_m * step.percent * step.percent;
            driven_m += step.length_m;
        }
    }
    Ok(f64::sqrt(squares / driven_m))
}

fn named(effect: &str) -> Result<&'static Known> {
    known(effect).ok_or_else(|| refused(format!("effect \"{effect}\": there is none of that name")))
}

fn parse(text: &str) -> Result<Scenario> {
    Scenario::parse(text, Path::new(ORIGIN))
}

fn refused(problem: impl Into<String>) -> Error {
    Error::content(Path::new(ORIGIN), problem)
}

/// Returns the folder of the truth.
fn beside(folder: &Path) -> PathBuf {
    let mut name = folder.as_os_str().to_owned();
    name.push(".truth");
    PathBuf::from(name)
}

/// The truck on its road, without a planted effect.
struct Bench<'a> {
    truck: &'a str,
    seed: u64,
    curvy: bool,
    /// Whether each run has air of its own temperature.
    weather: bool,
}

impl Bench<'_> {
    /// Returns the amount of an effect that alone makes the size.
    fn calibrated(&self, effect: &str, size_percent: f64) -> Result<Amount> {
        if !size_percent.is_finite() || size_percent == 0.0 {
            return Err(refused(format!(
                "{effect} of {size_percent} %: expected a number other than 0"
            )));
        }
        let mut planted = Amount {
            effect: effect.to_owned(),
            amount: named(effect)?.first_amount.copysign(size_percent),
        };
        if effect == "wheel_radius" {
            planted.amount = 0.01 * size_percent;
            return Ok(planted);
        }
        let mut nearest = (CLOSE.1, None);
        for _ in 0..TRIES {
            let scenario = parse(&self.text(std::slice::from_ref(&planted))?)?;
            let factor = size_percent.abs() / unmodelled_rms_percent(&scenario)?;
            let off = (factor - 1.0).abs();
            if off < nearest.0 {
                nearest = (off, Some(planted.clone()));
            }
            if off < CLOSE.0 {
                break;
            }
            planted.amount *= factor;
        }
        nearest.1.ok_or_else(|| {
            refused(format!(
                "{effect} of {size_percent} %: no amount makes it on this road"
            ))
        })
    }

    /// Returns the scenario.
    fn text(&self, planted: &[Amount]) -> Result<String> {
        let mut tables: BTreeMap<&str, String> = BTreeMap::from([
            ("rates", "fast_ms = 50.0\n".to_owned()),
            (
                "gnss",
                "altitude_sigma_m = 2.0\naltitude_time_s = 250.0\naltitude_white_sigma_m = 0.3\n"
                    .to_owned(),
            ),
            ("wind", "gust_sigma_mps = 0.3\n".to_owned()),
            (
                "road",
                format!("length_m = 20000.0\nstart_course_deg = {COURSE_DEG:?}\n"),
            ),
        ]);
        if self.curvy {
            let radii = "smallest_radius_m = 300.0\nlargest_radius_m = 600.0\n";
            tables.entry("road").or_default().push_str(radii);
        }
        for one in planted {
            let Known { table, keys, .. } = named(&one.effect)?;
            let keys = keys(one.amount, self.seed);
            let _ = writeln!(tables.entry(table).or_default(), "{keys}");
        }
        let mut text = format!("seed = {}\n", self.seed);
        for (table, keys) in tables {
            let _ = write!(text, "[{table}]\n{keys}");
        }
        for (name, forward, start_s, tyres_s, celsius) in RUNS {
            let direction = if forward { "forward" } else { "backward" };
            let _ = write!(
                text,
                "[[runs]]\nname = \"{name}\"\ntruck = \"{}\"\ndirection = \"{direction}\"\n\
                 start_time_s = {start_s}.0\ntyres_driven_s = {tyres_s}.0\n",
                self.truck
            );
            if self.weather {
                let _ = writeln!(text, "temperature_celsius = {celsius}.0");
            }
        }
        Ok(text)
    }
}
