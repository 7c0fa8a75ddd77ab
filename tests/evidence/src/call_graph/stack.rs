//! The deepest stack of a call, over all paths of the call graph.

use super::function::Callee;
use super::graph::CallGraph;
use std::collections::BTreeMap;

/// The deepest stack of a function and of what it calls.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct StackBound {
    /// Bytes.
    pub bytes: u32,
    /// Names of the functions on the deepest path.
    pub path: Vec<String>,
}

impl CallGraph {
    /// Returns the deepest stack of each function whose name begins with `roots`, by name.
    ///
    /// # Errors
    /// A function can call itself: its stack has no bound.
    pub fn stack_bounds(&self, roots: &str) -> Result<BTreeMap<String, StackBound>, String> {
        let mut depths = Depths {
            graph: self,
            known: BTreeMap::new(),
            above: Vec::new(),
        };
        let mut bounds: BTreeMap<String, StackBound> = BTreeMap::new();
        for (address, function) in &self.functions {
            if !function.name.starts_with(roots) {
                continue;
            }
            let bytes = depths.of(*address)?;
            let path = depths.path(*address);
            // Of several functions of one name, for several types, the deepest counts.
            let bound = bounds
                .entry(function.name.clone())
                .or_insert_with(|| StackBound {
                    bytes: 0,
                    path: Vec::new(),
                });
            if bytes >= bound.bytes {
                *bound = StackBound { bytes, path };
            }
        }
        Ok(bounds)
    }
}

struct Depths<'a> {
    graph: &'a CallGraph,
    /// Deepest stack of a function, and the callee on the deepest path.
    known: BTreeMap<u32, (u32, Option<u32>)>,
    /// The functions that are being looked at.
    above: Vec<u32>,
}

impl Depths<'_> {
    fn of(&mut self, address: u32) -> Result<u32, String> {
        if let Some((bytes, _)) = self.known.get(&address) {
            return Ok(*bytes);
        }
        if let Some(first) = self.above.iter().position(|above| *above == address) {
            let names: Vec<&str> = self.above[first..]
                .iter()
                .map(|at| self.name(*at))
                .collect();
            return Err(format!("recursion: {}", names.join(" → ")));
        }
        let graph = self.graph;
        let function = graph
            .functions
            .get(&address)
            .ok_or_else(|| format!("{address:#x}: a call of no function"))?;
        self.above.push(address);
        let mut deepest = (function.stack_bytes, None);
        for call in &function.calls {
            let callees: Vec<u32> = match call.callee {
                Callee::At(callee) => vec![callee],
                Callee::Indirect => graph.stored.iter().copied().collect(),
            };
            for callee in callees {
                let bytes = call.stack_bytes + self.of(callee)?;
                if bytes > deepest.0 {
                    deepest = (bytes, Some(callee));
                }
            }
        }
        self.above.pop();
        self.known.insert(address, deepest);
        Ok(deepest.0)
    }

    fn path(&self, address: u32) -> Vec<String> {
        let mut path = vec![self.name(address).to_owned()];
        let mut next = self.known.get(&address).and_then(|(_, callee)| *callee);
        while let Some(address) = next {
            path.push(self.name(address).to_owned());
            next = self.known.get(&address).and_then(|(_, callee)| *callee);
        }
        path
    }

    fn name(&self, address: u32) -> &str {
        let function = self.graph.functions.get(&address);
        function.map_or("?", |function| &function.name)
    }
}

#[cfg(test)]
mod tests {
    use super::super::function::{Call, Function};
    use super::*;

    /// Address and own stack of a function, and address and stack of each of its calls.
    type Described<'a> = (u32, u32, &'a [(u32, u32)]);

    fn graph(functions: &[Described<'_>]) -> CallGraph {
        let function = |(at, stack_bytes, calls): &Described<'_>| {
            let calls = calls.iter().map(|(callee, stack_bytes)| Call {
                callee: Callee::At(*callee),
                stack_bytes: *stack_bytes,
            });
            let function = Function {
                name: format!("f{at}"),
                stack_bytes: *stack_bytes,
                calls: calls.collect(),
                ..Function::default()
            };
            (*at, function)
        };
        CallGraph {
            functions: functions.iter().map(function).collect(),
            ..CallGraph::default()
        }
    }

    #[test]
    fn the_deepest_of_all_paths_counts() {
        // The callee with the most stack is called where its caller has the least.
        let graph = graph(&[
            (1, 100, &[(2, 8), (3, 90)]),
            (2, 70, &[]),
            (3, 4, &[(4, 4)]),
            (4, 20, &[]),
        ]);
        let bounds = graph.stack_bounds("f1").unwrap();
        let bound = &bounds["f1"];
        assert_eq!(bound.bytes, 90 + 4 + 20);
        assert_eq!(bound.path, ["f1", "f3", "f4"]);
    }

    #[test]
    fn a_recursion_is_named() {
        let graph = graph(&[(1, 8, &[(2, 8)]), (2, 8, &[(3, 8)]), (3, 8, &[(2, 8)])]);
        let problem = graph.stack_bounds("f1").unwrap_err();
        assert_eq!(problem, "recursion: f2 → f3");
    }
}
