//! Tables of errors: the results of commands and studies.

use super::pipe_table::{pipe_table, table_as_it_is};
use clap::Parser;
use host_sim::cli::Cli;
use host_sim::error::{Error, Result};
use host_sim::numeric::statistics::mean;
use host_sim::report::page::{Page, Section, Table};
use host_sim::study::{STUDIES, Setting, StudyOutcome};
use serde::Deserialize;
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Mutex;
use tempfile::TempDir;

use crate::image::{measured_data, root};

/// A row of `score.csv`.
#[derive(Debug, Deserialize)]
struct Score {
    run: String,
    estimate: String,
    rmse_percent: f64,
    nees: f64,
}

/// Runs `roadgrade` with these arguments.
fn roadgrade<'a>(arguments: impl IntoIterator<Item = &'a str>) -> Result<()> {
    Cli::parse_from(["roadgrade"].into_iter().chain(arguments)).run()
}

fn scores(path: &Path) -> Result<Vec<Score>> {
    let problem = |error: csv::Error| Error::content(path, error.to_string());
    let mut reader = csv::Reader::from_path(path).map_err(problem)?;
    reader
        .deserialize()
        .map(|row| row.map_err(problem))
        .collect()
}

fn score<'a>(scores: &'a [Score], run: &str, estimate: &str) -> Result<&'a Score> {
    let mut rows = scores.iter();
    rows.find(|row| row.run == run && row.estimate == estimate)
        .ok_or_else(|| unexpected(&format!("no {estimate} of {run} in the scores")))
}

pub(super) fn unexpected(problem: &str) -> Error {
    Error::content(Path::new("the documentation's tables"), problem)
}

fn folder() -> Result<TempDir> {
    tempfile::tempdir().map_err(|error| unexpected(&error.to_string()))
}

fn path_in(folder: &TempDir, name: &str) -> String {
    folder.path().join(name).display().to_string()
}

/// Makes the table of the motorway's runs with right parameters.
pub fn motorway() -> Result<Option<String>> {
    let folder = folder()?;
    let scenario = root().join("host-sim/scenarios/motorway.toml");
    let simulated = path_in(&folder, "");
    roadgrade([
        "simulate",
        "--scenario",
        &scenario.display().to_string(),
        "--out",
        &simulated,
    ])?;
    let mut rows = Vec::new();
    for (run, words) in [
        ("a_forward", "A 39 t, forward"),
        ("a_backward", "A 39 t, backward"),
        ("b_forward", "B 12 t, forward"),
        ("b_backward", "B 12 t, backward"),
    ] {
        let file = |ending: &str| path_in(&folder, &format!("{run}.{ending}"));
        let (log, vehicle, truth) = (file("log"), file("vehicle.toml"), file("truth.csv"));
        // Without the files of the other methods beside the truth it is much faster.
        let alone = path_in(&folder, "truth.csv");
        std::fs::rename(&truth, &alone).map_err(Error::io(Path::new(&truth)))?;
        let estimated = file("csv");
        roadgrade(["estimate", "--vehicle", &vehicle, "--out", &estimated, &log])?;
        let table = path_in(&folder, "score.csv");
        roadgrade(["score", "--truth", &alone, "--out", &table, &estimated])?;
        let scores = scores(Path::new(&table))?;
        let of = |estimate| score(&scores, &estimated, estimate);
        rows.push([
            words.to_owned(),
            three(of("smoothed")?.rmse_percent),
            three(of("lagged")?.rmse_percent),
            three(of("live")?.rmse_percent),
            format!("{:.2}", of("smoothed")?.nees),
        ]);
    }
    Ok(Some(pipe_table(
        [
            "run",
            "smoothed",
            "lagged by 500 m",
            "live",
            "NEES smoothed",
        ],
        rows,
    )))
}

/// Makes the table of the demonstration's mean errors.
pub fn demo() -> Result<Option<String>> {
    let folder = folder()?;
    roadgrade(["demo", "--out", &path_in(&folder, "")])?;
    let scores = scores(&folder.path().join("score.csv"))?;
    let mean = |estimate| score(&scores, "mean", estimate);
    let row = |words: &str, estimates: [&'static str; 3]| -> Result<[String; 5]> {
        let [smoothed, lagged, live] = estimates.map(mean);
        let (smoothed, lagged, live) = (smoothed?, lagged?, live?);
        Ok([
            words.to_owned(),
            three(smoothed.rmse_percent),
            three(lagged.rmse_percent),
            three(live.rmse_percent),
            format!(
                "{:.2} / {:.2} / {:.2}",
                smoothed.nees, lagged.nees, live.nees
            ),
        ])
    };
    let single = |words: &str, score: &Score| {
        let [rmse, nees] = [three(score.rmse_percent), format!("{:.2}", score.nees)];
        [words.to_owned(), rmse, String::new(), String::new(), nees]
    };
    let oracle = "oracle: the same filter, given the true vehicle and the true noise levels";
    let rows = [
        row(
            "this estimator, mean of five runs",
            ["smoothed", "lagged", "live"],
        )?,
        row(oracle, ["oracle", "oracle_lagged", "oracle_live"])?,
        single("thesis, original filter", mean("original")?),
        single("thesis, modified method", mean("modified")?),
        single("map of all five runs", score(&scores, "all", "map")?),
    ];
    Ok(Some(pipe_table(
        ["estimate", "smoothed", "lagged", "live", "NEES"],
        rows,
    )))
}

/// Makes the table of errors with wrong parameters, by truck and error of the receiver.
pub fn accuracy() -> Result<Option<String>> {
    let header = [
        "truck, GNSS",
        "smoothed",
        "lagged",
        "live",
        "NEES",
        "scale error",
        "stated",
    ];
    of_rows("accuracy", "accuracy", header, |row| {
        let [
            truck,
            gnss,
            smoothed,
            lagged,
            live,
            nees @ ..,
            error,
            stated,
        ] = row
        else {
            return Err(unexpected("a row of the accuracy has other columns"));
        };
        Ok([
            format!("{truck}, {gnss} m"),
            rounded(smoothed)?,
            rounded(lagged)?,
            rounded(live)?,
            nees.join(" / "),
            error.clone(),
            stated.clone(),
        ])
    })
}

/// Makes the same table for a usual receiver only.
pub fn accuracy_in_short() -> Result<Option<String>> {
    of_table("accuracy", "accuracy", |accuracy| {
        let mut rows = Vec::new();
        for (truck, words) in [("A", "truck A, 39 t"), ("B", "truck B, 12 t")] {
            let mut of = accuracy.rows.iter();
            let row = of
                .find(|row| {
                    row.first().is_some_and(|of| of == truck)
                        && row.get(1).is_some_and(|gnss| gnss == "2")
                })
                .ok_or_else(|| unexpected("no accuracy with an error of 2 m"))?;
            rows.push([
                words.to_owned(),
                rounded(&row[2])?,
                rounded(&row[3])?,
                rounded(&row[4])?,
            ]);
        }
        Ok(pipe_table(
            ["", "smoothed", "lagged by 500 m", "live"],
            rows,
        ))
    })
}

/// Makes the table of errors without one signal or another.
pub fn sensors() -> Result<Option<String>> {
    let header = [
        "missing for the whole drive",
        "truck A, 39 t",
        "NEES",
        "truck B, 12 t",
        "NEES",
    ];
    of_rows("sensors", "sensors", header, |row| match row {
        [missing, a @ .., b1, b2, b3, b4] if a.len() == 4 => Ok([
            missing.clone(),
            a[..3].join(" / "),
            a[3].clone(),
            [b1.as_str(), b2, b3].join(" / "),
            b4.clone(),
        ]),
        _ => Err(unexpected("a row of the sensors has other columns")),
    })
}

/// Makes the table of maps of several runs.
pub fn fleet() -> Result<Option<String>> {
    let header = [
        "map of",
        "RMSE",
        "NEES",
        "NEES if runs counted as independent",
    ];
    of_rows("fleet", "fleet_maps", header, |row| {
        let [of, rmse, nees, independent] = row else {
            return Err(unexpected("a row of the maps has other columns"));
        };
        Ok([
            of.clone(),
            rounded(rmse)?,
            nees.clone(),
            independent.clone(),
        ])
    })
}

/// Makes the table of the thesis's numbers, those of its replica, and ours on the replica.
pub fn thesis() -> Result<Option<String>> {
    let Some([summary, beside, maps]) = tables("modified", ["summary", "beside", "maps"])? else {
        return Ok(None);
    };
    let methods = ["original", "modified"];
    let mut rows = Vec::new();
    for (truck, runs) in [("A", "123"), ("B", "45")] {
        for method in methods {
            let what = format!("mean RMSE(v) of the {method} method, truck {truck}");
            let [replica, thesis] = summary_of(&summary, &what)?;
            let ours = if method == "modified" {
                format!("{:.4}", mean_of_ours(&beside, runs)?)
            } else {
                String::new()
            };
            rows.push([
                format!("{method} method, truck {truck}"),
                thesis,
                replica,
                ours,
            ]);
        }
    }
    for (runs, words) in [(3, "the three runs of A"), (5, "five runs")] {
        let mut cells: [Vec<String>; 3] = Default::default();
        for heading in ["southbound", "northbound"] {
            let what = format!("RMSE(m) of {runs} {heading} runs, modified");
            let [replica, thesis] = summary_of(&summary, &what)?;
            let ours = cell_of(&maps, &format!("{runs} runs {heading}"), "ours %")?;
            let column = [thesis, replica, ours.to_owned()];
            for (cell, text) in cells.iter_mut().zip(column) {
                cell.push(text);
            }
        }
        let [thesis, replica, ours] = cells.map(|cell| cell.join(" / "));
        let words = format!("map of {words}, modified, southbound / northbound");
        rows.push([words, thesis, replica, ours]);
    }
    Ok(Some(pipe_table(
        ["", "thesis", "replica", "ours on the replica"],
        rows,
    )))
}

/// Returns the replica's and the thesis's cell of a row of the summary.
fn summary_of(summary: &Table, what: &str) -> Result<[String; 2]> {
    let of = |column| cell_of(summary, what, column).and_then(rounded);
    Ok([of("replica")?, of("thesis")?])
}

fn mean_of_ours(beside: &Table, runs: &str) -> Result<f64> {
    let of_truck = |row: &&Vec<String>| {
        row.first()
            .is_some_and(|run| run.ends_with(|end| runs.contains(end)))
    };
    let ours: Vec<f64> = beside
        .rows
        .iter()
        .filter(of_truck)
        .map(|row| number(cell_of(beside, &row[0], "ours %")?))
        .collect::<Result<_>>()?;
    Ok(mean(&ours))
}

/// Makes the table of the measured bus.
pub fn bus() -> Result<Option<String>> {
    let Some([passes, drift]) = tables("ztbus", ["ztbus_passes", "ztbus_drift"])? else {
        return Ok(None);
    };
    let range = |column: &str, decimals: usize| -> Result<String> {
        let numbers = passes
            .rows
            .iter()
            .map(|row| number(cell_of(&passes, &row[0], column)?));
        let numbers = numbers.collect::<Result<Vec<f64>>>()?;
        let least = numbers.iter().copied().fold(f64::INFINITY, f64::min);
        let most = numbers.iter().copied().fold(0.0, f64::max);
        Ok(format!("{least:.decimals$} to {most:.decimals$} %"))
    };
    let drifts = drift.rows.iter().map(|row| {
        let drift = number(cell_of(&drift, &row[0], "drift m/km")?)?;
        Ok(format!("{drift:+.1}"))
    });
    let drifts = drifts.collect::<Result<Vec<String>>>()?.join(", ");
    let rows = [
        [
            "each pass against the map of the other passes, windows of 600 m, RMSE",
            &range("against other passes: RMSE %", 2)?,
        ],
        [
            "each pass against radar terrain (SRTM), RMSE, most of it the terrain's",
            &range("against terrain: RMSE %", 2)?,
        ],
        [
            "drift of the bare vehicle model in the three round trips",
            &format!("{drifts} m per km"),
        ],
    ];
    let rows = rows.map(|row| row.map(str::to_owned));
    Ok(Some(pipe_table(["", ""], rows)))
}

/// Makes the text of one table of a study, with another header and each of its rows made over.
pub(super) fn of_rows<const N: usize>(
    study: &str,
    name: &str,
    header: [&str; N],
    row: impl Fn(&[String]) -> Result<[String; N]>,
) -> Result<Option<String>> {
    of_table(study, name, |table| {
        let rows = table.rows.iter().map(|cells| row(cells));
        let rows = rows.collect::<Result<Vec<_>>>()?;
        Ok(pipe_table(header, rows))
    })
}

/// Makes the text of one table of a study as it is.
pub(super) fn whole_table(study: &str, name: &str) -> Result<Option<String>> {
    of_table(study, name, |table| {
        Ok(table_as_it_is(&table.header, &table.rows))
    })
}

/// Makes the text of one table of a study.
fn of_table(
    study: &str,
    name: &str,
    make: impl FnOnce(&Table) -> Result<String>,
) -> Result<Option<String>> {
    let tables = tables(study, [name])?;
    tables.map(|[table]| make(&table)).transpose()
}

/// Runs a study once and returns its tables; `None` if its measured data are absent.
fn tables<const N: usize>(study: &str, names: [&str; N]) -> Result<Option<[Table; N]>> {
    static DONE: Mutex<BTreeMap<String, Option<Vec<Table>>>> = Mutex::new(BTreeMap::new());
    let mut done = DONE.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
    if !done.contains_key(study) {
        done.insert(study.to_owned(), run_study(study)?);
    }
    let Some(Some(tables)) = done.get(study) else {
        return Ok(None);
    };
    let mut found = Vec::new();
    for name in names {
        let table = tables.iter().find(|table| table.name == name);
        found.push(
            table
                .cloned()
                .ok_or_else(|| unexpected(&format!("no table {name} of {study}")))?,
        );
    }
    Ok(found.try_into().ok())
}

fn run_study(name: &str) -> Result<Option<Vec<Table>>> {
    let study = STUDIES.iter().find(|study| study.name == name);
    let study = study.ok_or_else(|| unexpected(&format!("no study {name}")))?;
    // The defaults of `roadgrade study`.
    let setting = Setting {
        data: measured_data(),
        seed: 2011,
    };
    Ok(match (study.run)(&setting)? {
        StudyOutcome::Done(section) => Some(written_once(name, section)?.tables),
        StudyOutcome::Skipped(_) => None,
    })
}

/// Returns the section of a study, if `roadgrade study NAME --out DIR` writes each file once.
fn written_once(name: &str, section: Section) -> Result<Section> {
    let page = Page {
        title: String::new(),
        lead: String::new(),
        sections: vec![section],
    };
    let mut files = page.files(Path::new(""));
    files.sort();
    if let Some([file, _]) = files.windows(2).find(|pair| pair[0] == pair[1]) {
        let file = file.display();
        return Err(unexpected(&format!("study {name} writes {file} twice")));
    }
    let mut sections = page.sections;
    Ok(sections.remove(0))
}

/// Returns a cell by the first cell of its row and the name of its column.
fn cell_of<'a>(table: &'a Table, row: &str, column: &str) -> Result<&'a str> {
    let at = table.header.iter().position(|name| name == column);
    let row = table.rows.iter().find(|cells| cells[0] == row);
    row.zip(at)
        .and_then(|(row, at)| row.get(at))
        .map(String::as_str)
        .ok_or_else(|| unexpected(&format!("{}: no such row, or no {column}", table.name)))
}

fn number(text: &str) -> Result<f64> {
    let number = text.parse();
    number.map_err(|_| unexpected(&format!("`{text}`: expected a number")))
}

fn rounded(text: &str) -> Result<String> {
    number(text).map(three)
}

/// Formats a number with the three decimals of the tables.
fn three(percent: f64) -> String {
    format!("{percent:.3}")
}
