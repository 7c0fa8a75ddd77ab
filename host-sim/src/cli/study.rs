//! `roadgrade study`: tables and figures, computed.

use crate::error::{Error, Result};
use crate::output::print;
use crate::report::page::{Figure, Page, Section, Table};
use crate::report::plot::{Mark, Plot, Series, colour};
use crate::run_file::write_csv;
use crate::study::windows::WindowErrors;
use crate::study::ztbus::{self, DirectionProfiles, PassErrors, Study, WINDOW_M};
use crate::text_table::text_table;
use clap::ValueEnum;
use serde::Serialize;
use std::fs;
use std::path::{Path, PathBuf};

/// Which study.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Name {
    /// Every study whose data are there.
    All,
    /// The measured city bus (ZTBus): passes against each other and against terrain, and the
    /// drift of the bare vehicle model.
    Ztbus,
}

/// Arguments of `study`.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// Which one.
    name: Name,
    /// Where tables, figures and the page go.
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Where the measured data lie: ztbus/*.csv and srtm/*.hgt.
    #[arg(long, value_name = "DIR", default_value = "../shared/data")]
    data: PathBuf,
}

/// Runs it.
pub fn run(args: &Args) -> Result<()> {
    match (args.name, mission_file(&args.data)) {
        (_, Some(mission)) => measured_bus(&mission, &args.data.join("srtm"), &args.out),
        (Name::All, None) => {
            eprintln!(
                "skipped ztbus: no ztbus/*.csv in {}; --data tells where it lies",
                args.data.display()
            );
            Ok(())
        }
        (Name::Ztbus, None) => Err(Error::content(
            &args.data,
            "no ztbus/*.csv in it; expected a mission of the ZTBus data set (--data DIR)",
        )),
    }
}

/// The first mission of the data folder by name.
fn mission_file(data: &Path) -> Option<PathBuf> {
    let mut files: Vec<PathBuf> = fs::read_dir(data.join("ztbus"))
        .ok()?
        .filter_map(|entry| Some(entry.ok()?.path()))
        .filter(|path| path.extension().is_some_and(|ending| ending == "csv"))
        .collect();
    files.sort();
    files.into_iter().next()
}

fn measured_bus(mission: &Path, terrain: &Path, out: &Path) -> Result<()> {
    let study = ztbus::study(mission, terrain)?;
    write_csv(
        &out.join("ztbus_passes.csv"),
        study.passes.iter().map(PassLine::new),
    )?;
    write_csv(&out.join("ztbus_drift.csv"), &study.drifts)?;
    let (passes, drifts) = (pass_table(&study.passes), drift_table(&study));
    for table in [&passes, &drifts] {
        print(&format!(
            "{}\n\n",
            text_table(&table.header, &table.rows, 1)
        ))?;
    }
    let page = out.join("ztbus.html");
    page_of(&study, passes, drifts).write(&page)?;
    print(&format!("page to open: {}\n", page.display()))
}

/// One line of ztbus_passes.csv.
#[derive(Serialize)]
struct PassLine {
    pass: usize,
    direction: &'static str,
    others_rmse_percent: Option<f64>,
    others_bias_percent: Option<f64>,
    terrain_rmse_percent: Option<f64>,
    terrain_bias_percent: Option<f64>,
    model_bias_percent: f64,
    scale: f64,
}

impl PassLine {
    fn new(errors: &PassErrors) -> Self {
        let rmse = |e: &Option<WindowErrors>| e.as_ref().map(|e| e.rmse_percent);
        let bias = |e: &Option<WindowErrors>| e.as_ref().map(|e| e.bias_percent);
        Self {
            pass: errors.pass,
            direction: errors.direction,
            others_rmse_percent: rmse(&errors.others),
            others_bias_percent: bias(&errors.others),
            terrain_rmse_percent: rmse(&errors.terrain),
            terrain_bias_percent: bias(&errors.terrain),
            model_bias_percent: errors.bias_percent,
            scale: errors.scale,
        }
    }
}

fn pass_table(passes: &[PassErrors]) -> Table {
    let header = [
        "pass",
        "against other passes: RMSE %",
        "bias %",
        "against terrain: RMSE %",
        "bias %",
        "model bias found %",
        "scale found",
    ];
    let both = |errors: &Option<WindowErrors>| match errors {
        Some(e) => [
            format!("{:.3}", e.rmse_percent),
            format!("{:+.3}", e.bias_percent),
        ],
        None => ["-".to_owned(), "-".to_owned()],
    };
    let rows = passes.iter().map(|pass| {
        let mut row = vec![format!("{} {}", pass.pass, pass.direction)];
        row.extend(both(&pass.others));
        row.extend(both(&pass.terrain));
        row.push(format!("{:+.3}", pass.bias_percent));
        row.push(format!("{:.3}", pass.scale));
        row
    });
    Table {
        header: header.map(str::to_owned).to_vec(),
        rows: rows.collect(),
    }
}

fn drift_table(study: &Study) -> Table {
    let header = [
        "round trip",
        "length km",
        "drift m/km",
        "mean grade error %",
    ];
    let rows = study.drifts.iter().zip(1..).map(|(drift, number)| {
        vec![
            number.to_string(),
            format!("{:.2}", drift.length_m * 1e-3),
            format!("{:+.2}", drift.drift_m_per_km),
            format!("{:+.3}", drift.grade_error_percent),
        ]
    });
    Table {
        header: header.map(str::to_owned).to_vec(),
        rows: rows.collect(),
    }
}

fn page_of(study: &Study, passes: Table, drifts: Table) -> Page {
    Page {
        title: "A measured city bus".to_owned(),
        lead: "Articulated trolleybus, 19 t empty, on a hilly city route; speed, traction force \
               and raw GNSS once a second. No reference grade exists: passes are compared with \
               the map of the other passes in their direction, and with radar terrain."
            .to_owned(),
        sections: vec![
            Section {
                heading: "Each pass".to_owned(),
                words: format!(
                    "Mean grades over windows of {WINDOW_M} m. The other passes share the \
                     vehicle's own errors, the terrain shares none but sees roofs and trees."
                ),
                table: Some(passes),
                figures: study.profiles.iter().map(grade_figure).collect(),
            },
            Section {
                heading: "The bare vehicle model".to_owned(),
                words: "Altitude that eq. 9 gains over complete round trips, which end where they \
                        began, with the parameters that others use for this bus: what is gained \
                        is the model's error. Nothing is fitted."
                    .to_owned(),
                table: Some(drifts),
                figures: Vec::new(),
            },
        ],
    }
}

fn grade_figure(profiles: &DirectionProfiles) -> Figure {
    let mut plot = Plot::new("distance (km)", "altitude (m)").with(
        Series::line(
            "terrain",
            colour::BLACK,
            profiles.terrain.iter().map(|(x, z)| (x * 1e-3, *z)),
        )
        .drawn(Mark::Dashed),
    );
    for ((number, rows), colour) in profiles.passes.iter().zip(colour::CYCLE) {
        plot = plot.with(Series::line(
            format!("pass {number}"),
            colour,
            rows.iter()
                .filter_map(|row| Some((row.distance_m * 1e-3, row.altitude_m?))),
        ));
    }
    Figure::new(
        &plot,
        format!(
            "Estimated altitude, {} passes. GNSS gives the level, with metres of slow error in \
             each pass.",
            profiles.direction
        ),
    )
}
