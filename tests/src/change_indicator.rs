//! The change indicator: the results of a fixed set of inputs, in full digits.
//!
//! Each input has a file in `tests/change_indicator`: the counters, a digest of all rows, and one
//! row a kilometre. Every change of behaviour shows there line by line, however small it is. The
//! idea is that of PX4's estimator tests.
//!
//! The recorded inputs are read from `../shared/data`. They are left out where that is absent.

use crate::drive::{self, truck, truck_with_every_effect};
use crate::faults::catalogue::catalogue;
use crate::faults::drive::drive as fault_drive;
use crate::faults::outcome::estimated;
use crate::image::{measured_data, measured_mission, root};
use estimator_core::{Counters, FixedPoint, Model, PersistentState, Scalar, Tuning};
use host_sim::error::{Error, Result};
use host_sim::files::output::write_whole;
use host_sim::files::run::{RunCell, RunRow};
use host_sim::map::{GradeMap, SessionRun, road_of_run, road_through};
use host_sim::recorder::{SmoothedRun, estimate_log};
use host_sim::simulator::scenario::Scenario;
use host_sim::simulator::simulate;
use host_sim::source::can_frame::TimedFrame;
use host_sim::source::read_options::ReadOptions;
use host_sim::source::ztbus::Mission;
use serde::Serialize;
use similar::TextDiff;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use xxhash_rust::xxh3::xxh3_64;

/// Number of rows from one row in the file to the next: 1 km of cells.
const SHOWN_EVERY: usize = 400;
/// Faults that are shown besides clean drives. The others are in `tests/faults.md`.
const FAULTS: [&str; 8] = [
    "silence of 60 s",
    "torque: error for 120 s",
    "wheel speed stuck",
    "gear stuck a gear too low",
    "brakes: error for 120 s",
    "frozen for 120 s",
    "drifts up by 10 m in 1 km",
    "one frame in five cut short",
];

/// The result of one input, as the text of its file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Indication {
    /// Name of the input, and of its file without the ending.
    pub input: String,
    /// The text.
    pub text: String,
}

/// The results of all available inputs, and the names of the others.
#[derive(Clone, Debug, Default)]
pub struct Indicated {
    /// One for each input.
    pub indications: Vec<Indication>,
    /// Recorded inputs whose file is absent.
    pub absent: Vec<String>,
}

/// Returns the folder of the committed files.
#[must_use]
pub fn committed_folder() -> PathBuf {
    root().join("tests/change_indicator")
}

/// Runs all inputs.
///
/// # Errors
/// A scenario or a recording cannot be read, or a temporary file cannot be written.
pub fn indicate() -> Result<Indicated> {
    let mut all = Indicated::default();
    all.motorway()?;
    all.faults()?;
    all.small_drive();
    all.recorded()?;
    Ok(all)
}

/// Returns the committed text of an input, if there is any.
#[must_use]
pub fn committed(input: &str) -> Option<String> {
    fs::read_to_string(file_of(input)).ok()
}

/// Returns the lines in which an input's text differs from the committed one, as a unified diff;
/// empty if there is none.
#[must_use]
pub fn changes(indication: &Indication) -> String {
    let before = committed(&indication.input).unwrap_or_default();
    let (old, new) = (
        format!("committed/{}", indication.input),
        indication.input.clone(),
    );
    TextDiff::from_lines(&before, &indication.text)
        .unified_diff()
        .context_radius(0)
        .header(&old, &new)
        .to_string()
}

/// Writes the results as the committed ones.
///
/// # Errors
/// Returns the error of the file system.
pub fn write(indicated: &Indicated) -> Result<()> {
    for indication in &indicated.indications {
        write_whole(&file_of(&indication.input), |file| {
            file.write_all(indication.text.as_bytes())
        })?;
    }
    Ok(())
}

fn file_of(input: &str) -> PathBuf {
    committed_folder().join(format!("{input}.csv"))
}

impl Indicated {
    fn add(&mut self, input: impl Into<String>, text: String) {
        let input = input.into();
        self.indications.push(Indication { input, text });
    }

    /// Adds the runs of both trucks in both directions, and the map of the forward runs.
    fn motorway(&mut self) -> Result<()> {
        let scenario = Scenario::read(&root().join("host-sim/scenarios/motorway.toml"))?;
        let mut forward = Vec::new();
        for index in 0..scenario.runs.len() {
            let simulated = simulate(&scenario, index)?;
            let frames = Box::new(simulated.frames.iter().copied());
            let run = estimated::<f32>(&simulated.vehicle.model, frames);
            self.add(format!("motorway_{}", simulated.name), text_of(&run));
            if simulated.name.ends_with("forward") {
                forward.push(run.rows);
            }
        }
        self.add("motorway_map", map_of(&forward)?);
        Ok(())
    }

    /// Adds a drive with every parameter wrong by one sigma, without and with a fault.
    fn faults(&mut self) -> Result<()> {
        let simulated = fault_drive("B", 1)?;
        let vehicle = &simulated.vehicle.model;
        let clean = Box::new(simulated.frames.iter().copied());
        self.add("fault_none", text_of(&estimated::<f32>(vehicle, clean)));
        let catalogue = catalogue();
        for name in FAULTS {
            let fault = catalogue
                .iter()
                .find(|fault| fault.name == name)
                .ok_or_else(|| Error::content(Path::new(name), "is no fault of the catalogue"))?;
            let run = estimated::<f32>(vehicle, fault.received(&simulated.frames));
            let words: Vec<&str> = name.split(|c: char| !c.is_alphanumeric()).collect();
            self.add(format!("fault_{}", words.join("_")), text_of(&run));
        }
        Ok(())
    }

    /// Adds the small drive of the emulated board: each scalar type, without and with all effects.
    fn small_drive(&mut self) {
        let frames = drive::drive();
        for (name, vehicle) in [("plain", truck()), ("effects", truck_with_every_effect())] {
            self.add(format!("small_{name}_f32"), small::<f32>(&vehicle, &frames));
            self.add(format!("small_{name}_f64"), small::<f64>(&vehicle, &frames));
            self.add(
                format!("small_{name}_fixed"),
                small::<FixedPoint>(&vehicle, &frames),
            );
        }
    }

    /// Adds the first round trip of the measured bus, and the idling truck.
    fn recorded(&mut self) -> Result<()> {
        let mission = measured_mission();
        let idle = measured_data().join("css_truck_idle/truck_idle.log");
        if mission.exists() {
            let mission = Mission::read(&mission)?;
            let vehicle = mission.vehicle().model;
            let folder = tempfile::tempdir().map_err(Error::io(&std::env::temp_dir()))?;
            for (pass, number) in mission.passes().iter().take(2).zip(1..) {
                let table = folder.path().join("pass.csv");
                mission.write_pass(&table, pass)?;
                let run = estimate_log::<f32>(
                    &vehicle,
                    &Tuning::default(),
                    None,
                    &table,
                    &ReadOptions::default(),
                    |_| (),
                )?
                .in_memory()?;
                self.add(format!("ztbus_pass_{number}"), text_of(&run));
            }
        } else {
            self.absent.push(mission.display().to_string());
        }
        if idle.exists() {
            let run = estimate_log::<f32>(
                &truck(),
                &Tuning::default(),
                None,
                &idle,
                &ReadOptions::default(),
                |_| (),
            )?
            .in_memory()?;
            self.add("truck_idle", text_of(&run));
        } else {
            self.absent.push(idle.display().to_string());
        }
        Ok(())
    }
}

fn small<S: Scalar>(model: &Model, frames: &[TimedFrame]) -> String {
    text_of(&estimated::<S>(model, Box::new(frames.iter().copied())))
}

/// Returns the text of a run: counters, persistent state, digest and rows.
fn text_of(run: &SmoothedRun) -> String {
    let kept = run
        .persistent_state
        .as_ref()
        .map_or("none".to_owned(), |kept: &PersistentState| {
            kept.to_bytes()
                .iter()
                .map(|byte| format!("{byte:02x}"))
                .collect()
        });
    format!(
        "{}kept {kept}\n{}",
        counted(&run.counters),
        rows_of(&run.rows)
    )
}

fn map_of(runs: &[Vec<RunRow>]) -> Result<String> {
    let name = Path::new("motorway_map");
    let no_road = || Error::content(name, "no run has a track");
    let cells: Vec<RunCell> = runs
        .first()
        .ok_or_else(no_road)?
        .iter()
        .map(RunCell::from)
        .collect();
    let network = road_through(name, road_of_run(&cells).ok_or_else(no_road)?)?;
    let mut map = GradeMap::new(&network);
    for rows in runs {
        map.add_run(&SessionRun {
            session: None,
            rows,
        });
    }
    Ok(rows_of(&map.fused().rows()))
}

/// Returns a line for each counter that is not 0.
fn counted(counters: &Counters) -> String {
    let names_and_numbers = format!("{counters:#?}");
    let lines = names_and_numbers.lines().filter_map(|line| {
        let (name, number) = line.trim().trim_end_matches(',').split_once(": ")?;
        (number != "0").then(|| (name.to_owned(), number.to_owned()))
    });
    let sorted: BTreeMap<String, String> = lines.collect();
    let lines = sorted
        .iter()
        .map(|(name, number)| format!("{name} {number}\n"));
    lines.collect()
}

/// Returns the number and the digest of all rows, and one row a kilometre with all digits.
fn rows_of<T: Serialize>(rows: &[T]) -> String {
    let mut all = csv::Writer::from_writer(Vec::new());
    let mut shown = csv::Writer::from_writer(Vec::new());
    for (index, row) in rows.iter().enumerate() {
        all.serialize(row).expect("rows of numbers are CSV");
        if index % SHOWN_EVERY == 0 || index + 1 == rows.len() {
            shown.serialize(row).expect("rows of numbers are CSV");
        }
    }
    let [all, shown] =
        [all, shown].map(|writer| writer.into_inner().expect("memory takes what is written"));
    format!(
        "rows {} digest {:016x}\n{}",
        rows.len(),
        xxh3_64(&all),
        String::from_utf8_lossy(&shown)
    )
}
