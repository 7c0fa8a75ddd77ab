//! `roadgrade fuse`.

use super::Cli;
use crate::error::{Error, Result};
use crate::map::{
    self, Agreement, Coverage, FusedMap, GradeMap, RoadLine, RoadPoint, RoadRow, SessionRun, Store,
    check_session_name,
};
use crate::run_file::{self, RunRow};
use clap::CommandFactory;
use rayon::prelude::*;
use std::path::{Path, PathBuf};

/// Runs in memory at once.
const BATCH: usize = 8;

/// Arguments of `fuse`.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Each run is placed on the road by position and course; the odometer only carries from one \
    position to the next. Where a run is off the road, crosses it or drives it the other way, it \
    adds nothing. Smoothed grades and altitudes are then weighted by the inverse of their \
    variances, every 2.5 m. Cells that no run covers have no row in the map.\n\n\
    Runs of one vehicle on one day share its errors, so more of them help less and less: name \
    them with --session, and they count as one estimate whose variance keeps the share that they \
    have in common. The sessions then make the map, less a smaller share common to all. Both \
    shares are learned from how far runs disagree; runs that disagree more than their sigmas \
    allow make the map's sigmas larger.\n\n\
    With --store the sums behind the map are kept in a file, and later runs are added to them \
    without the earlier ones; its size depends on the road and on the sessions that have names, \
    not on the number of runs. A run added twice counts twice.\n\n\
    Examples:\n  \
    roadgrade fuse --out map.csv monday.csv tuesday.csv\n  \
    roadgrade fuse --out map.csv --session truck7=a1.csv,a2.csv,a3.csv b.csv\n  \
    roadgrade fuse --out map.csv --store sums.csv --session truck7=a4.csv"
)]
pub struct Args {
    /// Where the map goes: distance_m, latitude_deg, longitude_deg, altitude_m, grade_percent,
    /// grade_sigma_percent, runs.
    #[arg(long, value_name = "MAP.csv")]
    out: PathBuf,
    /// The road, as distance_m, latitude_deg, longitude_deg from point to point in the direction
    /// of travel (a map serves too). Without it the road is that of the store, or else the track
    /// of the first run.
    #[arg(long, value_name = "ROAD.csv")]
    road: Option<PathBuf>,
    /// Runs of one vehicle in one session, under a name; may be repeated, for other sessions and
    /// for the same.
    #[arg(long = "session", value_name = "NAME=RUN.csv,RUN.csv", value_parser = session)]
    sessions: Vec<Session>,
    /// Sums to start from, if the file exists; written with the new runs in them. Without runs,
    /// the map of the sums.
    #[arg(long, value_name = "SUMS.csv")]
    store: Option<PathBuf>,
    /// Runs to fuse, as `estimate` wrote them, each a session of its own.
    #[arg(required_unless_present_any = ["sessions", "store"], value_name = "RUN.csv")]
    runs: Vec<PathBuf>,
}

/// A session on the command line.
#[derive(Clone, Debug)]
struct Session {
    name: String,
    runs: Vec<PathBuf>,
}

/// One run to fuse.
struct Input<'a> {
    session: Option<&'a str>,
    path: &'a Path,
}

/// Sums of earlier runs.
struct Stored<'a> {
    path: &'a Path,
    store: Store,
}

/// Runs it.
pub fn run(args: &Args) -> Result<()> {
    if args.store.as_ref() == Some(&args.out) {
        let problem = "--store and --out name the same file; expected two";
        Cli::command()
            .error(clap::error::ErrorKind::ArgumentConflict, problem)
            .exit();
    }
    let inputs: Vec<Input> = args.inputs().collect();
    let stored = args.stored(inputs.is_empty())?;
    let road = args.road(&inputs, stored.as_ref())?;
    let mut sums = match &stored {
        Some(stored) => stored.store.resume(&road),
        None => GradeMap::new(&road),
    };
    add(&mut sums, &inputs)?;
    let fused = sums.fused();
    if fused.rows.is_empty() {
        let first = inputs.first().map(|input| input.path);
        let path = first.or(args.store.as_deref()).unwrap_or(&args.out);
        let problem = "no cell of the road is covered; expected runs over it, in its direction";
        return Err(Error::content(path, problem));
    }
    let map_file = map::stage_map(&args.out, &fused.rows)?;
    let store_file = match &args.store {
        Some(path) if !inputs.is_empty() => Some(map::stage_store(path, &sums)?),
        _ => None,
    };
    map_file.commit()?;
    if let Some(file) = store_file {
        // Last: should it fail, the runs are not in the store and can be added again.
        file.commit()?;
    }
    report(&args.out, &fused);
    Ok(())
}

impl Args {
    fn inputs(&self) -> impl Iterator<Item = Input<'_>> {
        let alone = self.runs.iter().map(|path| Input {
            session: None,
            path,
        });
        let named = self.sessions.iter().flat_map(|session| {
            session.runs.iter().map(|path| Input {
                session: Some(&session.name),
                path,
            })
        });
        alone.chain(named)
    }

    /// The sums to start from; there must be some if there is nothing to add.
    fn stored(&self, required: bool) -> Result<Option<Stored<'_>>> {
        match &self.store {
            Some(path) if required || path.exists() => {
                let store = map::read_store(path)?;
                Ok(Some(Stored { path, store }))
            }
            _ => Ok(None),
        }
    }

    /// The road, as a point for each of its cells whether it comes from a store or not: runs
    /// that are added later are then placed exactly as they would have been at first.
    fn road(&self, inputs: &[Input], stored: Option<&Stored>) -> Result<RoadLine> {
        let given = self.road.as_deref().map(road_from_file).transpose()?;
        let Some(Stored { path, store }) = stored else {
            return given.map_or_else(|| road_from_runs(inputs), Ok);
        };
        if given.is_some_and(|road| !store.is_of(&road)) {
            let problem = "the store of another road; expected the one of --road, or no --road";
            return Err(Error::content(path, problem));
        }
        line(path, store.road.clone())
    }
}

/// A session from the command line.
fn session(argument: &str) -> std::result::Result<Session, String> {
    let expected = "expected NAME=RUN.csv,RUN.csv";
    let (name, runs) = argument.split_once('=').ok_or(expected)?;
    check_session_name(name)
        .map_err(|flaw| format!("{}; expected {}", flaw.problem, flaw.expected))?;
    let runs: Vec<PathBuf> = runs.split(',').map(PathBuf::from).collect();
    if runs.iter().any(|path| path.as_os_str().is_empty()) {
        return Err(expected.to_owned());
    }
    Ok(Session {
        name: name.to_owned(),
        runs,
    })
}

/// Adds the runs, a few in memory at a time.
fn add(sums: &mut GradeMap, inputs: &[Input]) -> Result<()> {
    let mut unmatched = 0;
    for batch in inputs.chunks(BATCH) {
        // Collected before they are judged: which error is told must not depend on threads.
        let read: Vec<Result<Vec<RunRow>>> = batch
            .par_iter()
            .map(|input| run_file::read(input.path))
            .collect();
        let read = read.into_iter().collect::<Result<Vec<_>>>()?;
        let runs: Vec<SessionRun> = batch
            .iter()
            .zip(&read)
            .map(|(input, rows)| SessionRun {
                session: input.session,
                rows,
            })
            .collect();
        let fusion = map::fuse(sums.road(), &runs);
        sums.merge(&fusion.map);
        for (input, coverage) in batch.iter().zip(&fusion.coverage) {
            eprintln!("{}", describe(input.path, coverage));
            unmatched += usize::from(coverage.matched == 0);
        }
    }
    match inputs.first() {
        Some(first) if unmatched == inputs.len() => Err(Error::content(
            first.path,
            format!(
                "neither this nor another of {unmatched} runs covers a cell of the road; expected \
                 runs over the road, in its direction"
            ),
        )),
        _ => {
            if unmatched > 0 {
                eprintln!("warning: {unmatched} of {} runs gave nothing", inputs.len());
            }
            Ok(())
        }
    }
}

/// The road through these points, with a point for each of its cells.
fn line(path: &Path, points: Vec<RoadPoint>) -> Result<RoadLine> {
    RoadLine::new(points)
        .and_then(|line| RoadLine::new(line.on_grid()))
        .map_err(|problem| Error::content(path, problem.to_string()))
}

fn road_from_file(path: &Path) -> Result<RoadLine> {
    let rows = map::read_road(path)?;
    line(path, rows.iter().map(RoadRow::point).collect())
}

/// The road of the first run that has a track.
fn road_from_runs(inputs: &[Input]) -> Result<RoadLine> {
    for Input { path, .. } in inputs {
        match map::road_of_run(&run_file::read(path)?) {
            Some(track) => return line(path, track),
            None => eprintln!(
                "warning: {}: no positions to take the road from",
                path.display()
            ),
        }
    }
    let first = inputs.first().map_or(Path::new(""), |input| input.path);
    Err(Error::content(
        first,
        "no positions, nor in any other run; expected latitude_deg and longitude_deg in the rows",
    ))
}

fn report(out: &Path, fused: &FusedMap) {
    let cells = fused.rows.len();
    let km = cells as f64 * map::GRID_M / 1000.0;
    eprintln!("{}: {cells} cells, {km:.2} km", out.display());
    for (name, agreement) in &fused.within {
        tell(&format!("runs of session {name}"), agreement);
    }
    tell("sessions", &fused.between);
}

/// Says how far estimates agree, where two of them meet.
fn tell(who: &str, agreement: &Agreement) {
    let Agreement {
        disagreement,
        dependence,
    } = agreement;
    let Some(ratio) = disagreement.ratio() else {
        return;
    };
    let inflation = if dependence.inflation > 1.0 {
        format!(
            ", sigmas made {:.2} times as large",
            dependence.inflation.sqrt()
        )
    } else {
        String::new()
    };
    eprintln!(
        "{who} differ by {:.2} times what their sigmas promise (squared: {ratio:.2}); taken as \
         common: {:.0} % of the variance{inflation}",
        ratio.sqrt(),
        100.0 * dependence.share
    );
}

fn describe(path: &Path, coverage: &Coverage) -> String {
    let Coverage {
        cells,
        matched,
        off_road,
        opposite,
        no_position,
    } = coverage;
    let warning = if *matched > 0 {
        ""
    } else if opposite > off_road {
        "; warning: drives the other way, fuse it with runs of its direction"
    } else {
        "; warning: nowhere on the road"
    };
    format!(
        "{}: {cells} cells: {matched} matched, {off_road} off the road, {opposite} in the \
         opposite direction, {no_position} without position{warning}",
        path.display()
    )
}
