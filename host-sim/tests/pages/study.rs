//! The page of a study.

use super::parsed::{ParsedPage, points};
use std::fs;
use test_kit::command::{folder, roadgrade};

#[test]
fn tables_and_charts_are_those_of_the_files() {
    let folder = folder();
    roadgrade(
        folder.path(),
        &["study", "sensitivity", "--out", ".", "--data", "."],
    )
    .success();
    let page = ParsedPage::read(&folder.path().join("report.html"));
    let file = |name: &str| fs::read_to_string(folder.path().join(name)).unwrap();
    let cells = page.texts("tbody td").join(",").replace('"', "");
    let table = file("sensitivity.csv").replace('"', "");
    let rows: Vec<&str> = table.lines().skip(1).collect();
    assert_eq!(cells, rows.join(","));
    assert!(page.all(".scroll table").len() == page.all("table").len());

    let chart = page.figure("sensitivity_A");
    let csv = file("sensitivity_A.csv");
    let first: Vec<&str> = csv.lines().nth(1).unwrap().split(',').collect();
    let drawn = points(&chart, first[0])[0];
    let (x, y): (f64, f64) = (first[1].parse().unwrap(), first[2].parse().unwrap());
    assert!(
        (drawn.0 - x).abs() < 1e-5 && (drawn.1 - y).abs() < 1e-5,
        "{drawn:?}"
    );
    assert!(file("sensitivity_A.svg").starts_with("<svg"));
}
