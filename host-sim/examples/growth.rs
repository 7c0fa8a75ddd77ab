//! Time and memory with ten times the work: a longer log, more runs, a longer road.
//!
//! ```text
//! cargo run --profile dist -p host-sim --example growth
//! ```
//!
//! Each is measured at one and at ten times the work, as the processor time and the largest
//! resident memory of a process of its own; the slope is the decimal logarithm of the ratio, so
//! that 1 is linear. Fails if a time grows by more than [`STEEPEST`], or the memory of an estimate
//! at all.

use host_sim::error::{Error, Result};
use host_sim::terminal::print::print;
use host_sim::terminal::table::text_table;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode, Stdio};
use std::{env, fs};
use tempfile::TempDir;
use wait4::Wait4;

/// Slope of a time that passes for linear; caches make a little more than 1 of it.
const STEEPEST: f64 = 1.15;
/// Slope of a memory that passes for none: the kernel's accounts are not exact.
const FLAT: f64 = 0.1;
/// Shortest log and road, km; runs of the smallest fleet.
const LOG_KM: usize = 40;
const ROAD_KM: usize = 20;
const RUNS: usize = 25;

fn main() -> ExitCode {
    match run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}

/// What a process took.
struct Cost {
    seconds: f64,
    megabytes: f64,
}

/// Something that grows: what it costs at one and at ten times the work.
struct Growth {
    name: &'static str,
    costs: [Cost; 2],
    memory_is_flat: bool,
}

fn run() -> Result<()> {
    let programs = Programs::build()?;
    let folder = TempDir::new().map_err(Error::io(&env::temp_dir()))?;
    let at = folder.path();
    let mut all = Vec::new();
    let mut add = |name, memory_is_flat, cost: &dyn Fn(usize) -> Result<Cost>| -> Result<()> {
        all.push(Growth {
            name,
            costs: [cost(1)?, cost(10)?],
            memory_is_flat,
        });
        Ok(())
    };
    let log = |factor| programs.estimate(at, LOG_KM * factor);
    add("estimate, log ×10", true, &log)?;
    add("fuse, runs ×10", false, &|factor| {
        programs.fuse(at, RUNS * factor, ROAD_KM)
    })?;
    add("fuse, road ×10", false, &|factor| {
        programs.fuse(at, RUNS, ROAD_KM * factor)
    })?;
    report(&all)
}

fn report(all: &[Growth]) -> Result<()> {
    let mut rows = Vec::new();
    let mut steep = Vec::new();
    for Growth {
        name,
        costs: [one, ten],
        memory_is_flat,
    } in all
    {
        let time = (ten.seconds / one.seconds).log10();
        let memory = (ten.megabytes / one.megabytes).log10();
        if time > STEEPEST || memory > if *memory_is_flat { FLAT } else { STEEPEST } {
            steep.push(*name);
        }
        rows.push(vec![
            (*name).to_owned(),
            format!("{:.2}", one.seconds),
            format!("{:.2}", ten.seconds),
            format!("{time:.2}"),
            format!("{:.1}", one.megabytes),
            format!("{:.1}", ten.megabytes),
            format!("{memory:.2}"),
        ]);
    }
    let header = ["", "s", "×10", "slope", "MB", "×10", "slope"];
    print(&format!("{}\n", text_table(&header, &rows, 1)))?;
    if steep.is_empty() {
        return Ok(());
    }
    let problem = format!("grows too fast: {}", steep.join("; "));
    Err(Error::content(Path::new("growth"), problem))
}

/// What is measured, and what makes its input.
struct Programs {
    roadgrade: PathBuf,
    fleet: PathBuf,
}

impl Programs {
    /// Builds them beside this one.
    fn build() -> Result<Self> {
        let cargo = env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
        let mut build = Command::new(cargo);
        build
            .current_dir(env!("CARGO_MANIFEST_DIR"))
            .args(["build", "--profile", "dist", "--bin", "roadgrade"])
            .args(["--example", "fleet"]);
        cost(&mut build)?;
        let this = env::current_exe().map_err(Error::io(Path::new("growth")))?;
        let examples = this.parent().unwrap_or(Path::new("."));
        Ok(Self {
            roadgrade: examples.join("../roadgrade"),
            fleet: examples.join("fleet"),
        })
    }

    /// Of a drive of so many km.
    fn estimate(&self, at: &Path, km: usize) -> Result<Cost> {
        let at = at.join(format!("log_{km}"));
        fs::create_dir(&at).map_err(Error::io(&at))?;
        let scenario = at.join("scenario.toml");
        let text = format!(
            "seed = 1\n[road]\nlength_m = {km}000.0\n[[runs]]\nname = \"a\"\ntruck = \"A\"\n"
        );
        fs::write(&scenario, text).map_err(Error::io(&scenario))?;
        let mut simulate = Command::new(&self.roadgrade);
        simulate.arg("simulate").arg("--scenario").arg(&scenario);
        cost(simulate.arg("--out").arg(&at))?;
        let mut estimate = Command::new(&self.roadgrade);
        estimate
            .arg("estimate")
            .arg("--vehicle")
            .arg(at.join("a.vehicle.toml"))
            .arg("--out")
            .arg(at.join("run.csv"))
            .arg(at.join("a.log"));
        let cost = cost(&mut estimate)?;
        fs::remove_dir_all(&at).map_err(Error::io(&at))?;
        Ok(cost)
    }

    /// Of so many runs over a road of so many km.
    fn fuse(&self, at: &Path, runs: usize, km: usize) -> Result<Cost> {
        let at = at.join(format!("fleet_{runs}_{km}"));
        let mut fleet = Command::new(&self.fleet);
        let cells = runs * (km * 400 + 1);
        fleet
            .arg(&at)
            .args([cells.to_string(), "1".into(), km.to_string()]);
        cost(&mut fleet)?;
        let mut fuse = Command::new(&self.roadgrade);
        fuse.arg("fuse")
            .arg("--out")
            .arg(at.join("map.parquet"))
            .arg("--road")
            .arg(at.join("road.csv"))
            .arg(at.join("runs"));
        let cost = cost(&mut fuse)?;
        fs::remove_dir_all(&at).map_err(Error::io(&at))?;
        Ok(cost)
    }
}

/// Runs a program to its end.
fn cost(command: &mut Command) -> Result<Cost> {
    let program = PathBuf::from(command.get_program());
    let child = command
        .stdout(Stdio::null())
        .stderr(Stdio::inherit())
        .spawn()
        .map_err(Error::io(&program))?;
    let used = child.wait4().map_err(Error::io(&program))?;
    if !used.status.success() {
        return Err(Error::content(&program, used.status.to_string()));
    }
    let time = used.rusage.utime + used.rusage.stime;
    Ok(Cost {
        seconds: time.as_secs_f64(),
        megabytes: used.rusage.maxrss as f64 * 1e-6,
    })
}
