//! The loops of a function: what of its code an instruction can lead back to.

use super::function::{Function, Node};
use petgraph::algo::tarjan_scc;
use petgraph::graphmap::DiGraphMap;
use std::collections::{BTreeMap, BTreeSet};

/// A loop.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Loop {
    /// Its instruction that each pass begins with. Without the way to it, there is no loop.
    pub head: u32,
    /// Its instructions, those of inner loops included.
    pub nodes: BTreeSet<u32>,
    /// Whether it is entered elsewhere, too.
    pub has_side_entry: bool,
}

/// Parts of code in the order in which they can run: each is one instruction, or a loop.
pub(super) enum Part {
    Instruction(u32),
    Loop(Loop),
}

impl Function {
    /// Returns its loops with those in them, by address.
    #[must_use]
    pub fn loops(&self) -> Vec<Loop> {
        let mut found = Vec::new();
        let mut open: Vec<(BTreeSet<u32>, Option<u32>)> =
            vec![(self.nodes.keys().copied().collect(), None)];
        while let Some((nodes, head)) = open.pop() {
            for part in self.parts(&nodes, head) {
                if let Part::Loop(inner) = part {
                    open.push((inner.nodes.clone(), Some(inner.head)));
                    found.push(inner);
                }
            }
        }
        found.sort_by_key(|of| of.head);
        found
    }

    /// Divides code into its parts, the last to run first. Ways to `head` do not count.
    pub(super) fn parts(&self, nodes: &BTreeSet<u32>, head: Option<u32>) -> Vec<Part> {
        let mut graph = DiGraphMap::<u32, ()>::new();
        for address in nodes {
            graph.add_node(*address);
            for next in self.next(*address) {
                if nodes.contains(&next) && Some(next) != head {
                    graph.add_edge(*address, next, ());
                }
            }
        }
        // Tarjan's algorithm gives them in this order.
        tarjan_scc(&graph)
            .into_iter()
            .map(|component| match *component {
                [only] if !graph.contains_edge(only, only) => Part::Instruction(only),
                _ => Part::Loop(self.loop_of(component.into_iter().collect())),
            })
            .collect()
    }

    fn loop_of(&self, nodes: BTreeSet<u32>) -> Loop {
        let outside = self.nodes.iter().filter(|(at, _)| !nodes.contains(at));
        let targets = outside.flat_map(|(_, Node { next, .. })| next.iter().copied());
        let mut entries: BTreeSet<u32> = targets.filter(|at| nodes.contains(at)).collect();
        if nodes.contains(&self.address) {
            entries.insert(self.address);
        }
        Loop {
            head: entries.first().copied().unwrap_or_default(),
            has_side_entry: entries.len() > 1,
            nodes,
        }
    }

    pub(super) fn next(&self, address: u32) -> impl Iterator<Item = u32> + '_ {
        let node = self.nodes.get(&address);
        node.into_iter().flat_map(|node| node.next.iter().copied())
    }

    /// Returns the largest constant that a register can have before an instruction; `None` if it may
    /// have another value.
    #[must_use]
    pub fn constant_before(&self, address: u32, register: u16) -> Option<u32> {
        let mut before: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
        for (at, node) in &self.nodes {
            for next in &node.next {
                before.entry(*next).or_default().push(*at);
            }
        }
        let mut seen = BTreeSet::new();
        let mut open = vec![address];
        let mut largest = None;
        while let Some(at) = open.pop() {
            // At the begin of the function it is an argument.
            for from in before.get(&at)? {
                let node = self.nodes.get(from)?;
                match node.constant {
                    Some((of, constant)) if of == register => {
                        largest = largest.max(Some(constant));
                    }
                    // A call may write any of the registers of arguments.
                    _ if node.callee.is_some() || node.writes.contains(&register) => return None,
                    _ if *from == self.address => return None,
                    _ if seen.insert(*from) => open.push(*from),
                    _ => {}
                }
            }
        }
        largest
    }
}
