//! `roadgrade fuse`.

mod inputs;
mod intake;
mod words;

use super::Cli;
use crate::error::{Error, Result};
use crate::files::run;
use crate::map::{
    self, GradeMap, Network, RunList, Store, Way, check_session_name, read_network, road_through,
};
use clap::CommandFactory;
use inputs::Inputs;
use intake::Intake;
use std::path::{Path, PathBuf};

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
    A network has many ways, each in one direction of travel: lines of a GeoJSON file with a \
    property \"way\" (else @id, id, osm_id, or the feature's id), in both directions unless \"oneway\" \
    says yes (or -1: against its points; roundabouts and motorways are one-way without it). A run \
    passes from way to way where they share a point or one ends at another; a parallel road or a \
    bridge above is not entered. The map then has columns way and direction, and distances count \
    along each way in that direction.\n\n\
    With --store the sums behind the map are kept in a file, and later runs are added to them \
    without the earlier ones; its size depends on the road and on the sessions that have names, \
    not on the number of runs (a line each). It is written now and then on the way: a fusion that \
    was interrupted goes on from there when it is started again. A run that is in the map \
    already, whatever its file is called now, is not counted again.\n\n\
    A folder stands for all runs in it and its folders (.parquet, .csv), as those of \
    `estimate --dataset`. A damaged file in a folder is named and left out whole, and the exit \
    status is still 0 (--strict: 1, and no map); a damaged file that is named here is an error. \
    A RUN.parquet knows its session if `estimate --day` has told it.\n\n\
    Files are CSV or, if their names end in .parquet, Parquet; SUMS.csv is CSV. Give --road where \
    runs come in no order: without it the first one decides where cells begin.\n\n\
    Examples:\n  \
    roadgrade fuse --out map.csv monday.csv tuesday.csv\n  \
    roadgrade fuse --out map.parquet --road road.csv --store sums.csv runs/tile=N47E008\n  \
    roadgrade fuse --out a1.parquet --placed placed runs     (for SQL: host-sim/sql/fuse.sql)\n  \
    roadgrade fuse --out map.parquet --road network.geojson runs\n  \
    roadgrade fuse --out map.csv --session truck7=a1.csv,a2.csv,a3.csv b.csv\n  \
    roadgrade fuse --out map.csv --store sums.csv --session truck7=a4.csv"
)]
pub struct Args {
    /// Where the map goes: distance_m, latitude_deg, longitude_deg, altitude_m, grade_percent,
    /// grade_sigma_percent, runs; of a network, way and direction come first.
    #[arg(long, value_name = "MAP.csv")]
    out: PathBuf,
    /// The road, as distance_m, latitude_deg, longitude_deg from point to point in the direction
    /// of travel (a map serves too), or a network: the same with a column way, or a GeoJSON file
    /// of LineStrings. Without it the road is that of the store, or else the track of the first
    /// run.
    #[arg(long, value_name = "ROAD.csv|NET.geojson")]
    road: Option<PathBuf>,
    /// Runs of one vehicle in one session, under a name; may be repeated, for other sessions and
    /// for the same.
    #[arg(long = "session", value_name = "NAME=RUN.csv,RUN.csv", value_parser = session)]
    sessions: Vec<Session>,
    /// Sums to start from, if the file exists; written with the new runs in them. Without runs,
    /// the map of the sums.
    #[arg(long, value_name = "SUMS.csv")]
    store: Option<PathBuf>,
    /// Where each run goes as it lies on the road, as DIR/road=MAP/*.parquet, MAP being the name
    /// of the map's file: from these, SQL makes the same map.
    #[arg(long, value_name = "DIR")]
    placed: Option<PathBuf>,
    /// A damaged file in a folder is an error.
    #[arg(long)]
    strict: bool,
    /// Runs to fuse, or folders of them, as `estimate` wrote them, each a session of its own
    /// unless it tells another.
    #[arg(required_unless_present_any = ["sessions", "store"], value_name = "RUN")]
    runs: Vec<PathBuf>,
}

/// A session on the command line.
#[derive(Clone, Debug)]
struct Session {
    name: String,
    runs: Vec<PathBuf>,
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
    let mut inputs = args.inputs()?;
    if inputs.runs.is_empty() && !inputs.damaged.is_empty() {
        return Err(inputs.damaged.swap_remove(0));
    }
    let stored = args.stored(inputs.runs.is_empty())?;
    let road = args.road(&inputs, stored.as_ref())?;
    if let (Some(_), Some(path), [Way { name: Some(_), .. }, ..]) =
        (&args.placed, &args.road, road.ways())
    {
        let problem = "a network; expected a single road with --placed";
        return Err(Error::content(path, problem));
    }
    let (sums, runs) = match &stored {
        Some(Stored { store, .. }) => (store.resume(&road), store.runs.clone()),
        None => (GradeMap::new(&road), RunList::default()),
    };
    let first = inputs.runs.first().map(|input| input.path.clone());
    let store = args.store.as_deref();
    let mut intake = Intake::new(sums, runs, store, args.placed_folder());
    intake.add(inputs, args.strict)?;
    let fused = intake.sums.fused();
    if fused.ways.is_empty() {
        let path = first.as_deref().or(store).unwrap_or(&args.out);
        let problem = "no cell of the road is covered; expected runs over it, in its direction";
        return Err(Error::content(path, problem));
    }
    let map_file = map::stage_map_ways(&args.out, &fused.ways)?;
    let store_file = match &args.store {
        Some(path) if intake.tally.added > 0 => {
            Some(map::stage_store(path, &intake.sums, &intake.runs)?)
        }
        _ => None,
    };
    map_file.commit()?;
    if let Some(file) = store_file {
        // Last: should it fail, the runs are not in the store and can be added again.
        file.commit()?;
    }
    words::report(&args.out, &fused);
    Ok(())
}

impl Args {
    fn inputs(&self) -> Result<Inputs> {
        let mut inputs = Inputs::default();
        for path in &self.runs {
            inputs.add(path, None)?;
        }
        for session in &self.sessions {
            for path in &session.runs {
                inputs.add(path, Some(&session.name))?;
            }
        }
        inputs.sort();
        Ok(inputs)
    }

    /// Hive's layout: the road is a column whose value the folder has.
    fn placed_folder(&self) -> Option<PathBuf> {
        let road = self.out.file_stem().unwrap_or_default().to_string_lossy();
        Some(self.placed.as_ref()?.join(format!("road={road}")))
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

    /// The road or the network. A single road has a point for each of its cells whether it comes
    /// from a store or not: runs that are added later are then placed exactly as they would have
    /// been at first.
    fn road(&self, inputs: &Inputs, stored: Option<&Stored>) -> Result<Network> {
        let given = self.road.as_deref().map(read_network).transpose()?;
        let Some(Stored { path, store }) = stored else {
            return given.map_or_else(|| road_from_runs(inputs), Ok);
        };
        if given.as_ref().is_some_and(|road| !store.is_of(road)) {
            let problem = "the store of another road; expected the one of --road, or no --road";
            return Err(Error::content(path, problem));
        }
        match (store.road(), given) {
            (Some(points), _) => road_through(path, points.to_vec()),
            (None, Some(network)) => Ok(network),
            (None, None) => {
                let problem = "the store of a network; expected its file by --road too";
                Err(Error::content(path, problem))
            }
        }
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

/// The road of the first run that has a track.
fn road_from_runs(inputs: &Inputs) -> Result<Network> {
    let mut damage = None;
    for input in &inputs.runs {
        let path = &input.path;
        let track = match run::read_cells(path) {
            Ok((cells, _)) => map::road_of_run(&cells),
            // Told when it is its turn, if another run gives the road.
            Err(e) if input.found => {
                damage.get_or_insert(e);
                continue;
            }
            Err(e) => return Err(e),
        };
        match track {
            Some(track) => return road_through(path, track),
            None => eprintln!(
                "warning: {}: no positions to take the road from",
                path.display()
            ),
        }
    }
    let first = inputs.runs.first();
    Err(damage.unwrap_or_else(|| {
        Error::content(
            first.map_or(Path::new(""), |input| &input.path),
            "no positions, nor in any other run; expected latitude_deg and longitude_deg in the \
             rows",
        )
    }))
}
