//! Logs with an effect in them that nobody is told of, for a diagnosis to find.
//!
//! The simulator drives six runs over one road of 20 km, four to fit and two held out, as many each
//! way. The vehicle file is right but for what is planted, in an amount that makes the asked grade
//! error. Logs and vehicle file go into a folder of their own; what is true goes beside it.

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

/// The effects that the estimator has a name for.
pub const CATALOGUE: [&str; 12] = [
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
];
/// Those that it has none for.
pub const OUTSIDE: [&str; 3] = ["torque_hysteresis", "side_resistance", "thermostat"];
/// Nothing at all.
pub const CLEAN: &str = "clean";

/// The four runs to fit and the two held out: forward or not, log's clock at the start in s (times
/// of day, no multiples of anything), and how long the tyres have rolled before in s.
const RUNS: [(&str, bool, u32, u32); 6] = [
    ("fit1", true, 21_617, 0),
    ("fit2", false, 34_241, 0),
    ("fit3", true, 47_903, 7_200),
    ("fit4", false, 61_379, 3_000),
    ("held1", true, 28_051, 0),
    ("held2", false, 72_463, 600),
];
/// How many of them are to fit.
const FIT_RUNS: usize = 4;
/// What stands for the scenario in messages.
const ORIGIN: &str = "bench";
/// How near to the asked size an amount shall come, and how near it must, as a part of it: where
/// another amount means another gear on a slope, the size jumps.
const CLOSE: (f64, f64) = (2e-3, 0.02);
/// Amounts tried: all effects but hysteresis are close to proportional to theirs.
const TRIES: usize = 12;

/// One effect in the true world.
#[derive(Clone, Debug, PartialEq)]
pub struct Amount {
    /// Its name.
    pub effect: String,
    /// In the unit of the scenario's key that makes it (added rolling resistance for stretches of
    /// road, m/s of wind); for keys that are factors, what they are above 1.
    pub amount: f64,
}

/// What a diagnosis may see, and what is true.
#[derive(Clone, Debug)]
pub struct PlantedLogs {
    /// The vehicle as it is believed.
    pub vehicle: PathBuf,
    /// Two runs each way.
    pub fit: Vec<PathBuf>,
    /// One run each way.
    pub held_out: Vec<PathBuf>,
    /// Not for the diagnosis.
    pub truth: PlantedTruth,
}

/// What was planted, for the judge.
#[derive(Clone, Debug)]
pub struct PlantedTruth {
    /// Where the files are: outside the folder of the logs.
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

/// Simulates runs of truck "A" or "B" with one effect of `size_percent` in them; with none if it is
/// [`CLEAN`], or of 0 %, on the road that this effect is planted on.
///
/// The size is the effect's force over the truck's weight, as RMS over the way of all six runs
/// without shift or brake, in %; for `wheel_radius` that of the radius. A negative size makes the opposite of
/// `rolling_resistance`, `air_drag`, `mass`, `torque_scale` or `wheel_radius`: less than believed.
///
/// `folder` gets the logs and `vehicle.toml`; the truth goes into the folder of the same name with
/// `.truth` at its end.
///
/// # Errors
/// An effect or a truck that there is not, a size that no truck could have, or what the file
/// system says.
pub fn logs(
    effect: &str,
    size_percent: f64,
    truck: &str,
    seed: u64,
    folder: &Path,
) -> Result<PlantedLogs> {
    logs_of(&[(effect, size_percent)], truck, seed, folder)
}

/// As [`logs`], with several effects, each of its own size.
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

/// Returns how much of `effect` makes `size_percent` on the bench's runs.
///
/// # Errors
/// Returns the errors of [`logs`].
pub fn amount(effect: &str, size_percent: f64, truck: &str, seed: u64) -> Result<Amount> {
    let bench = Bench {
        truck,
        seed,
        curvy: effect == "cornering",
    };
    bench.calibrated(effect, size_percent)
}

/// Returns what the believed vehicle does not explain in all runs of a scenario, gusts excepted:
/// RMS over the way driven without shift or brake, %.
///
/// # Errors
/// A truck that gets stuck.
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

/// The truck on its road, before anything is planted.
struct Bench<'a> {
    truck: &'a str,
    seed: u64,
    curvy: bool,
}

impl Bench<'_> {
    /// Returns the amount of an effect, alone, that makes the size.
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
        for (name, forward, start_s, tyres_s) in RUNS {
            let direction = if forward { "forward" } else { "backward" };
            let _ = write!(
                text,
                "[[runs]]\nname = \"{name}\"\ntruck = \"{}\"\ndirection = \"{direction}\"\n\
                 start_time_s = {start_s}.0\ntyres_driven_s = {tyres_s}.0\n",
                self.truck
            );
        }
        Ok(text)
    }
}
