//! Stack and instructions of each call of the interface, from the linked image, as they are committed.

use crate::call_graph::{CallGraph, LoopBounds, StackBound};
use crate::files::{Result, evidence, problem, root, text};
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
/// The same of the call that creates the estimator, once.
const MOST_START_STACK_BYTES: u32 = 16_000;
/// Measured instructions, and the call that each was measured of.
const MEASURED_INSTRUCTIONS: [(&str, &str); 5] = [
    ("relevant_frame_worst", "on_frame"),
    ("step_worst", "step"),
    ("drain_worst", "drain_step"),
    ("live_worst", "live"),
    ("persistent_state", "persistent_state"),
];
/// Largest accepted growth of a bound over the committed one, %.
const SLACK_PERCENT: u64 = 3;

/// The bounds of a call.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CallBound {
    /// Stack, bytes.
    pub stack_bytes: u32,
    /// Instructions; `None` if a loop has no bound.
    pub instructions: Option<u64>,
}

/// The bounds of an image.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct CallBounds {
    /// Those of each call, by its name.
    pub calls: BTreeMap<String, CallBound>,
    /// Functions that the calls reach.
    pub functions: u32,
    /// Loops in them.
    pub loops: u32,
    /// Functions with a loop that has no bound, with what their loops are. This is not committed.
    pub without_bound: Vec<String>,
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
        let loops: LoopBounds = evidence("loops.toml")?;
        let lacks: Vec<String> = [loops.unargued(), loops.needless(&graph)].concat();
        if !lacks.is_empty() {
            return Err(format!("loops.toml:\n{}", lacks.join("\n")));
        }
        let instructions = graph.instruction_bounds(ROOTS, &loops);
        let of = Self {
            calls: bounds
                .iter()
                .map(|(name, bound)| {
                    let instructions = instructions.of.get(&format!("{ROOTS}{name}"));
                    let bound = CallBound {
                        stack_bytes: bound.bytes,
                        instructions: instructions.copied(),
                    };
                    (name.clone(), bound)
                })
                .collect(),
            without_bound: instructions.without_bound,
            functions: graph.len() as u32,
            loops: graph.loops() as u32,
        };
        Ok((of, bounds))
    }

    /// Reads committed bounds.
    ///
    /// # Errors
    /// The file cannot be read, or a line is not a name with numbers.
    pub fn read(path: &Path) -> Result<Self> {
        let text = text(path)?;
        let mut bounds = Self::default();
        for (number, line) in (1..).zip(text.lines()).skip(1) {
            let wrong = || problem(path, format!("line {number}: expected a name and numbers"));
            let mut words = line.split(',');
            let name = words.next().unwrap_or_default();
            let value = words.next().and_then(|word| word.parse().ok());
            let value = value.ok_or_else(wrong)?;
            match name {
                "functions" => bounds.functions = value,
                "loops" => bounds.loops = value,
                _ => {
                    let instructions = match words.next() {
                        None => return Err(wrong()),
                        Some("") => None,
                        Some(word) => Some(word.parse().map_err(|_| wrong())?),
                    };
                    let bound = CallBound {
                        stack_bytes: value,
                        instructions,
                    };
                    let _ = bounds.calls.insert(name.to_owned(), bound);
                }
            }
        }
        Ok(bounds)
    }

    /// Returns them as [`CallBounds::read`] reads them.
    #[must_use]
    pub fn to_csv(&self) -> String {
        let calls = self.calls.iter().map(|(name, bound)| {
            let instructions = bound.instructions.map(|of| of.to_string());
            let bytes = bound.stack_bytes;
            format!("{name},{bytes},{}\n", instructions.unwrap_or_default())
        });
        let counts = [("functions", self.functions), ("loops", self.loops)];
        let counts = counts.map(|(name, count)| format!("{name},{count},\n"));
        let header = "call,stack_bytes,instructions\n".to_owned();
        std::iter::once(header).chain(calls).chain(counts).collect()
    }

    /// Returns one line for each stack or number of instructions that was measured above its bound: the
    /// analysis is wrong. `budgets` is `firmware/budgets.csv`, measured in an emulated drive.
    ///
    /// # Errors
    /// A figure is missing.
    pub fn below_measured(&self, budgets: &str) -> Result<Vec<String>> {
        let mut below = Vec::new();
        let measured = |figure: &str| {
            let row = budgets
                .lines()
                .find_map(|line| line.strip_prefix(figure)?.strip_prefix(','));
            // The first column is that of the analysed image: `f32` on a Cortex-M4F.
            let measured = row.and_then(|row| row.split(',').next()?.parse::<u32>().ok());
            measured.ok_or_else(|| format!("no figure {figure}"))
        };
        for (figure, call) in MEASURED_INSTRUCTIONS {
            let measured: u64 = measured(figure)?.into();
            let bound = self.calls.get(call).and_then(|of| of.instructions);
            if bound.is_some_and(|bound| measured > bound) {
                below.push(format!(
                    "{figure}: {measured} instructions measured, more than the bound of {call}"
                ));
            }
        }
        for (figure, calls) in MEASURED {
            let measured = measured(figure)?;
            let bounds = calls.iter().filter_map(|call| self.calls.get(*call));
            let bound = bounds.map(|of| of.stack_bytes).max().unwrap_or(0);
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
        for (name, bound) in &self.calls {
            let bytes = bound.stack_bytes;
            let most = if name == "create" {
                MOST_START_STACK_BYTES
            } else {
                MOST_STACK_BYTES
            };
            if bytes > most {
                excesses.push(format!(
                    "{name}: {bytes} bytes of stack, more than the limit {most}"
                ));
            }
            let Some(known) = committed.calls.get(name) else {
                excesses.push(format!("{name}: not committed"));
                continue;
            };
            if exceeds(bytes.into(), known.stack_bytes.into()) {
                let known = known.stack_bytes;
                excesses.push(format!("{name}: {bytes} bytes of stack, {known} committed"));
            }
            match (bound.instructions, known.instructions) {
                (None, Some(_)) => excesses.push(format!(
                    "{name}: no bound of its instructions; see docs/evidence/loops.toml for\n{}",
                    self.without_bound.join("\n")
                )),
                (Some(now), Some(known)) if exceeds(now, known) => {
                    excesses.push(format!("{name}: {now} instructions, {known} committed"));
                }
                _ => {}
            }
        }
        let lost = committed.calls.keys();
        let lost = lost.filter(|name| !self.calls.contains_key(*name));
        excesses.extend(lost.map(|name| format!("{name}: no such call in the image")));
        excesses
    }
}

/// Returns whether a bound grew over the committed one.
fn exceeds(bound: u64, committed: u64) -> bool {
    bound > committed + committed * SLACK_PERCENT / 100
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
