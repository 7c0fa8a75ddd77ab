//! The stack of each call of the interface, from the linked image, as it is committed.

use crate::call_graph::{CallGraph, StackBound};
use crate::files::{Result, problem, root, text};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Begin of the names of the calls: `firmware::calls` has a function for each.
pub const ROOTS: &str = "firmware::calls::";
/// Path of the committed bounds from the root of the repository.
pub const CALLS: &str = "firmware/calls.csv";
/// The function that makes the calls, and is none itself.
const CALLER: &str = "run";
/// Functions that may make indirect calls. The force of an effect is a function that its definition
/// holds. The climb test asks for the error of the model only where it needs it. Roads of a memory are
/// read through a table of functions, which this image does not have.
const INDIRECT_CALLERS: [&str; 4] = [
    "estimator_core::filter::effect_uncertainty::",
    "estimator_core::model::adopted_effects::",
    "estimator_core::filter::altitude_gate::climb_test::",
    "estimator_core::roadmap::",
];
/// Functions that they may call.
const INDIRECT_TARGETS: [&str; 3] = [
    "estimator_core::effect::",
    "core::ops::function::FnOnce::call_once",
    "estimator_core::filter::altitude_gate::AltitudeGate::",
];
/// Measured stacks, and the calls that each was measured of. With a map, the measured image has the
/// calls inlined where it measures, so that their frames differ.
const MEASURED: [(&str, &[&str]); 2] = [
    ("start_stack_bytes", &["create"]),
    (
        "stack_bytes",
        &[
            "on_frame",
            "step",
            "live",
            "next_cell",
            "drain_step",
            "persistent_state",
        ],
    ),
];
/// Begin of the names of functions that only a panic calls.
const PANICS: &str = "core::panicking::";
/// Largest accepted stack of a call, bytes: the limit of the budgets.
const MOST_STACK_BYTES: u32 = 4_000;
/// Largest accepted growth of a bound over the committed one, %.
const SLACK_PERCENT: u32 = 3;

/// The bounds of an image.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct CallBounds {
    /// Stack of each call, bytes, by its name.
    pub stack_bytes: BTreeMap<String, u32>,
    /// Functions that the calls reach.
    pub functions: u32,
    /// Loops in them.
    pub loops: u32,
}

/// Returns the path of the committed bounds.
#[must_use]
pub fn committed_calls() -> PathBuf {
    root().join(CALLS)
}

impl CallBounds {
    /// Reads them off an image whose calls are the functions of [`ROOTS`]. Returns them with the
    /// deepest path of each call.
    ///
    /// # Errors
    /// The image can panic, something calls itself, or an indirect call has an unknown caller or
    /// target.
    pub fn of_image(path: &Path) -> Result<(Self, BTreeMap<String, StackBound>)> {
        let graph = CallGraph::read(path, ROOTS)?;
        check_panics(&graph)
            .and_then(|()| check_indirect(&graph))
            .map_err(|why| problem(path, why))?;
        let bounds = graph
            .stack_bounds(ROOTS)
            .map_err(|why| problem(path, why))?;
        let bounds: BTreeMap<String, StackBound> = bounds
            .into_iter()
            .filter_map(|(name, bound)| Some((name.strip_prefix(ROOTS)?.to_owned(), bound)))
            .filter(|(name, _)| name != CALLER)
            .collect();
        let of = Self {
            stack_bytes: bounds
                .iter()
                .map(|(name, bound)| (name.clone(), bound.bytes))
                .collect(),
            functions: graph.len() as u32,
            loops: graph.loops() as u32,
        };
        Ok((of, bounds))
    }

    /// Reads committed bounds.
    ///
    /// # Errors
    /// The file cannot be read, or a line is not a name and a number.
    pub fn read(path: &Path) -> Result<Self> {
        let text = text(path)?;
        let mut bounds = Self::default();
        for (number, line) in (1..).zip(text.lines()).skip(1) {
            let wrong = || problem(path, format!("line {number}: expected a name and a number"));
            let (name, value) = line.split_once(',').ok_or_else(wrong)?;
            let value = value.parse().map_err(|_| wrong())?;
            match name {
                "functions" => bounds.functions = value,
                "loops" => bounds.loops = value,
                _ => {
                    let _ = bounds.stack_bytes.insert(name.to_owned(), value);
                }
            }
        }
        Ok(bounds)
    }

    /// Returns them as [`CallBounds::read`] reads them.
    #[must_use]
    pub fn to_csv(&self) -> String {
        let calls = self
            .stack_bytes
            .iter()
            .map(|(name, bytes)| format!("{name},{bytes}\n"));
        let counts = [("functions", self.functions), ("loops", self.loops)];
        let counts = counts.map(|(name, count)| format!("{name},{count}\n"));
        let header = "call,stack_bytes\n".to_owned();
        std::iter::once(header).chain(calls).chain(counts).collect()
    }

    /// Returns one line for each stack that was measured deeper than its bound: the analysis is wrong.
    /// `budgets` is `firmware/budgets.csv`, whose stacks an emulated drive has painted.
    ///
    /// # Errors
    /// A figure is missing.
    pub fn below_measured(&self, budgets: &str) -> Result<Vec<String>> {
        let mut below = Vec::new();
        for (figure, calls) in MEASURED {
            let row = budgets
                .lines()
                .find_map(|line| line.strip_prefix(figure)?.strip_prefix(','));
            // The first column is that of the analysed image: `f32` on a Cortex-M4F.
            let measured = row.and_then(|row| row.split(',').next()?.parse().ok());
            let measured: u32 = measured.ok_or_else(|| format!("no figure {figure}"))?;
            let bounds = calls.iter().filter_map(|call| self.stack_bytes.get(*call));
            let bound = bounds.max().copied().unwrap_or(0);
            if measured > bound {
                below.push(format!(
                    "{figure}: {measured} bytes measured, {bound} bound"
                ));
            }
        }
        Ok(below)
    }

    /// Returns one line for each bound that is above its limit, that grew over the committed one, or
    /// that only one of both has.
    #[must_use]
    pub fn excesses(&self, committed: &Self) -> Vec<String> {
        let mut excesses = Vec::new();
        for (name, bytes) in &self.stack_bytes {
            if *bytes > MOST_STACK_BYTES {
                excesses.push(format!(
                    "{name}: {bytes} bytes of stack, more than the limit {MOST_STACK_BYTES}"
                ));
            }
            match committed.stack_bytes.get(name) {
                None => excesses.push(format!("{name}: not committed")),
                Some(known) if *bytes > known + known * SLACK_PERCENT / 100 => {
                    excesses.push(format!("{name}: {bytes} bytes of stack, {known} committed"));
                }
                Some(_) => {}
            }
        }
        let lost = committed.stack_bytes.keys();
        let lost = lost.filter(|name| !self.stack_bytes.contains_key(*name));
        excesses.extend(lost.map(|name| format!("{name}: no such call in the image")));
        excesses
    }
}

/// Refuses an image in which a function that only a panic calls can be reached.
fn check_panics(graph: &CallGraph) -> std::result::Result<(), String> {
    let panics: Vec<&str> = graph
        .functions(PANICS)
        .map(|function| &*function.name)
        .collect();
    if panics.is_empty() {
        return Ok(());
    }
    Err(format!("may panic: {}", panics.join(", ")))
}

/// Refuses indirect calls of which the caller or a target is not known.
fn check_indirect(graph: &CallGraph) -> std::result::Result<(), String> {
    let callers: Vec<&str> = graph
        .indirect_callers()
        .map(|function| &*function.name)
        .collect();
    if callers.is_empty() {
        return Ok(());
    }
    let may_call = |name: &str| {
        // A method of a trait is named `<Type as Trait>::method`.
        let name = name.trim_start_matches('<');
        INDIRECT_CALLERS.iter().any(|of| name.starts_with(of))
    };
    let strangers = callers.iter().filter(|name| !may_call(name));
    let strangers = strangers.map(|name| format!("an indirect call in {name}"));
    let is_known = |name: &str| INDIRECT_TARGETS.iter().any(|of| name.starts_with(of));
    let targets = graph
        .indirect_targets()
        .filter(|function| !is_known(&function.name));
    let targets =
        targets.map(|function| format!("an unknown target of an indirect call: {}", function.name));
    let problems: Vec<String> = strangers.chain(targets).collect();
    if problems.is_empty() {
        return Ok(());
    }
    Err(problems.join("\n"))
}
