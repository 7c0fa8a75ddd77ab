//! How often the loops of an image run, at most: it is argued, not read off the image.

use super::function::Function;
use super::graph::CallGraph;
use super::loops::Loop;
use capstone::arch::arm::ArmReg;
use serde::Deserialize;
use std::collections::BTreeMap;

/// How often the loops of an image run, at most.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LoopBounds {
    #[serde(default)]
    function: Vec<FunctionLoops>,
    #[serde(default)]
    pub(super) copy: Vec<Copy>,
    #[serde(default)]
    length: Vec<Length>,
    #[serde(default)]
    pub(super) once: Vec<Once>,
}

/// The loops of a function, by address; an inner one follows that around it.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct FunctionLoops {
    name: String,
    loops: Vec<LoopBound>,
}

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct LoopBound {
    /// Number of its instructions when it was argued. Where it is another by far, this is another loop.
    instructions: usize,
    /// Passes through its first instruction, at most: each time it is entered, or in a whole call.
    times: u64,
    /// Whether it is in a whole call.
    #[serde(default)]
    in_all: bool,
    /// Why.
    why: String,
}

/// How often a loop runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Times {
    pub passes: u64,
    pub in_all: bool,
}

impl LoopBound {
    /// Returns how often it runs: once at least, where it is entered.
    fn times(&self) -> Times {
        Times {
            passes: self.times.max(1),
            in_all: self.in_all,
        }
    }
}

/// A function of the compiler that copies, clears or compares bytes. Its loops follow from their number.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Copy {
    pub name: String,
    /// Number of the register with the number of bytes.
    length_in_register: u16,
    /// Instructions besides those that depend on it.
    instructions: u64,
    /// Instructions for sixteen bytes.
    per_sixteen_bytes: u64,
    why: String,
}

/// The most bytes that a function copies, clears or compares where it does not give a constant.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Length {
    caller: String,
    bytes: u64,
    why: String,
}

/// A function that a call of the interface reaches in a loop, but in one pass only.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Once {
    pub call: String,
    pub function: String,
    why: String,
}

impl LoopBounds {
    /// Returns one line for each bound without a reason.
    #[must_use]
    pub fn unargued(&self) -> Vec<String> {
        let loops = self.function.iter().flat_map(|of| {
            let without = of.loops.iter().filter(|bound| bound.why.is_empty());
            without.map(|_| &of.name)
        });
        let copies = self.copy.iter().map(|of| (&of.name, &of.why));
        let lengths = self.length.iter().map(|of| (&of.caller, &of.why));
        let onces = self.once.iter().map(|of| (&of.function, &of.why));
        let others = copies.chain(lengths).chain(onces);
        let others = others.filter(|(_, why)| why.is_empty());
        let names = loops.chain(others.map(|(name, _)| name));
        names.map(|name| format!("{name}: no reason")).collect()
    }

    /// Returns one line for each bound of a function that the image does not have.
    #[must_use]
    pub fn needless(&self, graph: &CallGraph) -> Vec<String> {
        let loops = self.function.iter().map(|of| &of.name);
        let copies = self.copy.iter().map(|of| &of.name);
        let lengths = self.length.iter().map(|of| &of.caller);
        let onces = self.once.iter().map(|of| &of.function);
        let names = loops.chain(copies).chain(lengths).chain(onces);
        let gone = names.filter(|name| graph.functions.values().all(|of| of.name != **name));
        gone.map(|name| format!("{name}: not in the image"))
            .collect()
    }

    /// Returns how often each loop of a function runs, by its first instruction.
    pub(super) fn times(&self, function: &Function) -> Result<BTreeMap<u32, Times>, String> {
        let loops = function.loops();
        let known = self.function.iter().find(|of| of.name == function.name);
        let bounds: &[LoopBound] = known.map_or(&[], |of| &of.loops);
        let is_near = |(of, bound): (&Loop, &LoopBound)| {
            let (now, then) = (of.nodes.len(), bound.instructions);
            now.abs_diff(then) <= then / 4 + 4
        };
        if bounds.len() == loops.len() && loops.iter().zip(bounds).all(is_near) {
            let times = loops.iter().zip(bounds);
            return Ok(times.map(|(of, bound)| (of.head, bound.times())).collect());
        }
        let found = loops
            .iter()
            .map(|of| format!("{} from {:#x}", of.nodes.len(), of.head));
        let found: Vec<String> = found.collect();
        Err(format!(
            "{}: loops that have no bound, or another: instructions: {}",
            function.name,
            found.join(", ")
        ))
    }
}

impl Copy {
    /// Returns the instructions of a call of it; `None` if nothing says how many bytes.
    pub fn instructions(&self, bounds: &LoopBounds, caller: &Function, at: u32) -> Option<u64> {
        let register = ArmReg::ARM_REG_R0 as u16 + self.length_in_register;
        let length = bounds.length.iter().find(|of| of.caller == caller.name);
        let bytes = match caller.constant_before(at, register) {
            Some(constant) => constant.into(),
            None => length?.bytes,
        };
        Some(self.instructions + (self.per_sixteen_bytes * bytes).div_ceil(16))
    }
}
