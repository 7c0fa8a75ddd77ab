//! The error of GNSS altitude as a Markov chain (thesis section 5, after its reference 8).
//!
//! Sixty-one states stand for errors of -15 m to +15 m in steps of 0.5 m; one step of the chain
//! is one step of distance, [`super::STEP_M`].
//!
//! Two deviations from the text of the thesis. Its formula for G divides by a sum over the first
//! index of F, a column, although F(i, j) counts transitions from i to j, and the next state is
//! drawn from a row of G. Here rows are normalised, as its prose says. The thesis also leaves rows
//! without data zero; no state can be drawn from such a row. See [`Chain::probability`].

use crate::error::{Error, Result};
use rand::{Rng, RngExt};
use std::path::Path;

/// Number of states.
pub const STATES: usize = 61;
/// Width of a state, m.
pub const BIN_M: f64 = 0.5;
/// The state of no error.
pub const CENTRE: usize = STATES / 2;
/// Length of each of the two moving means that smooth the generated error, m. The raw chain changes
/// by half a metre within one step of 2.5 m. That is a grade of 20 %, which no receiver shows. Two
/// means of this length keep waves above 500 m and remove the steps.
pub const LOW_PASS_M: f64 = 150.0;
/// The chain trained on the measured bus. Its first lines name its origin.
const MEASURED: &str = include_str!("../../data/gps_chain.csv");

/// A Markov chain as counts of transitions.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Chain {
    /// F: `counts[i][j]` transitions from state i to state j.
    counts: Vec<[u32; STATES]>,
}

/// Returns the state nearest to an error in m. Errors beyond the last state get the last state.
#[must_use]
pub fn state_of(error_m: f64) -> usize {
    let state = (error_m / BIN_M).round() + CENTRE as f64;
    state.clamp(0.0, (STATES - 1) as f64) as usize
}

/// Returns the error of a state, m.
#[must_use]
pub fn error_of(state: usize) -> f64 {
    (state as f64 - CENTRE as f64) * BIN_M
}

/// Returns a series less its mean.
#[must_use]
pub fn centred(errors_m: &[f64]) -> Vec<f64> {
    let mean = errors_m.iter().sum::<f64>() / errors_m.len().max(1) as f64;
    errors_m.iter().map(|error| error - mean).collect()
}

impl Chain {
    /// Counts the transitions in series of altitude errors in m, one value per step. Each series is
    /// centred first: the mean of a drive's error is nearly constant and does not affect the grade.
    #[must_use]
    pub fn train(runs: &[Vec<f64>]) -> Self {
        Self::of_states(
            runs.iter()
                .map(|run| centred(run).into_iter().map(state_of).collect()),
        )
    }

    /// Counts the transitions in series of states.
    ///
    /// # Panics
    /// Panics if a state is not below [`STATES`].
    #[must_use]
    pub fn of_states(runs: impl IntoIterator<Item = Vec<usize>>) -> Self {
        let mut counts = vec![[0; STATES]; STATES];
        for run in runs {
            for pair in run.windows(2) {
                counts[pair[0]][pair[1]] += 1;
            }
        }
        Self { counts }
    }

    /// Creates the chain trained on the measured bus.
    ///
    /// # Panics
    /// Never: a test reads the file that is built in.
    #[must_use]
    pub fn measured() -> Self {
        Self::parse(Path::new("gps_chain.csv"), MEASURED).expect("the built-in file is sound")
    }

    /// Returns the number of transitions from a state.
    #[must_use]
    pub fn visits(&self, from: usize) -> u32 {
        self.counts[from].iter().sum()
    }

    /// Returns G: the probability of a transition from one state to another.
    ///
    /// A state without transitions goes one step towards no error. The chain reaches such a state
    /// only where a training series ended in it. The errors have mean zero, so a step towards zero
    /// is plausible, and a single step adds no jump.
    #[must_use]
    pub fn probability(&self, from: usize, to: usize) -> f64 {
        match self.visits(from) {
            0 => f64::from(u8::from(to == towards_centre(from))),
            visits => f64::from(self.counts[from][to]) / f64::from(visits),
        }
    }

    /// Generates `n` states. The first is drawn from the frequencies of the training, so a series
    /// starts in equilibrium. An untrained chain starts without error.
    pub fn generate_states(&self, n: usize, rng: &mut impl Rng) -> Vec<usize> {
        let visits: Vec<u32> = (0..STATES).map(|state| self.visits(state)).collect();
        let mut state = drawn(&visits, visits.iter().sum(), rng).unwrap_or(CENTRE);
        let mut states = Vec::with_capacity(n);
        for _ in 0..n {
            states.push(state);
            state = drawn(&self.counts[state], visits[state], rng)
                .unwrap_or_else(|| towards_centre(state));
        }
        states
    }

    /// Generates `n` altitude errors in m, one per step, with the low-pass of [`LOW_PASS_M`].
    pub fn generate(&self, n: usize, rng: &mut impl Rng) -> Vec<f64> {
        let raw = self.generate_states(n, rng).into_iter().map(error_of);
        let once = super::drive::moving_mean(&raw.collect::<Vec<_>>(), LOW_PASS_M);
        super::drive::moving_mean(&once, LOW_PASS_M)
    }

    /// Returns the chain as text: lines of `origin` as comments, then `from,to,count` with errors
    /// in m.
    #[must_use]
    pub fn to_text(&self, origin: &str) -> String {
        let mut text: String = origin.lines().map(|line| format!("# {line}\n")).collect();
        text.push_str("from_m,to_m,count\n");
        for (from, row) in self.counts.iter().enumerate() {
            for (to, count) in row.iter().enumerate().filter(|(_, count)| **count > 0) {
                let (from, to) = (error_of(from), error_of(to));
                text.push_str(&format!("{from},{to},{count}\n"));
            }
        }
        text
    }

    /// Parses such text; `path` is for error messages.
    ///
    /// # Errors Returns an error with the line: another header, fields that are not numbers, or
    /// errors without a state.
    pub fn parse(path: &Path, text: &str) -> Result<Self> {
        let mut counts = vec![[0; STATES]; STATES];
        let mut reader = csv::ReaderBuilder::new()
            .comment(Some(b'#'))
            .from_reader(text.as_bytes());
        for row in reader.deserialize() {
            let (from_m, to_m, count): (f64, f64, u32) = row.map_err(|problem| {
                let line = problem.position().map_or(0, csv::Position::line);
                Error::line(path, line, problem.to_string(), "from_m,to_m,count")
            })?;
            let (from, to) = (state_of(from_m), state_of(to_m));
            if error_of(from) != from_m || error_of(to) != to_m {
                return Err(Error::content(
                    path,
                    format!(
                        "transition from {from_m} m to {to_m} m; expected multiples of {BIN_M} m \
                         up to 15 m"
                    ),
                ));
            }
            counts[from][to] = count;
        }
        Ok(Self { counts })
    }
}

fn towards_centre(state: usize) -> usize {
    match state.cmp(&CENTRE) {
        std::cmp::Ordering::Less => state + 1,
        std::cmp::Ordering::Equal => state,
        std::cmp::Ordering::Greater => state - 1,
    }
}

/// Draws an index with these weights, whose sum is `total`; `None` if the sum is zero.
fn drawn(weights: &[u32], total: u32, rng: &mut impl Rng) -> Option<usize> {
    if total == 0 {
        return None;
    }
    let mut left = rng.random_range(0..total);
    weights.iter().position(|&weight| {
        let found = left < weight;
        left = left.saturating_sub(weight);
        found
    })
}
