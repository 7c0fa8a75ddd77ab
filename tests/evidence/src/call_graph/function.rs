//! A function of an image: its paths, the calls on them, and the stack at each.

use super::instruction::{Decoder, Flow, Half, Instruction};
use std::collections::{BTreeMap, BTreeSet};

/// What a call leads to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Callee {
    /// The function at this address.
    At(u32),
    /// A function whose address is in a register.
    Indirect,
}

/// A call.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Call {
    /// What it leads to.
    pub callee: Callee,
    /// The stack of the caller at the call, bytes.
    pub stack_bytes: u32,
}

/// An instruction of a function.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Node {
    /// Addresses of the instructions of the function that may follow.
    pub next: Vec<u32>,
    /// The function that it calls, or goes on in.
    pub callee: Option<Callee>,
    /// The registers that it writes.
    pub writes: Vec<u16>,
    /// A register and the constant that it writes to it.
    pub constant: Option<(u16, u32)>,
}

/// A function.
#[derive(Clone, Debug, Default)]
pub struct Function {
    /// Its name as in the source.
    pub name: String,
    /// Its largest own stack, bytes.
    pub stack_bytes: u32,
    /// Its calls.
    pub calls: Vec<Call>,
    /// Address of its first instruction.
    pub address: u32,
    /// Its instructions by address.
    pub nodes: BTreeMap<u32, Node>,
    /// Constants that it loads in two halves; some are addresses.
    pub constants: BTreeSet<u32>,
}

/// The code of a function.
pub struct Code<'a> {
    /// Address of its first instruction.
    pub address: u32,
    /// All of its bytes, tables included.
    pub bytes: &'a [u8],
    /// Where its tables of jumps end, by their begin.
    pub table_ends: &'a BTreeMap<u32, u32>,
}

impl Code<'_> {
    fn contains(&self, address: u32) -> bool {
        (self.address..self.address + self.bytes.len() as u32).contains(&address)
    }

    fn at(&self, address: u32) -> &[u8] {
        let from = address.saturating_sub(self.address) as usize;
        self.bytes.get(from..).unwrap_or_default()
    }

    /// Follows every path through the function.
    ///
    /// # Errors
    /// An instruction is not understood, or the stack is not the same on all paths to a place.
    pub fn function(&self, decoder: &Decoder, name: &str) -> Result<Function, String> {
        let mut paths = Paths {
            code: self,
            depths: BTreeMap::new(),
            open: vec![(self.address, 0)],
            conditional: BTreeSet::new(),
            halves: BTreeMap::new(),
            function: Function {
                name: name.to_owned(),
                address: self.address,
                ..Function::default()
            },
        };
        while let Some((address, depth)) = paths.open.pop() {
            paths.follow(decoder, address, depth)?;
        }
        Ok(paths.function)
    }

    /// Returns the targets of a jump by a table of entries of `width` bytes.
    fn table_targets(&self, table: u32, width: u32) -> Result<Vec<u32>, String> {
        let end = self.table_ends.get(&table).copied();
        let end = end.ok_or_else(|| format!("{table:#x}: no table of jumps"))?;
        let entries = self.at(table).iter().take((end - table) as usize);
        let entries: Vec<u32> = entries.map(|byte| u32::from(*byte)).collect();
        let offsets = entries
            .chunks_exact(width as usize)
            .map(|entry| entry.iter().rev().fold(0, |value, byte| value << 8 | byte));
        // An entry that leads into the table fills it up to a whole half-word.
        let targets = offsets
            .map(|offset| table + 2 * offset)
            .filter(|target| *target >= end);
        Ok(targets.collect())
    }
}

/// Returns the length of a Thumb instruction, bytes: its first bits say whether it has two halves.
fn instruction_length(code: &[u8]) -> u32 {
    match code.get(1) {
        Some(0b1110_1000..) => 4,
        _ => 2,
    }
}

/// The paths that were followed so far.
struct Paths<'a> {
    code: &'a Code<'a>,
    /// The stack before each instruction, bytes.
    depths: BTreeMap<u32, i32>,
    open: Vec<(u32, i32)>,
    /// Instructions that an IT instruction makes conditional. The decoder sees one at a time.
    conditional: BTreeSet<u32>,
    halves: BTreeMap<u16, u32>,
    function: Function,
}

impl Paths<'_> {
    /// Follows the instruction at an address.
    fn follow(&mut self, decoder: &Decoder, address: u32, depth: i32) -> Result<(), String> {
        if let Some(known) = self.depths.get(&address) {
            return if *known == depth {
                Ok(())
            } else {
                Err(format!("{address:#x}: {known} or {depth} bytes of stack"))
            };
        }
        if !self.code.contains(address) {
            return Err(format!("{address:#x}: runs out of {}", self.function.name));
        }
        self.depths.insert(address, depth);
        let is_conditional = self.conditional.contains(&address);
        let read = decoder.read(self.code.at(address), address, is_conditional)?;
        let mut behind = address + read.length;
        for _ in 0..read.conditional {
            self.conditional.insert(behind);
            behind += instruction_length(self.code.at(behind));
        }
        self.remember(read.half);
        let growth = read
            .stack_growth
            .ok_or_else(|| format!("{address:#x}: unknown stack: {}", read.words))?;
        let after = depth + growth;
        let deepest = u32::try_from(after.max(depth)).unwrap_or(0);
        self.function.stack_bytes = self.function.stack_bytes.max(deepest);
        let node = Node {
            writes: read.writes.clone(),
            constant: read.constant,
            ..Node::default()
        };
        self.function.nodes.insert(address, node);
        self.go_on(&read, address, depth, after)
    }

    fn go_on(
        &mut self,
        read: &Instruction,
        address: u32,
        depth: i32,
        after: i32,
    ) -> Result<(), String> {
        let next = address + read.length;
        match read.flow {
            Flow::Next => self.follow_later(address, next, after),
            Flow::Jump(target) => self.jump(address, target, after),
            Flow::Branch(target) => {
                self.jump(address, target, after);
                self.follow_later(address, next, after);
            }
            Flow::Call(target) => self.call(address, Callee::At(target), next, after),
            Flow::IndirectCall => self.call(address, Callee::Indirect, next, after),
            Flow::Table(width) => {
                for target in self.code.table_targets(next, width)? {
                    self.jump(address, target, after);
                }
            }
            Flow::Return { may_stay: true } => self.follow_later(address, next, depth),
            Flow::Return { may_stay: false } if after == 0 => {}
            Flow::Return { may_stay: false } => {
                return Err(format!("{address:#x}: returns with {after} bytes of stack"));
            }
            Flow::Nowhere => {}
        }
        Ok(())
    }

    /// Follows a jump. One that leaves the function is a call whose callee returns to the caller.
    fn jump(&mut self, from: u32, target: u32, depth: i32) {
        if !self.code.contains(target) || (target == self.code.address && depth == 0) {
            self.add_call(from, Callee::At(target), depth);
            return;
        }
        self.follow_later(from, target, depth);
    }

    fn follow_later(&mut self, from: u32, target: u32, depth: i32) {
        self.node(from).next.push(target);
        self.open.push((target, depth));
    }

    fn node(&mut self, address: u32) -> &mut Node {
        self.function.nodes.entry(address).or_default()
    }

    fn call(&mut self, from: u32, callee: Callee, next: u32, depth: i32) {
        self.add_call(from, callee, depth);
        // Behind the call of a function that never returns, a table or the next function begins.
        let is_code = self.code.contains(next) && !self.code.table_ends.contains_key(&next);
        if is_code {
            self.follow_later(from, next, depth);
        }
    }

    fn add_call(&mut self, from: u32, callee: Callee, depth: i32) {
        self.node(from).callee = Some(callee);
        let stack_bytes = u32::try_from(depth).unwrap_or(0);
        self.function.calls.push(Call {
            callee,
            stack_bytes,
        });
    }

    /// Puts the halves of constants together. The paths are not followed in the order of the code, so
    /// that a constant may be put together wrongly; one that is none of a function is not used.
    fn remember(&mut self, half: Option<Half>) {
        let Some(half) = half else { return };
        if half.is_upper {
            let lower = self.halves.get(&half.register).copied().unwrap_or(0);
            self.function.constants.insert(half.bits << 16 | lower);
        } else {
            self.halves.insert(half.register, half.bits);
            // Without an upper half it is a constant of its own.
            self.function.constants.insert(half.bits);
        }
    }
}
