//! The page of the demonstration.

use super::parsed::{ParsedPage, points};
use std::fs;
use std::path::Path;
use std::process::Command;
use std::sync::LazyLock;
use tempfile::TempDir;
use test_kit::command::roadgrade;

/// The demonstration, run once for all tests.
static DEMO: LazyLock<(TempDir, String)> = LazyLock::new(|| {
    let folder = tempfile::tempdir().expect("a folder");
    let done = roadgrade(folder.path(), &["demo", "--out", "."]).success();
    let printed = String::from_utf8_lossy(&done.get_output().stdout).into_owned();
    (folder, printed)
});

fn folder() -> &'static Path {
    DEMO.0.path()
}

fn page() -> ParsedPage {
    ParsedPage::read(&folder().join("report.html"))
}

#[test]
fn the_demo_ends_with_a_table_and_a_page() {
    let lines: Vec<&str> = DEMO.1.lines().collect();
    for run in ["| all ", "| from_logs "] {
        let is_map = |line: &&&str| line.starts_with(run) && line.contains("| map ");
        assert_eq!(lines.iter().filter(is_map).count(), 1, "{run}: {}", DEMO.1);
    }
    assert!(DEMO.1.contains("report.html") && DEMO.1.contains("index.html"));
    let page = page();
    assert_eq!(page.all(".drawing").len(), 4);
    assert_eq!(page.all("nav li").len(), page.all("section").len());
    let estimates = page.texts("td");
    for estimate in ["smoothed", "original", "modified", "oracle"] {
        assert!(
            estimates.iter().any(|of| of.contains(estimate)),
            "{estimate}"
        );
    }
    // Five runs and their mean with eight rows each, and the map.
    let table = fs::read_to_string(folder().join("score.csv")).unwrap();
    assert!(table.starts_with("run,estimate,cells,rmse_percent,"));
    assert_eq!(table.lines().count(), 1 + 6 * 8 + 1);
    for name in [
        "a1.log",
        "a1.truth.csv",
        "a1.vehicle.toml",
        "a1.csv",
        "map.csv",
        "map_grade.svg",
        "score.csv",
    ] {
        assert!(folder().join(name).exists(), "{name}");
    }
}

/// What the first picture shows is what the table says: map and truth at the same places.
#[test]
fn the_error_drawn_is_the_error_printed() {
    let page = page();
    let chart = page.figure("map_grade");
    let (map, truth) = (
        points(&chart, "map of all runs"),
        points(&chart, "true grade"),
    );
    let (first, last) = (map[0].0 + 0.5, map[map.len() - 1].0 - 0.5);
    let mut squares = Vec::new();
    for (km, percent) in map {
        let at = truth.iter().find(|point| point.0 == km);
        let Some((_, true_percent)) = at else {
            panic!("no truth at {km} km");
        };
        if (first..=last).contains(&km) {
            squares.push((percent - true_percent).powi(2));
        }
    }
    let drawn = (squares.iter().sum::<f64>() / squares.len() as f64).sqrt();
    let table = fs::read_to_string(folder().join("score.csv")).unwrap();
    let row = table.lines().find(|line| line.starts_with("all,map,"));
    let fields: Vec<&str> = row.expect("the map's row").split(',').collect();
    assert_eq!(fields[2], squares.len().to_string());
    let printed: f64 = fields[3].parse().unwrap();
    assert!((drawn - printed).abs() < 1e-4, "{drawn} and {printed}");
    let scored = page.texts("#s2 tbody tr:last-child td").join(" ");
    assert!(
        scored.contains(&format!("{printed:.4}")),
        "{printed}: {scored}"
    );
}

#[test]
fn plan_and_profiles_share_the_road() {
    let page = page();
    for name in ["map_grade", "errors", "altitude"] {
        assert_eq!(page.figure(name)["link"], "road", "{name}");
    }
    let plan = page.figure("plan");
    let line = &plan["lines"][0];
    assert_eq!(line["link"], "road");
    let count = |value: &serde_json::Value| value.as_array().map(Vec::len);
    let map = points(&page.figure("map_grade"), "map of all runs").len();
    assert_eq!(count(&line["km"]), Some(map));
    assert_eq!(count(&line["places"]), Some(2 * map));
    assert_eq!(count(&line["values"][0]), Some(map));
}

/// Captions speak only of what is drawn.
#[test]
fn marks_that_captions_name_are_there() {
    let page = page();
    let errors = page.figure("errors");
    let captions = page.texts("figcaption").join("\n");
    let shaded = errors["shaded"].as_array().unwrap();
    assert_eq!(captions.contains("Grey"), !shaded.is_empty());
    let beyond = errors["series"].as_array().unwrap().iter().any(|series| {
        let y = series["y"].as_array().unwrap();
        y.iter()
            .filter_map(serde_json::Value::as_f64)
            .any(|y| y.abs() > 0.5)
    });
    assert_eq!(captions.contains("Triangles"), beyond);
}

/// In a browser, every figure becomes a canvas.
#[test]
fn a_browser_draws_every_figure() {
    let profile = tempfile::tempdir().expect("a folder");
    let drawn = Command::new("chromium")
        .args(["--headless", "--no-sandbox", "--disable-gpu"])
        .args(["--virtual-time-budget=3000", "--dump-dom"])
        .arg(format!("--user-data-dir={}", profile.path().display()))
        .arg(format!("file://{}", folder().join("report.html").display()))
        .output();
    let Ok(drawn) = drawn else {
        eprintln!("SKIPPED: no chromium to draw the page");
        return;
    };
    let page = String::from_utf8_lossy(&drawn.stdout);
    let said = String::from_utf8_lossy(&drawn.stderr);
    assert_eq!(page.matches("<canvas").count(), 4, "{said}");
    assert_eq!(page.matches("class=\"u-legend").count(), 3);
    assert_eq!(page.matches("class=\"classes\"").count(), 1);
}
