//! Manoeuvres and faults on simulated drives, and whether any sigma lies:
//!
//! ```text
//! cargo run -p cross-tests --release --example manoeuvres -- [--only WORDS]... [--truck A|B]
//!     [--seeds N] [--random N [--seed S] [--most-lying PERCENT]] [--mass N [--seed S]] [--json]
//! ```

use clap::Parser;
use cross_tests::exit_code;
use cross_tests::image::root;
use cross_tests::manoeuvres::bench::bench;
use cross_tests::manoeuvres::catalogue::catalogue;
use cross_tests::manoeuvres::drives::Plan;
use cross_tests::manoeuvres::mass;
use cross_tests::manoeuvres::random::drawn;
use cross_tests::manoeuvres::road::BenchRoad;
use cross_tests::manoeuvres::table::{json, lying_percent, table};
use host_sim::error::{Error, Result};
use host_sim::terminal::print::print;
use host_sim::terminal::progress;
use std::process::ExitCode;

/// Drives manoeuvres and faults through the estimator, and judges errors by their sigmas.
#[derive(Parser)]
struct Options {
    /// Only those whose name contains this; may be repeated.
    #[arg(long, value_name = "WORDS")]
    only: Vec<String>,
    /// Only this truck, A or B.
    #[arg(long, value_parser = ["A", "B"])]
    truck: Option<String>,
    /// Drives of each manoeuvre and truck, each on another stretch of the road.
    #[arg(long, default_value_t = 1, conflicts_with = "random")]
    seeds: u64,
    /// Instead, so many drives with two or three manoeuvres or faults at once.
    #[arg(long, value_name = "N")]
    random: Option<usize>,
    /// Instead, so many drives whose mass nobody reports: the stated mass beside the true one.
    #[arg(long, value_name = "N", conflicts_with = "random")]
    mass: Option<usize>,
    /// Seed of the random drives.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Fail if a larger part of the drives lies or has no result, %.
    #[arg(long, value_name = "PERCENT")]
    most_lying: Option<f64>,
    /// Print JSON instead of a table.
    #[arg(long)]
    json: bool,
}

impl Options {
    fn wants(&self, plan: &Plan) -> bool {
        let named = self.only.is_empty() || self.only.iter().any(|words| plan.name.contains(words));
        let truck = self.truck.as_deref();
        named && truck.is_none_or(|truck| truck == plan.truck.name())
    }

    fn plans(&self) -> Vec<Plan> {
        let all = match self.random {
            Some(count) => drawn(count, self.seed),
            None => (1..=self.seeds).flat_map(catalogue).collect(),
        };
        let mut plans: Vec<Plan> = all.into_iter().filter(|plan| self.wants(plan)).collect();
        plans.sort_by_key(|plan| !plan.faults.is_empty());
        plans
    }
}

fn main() -> ExitCode {
    exit_code(run(&Options::parse()))
}

fn run(options: &Options) -> Result<()> {
    let road = BenchRoad::load()?;
    if !road.is_measured {
        eprintln!(
            "no ../shared/data/e4/road.csv: drives on a generated road of the same statistics"
        );
    }
    if let Some(count) = options.mass {
        let rows = mass::bench(&road, &mass::drawn(count, options.seed))?;
        return print(&format!("{}\n", mass::table(&rows)));
    }
    let plans = options.plans();
    let bar = progress::count(plans.len() as u64, "drives");
    let rows = bench(&road, plans, || bar.inc(1));
    bar.finish_and_clear();
    if options.json {
        print(&format!("{:#}\n", json(&rows)))?;
    } else {
        print(&format!("{}\n", table(&rows)))?;
    }
    let lying_percent = lying_percent(&rows);
    match options.most_lying {
        Some(most) if lying_percent > most => Err(Error::content(
            &root(),
            format!("{lying_percent:.1} % of the drives lie, more than {most} %"),
        )),
        _ => Ok(()),
    }
}
