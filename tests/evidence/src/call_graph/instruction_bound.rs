//! The most instructions of a call: the longest path of each function, its loops as often as they can
//! run, and what it calls.
//!
//! How often a loop runs is not read off the image: it is argued ([`LoopBounds`]).

use super::function::{Callee, Function};
use super::graph::CallGraph;
use super::loop_bounds::{Copy, LoopBounds, Times};
use super::loops::{Loop, Part};
use std::collections::{BTreeMap, BTreeSet};

impl CallGraph {
    /// Returns the most instructions of each function whose name begins with `roots`, as far as all loops
    /// that it reaches have bounds.
    #[must_use]
    pub fn instruction_bounds(&self, roots: &str, bounds: &LoopBounds) -> InstructionBounds {
        let mut times = BTreeMap::new();
        let mut problems = BTreeSet::new();
        for (address, function) in &self.functions {
            if bounds.copy.iter().any(|of| of.name == function.name) {
                continue;
            }
            match bounds.times(function) {
                Ok(of) => drop(times.insert(*address, of)),
                Err(problem) => drop(problems.insert(problem)),
            }
        }
        let mut most: BTreeMap<String, u64> = BTreeMap::new();
        for (address, function) in &self.functions {
            let Some(call) = function.name.strip_prefix(roots) else {
                continue;
            };
            let onces = bounds.once.iter().filter(|once| once.call == call);
            let onces: Vec<u32> = onces
                .filter_map(|once| self.named(&once.function))
                .collect();
            let mut work = Work::new(self, bounds, &times, &onces);
            let once = onces
                .iter()
                .map(|once| work.body(*once))
                .sum::<Option<u64>>();
            let Some(instructions) = work.of(*address).zip(once) else {
                continue;
            };
            let instructions = instructions.0 + instructions.1;
            let known = most.entry(function.name.clone()).or_default();
            *known = (*known).max(instructions);
        }
        InstructionBounds {
            of: most,
            without_bound: problems.into_iter().collect(),
        }
    }

    fn named(&self, name: &str) -> Option<u32> {
        let found = self.functions.iter().find(|(_, of)| of.name == name);
        found.map(|(address, _)| *address)
    }
}

/// The most instructions of functions.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct InstructionBounds {
    /// Those of each function that has a bound, by name.
    pub of: BTreeMap<String, u64>,
    /// One line for each function with a loop that has no bound.
    pub without_bound: Vec<String>,
}

/// The instructions of functions, as far as they are known.
struct Work<'a> {
    graph: &'a CallGraph,
    bounds: &'a LoopBounds,
    times: &'a BTreeMap<u32, BTreeMap<u32, Times>>,
    known: BTreeMap<u32, Option<u64>>,
}

impl<'a> Work<'a> {
    /// Creates it. The functions `counted_apart` count nothing where they are called.
    fn new(
        graph: &'a CallGraph,
        bounds: &'a LoopBounds,
        times: &'a BTreeMap<u32, BTreeMap<u32, Times>>,
        counted_apart: &[u32],
    ) -> Self {
        Self {
            graph,
            bounds,
            times,
            known: counted_apart
                .iter()
                .map(|address| (*address, Some(0)))
                .collect(),
        }
    }

    /// Returns the most instructions of a function; `None` if a loop has no bound.
    fn of(&mut self, address: u32) -> Option<u64> {
        if let Some(known) = self.known.get(&address) {
            return *known;
        }
        let instructions = self.body(address);
        self.known.insert(address, instructions);
        instructions
    }

    fn body(&mut self, address: u32) -> Option<u64> {
        let function = self.graph.functions.get(&address)?;
        let nodes: BTreeSet<u32> = function.nodes.keys().copied().collect();
        let from = self.longest(function, &nodes, None, &|_| true)?;
        let mut instructions = from.get(&address).copied()?;
        for of in function.loops() {
            let times = self.times(function, &of)?;
            if times.in_all {
                instructions += times.passes * self.pass(function, &of, &|_| true)?;
            }
        }
        Some(instructions)
    }

    /// Returns the most instructions on a path from each node to an end that stays within `nodes` and
    /// does not come to `head` again. Nodes from which no end is reached are left out.
    fn longest(
        &mut self,
        function: &Function,
        nodes: &BTreeSet<u32>,
        head: Option<u32>,
        is_end: &dyn Fn(u32) -> bool,
    ) -> Option<BTreeMap<u32, u64>> {
        let mut from: BTreeMap<u32, u64> = BTreeMap::new();
        for part in function.parts(nodes, head) {
            let (own, members) = match part {
                Part::Instruction(at) => (1 + self.called(function, at)?, BTreeSet::from([at])),
                Part::Loop(of) => (self.passes(function, &of)?, of.nodes),
            };
            let ways = members.iter().flat_map(|at| function.next(*at));
            let ways = ways.filter(|next| Some(*next) != head && !members.contains(next));
            let after = ways.filter_map(|next| from.get(&next).copied()).max();
            let ends = members.iter().any(|at| is_end(*at)).then_some(0);
            if let Some(after) = after.max(ends) {
                from.extend(members.into_iter().map(|at| (at, own + after)));
            }
        }
        Some(from)
    }

    /// Returns the most instructions of all passes through a loop, each time it is entered; none if
    /// they are counted for a whole call.
    fn passes(&mut self, function: &Function, of: &Loop) -> Option<u64> {
        let times = self.times(function, of)?;
        if times.in_all {
            return Some(0);
        }
        let goes_on = self.pass(function, of, &|at| {
            function.next(at).any(|to| to == of.head)
        })?;
        let leaves = |at: u32| {
            let mut next = function.next(at).peekable();
            next.peek().is_none() || next.any(|to| !of.nodes.contains(&to))
        };
        let ends = self.pass(function, of, &leaves)?;
        // Entered elsewhere, it runs a part of a pass before the first.
        let more = times.passes - 1 + u64::from(of.has_side_entry);
        Some(more * goes_on + ends.max(goes_on * u64::from(of.has_side_entry)))
    }

    /// Returns the most instructions from the first one of a loop, or where it is entered, to an end.
    fn pass(
        &mut self,
        function: &Function,
        of: &Loop,
        is_end: &dyn Fn(u32) -> bool,
    ) -> Option<u64> {
        let longest = self.longest(function, &of.nodes, Some(of.head), is_end)?;
        if of.has_side_entry {
            return longest.values().max().copied();
        }
        longest.get(&of.head).copied().or(Some(0))
    }

    fn times(&self, function: &Function, of: &Loop) -> Option<Times> {
        self.times.get(&function.address)?.get(&of.head).copied()
    }

    /// Returns the most instructions of what an instruction calls.
    fn called(&mut self, function: &Function, at: u32) -> Option<u64> {
        let callee = function.nodes.get(&at).and_then(|node| node.callee);
        match callee {
            None => Some(0),
            Some(Callee::At(callee)) => match self.copy(callee) {
                Some(copy) => copy.instructions(self.bounds, function, at),
                None => self.of(callee),
            },
            Some(Callee::Indirect) => {
                let mut most = 0;
                for target in &self.graph.stored {
                    most = most.max(self.of(*target)?);
                }
                Some(most)
            }
        }
    }

    fn copy(&self, callee: u32) -> Option<&'a Copy> {
        let name = &self.graph.functions.get(&callee)?.name;
        self.bounds.copy.iter().find(|copy| copy.name == *name)
    }
}

#[cfg(test)]
mod tests {
    use super::super::function::Node;
    use super::*;
    use capstone::arch::arm::ArmReg;

    /// Addresses that may follow an address.
    type Way<'a> = (u32, &'a [u32]);

    fn function(name: &str, ways: &[Way<'_>]) -> Function {
        let node = |(at, next): &Way<'_>| {
            let node = Node {
                next: next.to_vec(),
                ..Node::default()
            };
            (*at, node)
        };
        Function {
            name: name.to_owned(),
            address: ways[0].0,
            nodes: ways.iter().map(node).collect(),
            ..Function::default()
        }
    }

    fn calling(mut function: Function, at: u32, callee: u32) -> Function {
        let node = function.nodes.get_mut(&at).unwrap();
        node.callee = Some(Callee::At(callee));
        function
    }

    fn bounds_of(functions: Vec<Function>, loops: &str) -> InstructionBounds {
        let graph = CallGraph {
            functions: functions.into_iter().map(|of| (of.address, of)).collect(),
            ..CallGraph::default()
        };
        graph.instruction_bounds("call ", &toml::from_str(loops).unwrap())
    }

    fn bound_of(functions: Vec<Function>, loops: &str) -> u64 {
        let bounds = bounds_of(functions, loops);
        assert_eq!(bounds.without_bound, [""; 0]);
        bounds.of["call a"]
    }

    fn loops(name: &str, bounds: &[(usize, u64, bool)]) -> String {
        let bounds = bounds.iter().map(|(instructions, times, in_all)| {
            format!(
                "{{ instructions = {instructions}, times = {times}, in_all = {in_all}, why = '-' }}"
            )
        });
        let bounds: Vec<String> = bounds.collect();
        let bounds = bounds.join(", ");
        format!("[[function]]\nname = '{name}'\nloops = [{bounds}]\n")
    }

    #[test]
    fn the_longest_of_all_ways_counts() {
        let ways: [Way<'_>; 5] = [(1, &[2, 4]), (2, &[3]), (3, &[5]), (4, &[5]), (5, &[])];
        assert_eq!(bound_of(vec![function("call a", &ways)], ""), 4);
    }

    #[test]
    fn a_loop_ends_where_it_is_left() {
        // Tested at its begin: four passes and the test that ends it.
        let ways: [Way<'_>; 4] = [(1, &[2]), (2, &[3, 4]), (3, &[2]), (4, &[])];
        let at_begin = loops("call a", &[(2, 5, false)]);
        assert_eq!(
            bound_of(vec![function("call a", &ways)], &at_begin),
            1 + 4 * 2 + 1 + 1
        );
        // Tested at its end: five whole passes.
        let ways: [Way<'_>; 4] = [(1, &[2]), (2, &[3]), (3, &[2, 4]), (4, &[])];
        let at_end = loops("call a", &[(2, 5, false)]);
        assert_eq!(
            bound_of(vec![function("call a", &ways)], &at_end),
            1 + 5 * 2 + 1
        );
    }

    #[test]
    fn a_loop_in_a_loop_counts_in_each_pass_or_in_all() {
        let ways: [Way<'_>; 5] = [(1, &[2]), (2, &[3]), (3, &[3, 4]), (4, &[2, 5]), (5, &[])];
        let each = loops("call a", &[(3, 4, false), (1, 10, false)]);
        assert_eq!(
            bound_of(vec![function("call a", &ways)], &each),
            1 + 4 * (2 + 10) + 1
        );
        let all = loops("call a", &[(3, 4, false), (1, 10, true)]);
        assert_eq!(
            bound_of(vec![function("call a", &ways)], &all),
            1 + 4 * 2 + 10 + 1
        );
    }

    #[test]
    fn a_loop_that_is_entered_twice_runs_a_pass_more() {
        let ways: [Way<'_>; 4] = [(1, &[2, 3]), (2, &[3]), (3, &[2, 4]), (4, &[])];
        let bound = bound_of(
            vec![function("call a", &ways)],
            &loops("call a", &[(2, 5, false)]),
        );
        assert!(bound > 1 + 1 + 5 * 2, "{bound}");
    }

    #[test]
    fn a_loop_without_a_bound_leaves_its_callers_without_one() {
        let functions = || {
            vec![
                calling(function("call a", &[(1, &[2]), (2, &[])]), 1, 10),
                function("call b", &[(5, &[])]),
                function("looping", &[(10, &[10, 11]), (11, &[])]),
            ]
        };
        let bounds = bounds_of(functions(), "");
        assert_eq!(bounds.of, BTreeMap::from([("call b".to_owned(), 1)]));
        assert_eq!(bounds.without_bound.len(), 1);
        assert!(bounds.without_bound[0].starts_with("looping: "));
        // Nor does the bound of another loop count.
        let other = loops("looping", &[(50, 3, false)]);
        assert_eq!(bounds_of(functions(), &other).of.len(), 1);
        let known = loops("looping", &[(1, 3, false)]);
        assert_eq!(bounds_of(functions(), &known).of["call a"], 2 + 3 + 1);
    }

    #[test]
    fn a_function_counts_once_where_a_loop_reaches_it_once() {
        let functions = vec![
            calling(
                function("call a", &[(1, &[2]), (2, &[2, 3]), (3, &[])]),
                2,
                10,
            ),
            function("long", &[(10, &[11]), (11, &[12]), (12, &[])]),
        ];
        let looping = loops("call a", &[(1, 5, false)]);
        assert_eq!(bound_of(functions.clone(), &looping), 1 + 5 * (1 + 3) + 1);
        let once = looping + "[[once]]\ncall = 'a'\nfunction = 'long'\nwhy = '-'\n";
        assert_eq!(bound_of(functions, &once), 1 + 5 + 3 + 1);
    }

    #[test]
    fn a_copy_counts_by_its_length() {
        let register = ArmReg::ARM_REG_R0 as u16 + 2;
        let copy = "[[copy]]\nname = 'copy'\nlength_in_register = 2\ninstructions = 10\n\
            per_sixteen_bytes = 8\nwhy = '-'\n";
        let of_length = |constant: Option<u32>| {
            let ways: [Way<'_>; 4] = [(1, &[2]), (2, &[3]), (3, &[4]), (4, &[])];
            let mut caller = calling(function("call a", &ways), 3, 10);
            let node = caller.nodes.get_mut(&1).unwrap();
            node.writes = vec![register];
            node.constant = constant.map(|constant| (register, constant));
            vec![caller, function("copy", &[(10, &[10, 11]), (11, &[])])]
        };
        assert_eq!(bound_of(of_length(Some(100)), copy), 4 + 10 + 50);
        assert!(bounds_of(of_length(None), copy).of.is_empty());
        let length = format!("{copy}[[length]]\ncaller = 'call a'\nbytes = 32\nwhy = '-'\n");
        assert_eq!(bound_of(of_length(None), &length), 4 + 10 + 16);
    }
}
