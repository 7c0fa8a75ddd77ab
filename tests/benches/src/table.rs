//! Figures of one run.

use host_sim::terminal::table::text_table;

/// The times of one contender.
#[derive(Clone, Debug)]
pub struct BenchTimes {
    /// Name of the contender.
    pub name: String,
    /// Unit of work.
    pub unit: &'static str,
    /// Time for a unit in each turn, ns.
    pub turns_ns: Vec<f64>,
}

impl BenchTimes {
    /// Returns the median, ns.
    #[must_use]
    pub fn median_ns(&self) -> f64 {
        let mut turns = self.turns_ns.clone();
        turns.sort_by(f64::total_cmp);
        turns.get(turns.len() / 2).copied().unwrap_or(f64::NAN)
    }

    fn least_ns(&self) -> f64 {
        self.turns_ns.iter().copied().fold(f64::INFINITY, f64::min)
    }
}

/// Returns a table of figures, each with its ratio to the figure named `base`.
#[must_use]
pub fn table(figures: &[BenchTimes], base: &str) -> String {
    let base = figures.iter().find(|figure| figure.name == base);
    let rows: Vec<Vec<String>> = figures
        .iter()
        .map(|figure| {
            let median = figure.median_ns();
            let ratio = base.map(|base| format!("{:.2}", median / base.median_ns()));
            vec![
                figure.name.clone(),
                figure.unit.to_owned(),
                digits(median),
                digits(figure.least_ns()),
                format!("{:.3e}", 1e9 / median),
                ratio.unwrap_or_default(),
            ]
        })
        .collect();
    let header = ["", "unit", "median ns", "least ns", "a second", "ratio"];
    text_table(&header, &rows, 2).to_string()
}

/// Formats a number with three significant digits.
fn digits(value: f64) -> String {
    let before = value.abs().log10().floor().max(-9.0) as i32;
    let decimals = (2 - before).clamp(0, 9) as usize;
    format!("{value:.decimals$}")
}
