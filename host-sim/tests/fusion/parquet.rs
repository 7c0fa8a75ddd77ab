//! Runs and maps as Parquet, folders of them, and fusions that are interrupted.

use assert_cmd::assert::Assert;
use host_sim::files::data_set;
use host_sim::files::run::{self, Origin, RunCell, RunIdentity, RunRow};
use host_sim::map::{MapRow, read_map};
use parquet::arrow::arrow_reader::ParquetRecordBatchReaderBuilder;
use predicates::prelude::*;
use predicates::str::contains;
use rand::SeedableRng;
use rand::seq::SliceRandom;
use rand_chacha::ChaCha8Rng;
use std::fs;
use std::path::{Path, PathBuf};
use tempfile::TempDir;
use test_kit::command::roadgrade;
use test_kit::roads::{hills, run};

fn fuse(folder: &Path, arguments: &[&str]) -> Assert {
    roadgrade(folder, &[&["fuse"][..], arguments].concat())
}

/// Returns a run over the hills whose grade, position and sigma depend on its number.
fn wavy(number: usize) -> Vec<RunRow> {
    let spots = test_kit::roads::with_position_noise(&hills(), 1.5, 80.0, number as u64);
    let mut rows = run(&spots[..600]);
    for row in &mut rows {
        row.grade_percent += 0.05 * (row.distance_m / (70.0 + 9.0 * number as f64)).sin();
        row.grade_sigma_percent = 0.05 + 0.01 * number as f64;
        // A row before the first fix.
        row.altitude_m = row.altitude_m.filter(|_| row.distance_m > 40.0);
        row.altitude_sigma_m = row.altitude_sigma_m.filter(|_| row.distance_m > 40.0);
    }
    rows
}

fn origin(truck: usize) -> Origin {
    Origin {
        vehicle: Some(format!("truck {truck}")),
        day: Some("2026-11-21".into()),
        ..Origin::default()
    }
}

/// Writes `road.csv`, and `runs` in Hive's layout: seven runs of trucks 0, 1 and 2 in turns.
fn fleet() -> TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    let at = folder.path();
    for number in 0..7 {
        let rows = wavy(number);
        let name = format!("{number}");
        let path = data_set::run_path(&at.join("runs"), &mut &rows[..], "2026-11-21", &name)
            .expect("a path");
        run::write_from(&path, &rows, &origin(number % 3)).expect("written");
    }
    run::write(&at.join("first.csv"), &wavy(0)).expect("written");
    fuse(at, &["--out", "road.csv", "first.csv"]).success();
    folder
}

fn of_fleet(number: usize) -> PathBuf {
    format!("runs/tile=N47E008/day=2026-11-21/{number}.parquet").into()
}

fn same(a: &[MapRow], b: &[MapRow], within: f64) {
    assert_eq!(a.len(), b.len());
    for (a, b) in a.iter().zip(b) {
        assert_eq!((a.distance_m, a.runs), (b.distance_m, b.runs));
        assert!((a.grade_percent - b.grade_percent).abs() <= within);
        assert!((a.grade_sigma_percent - b.grade_sigma_percent).abs() <= within);
        let altitudes = a.altitude_m.zip(b.altitude_m);
        assert_eq!(altitudes.is_some(), a.altitude_m.is_some());
        // Altitudes are hundreds of metres.
        assert!(altitudes.is_none_or(|(a, b)| (a - b).abs() <= 1000.0 * within));
    }
}

fn map(folder: &TempDir, name: &str) -> Vec<MapRow> {
    read_map(&folder.path().join(name)).expect("a map")
}

#[test]
fn a_run_is_the_same_in_either_form() {
    let folder = tempfile::tempdir().expect("a folder");
    let (csv, parquet) = (folder.path().join("a.csv"), folder.path().join("a.parquet"));
    let mut rows = wavy(3);
    rows[7].latitude_deg = None;
    rows[7].longitude_deg = None;
    rows[9].valid = 0;
    rows[11].grade_percent = -0.000_000_1;
    run::write(&csv, &rows).expect("written");
    run::write_from(&parquet, &rows, &origin(4)).expect("written");
    let from_csv = run::read(&csv).expect("a run");
    assert_eq!(from_csv, run::read(&parquet).expect("a run"));
    let (cells, identity) = run::read_cells(&parquet).expect("cells");
    assert!(cells.iter().copied().eq(from_csv.iter().map(RunCell::from)));
    assert_eq!(identity, run::read_cells(&csv).expect("cells").1);
    assert_eq!(identity.to_string().parse(), Ok(identity));
    assert_ne!(identity, RunIdentity::of(cells[1..].iter().copied()));

    let session = run::session(&parquet).expect("opened");
    assert_eq!(session.as_deref(), Some("truck 4 2026-11-21"));
    let file = host_sim::files::parquet::open(&parquet).expect("opened");
    assert_eq!(file.metadata("schema"), Some("run 1"));
    assert_eq!(file.metadata("day"), Some("2026-11-21"));
    // The same columns in the same order, with their units.
    let header = fs::read_to_string(&csv).expect("text");
    let header: Vec<&str> = header
        .lines()
        .next()
        .expect("a header")
        .split(',')
        .collect();
    let file = fs::File::open(&parquet).expect("opened");
    let reader = ParquetRecordBatchReaderBuilder::try_new(file).expect("Parquet");
    let fields = reader.schema().fields();
    let names: Vec<&str> = fields.iter().map(|field| field.name().as_str()).collect();
    assert_eq!(names, header);
    let unit = |name: &str| {
        let field = reader.schema().field_with_name(name).expect("a column");
        field.metadata().get("unit").cloned()
    };
    assert_eq!(unit("grade_sigma_percent").as_deref(), Some("%"));
    assert_eq!(unit("speed_mps").as_deref(), Some("m/s"));
    assert_eq!(unit("valid"), None);
}

#[test]
fn a_data_set_fuses_as_its_runs_do_in_any_order() {
    let folder = fleet();
    let at = folder.path();
    let road = ["--road", "road.csv"];
    fuse(at, &[&road[..], &["--out", "all.parquet", "runs"]].concat())
        .success()
        .stderr(contains("runs of session truck 0 2026-11-21 differ by"));
    let all = map(&folder, "all.parquet");
    assert!(all.len() > 590);
    assert_eq!(all[100].runs, 7);

    let mut order: Vec<usize> = (0..7).collect();
    for seed in 0..4 {
        order.shuffle(&mut ChaCha8Rng::seed_from_u64(seed));
        let paths: Vec<String> = order
            .iter()
            .map(|&number| of_fleet(number).display().to_string())
            .collect();
        let paths: Vec<&str> = paths.iter().map(String::as_str).collect();
        fuse(at, &[&road[..], &["--out", "b.parquet"], &paths].concat()).success();
        same(&all, &map(&folder, "b.parquet"), 1e-12);
        // One by one into a store, the sessions as they come.
        let _ = fs::remove_file(at.join("sums.csv"));
        for path in paths {
            let store = ["--store", "sums.csv", "--out", "b.parquet", path];
            fuse(at, &[&road[..], &store].concat()).success();
        }
        same(&all, &map(&folder, "b.parquet"), 1e-12);
    }
    // The map in CSV has fixed decimals. It serves as a road in either form.
    fuse(at, &[&road[..], &["--out", "all.csv", "runs"]].concat()).success();
    same(&all, &map(&folder, "all.csv"), 5.1e-6);
    fuse(at, &["--road", "all.parquet", "--out", "b.parquet", "runs"]).success();
}

#[test]
fn sessions_of_files_are_those_of_the_command_line() {
    let folder = fleet();
    let at = folder.path();
    let road = ["--road", "road.csv"];
    fuse(
        at,
        &[&road[..], &["--out", "of_files.parquet", "runs"]].concat(),
    )
    .success();
    for number in 0..7 {
        let rows = run::read(&at.join(of_fleet(number))).expect("a run");
        run::write(&at.join(format!("{number}.csv")), &rows).expect("written");
    }
    let named = [
        "--session",
        "a=0.csv,3.csv,6.csv",
        "--session",
        "b=1.csv,4.csv",
        "--session",
        "c=2.csv,5.csv",
    ];
    fuse(
        at,
        &[&road[..], &["--out", "named.parquet"], &named].concat(),
    )
    .success();
    same(
        &map(&folder, "of_files.parquet"),
        &map(&folder, "named.parquet"),
        1e-12,
    );
    // The command line takes precedence over the file.
    let one = ["--out", "one.parquet", "--session", "all=runs"];
    fuse(at, &[&road[..], &one].concat())
        .success()
        .stderr(contains("runs of session all differ").and(contains("truck 0 2026").not()));
}

#[test]
fn a_run_counts_once() {
    let folder = fleet();
    let at = folder.path();
    let first = of_fleet(0).display().to_string();
    fs::copy(at.join(&first), at.join("copy.parquet")).expect("copied");
    let road = ["--road", "road.csv"];
    fuse(
        at,
        &[&road[..], &["--out", "once.parquet", &first]].concat(),
    )
    .success();
    // Under another name, in the other form, in another session.
    let more = [
        "--out",
        "more.parquet",
        &first,
        "copy.parquet",
        "--session",
        "x=first.csv",
    ];
    fuse(at, &[&road[..], &more].concat()).success().stderr(
        contains("copy.parquet: already in the map, not counted again")
            .and(contains("first.csv: already in the map"))
            .and(contains("warning: 2 runs were already in the map")),
    );
    same(
        &map(&folder, "once.parquet"),
        &map(&folder, "more.parquet"),
        0.0,
    );
}

#[test]
fn an_interrupted_fusion_goes_on() {
    let folder = fleet();
    let at = folder.path();
    let arguments = [
        "--road",
        "road.csv",
        "--store",
        "sums.csv",
        "--out",
        "map.parquet",
    ];
    let fuse_runs = |runs: &[&str]| fuse(at, &[&arguments[..], runs].concat());
    // An interrupted fusion leaves a store with three of seven runs.
    let three: Vec<String> = [0, 1, 5]
        .iter()
        .map(|&number| of_fleet(number).display().to_string())
        .collect();
    fuse_runs(&three.iter().map(String::as_str).collect::<Vec<_>>()).success();
    // The same command resumes it.
    fuse_runs(&["runs"])
        .success()
        .stderr(contains("warning: 3 runs were already in the map"));
    let resumed = map(&folder, "map.parquet");
    let sums = fs::read(at.join("sums.csv")).expect("sums");
    fuse_runs(&["runs"])
        .success()
        .stderr(contains("warning: 7 runs were already in the map"));
    assert_eq!(fs::read(at.join("sums.csv")).expect("sums"), sums);
    same(&resumed, &map(&folder, "map.parquet"), 0.0);
    fuse(at, &["--road", "road.csv", "--out", "all.parquet", "runs"]).success();
    same(&resumed, &map(&folder, "all.parquet"), 1e-12);

    // A store with a changed list of runs.
    let text = String::from_utf8(sums).expect("text");
    let last = text.lines().last().expect("a line").to_owned();
    let cases = [
        (
            text.replace(&format!("{last}\n"), ""),
            "sums.csv: 6 runs; expected the 7",
        ),
        (
            format!("{text}{last}\n"),
            "not a run, or a run that is already listed",
        ),
        (
            text.replace(&last, "# run 12"),
            "not a run, or a run that is already listed",
        ),
    ];
    for (text, message) in cases {
        fs::write(at.join("sums.csv"), text).expect("written");
        fuse_runs(&["runs"]).code(1).stderr(contains(message));
    }
}

#[test]
fn a_damaged_file_is_named_and_left_out_whole() {
    let folder = fleet();
    let at = folder.path();
    let road = ["--road", "road.csv"];
    let bad = of_fleet(3);
    let whole = fs::read(at.join(&bad)).expect("bytes");
    let others: Vec<String> = [0, 1, 2, 4, 5, 6]
        .iter()
        .map(|&number| of_fleet(number).display().to_string())
        .collect();
    let others: Vec<&str> = others.iter().map(String::as_str).collect();
    fuse(
        at,
        &[&road[..], &["--out", "others.parquet"], &others].concat(),
    )
    .success();
    let others = map(&folder, "others.parquet");

    let mut flipped = whole.clone();
    // In a page of the grades, which the format protects by no checksum.
    flipped[whole.len() / 3] ^= 0x10;
    let cases = [
        whole[..whole.len() / 2].to_vec(),
        whole[..whole.len() - 3].to_vec(),
        Vec::new(),
        b"PAR1 and nothing else PAR1".to_vec(),
        flipped,
    ];
    for bytes in cases {
        fs::write(at.join(&bad), &bytes).expect("written");
        fuse(at, &[&road[..], &["--out", "map.parquet", "runs"]].concat())
            .success()
            .stderr(
                contains("3.parquet: ")
                    .and(contains(": left out"))
                    .and(contains("warning: 1 damaged files left out, 6 runs added")),
            );
        same(&others, &map(&folder, "map.parquet"), 0.0);
        fs::remove_file(at.join("map.parquet")).expect("removed");
        let strict = ["--strict", "--out", "map.parquet", "runs"];
        fuse(at, &[&road[..], &strict].concat())
            .code(1)
            .stderr(contains("3.parquet: "));
        // Named by the user, it is an error too.
        let named = ["--out", "map.parquet", &bad.display().to_string()];
        fuse(at, &[&road[..], &named].concat())
            .code(1)
            .stderr(contains("3.parquet: "));
        assert!(!at.join("map.parquet").exists());
    }
    // No usable run, and no run at all.
    fs::create_dir_all(at.join("lone")).expect("a folder");
    fuse(at, &[&road[..], &["--out", "map.parquet", "lone"]].concat())
        .code(1)
        .stderr(contains("no runs in this folder"));
    for name in ["x.parquet", "y.csv"] {
        fs::write(at.join("lone").join(name), b"nothing").expect("written");
        fuse(at, &[&road[..], &["--out", "map.parquet", "lone"]].concat())
            .code(1)
            .stderr(contains("lone/"));
    }
    assert!(!at.join("map.parquet").exists());
}

#[test]
fn no_flipped_bit_passes_or_panics() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("a.parquet");
    run::write_from(&path, &wavy(1)[..40], &origin(1)).expect("written");
    let whole = fs::read(&path).expect("bytes");
    let cells = run::read_cells(&path).expect("cells").0;
    let mut refused = 0;
    let mut senseless = None;
    let everywhere = (0..whole.len()).step_by(5).map(|place| (place, place % 8));
    for (place, bit) in everywhere.chain((0..500).map(|place| (place, 1))) {
        let mut bytes = whole.clone();
        bytes[place] ^= 1 << bit;
        fs::write(&path, &bytes).expect("written");
        match run::read_cells(&path) {
            // Some bytes do not matter: those of unread columns, and of statistics.
            Ok((read, _)) => assert_eq!(read, cells, "byte {place}"),
            Err(e) => {
                assert!(e.to_string().contains("a.parquet"), "{e}");
                refused += 1;
                if e.to_string().contains("its pages cannot be decoded") {
                    senseless = Some(bytes);
                }
            }
        }
    }
    assert!(refused > whole.len() / 20, "{refused} of {}", whole.len());
    // One of them makes the decoder panic. The panic must not be visible.
    fs::write(&path, senseless.expect("one of them")).expect("written");
    fuse(folder.path(), &["--out", "map.parquet", "a.parquet"])
        .code(1)
        .stderr(contains("its pages cannot be decoded").and(contains("panicked").not()));
}

#[test]
fn other_tables_are_refused_by_what_they_lack() {
    let folder = fleet();
    let at = folder.path();
    fuse(at, &["--road", "road.csv", "--out", "map.parquet", "runs"]).success();
    fuse(at, &["--out", "b.parquet", "map.parquet"])
        .code(1)
        .stderr(contains(
            "map.parquet: schema \"map 1\"; expected \"run 1\"",
        ));
    let run = of_fleet(0).display().to_string();
    // A run has the columns of a road, and its own odometer is one.
    fuse(at, &["--road", &run, "--out", "b.parquet", &run]).success();
    fuse(
        at,
        &[
            "--road",
            "road.csv",
            "--out",
            "b.parquet",
            "--placed",
            "placed",
            "runs",
        ],
    )
    .success();
    let placed = fs::read_dir(at.join("placed/road=b")).expect("listed");
    let placed: Vec<PathBuf> = placed.map(|entry| entry.expect("listed").path()).collect();
    assert_eq!(placed.len(), 7);
    assert!(read_map(&placed[0]).is_err_and(|e| e.to_string().contains("no column distance_m")));
}

#[test]
fn a_run_has_the_name_of_its_log() {
    for (log, name) in [
        ("drive.log", "drive"),
        ("logs/drive.csv.gz", "drive"),
        ("2026-11-21T08.30.log", "2026-11-21T08.30"),
        ("2026-11-21T14.30.log.gz", "2026-11-21T14.30"),
        ("drive", "drive"),
        (".log", ".log"),
    ] {
        assert_eq!(data_set::run_name(Path::new(log)), name);
    }
}

#[test]
fn tiles_are_named_by_their_corner() {
    for (position, name) in [
        ((47.4, 8.5), "N47E008"),
        ((-0.1, -0.1), "S01W001"),
        ((0.0, 0.0), "N00E000"),
        ((-33.9, 151.2), "S34E151"),
        ((61.0, -149.9), "N61W150"),
    ] {
        assert_eq!(data_set::tile(position.0, position.1), name);
    }
    for day in ["2026-11-21", "2024-02-29"] {
        assert_eq!(data_set::check_day(day).as_deref(), Ok(day));
    }
    for day in [
        "",
        "2026",
        "2026-13-01",
        "2026-00-10",
        "21-11-2026",
        "2026-1-1",
        "+026-11-21",
        "../..",
    ] {
        assert!(data_set::check_day(day).is_err(), "{day}");
    }
}
