//! Times all contenders in turn and prints the table:
//!
//! ```text
//! beside TURNS [PYTHON]                     times, with the peers in Python if there is one that has them
//! beside count f32|f64 NAME STATES STEPS    one filter alone, to count its instructions
//! ```

use benches::stopwatch::{STEPS, Stopwatch};
use benches::table::{BenchTimes, table};
use benches::work::Work;
use benches::{Contender, double, single};
use serde_json::Value;
use std::error::Error;
use std::path::Path;
use std::process::Command;
use std::time::Instant;

/// Turns of the filters for each turn of the other work, which takes longer.
const FILTER_TURNS: usize = 10;
/// Largest difference of two filters that do the same work, absolute or relative.
const AGREEMENT: [f64; 2] = [1e-3, 1e-9];
/// The filters' sizes.
const SIZES: [usize; 3] = [8, 5, 3];
const OURS: &str = "ours";

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    match &*arguments.iter().map(String::as_str).collect::<Vec<_>>() {
        ["count", precision, name, states, steps] => {
            let all: Vec<Contender<Stopwatch>> = match *precision {
                "f32" => single::contenders(),
                _ => double::contenders(),
            };
            let states: usize = states.parse()?;
            let found = all.iter().find(|c| c.name == *name && c.states == states);
            (found.ok_or("no such filter")?.measure)(&mut Stopwatch::new(steps.parse()?));
            Ok(())
        }
        [turns] => beside(turns.parse()?, None),
        [turns, python] => beside(turns.parse()?, Some(python)),
        _ => Err("expected TURNS [PYTHON], or count f32|f64 NAME STATES STEPS".into()),
    }
}

fn beside(turns: usize, python: Option<&str>) -> Result<(), Box<dyn Error>> {
    filters(turns, python)?;
    drive(turns, python)
}

/// A filter's turns, and its last state in the first turn.
struct FilterTurns {
    states: usize,
    precision: usize,
    figure: BenchTimes,
    state: Vec<f64>,
}

fn filters(turns: usize, python: Option<&str>) -> Result<(), Box<dyn Error>> {
    let mut all: Vec<FilterTurns> = Vec::new();
    for turn in 0..turns * FILTER_TURNS {
        let mut number = 0;
        let mut note = |precision, name: &str, states, step_ns, state: Vec<f64>| {
            if turn == 0 {
                let figure = BenchTimes {
                    name: name.to_owned(),
                    unit: "step",
                    turns_ns: Vec::new(),
                };
                all.push(FilterTurns {
                    states,
                    precision,
                    figure,
                    state,
                });
            }
            all[number].figure.turns_ns.push(step_ns);
            number += 1;
        };
        for contender in single::contenders() {
            let mut watch = Stopwatch::new(STEPS);
            (contender.measure)(&mut watch);
            note(
                0,
                contender.name,
                contender.states,
                watch.step_ns,
                watch.state,
            );
        }
        for contender in double::contenders() {
            let mut watch = Stopwatch::new(STEPS);
            (contender.measure)(&mut watch);
            note(
                1,
                contender.name,
                contender.states,
                watch.step_ns,
                watch.state,
            );
        }
        if let Some(python) = python.filter(|_| turn % FILTER_TURNS == 0) {
            for (size, found) in SIZES.iter().zip(ask(python, "filter.py", &SIZES)?) {
                let state = serde_json::from_value(found["state"].clone())?;
                let step_ns = found["step_ns"].as_f64().ok_or("no time")?;
                note(1, "filterpy (Python)", *size, step_ns, state);
            }
        }
    }
    for (precision, title) in ["f32", "f64"].into_iter().enumerate() {
        for size in SIZES {
            let of_size = |f: &&FilterTurns| f.states == size && f.precision == precision;
            let here: Vec<&FilterTurns> = all.iter().filter(of_size).collect();
            agree(&here, AGREEMENT[precision])?;
            let figures: Vec<BenchTimes> = here.iter().map(|f| f.figure.clone()).collect();
            let base = if size == 8 { OURS } else { &figures[0].name };
            println!("{size} states, {title}\n{}\n", table(&figures, base));
        }
    }
    Ok(())
}

/// Checks that the states of all peers agree with that of the first.
fn agree(filters: &[&FilterTurns], tolerance: f64) -> Result<(), String> {
    let mut peers = filters.iter().filter(|f| f.figure.name != OURS);
    let Some(first) = peers.next() else {
        return Ok(());
    };
    for other in peers {
        let is_near = |(a, b): (&f64, &f64)| (a - b).abs() <= tolerance * b.abs().max(1.0);
        if !other.state.iter().zip(&first.state).all(is_near) {
            let (name, state) = (&other.figure.name, &other.state);
            return Err(format!(
                "{name} ended at {state:?}, others at {:?}",
                first.state
            ));
        }
    }
    Ok(())
}

fn drive(turns: usize, python: Option<&str>) -> Result<(), Box<dyn Error>> {
    const BASE: &str = "log read and decode";
    let work = Work::prepare()?;
    let log = work.log();
    let mut jobs = work.jobs();
    let mut figures: Vec<BenchTimes> = jobs
        .iter()
        .map(|job| BenchTimes {
            name: job.name.to_owned(),
            unit: job.unit,
            turns_ns: Vec::new(),
        })
        .collect();
    let mut python_decode = BenchTimes {
        name: "python-can and cantools".to_owned(),
        unit: "frame",
        turns_ns: Vec::new(),
    };
    for _ in 0..turns {
        for (job, figure) in jobs.iter_mut().zip(&mut figures) {
            let started = Instant::now();
            (job.run)();
            let units = job.units as f64;
            figure
                .turns_ns
                .push(started.elapsed().as_secs_f64() * 1e9 / units);
        }
        if let Some(python) = python {
            for found in ask(python, "decode.py", &[&log.to_string_lossy()])? {
                python_decode
                    .turns_ns
                    .push(found["frame_ns"].as_f64().ok_or("no time")?);
            }
        }
    }
    figures.extend((!python_decode.turns_ns.is_empty()).then_some(python_decode));
    println!("40 km, {} frames\n{}", work.frames(), table(&figures, BASE));
    Ok(())
}

/// Runs a program in Python and returns its output, one JSON object a line.
fn ask(
    python: &str,
    program: &str,
    arguments: &[impl ToString],
) -> Result<Vec<Value>, Box<dyn Error>> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("python");
    let output = Command::new(python)
        .arg(folder.join(program))
        .args(arguments.iter().map(ToString::to_string))
        .output()?;
    if !output.status.success() {
        return Err(String::from_utf8_lossy(&output.stderr).into());
    }
    let text = String::from_utf8(output.stdout)?;
    Ok(text
        .lines()
        .map(serde_json::from_str)
        .collect::<Result<_, _>>()?)
}
