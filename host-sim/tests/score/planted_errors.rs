//! Scores of planted errors equal these errors.

use assert_cmd::assert::Assert;
use host_sim::files::run::{self, RunRow};
use host_sim::files::truth::{self, TruthRow};
use host_sim::map::MapRow;
use host_sim::score::{MEAN, mean, score_map, score_run};
use predicates::prelude::*;
use predicates::str::contains;
use std::path::Path;
use tempfile::TempDir;
use test_kit::command::roadgrade;
use test_kit::roads::{Spot, drive, hill_percent, hills, run};

/// Returns the truth of a drive at 20 m/s, ten times a second.
fn truth(spots: &[Spot], grade_percent: impl Fn(f64) -> f64) -> Vec<TruthRow> {
    let end_m = spots[spots.len() - 1].distance_m;
    (0..=(end_m / 2.0) as usize)
        .map(|i| TruthRow {
            time_s: i as f64 * 0.1,
            distance_m: i as f64 * 2.0,
            grade_percent: grade_percent(i as f64 * 2.0),
            altitude_m: 400.0,
            shifting: 0,
            braking: 0,
        })
        .collect()
}

/// Returns a run with planted errors: smoothed 0.3 % too high, lagged ±0.2 % in turn, and live 1 %
/// where it is not valid.
fn planted(spots: &[Spot]) -> Vec<RunRow> {
    let mut rows = run(spots);
    for (i, row) in rows.iter_mut().enumerate() {
        row.grade_percent += 0.3;
        row.grade_sigma_percent = 0.15;
        row.lagged_grade_percent += if i % 2 == 0 { 0.2 } else { -0.2 };
        row.lagged_grade_sigma_percent = 0.2;
        if i % 4 == 0 {
            row.live_grade_percent += 1.0;
            row.valid = 0;
        }
        row.live_grade_sigma_percent = 0.5;
    }
    rows
}

fn close(a: f64, b: f64) -> bool {
    (a - b).abs() < 2e-3
}

#[test]
fn planted_errors_are_found() {
    let spots = hills();
    let mut rows = planted(&spots);
    // Wrong values at the ends must not count.
    for row in &mut rows {
        if row.distance_m < 499.0 || row.distance_m > 5501.0 {
            row.grade_percent = 99.0;
        }
    }
    let scored = score_run("a", &rows, &truth(&spots, hill_percent)).expect("scored");
    assert_eq!(scored.beyond_truth, 0);
    let [smoothed, lagged, live] = &scored.rows[..] else {
        panic!("three rows");
    };
    assert_eq!(
        (smoothed.estimate, lagged.estimate, live.estimate),
        ("smoothed", "lagged", "live")
    );
    for row in &scored.rows {
        assert_eq!((row.run.as_str(), row.cells), ("a", 2001));
    }
    assert!(close(smoothed.rmse_percent, 0.3) && close(smoothed.bias_percent, 0.3));
    assert!(close(smoothed.nees, 4.0));
    assert!(close(lagged.rmse_percent, 0.2) && close(lagged.bias_percent, 0.0));
    assert!(close(lagged.nees, 1.0));
    assert!(close(live.rmse_percent, 0.5) && close(live.bias_percent, 0.25));
    assert!(close(live.rmse_valid_percent.expect("valid cells"), 0.0));
    assert!(close(live.nees, 1.0));
}

#[test]
fn marked_cells_are_counted_and_left_out_of_a_second_nees() {
    let spots = hills();
    let mut rows = run(&spots);
    // A tenth of the cells is off by five sigmas and says so, in the smoothed grade alone.
    for row in rows.iter_mut().step_by(10) {
        row.grade_percent += 0.5;
        row.consistent = 0;
    }
    // The live grade is marked everywhere.
    for row in &mut rows {
        row.live_consistent = 0;
    }
    let scored = score_run("a", &rows, &truth(&spots, hill_percent)).expect("scored");
    let [smoothed, lagged, live] = &scored.rows[..] else {
        panic!("three rows");
    };
    assert!((smoothed.marked_percent.expect("marks") - 10.0).abs() < 0.1);
    assert!((smoothed.nees - 2.5).abs() < 0.03);
    assert!(close(smoothed.nees_unmarked.expect("unmarked cells"), 0.0));
    assert_eq!(lagged.marked_percent, Some(0.0));
    assert!(close(
        lagged.nees_unmarked.expect("unmarked cells"),
        lagged.nees
    ));
    assert_eq!(
        (live.marked_percent, live.nees_unmarked),
        (Some(100.0), None)
    );
    let means = mean(&scored.rows);
    assert_eq!(means[0].marked_percent, smoothed.marked_percent);
    assert_eq!(means[2].nees_unmarked, None);
}

#[test]
fn without_valid_cells_there_is_no_valid_error() {
    let spots = hills();
    let mut rows = run(&spots);
    for row in &mut rows {
        row.valid = 0;
    }
    let scored = score_run("a", &rows, &truth(&spots, hill_percent)).expect("scored");
    assert!(
        scored
            .rows
            .iter()
            .all(|row| row.rmse_valid_percent.is_none())
    );
    assert!(
        mean(&scored.rows)
            .iter()
            .all(|row| row.rmse_valid_percent.is_none())
    );
}

#[test]
fn truth_is_joined_by_time_and_cut_where_it_ends() {
    let spots = hills();
    let rows = run(&spots);
    let truth = truth(&spots, hill_percent);
    // Without the truth after 4 km = 200 s.
    let scored = score_run("a", &rows, &truth[..2001]).expect("scored");
    assert_eq!(scored.beyond_truth, 800);
    assert_eq!(scored.rows[0].cells, 1401);
    // Two seconds are 40 m, an error of at most 0.4 % here.
    let late: Vec<TruthRow> = truth
        .iter()
        .map(|row| TruthRow {
            time_s: row.time_s + 2.0,
            ..*row
        })
        .collect();
    let scored = score_run("a", &rows, &late).expect("scored");
    assert!(
        (0.25..0.31).contains(&scored.rows[0].rmse_percent),
        "{scored:?}"
    );
    // The truth of another day, or one that is too short.
    let other: Vec<TruthRow> = truth
        .iter()
        .map(|row| TruthRow {
            time_s: row.time_s + 9e4,
            ..*row
        })
        .collect();
    assert!(score_run("a", &rows, &other).is_err());
    assert!(score_run("a", &rows[..399], &truth).is_err());
    assert!(score_run("a", &[], &truth).is_err());
}

#[test]
fn means_are_over_runs() {
    let spots = hills();
    let truth = truth(&spots, hill_percent);
    let mut rows = score_run("a", &planted(&spots), &truth)
        .expect("scored")
        .rows;
    rows.extend(score_run("b", &run(&spots), &truth).expect("scored").rows);
    let means = mean(&rows);
    assert_eq!(means.len(), 3);
    assert_eq!(
        (means[0].run.as_str(), means[0].estimate),
        (MEAN, "smoothed")
    );
    assert_eq!(means[0].cells, 2 * 2001);
    assert!(close(means[0].rmse_percent, 0.15) && close(means[0].nees, 2.0));
}

#[test]
fn maps_are_scored_by_distance() {
    let map: Vec<MapRow> = (0..2000)
        .map(|i| MapRow {
            distance_m: f64::from(i) * 2.5,
            latitude_deg: 47.0,
            longitude_deg: 8.0,
            altitude_m: None,
            grade_percent: 1.0 + if i % 2 == 0 { 0.1 } else { -0.3 },
            grade_sigma_percent: 0.1,
            runs: 1,
        })
        .collect();
    let reference = [(0.0, 1.0), (4000.0, 1.0)];
    let score = score_map(&map, &reference).expect("scored");
    assert_eq!(score.cells, 1401);
    assert!(close(score.bias_percent, -0.1) && close(score.rmse_percent, 0.05_f64.sqrt()));
    assert!((score.nees - 5.0).abs() < 0.01);
    assert!(score_map(&map, &[]).is_err());
    assert!(score_map(&[], &reference).is_err());
}

fn score(folder: &Path, arguments: &[&str]) -> Assert {
    roadgrade(folder, &[&["score"][..], arguments].concat())
}

/// Writes the runs `runs/a.csv` (planted errors over hills) and `runs/b.csv` (without errors, on a
/// level road), and the truth of each.
fn two_drives() -> TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| folder.path().join(name);
    let flat = drive((0.0, 0.0), 3000.0, |_| 90.0, |_| 0.0);
    run::write(&path("runs/a.csv"), &planted(&hills())).expect("written");
    run::write(&path("runs/b.csv"), &run(&flat)).expect("written");
    truth::write(&path("a.truth.csv"), &truth(&hills(), hill_percent)).expect("written");
    truth::write(&path("b.truth.csv"), &truth(&flat, |_| 0.0)).expect("written");
    folder
}

#[test]
fn the_table_is_printed_and_written() {
    let folder = two_drives();
    let pairs = [
        "--truth",
        "a.truth.csv",
        "--truth",
        "b.truth.csv",
        "runs/a.csv",
        "runs/b.csv",
    ];
    score(folder.path(), &pairs).success().stdout(
        contains("runs/a.csv")
            .and(contains("RMSE valid %"))
            .and(contains("mean")),
    );
    let table = std::fs::read_to_string(folder.path().join("runs/score.csv")).expect("written");
    let lines: Vec<&str> = table.lines().collect();
    assert_eq!(
        lines[0],
        "run,estimate,cells,rmse_percent,rmse_valid_percent,bias_percent,nees,oracle_ratio,\
         marked_percent,nees_unmarked"
    );
    assert_eq!(lines.len(), 10);
    assert!(
        lines[1] == "runs/a.csv,smoothed,2001,0.3,0.3,0.3,4.0,,0.0,4.0",
        "{}",
        lines[1]
    );
    assert_eq!(lines[4], "runs/b.csv,smoothed,801,0.0,0.0,0.0,0.0,,0.0,0.0");
    assert!(
        lines[7].starts_with("mean,smoothed,2802,0.15,0.15,0.15,2.0"),
        "{}",
        lines[7]
    );

    let json = score(
        folder.path(),
        &[&pairs[..], &["--json", "--out", "t.csv"]].concat(),
    )
    .success()
    .get_output()
    .stdout
    .clone();
    let rows: serde_json::Value = serde_json::from_slice(&json).expect("JSON alone");
    assert_eq!(rows.as_array().map(Vec::len), Some(9));
    assert_eq!(rows[0]["estimate"], "smoothed");
    assert!(close(
        rows[0]["rmse_percent"].as_f64().expect("a number"),
        0.3
    ));
    let again = std::fs::read_to_string(folder.path().join("t.csv")).expect("written");
    assert_eq!(again, table);
}

#[test]
fn one_truth_serves_all_runs_and_cells_beyond_it_are_noted() {
    let folder = two_drives();
    std::fs::copy(
        folder.path().join("runs/a.csv"),
        folder.path().join("runs/c.csv"),
    )
    .expect("copied");
    score(
        folder.path(),
        &["--truth", "a.truth.csv", "runs/a.csv", "runs/c.csv"],
    )
    .success();
    score(folder.path(), &["--truth", "b.truth.csv", "runs/a.csv"])
        .success()
        .stderr(contains(
            "runs/a.csv: 1200 of 2401 cells left out, beyond the time span",
        ))
        .stdout(contains("mean").not());
}

#[test]
fn wrong_usage_and_bad_files_are_reported() {
    let folder = two_drives();
    score(folder.path(), &["runs/a.csv"]).code(2);
    let three = [
        "--truth",
        "a.truth.csv",
        "--truth",
        "b.truth.csv",
        "runs/a.csv",
    ];
    score(folder.path(), &three)
        .code(2)
        .stderr(contains("2 times --truth for 1 runs"));

    let header = "time_s,distance_m,grade_percent,altitude_m,shifting,braking\n";
    let cases = [
        (
            format!("{header}0,0,NaN,400,0,0\n"),
            "t.csv:2: grade_percent is NaN",
        ),
        (
            format!("{header}0,0,1,400,0,0\n1,20,x,400,0,0\n"),
            "t.csv:3: grade_percent: ",
        ),
        (
            format!("{header}5,0,1,400,0,0\n4,20,1,400,0,0\n"),
            "t.csv:3: time_s is 4 after 5",
        ),
        (
            "time_s,distance_m\n0,0\n".into(),
            "t.csv:1: no column `grade_percent`",
        ),
        (header.into(), "t.csv: no rows"),
        (String::new(), "t.csv: no rows"),
        (
            format!("{header}0,0,1,400,0,0\n1,20,1,400,0,0\n"),
            "runs/a.csv: no cell of 2401",
        ),
    ];
    for (text, message) in cases {
        std::fs::write(folder.path().join("t.csv"), &text).expect("written");
        score(folder.path(), &["--truth", "t.csv", "runs/a.csv"])
            .code(1)
            .stdout("")
            .stderr(contains(message));
        assert!(!folder.path().join("runs/score.csv").exists(), "{text}");
    }
    let run = std::fs::read_to_string(folder.path().join("runs/a.csv")).expect("text");
    let spoiled = run.replacen(",20.0,", ",inf,", 1);
    assert_ne!(run, spoiled);
    std::fs::write(folder.path().join("runs/a.csv"), spoiled).expect("written");
    score(folder.path(), &["--truth", "a.truth.csv", "runs/a.csv"])
        .code(1)
        .stderr(contains("runs/a.csv:2: speed_mps is inf"));
    assert!(!folder.path().join("runs/score.csv").exists());
}
