//! Good files, damaged at random, in every command: an error or a result, never a panic, a hang,
//! all memory, half a file or a number that is none.
//!
//! `BAD_INPUT_CASES` is the number of cases, `BAD_INPUT_SEED` the first seed; each case has its own,
//! which a failure names.

use crate::shell::{limited, names, rows, stderr};
use flate2::write::GzEncoder;
use host_sim::files::run::{self, Origin};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use std::fs;
use std::io::Write as _;
use std::path::Path;
use std::process::Command;
use tempfile::TempDir;
use test_kit::command::roadgrade;
use test_kit::roads::{hills, network};

/// Commands; `{}` is the file that is damaged. `out` is a file or a folder that they write.
const COMMANDS: [(&str, &str); 40] = [
    ("run.csv", "fuse --out out.csv {}"),
    (
        "run.csv",
        "fuse --out out.csv --road road.csv {} run.parquet",
    ),
    (
        "run.csv",
        "fuse --out out.csv --road net.geojson --session a={},run.parquet",
    ),
    (
        "run.csv",
        "fuse --out out.parquet --store store.csv --placed placed {}",
    ),
    ("run.csv", "score --truth truth.csv --out out.csv {}"),
    ("run.parquet", "fuse --out out.csv {}"),
    ("run.parquet", "fuse --out out.csv --session a={},run.csv"),
    ("run.parquet", "score --truth truth.csv --out out.csv {}"),
    ("run.parquet", "fuse --out out.csv --road {} run.csv"),
    ("store.csv", "fuse --out out.csv --store {}"),
    ("store.csv", "fuse --out out.csv --store {} run.csv"),
    ("map.csv", "export {} --out out.geojson"),
    ("map.csv", "export {} --out out.geojson --pieces 100"),
    ("map.csv", "export {} --out out.html"),
    ("map.csv", "export {} --out out"),
    ("map.csv", "fuse --out out.csv --road {} run.csv"),
    ("map.parquet", "export {} --out out.geojson"),
    ("map.parquet", "fuse --out out.csv --road {} run.csv"),
    ("net.geojson", "fuse --out out.csv --road {} run.csv"),
    ("road.csv", "fuse --out out.csv --road {} run.csv"),
    ("road.csv", "simulate --scenario with_road.toml --out out"),
    ("truth.csv", "score --truth {} --out out.csv run.csv"),
    ("table.csv", "inspect --json {}"),
    (
        "table.csv",
        "estimate --vehicle force.toml --out out.csv {}",
    ),
    (
        "table.csv",
        "estimate --vehicle force.toml --out out.parquet --kept kept {}",
    ),
    (
        "table.csv",
        "diagnose --vehicle force.toml --out out {} other.csv",
    ),
    (
        "table.csv.gz",
        "estimate --vehicle force.toml --out out.csv {}",
    ),
    ("drive.log", "inspect --json {}"),
    (
        "drive.log",
        "estimate --vehicle a.vehicle.toml --out out.csv {}",
    ),
    (
        "drive.log",
        "estimate --vehicle a.vehicle.toml --dataset out --day 2026-11-21 {}",
    ),
    ("drive.log.gz", "inspect {}"),
    ("drive.log", "replay --can no_such_0 {}"),
    (
        "force.toml",
        "estimate --vehicle {} --out out.csv table.csv",
    ),
    (
        "a.vehicle.toml",
        "estimate --vehicle {} --out out.csv drive.log",
    ),
    (
        "a.oracle.toml",
        "score --truth a.truth.csv --log drive.log --oracle {} --out out.csv a.csv",
    ),
    (
        "tuning.toml",
        "estimate --tuning {} --vehicle force.toml --out out.csv table.csv",
    ),
    (
        "kept",
        "estimate --kept {} --vehicle force.toml --out out.csv table.csv",
    ),
    ("scenario.toml", "simulate --scenario {} --out out"),
    ("mission.csv", "import ztbus {} --out out"),
    ("folder.csv", "fuse --out out.csv {} run.csv run.parquet ."),
];

const VEHICLE: &str = "[vehicle]\nname = \"A\"\nmass_kg = 39000.0\ndrag_area_m2 = 6.0\n\
    rolling_resistance = 0.0065\nwheel_radius_m = 0.5\nwheel_inertia_kgm2 = 100.0\n\
    [traction]\nsource = \"force\"\n[effects.tyre_warmup]\namount = 0.3\namount_sigma = 0.04\n";
const SCENARIO: &str = "seed = 3\n[road]\nlength_m = 1200.0\nstart_altitude_m = 40.0\n\
    [gnss]\naltitude_sigma_m = 3.0\nsteps = [[100.0, 200.0, 5.0]]\n[wind]\nspeed_mps = 3.0\n\
    [planted]\nfan_w = 1000.0\n[errors]\nmass_factor = 1.1\n\
    [[runs]]\nname = \"a\"\ntruck = \"A\"\n";

fn table(km: f64, lift_m: f64) -> String {
    let mut text = String::from(
        "time_s,wheel_speed_mps,traction_force_n,latitude_deg,longitude_deg,altitude_m\n",
    );
    for second in 0..(40.0 * km) as usize {
        let at_m = 25.0 * second as f64;
        let altitude_m = 400.0 + 30.0 * (at_m / 1_000.0).sin() + lift_m;
        let force_n = 4_700.0 + 39_000.0 * 9.81 * 0.03 * (at_m / 1_000.0).cos();
        let latitude_deg = 47.0 + at_m / 111e3;
        text += &format!("{second}.0,25.0,{force_n:.0},{latitude_deg:.7},8.5,{altitude_m:.2}\n");
    }
    text
}

fn mission() -> String {
    let header = "time_iso,time_unix,gnss_altitude,gnss_course,gnss_latitude,gnss_longitude,\
        itcs_numberOfPassengers,odometry_vehicleSpeed,status_haltBrakeIsActive,\
        status_parkBrakeIsActive,temperature_ambient,traction_brakePressure,traction_tractionForce\n";
    let row = |second: u32| {
        let latitude = 0.826 + f64::from(second) * 1e-6;
        format!(
            "x,{},400,1.0,{latitude},0.148,-,8,0,0,290,0,5000\n",
            1_571_000_000 + second
        )
    };
    header.to_owned() + &(0..200).map(row).collect::<String>()
}

fn zipped(content: &[u8]) -> Vec<u8> {
    let mut zip = GzEncoder::new(Vec::new(), Default::default());
    zip.write_all(content).unwrap();
    zip.finish().unwrap()
}

/// Writes every good file.
fn good() -> TempDir {
    let folder = TempDir::new().unwrap();
    let at = folder.path();
    let write = |name: &str, content: &[u8]| fs::write(at.join(name), content).unwrap();
    let done = |arguments: &str| {
        let arguments: Vec<&str> = arguments.split(' ').collect();
        roadgrade(at, &arguments).success();
    };
    run::write(&at.join("run.csv"), &rows(60, 0)).unwrap();
    run::write(&at.join("folder.csv"), &rows(60, 1)).unwrap();
    let origin = Origin {
        vehicle: Some("A".to_owned()),
        day: Some("2026-11-21".to_owned()),
    };
    run::write_from(&at.join("run.parquet"), &rows(60, 2), &origin).unwrap();
    done("fuse --out map.csv --store store.csv run.csv run.parquet");
    done("fuse --out map.parquet run.csv");
    network::save(
        &at.join("net.geojson"),
        &[network::way("w", "yes", &hills()[..60])],
    );
    write("table.csv", table(1.5, 0.0).as_bytes());
    write("other.csv", table(1.5, 1.0).as_bytes());
    write("table.csv.gz", &zipped(table(1.5, 0.0).as_bytes()));
    write("long.csv", table(8.0, 0.0).as_bytes());
    write("force.toml", VEHICLE.as_bytes());
    write(
        "tuning.toml",
        b"[measurement_noise]\nspeed_sigma_mps = 0.02\n[hold_times]\nshift_hold_ms = 1500\n",
    );
    write("mission.csv", mission().as_bytes());
    write("scenario.toml", SCENARIO.as_bytes());
    let with_road = "[road]\nfile = \"road.csv\"\n[[runs]]\nname = \"b\"\ntruck = \"B\"\n";
    write("with_road.toml", with_road.as_bytes());
    done("estimate --vehicle force.toml --out long_run.csv --kept kept long.csv");
    done("simulate --scenario scenario.toml --out sim");
    for name in ["a.vehicle.toml", "a.oracle.toml", "a.truth.csv", "road.csv"] {
        fs::copy(at.join("sim").join(name), at.join(name)).unwrap();
    }
    fs::copy(at.join("a.truth.csv"), at.join("truth.csv")).unwrap();
    let log = fs::read(at.join("sim/a.log")).unwrap();
    write("drive.log.gz", &zipped(&log));
    write("drive.log", &log);
    done("estimate --vehicle a.vehicle.toml --out a.csv drive.log");
    for name in ["sim", "long.csv", "long_run.csv"] {
        let path = at.join(name);
        let _ = fs::remove_dir_all(&path).or_else(|_| fs::remove_file(&path));
    }
    folder
}

/// Numbers and words that do not belong where they are put.
const WORDS: [&str; 16] = [
    "1e308",
    "-1e308",
    "NaN",
    "inf",
    "-inf",
    "1e-320",
    "-0",
    "",
    "9223372036854775808",
    "-1",
    "0x10",
    "1e9",
    "\"",
    "\u{1b}[2J",
    "1,1",
    "99999999",
];

/// Damages a file.
fn damage(content: &mut Vec<u8>, random: &mut ChaCha8Rng) {
    let length = content.len().max(1);
    let at = random.random_range(0..length);
    match random.random_range(0..13) {
        0..3 => {
            for _ in 0..random.random_range(1..8) {
                let bit = random.random_range(0..8 * length);
                if let Some(byte) = content.get_mut(bit / 8) {
                    *byte ^= 1 << (bit % 8);
                }
            }
        }
        3 => content.truncate(at),
        4 => {
            let end = (at + random.random_range(1..2_000)).min(content.len());
            drop(content.drain(at.min(end)..end));
        }
        5 => {
            let end = (at + random.random_range(1..2_000)).min(content.len());
            let block = content[at.min(end)..end].to_vec();
            content.splice(at.min(end)..at.min(end), block);
        }
        6..9 => replace_number(content, at, random),
        9 => swap_columns(content, random),
        10 => content.clear(),
        11 => {
            let noise: Vec<u8> = (0..random.random_range(1..5_000))
                .map(|_| random.random())
                .collect();
            content.splice(at.min(content.len())..at.min(content.len()), noise);
        }
        _ => {
            let open = [b'[', b'{', b'"', b'('][random.random_range(0..4)];
            let nest = vec![open; random.random_range(1..200_000)];
            content.splice(at.min(content.len())..at.min(content.len()), nest);
        }
    }
}

/// Puts a word in place of the number at or behind a place.
fn replace_number(content: &mut Vec<u8>, at: usize, random: &mut ChaCha8Rng) {
    let is_digit = |byte: &u8| byte.is_ascii_digit() || b".-+".contains(byte);
    let Some(begin) = content.iter().skip(at).position(is_digit) else {
        return;
    };
    let begin = at + begin;
    let length = content[begin..]
        .iter()
        .take_while(|byte| is_digit(byte))
        .count();
    let word = WORDS[random.random_range(0..WORDS.len())];
    content.splice(begin..begin + length, word.bytes());
}

/// Swaps two columns of a table in all rows.
fn swap_columns(content: &mut Vec<u8>, random: &mut ChaCha8Rng) {
    let (a, b) = (random.random_range(0..8), random.random_range(0..8));
    let swapped = content.split(|byte| *byte == b'\n').map(|line| {
        let mut fields: Vec<&[u8]> = line.split(|byte| *byte == b',').collect();
        if a < fields.len() && b < fields.len() && line.first() != Some(&b'#') {
            fields.swap(a, b);
        }
        fields.join(&b","[..])
    });
    let header = content
        .split(|byte| *byte == b'\n')
        .next()
        .unwrap_or_default()
        .to_vec();
    let mut rows: Vec<Vec<u8>> = swapped.collect();
    rows[0] = header;
    *content = rows.join(&b"\n"[..]);
}

/// Returns what is wrong with a file that a command wrote.
fn flaw_of(path: &Path) -> Option<String> {
    let content = fs::read(path).ok()?;
    let text = String::from_utf8(content).ok()?;
    let is_none = |word: &str| {
        let word = word.trim_start_matches(['-', '+']).to_ascii_lowercase();
        ["nan", "inf", "infinity"].contains(&&*word)
    };
    let mut words = text.split([',', ' ', '\n', ':', '[', ']', '"', '>', '<', ';']);
    let found = words.find(|word| is_none(word))?;
    Some(format!("{}: {found}", path.display()))
}

fn files_below(folder: &Path) -> Vec<std::path::PathBuf> {
    let found = walkdir::WalkDir::new(folder).into_iter().flatten();
    let files = found.filter(|entry| entry.file_type().is_file());
    files.map(walkdir::DirEntry::into_path).collect()
}

/// Runs one case; returns what is wrong.
fn case(good: &Path, seed: u64) -> Result<(), String> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let (file, command) = COMMANDS[random.random_range(0..COMMANDS.len())];
    let folder = TempDir::new().unwrap();
    let at = folder.path();
    for name in names(good) {
        fs::copy(good.join(&name), at.join(&name)).unwrap();
    }
    let mut content = fs::read(at.join(file)).unwrap();
    for _ in 0..random.random_range(1..3) {
        damage(&mut content, &mut random);
    }
    fs::write(at.join(file), &content).unwrap();
    let before: Vec<String> = names(at);
    let command = command.replace("{}", file);
    let arguments: Vec<&str> = command.split(' ').collect();
    let output = limited(at, &arguments);
    let message = stderr(&output);
    let tail: String = message.chars().take(600).collect();
    let wrong = |what: &str| Err(format!("seed {seed}: {command}: {what}: {tail}"));
    let keep = |result: Result<(), String>| {
        if let (Err(_), Ok(kept)) = (&result, std::env::var("BAD_INPUT_KEEP")) {
            let copied = Command::new("cp").arg("-r").arg(at).arg(kept).status();
            assert!(copied.is_ok_and(|status| status.success()));
        }
        result
    };
    let written: Vec<String> = names(at)
        .into_iter()
        .filter(|name| !before.contains(name))
        .collect();
    let code = output.status.code();
    keep(if !matches!(code, Some(0 | 1)) {
        wrong(&format!("{}", output.status))
    } else if message.contains("panicked") {
        wrong("a panic")
    } else if message
        .chars()
        .any(|c| c.is_control() && c != '\n' && c != '\t')
    {
        wrong("control characters")
    } else if code == Some(1) && written.iter().any(|name| name.starts_with("out.")) {
        wrong(&format!("half written: {written:?}"))
    } else if written.iter().any(|name| name.starts_with('.')) {
        wrong(&format!("left behind: {written:?}"))
    } else if let Some(flaw) = files_below(at)
        .iter()
        .filter(|path| {
            let name = path.strip_prefix(at).unwrap_or(path).to_string_lossy();
            !before.contains(&name.into_owned())
        })
        .find_map(|path| flaw_of(path))
    {
        wrong(&flaw)
    } else {
        Ok(())
    })
}

fn setting(name: &str, default: u64) -> u64 {
    std::env::var(name).map_or(default, |text| text.parse().expect(name))
}

#[test]
fn damaged_files_end_in_an_error_or_in_numbers() {
    let good = good();
    let first = setting("BAD_INPUT_SEED", 1);
    let cases = setting("BAD_INPUT_CASES", 300);
    let wrong: Vec<String> = (first..first + cases)
        .into_par_iter()
        .filter_map(|seed| case(good.path(), seed).err())
        .collect();
    assert!(
        wrong.is_empty(),
        "{} of {cases}:\n{}",
        wrong.len(),
        wrong.join("\n")
    );
}
