//! What is run: the commands, and how a case is drawn from its seed.

use rand::{Rng, RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::path::{Path, PathBuf};
use test_kit::damage::{WORDS, pick};

/// Commands over the good files. A name of a good file, or of a folder of them, is an input; `out`,
/// `out.…` and `placed` are written.
pub const COMMANDS: &[&str] = &[
    "fuse --out out.csv run.csv",
    "fuse --out out.csv --road line.csv run.csv run.parquet",
    "fuse --out out.csv --road net.geojson --session a=run.csv,run.parquet",
    "fuse --out out.parquet --road net.csv run.csv",
    "fuse --out out.csv --road net.osm.pbf run.csv",
    "fuse --out out.parquet --placed placed run.csv",
    "place --road net.geojson --out placed --json run.csv",
    "place --road line.csv --out placed runs",
    "fuse --out out.csv --store new.csv run.csv run.parquet",
    "fuse --out out.csv run.parquet",
    "fuse --out out.csv --session a=run.parquet,run.csv",
    "fuse --out out.csv --road map.csv run.csv",
    "fuse --out out.csv --road map.parquet run.csv",
    "fuse --out out.csv --road run.parquet run.csv",
    "fuse --out out.csv --store store.csv",
    "fuse --out out.csv --store store.csv folder.csv",
    "fuse --out out.csv --store store_net.csv --road net.geojson folder.csv",
    "fuse --out out.csv runs",
    "fuse --strict --out out.csv runs",
    "score --truth a.truth.csv --out out.csv a.csv",
    "score --truth a.truth.csv --out out.csv --json a.parquet a.csv",
    "score --truth a.truth.csv --log drive.log --oracle a.oracle.toml --out out.csv a.csv",
    "score --truth a.truth.csv --log drive.log --vehicle a.vehicle.toml --out out.csv a.csv",
    "export map.csv --out out.geojson",
    "export map.csv --out out.geojson --pieces 100",
    "export map.csv --out out.html",
    "export map.csv --out out",
    "export map_net.csv --out out.geojson",
    "export map_net.csv --out out",
    "export map_net.csv --road net.geojson --format edges --out out.csv",
    "export map_net.csv --road net.geojson --format inclines --out out.geojson",
    "export map_osm.csv --road net.osm.pbf --out out.osc",
    "export map_net.parquet --out out.html",
    "export map.parquet --out out.geojson",
    "simulate --scenario scenario.toml --out out",
    "simulate --scenario with_road.toml --out out",
    "inspect --json table.csv",
    "inspect --all drive.log",
    "inspect --json drive.log",
    "inspect drive.log.gz",
    "inspect table.csv.gz",
    "estimate --vehicle force.toml --out out.csv table.csv",
    "estimate --vehicle force.toml --out out.parquet --kept kept table.csv",
    "estimate --vehicle force.toml --tuning tuning.toml --out out.csv table.csv",
    "estimate --double --json --vehicle force.toml --out out.csv table.csv.gz",
    "estimate --vehicle a.vehicle.toml --out out.csv drive.log",
    "estimate --vehicle a.vehicle.toml --out out.csv drive.log.gz",
    "estimate --vehicle a.vehicle.toml --dataset out --day 2026-11-21 drive.log",
    "diagnose --vehicle force.toml --out out table.csv other.csv",
    "diagnose --vehicle force.toml --out out --reference reference.csv table.csv --holdout other.csv",
    "diagnose --vehicle a.vehicle.toml --tuning tuning.toml --out out --json drive.log",
    "import ztbus mission.csv --out out",
    "import i3 TripA01.csv TripA02.csv.gz --out out",
    "replay --can no_such_0 drive.log",
    "replay --can no_such_0 --speed 10 --log-time drive.log.gz",
    "listen --can no_such_0 --vehicle force.toml --kept kept --out out.csv",
    "listen --can no_such_0 --vehicle force.toml --tuning tuning.toml --log out.log --publish",
    "study ztbus --data data --out out",
    "study i3 --data data --out out",
];

/// Commands of seconds, drawn once in [`SLOW_EVERY`] cases.
const SLOW_COMMANDS: &[&str] = &[
    "demo --out out --tuning tuning.toml",
    "study gps --data data --out out --seed 5",
];
const SLOW_EVERY: u32 = 2_000;

/// Names that are no files of the kind that is expected.
const NO_FILES: [&str; 5] = [".", "no_such_file", "/dev/null", "runs", ""];

/// One case.
pub struct Case {
    pub seed: u64,
    /// The command line, without the name of the program.
    pub words: Vec<String>,
    /// Good files that are damaged, relative to their folder.
    pub damaged: Vec<PathBuf>,
    /// Draws the damage.
    pub random: ChaCha8Rng,
}

impl Case {
    /// Draws a case. `good` are the good files, relative to their folder.
    pub fn draw(seed: u64, good: &[PathBuf]) -> Self {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let commands = if random.random_range(0..SLOW_EVERY) == 0 {
            SLOW_COMMANDS
        } else {
            COMMANDS
        };
        let command = *pick(commands, &mut random);
        let mut words: Vec<String> = command.split(' ').map(str::to_owned).collect();
        let mut is_mistaken = false;
        if random.random_range(0..8) == 0 {
            is_mistaken = mistake_a_file(&mut words, good, &mut random);
        }
        if random.random_range(0..16) == 0 {
            let place = random.random_range(1..words.len());
            words[place] = (*pick(&WORDS, &mut random)).to_owned();
            is_mistaken = true;
        }
        let inputs: Vec<PathBuf> = words.iter().flat_map(|word| inputs(word, good)).collect();
        let fewest = usize::from(!is_mistaken);
        let count = random.random_range(fewest..3).min(inputs.len());
        let damaged = (0..count).map(|_| pick(&inputs, &mut random).clone());
        let damaged = damaged.collect();
        Self {
            seed,
            words,
            damaged,
            random,
        }
    }
}

/// Returns the names in a word of a command line, such as those of `a=run.csv,run.parquet`.
fn names(word: &str) -> impl Iterator<Item = &str> {
    word.split(['=', ','])
}

/// Returns the good files that a word names: a file, several, or all of a folder.
fn inputs(word: &str, good: &[PathBuf]) -> Vec<PathBuf> {
    let named = |name: &str, path: &Path| !name.is_empty() && path.starts_with(name);
    names(word)
        .flat_map(|name| good.iter().filter(move |path| named(name, path)).cloned())
        .collect()
}

/// Puts another file in place of an input. Returns false if there is no input.
fn mistake_a_file(words: &mut [String], good: &[PathBuf], random: &mut impl Rng) -> bool {
    let places: Vec<usize> = (0..words.len())
        .filter(|place| !inputs(&words[*place], good).is_empty())
        .collect();
    if places.is_empty() {
        return false;
    }
    let place = *pick(&places, random);
    let named: Vec<String> = names(&words[place]).map(str::to_owned).collect();
    let of_files: Vec<&String> = named
        .iter()
        .filter(|name| !inputs(name, good).is_empty())
        .collect();
    let old = *pick(&of_files, random);
    let new = if random.random_range(0..4) == 0 {
        (*pick(&NO_FILES, random)).to_owned()
    } else {
        pick(good, random).to_string_lossy().into_owned()
    };
    words[place] = words[place].replacen(old.as_str(), &new, 1);
    true
}
