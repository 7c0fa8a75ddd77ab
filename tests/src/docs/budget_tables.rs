//! The committed cost of the estimator on a board.

use super::pipe_table::{pipe_table, with_commas};
use crate::budgets::{Budgets, committed_file, wanted};
use host_sim::error::{Error, Result};

const M4F: &str = "thumbv7em-none-eabihf f32";
const M4F_EFFECTS: &str = "thumbv7em-none-eabihf f32 effects";
const M4F_FIXED: &str = "thumbv7em-none-eabihf fixed";
const M0: &str = "thumbv6m-none-eabi f32";
const M0_FIXED: &str = "thumbv6m-none-eabi fixed";

/// Rows: words, a figure, and the figure of the largest value where the first is a mean.
const ROWS: [(&str, &str, Option<&str>); 12] = [
    ("flash, bytes", "flash_bytes", None),
    (
        "RAM, the estimator as a whole, bytes",
        "estimator_bytes",
        None,
    ),
    ("deepest stack of a call, bytes", "stack_bytes", None),
    ("deepest stack of its creation", "start_stack_bytes", None),
    (
        "instructions: an ignored frame, mean / worst",
        "ignored_frame_mean",
        Some("ignored_frame_worst"),
    ),
    (
        "a relevant frame",
        "relevant_frame_mean",
        Some("relevant_frame_worst"),
    ),
    (
        "a filter step with both updates",
        "full_step_mean",
        Some("full_step_worst"),
    ),
    (
        "a share of the smoothing",
        "share_mean",
        Some("share_worst"),
    ),
    ("smoothing, per cell", "lag_mean", None),
    ("all of a cell", "cell_mean", None),
    (
        "the worst call of all, the end of a drive included",
        "call_worst",
        None,
    ),
    (FULL_BUS_WORDS, FULL_BUS, None),
];
const FULL_BUS: &str = "full_bus_millionths";
const FULL_BUS_WORDS: &str = "a full bus, of a 168 MHz core";

/// Makes the table of the estimator without effects, in floats.
pub fn of_the_estimator() -> Result<Option<String>> {
    let budgets = Committed::read()?;
    let rows = ROWS.map(|row| Ok([row.0.to_owned(), budgets.cell(M4F, row)?]));
    table(["", "value"], rows)
}

/// Makes the table without and with effects, beside the upper bounds.
pub fn with_effects() -> Result<Option<String>> {
    let budgets = Committed::read()?;
    let rows = ROWS.map(|row| {
        let wanted = wanted(row.1).map(|most| in_words(row.1, most));
        Ok([
            row.0.to_owned(),
            budgets.cell(M4F, row)?,
            budgets.cell(M4F_EFFECTS, row)?,
            wanted.unwrap_or_default(),
        ])
    });
    table(["", "without effects", "all effects", "wanted"], rows)
}

/// Makes the table of fixed point beside floats, with and without a float unit.
pub fn fixed_point() -> Result<Option<String>> {
    let budgets = Committed::read()?;
    let rows =
        [ROWS[6], ROWS[7], ROWS[8], ROWS[0], ROWS[1], ROWS[2]].map(|(words, figure, worst)| {
            let words = words.split(" (").next().unwrap_or(words);
            let of = |column| budgets.figure(column, figure);
            // Instructions are the ones that have a worst case; their ratio is of interest.
            let ratio = |fixed: u32, float: u32, decimals: usize| {
                let ratio = f64::from(fixed) / f64::from(float);
                worst.map_or_else(String::new, |_| format!("{ratio:.decimals$} ×"))
            };
            let [m4f, m4f_fixed, m0, m0_fixed] = [of(M4F)?, of(M4F_FIXED)?, of(M0)?, of(M0_FIXED)?];
            Ok([
                words.to_owned(),
                with_commas(m4f),
                with_commas(m4f_fixed),
                ratio(m4f_fixed, m4f, 1),
                with_commas(m0),
                with_commas(m0_fixed),
                ratio(m0_fixed, m0, 2),
            ])
        });
    let header = ["", "M4F `f32`", "M4F fixed", "", "M0 `f32`", "M0 fixed", ""];
    table(header, rows)
}

fn table<const N: usize, const ROWS: usize>(
    header: [&str; N],
    rows: [Result<[String; N]>; ROWS],
) -> Result<Option<String>> {
    let rows = rows.into_iter().collect::<Result<Vec<_>>>()?;
    Ok(Some(pipe_table(header, rows)))
}

struct Committed(Budgets);

impl Committed {
    fn read() -> Result<Self> {
        Budgets::read(&committed_file()).map(Self)
    }

    fn figure(&self, column: &str, figure: &str) -> Result<u32> {
        let found = self.0.figure(column, figure);
        found.ok_or_else(|| {
            let problem = format!("no {figure} of {column}");
            Error::content(&committed_file(), problem)
        })
    }

    fn cell(&self, column: &str, (_, figure, worst): (&str, &str, Option<&str>)) -> Result<String> {
        let mean = in_words(figure, self.figure(column, figure)?);
        Ok(match worst {
            Some(worst) => format!("{mean} / {}", with_commas(self.figure(column, worst)?)),
            None => mean,
        })
    }
}

fn in_words(figure: &str, value: u32) -> String {
    if figure != FULL_BUS {
        return with_commas(value);
    }
    let percent = format!("{:.2}", f64::from(value) * 1e-4);
    let percent = percent.trim_end_matches('0').trim_end_matches('.');
    format!("{percent} %")
}
