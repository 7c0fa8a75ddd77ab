//! The bench of the diagnosis: every effect is planted, in several sizes and on both trucks.
//!
//!     cargo run --release -p cross-tests --example diagnosis_bench -- --seeds 10
//!
//! prints the confusion table. With `--cases` it prints a line on stderr for each case when it is
//! done. A case takes some seconds; `--effects clean,cornering` and `--sizes 0.3` select cases.

use clap::Parser;
use cross_tests::diagnosed::{CaseOutcome, cases, effects, table};
use cross_tests::exit_code;
use host_sim::error::Result;
use host_sim::terminal::progress;
use std::process::ExitCode;

/// Plants effects in simulated logs and counts what the diagnosis finds.
#[derive(Debug, Parser)]
struct Args {
    /// Simulations of each effect and size on each truck, with seeds 1, 2 and so on.
    #[arg(long, default_value_t = 10, value_parser = clap::value_parser!(u64).range(1..))]
    seeds: u64,
    /// Grade errors that the effects make, RMS, %; ten times that for the radius of the wheels, %.
    /// Negative ones make less of an effect than assumed; effects that cannot be less are left out.
    #[arg(
        long,
        value_delimiter = ',',
        default_value = "0.05,0.1,0.3",
        allow_hyphen_values = true
    )]
    sizes: Vec<f64>,
    /// Effects to plant; all if none is given.
    #[arg(long, value_delimiter = ',')]
    effects: Vec<String>,
    /// Print a line for each case on stderr.
    #[arg(long)]
    cases: bool,
}

fn main() -> ExitCode {
    let mut args = Args::parse();
    if args.effects.is_empty() {
        args.effects = effects().map(str::to_owned).collect();
    }
    exit_code(run(&args))
}

fn run(args: &Args) -> Result<()> {
    let cases = cases(&args.effects, &args.sizes, args.seeds)?;
    let bar = progress::count(cases.len() as u64, "cases");
    let done = |outcome: &CaseOutcome| {
        if args.cases {
            bar.suspend(|| eprintln!("{}", line(outcome)));
        }
        bar.inc(1);
    };
    table(&cases, done).map(drop)
}

/// Returns a case and all that was found.
fn line(outcome: &CaseOutcome) -> String {
    let case = &outcome.case;
    let found = outcome.diagnosis.findings.iter().map(|finding| {
        let adopted = &finding.adopted;
        format!(
            "{} {:.4} ± {:.4} (evidence {:.0}; or {:?})",
            adopted.effect.name,
            adopted.amount,
            adopted.amount_sigma,
            finding.evidence,
            finding.group
        )
    });
    let rest = outcome.diagnosis.unexplained.iter().map(|rest| {
        format!(
            "[{} {:.3} % (evidence {:.0})]",
            rest.depends_on, rest.rms_percent, rest.evidence
        )
    });
    format!(
        "{} {} % {} seed {}: {:?}: {}; {:.3} -> {:.3} %",
        case.effect,
        case.size_percent,
        case.truck,
        case.seed,
        outcome.verdict(),
        found.chain(rest).collect::<Vec<_>>().join("; "),
        outcome.diagnosis.before.rmse_percent,
        outcome.diagnosis.after.rmse_percent
    )
}
