//! The functions that some roots can reach.

use super::function::{Callee, Function};
use std::collections::{BTreeMap, BTreeSet};

/// The functions that some roots can reach.
#[derive(Clone, Debug, Default)]
pub struct CallGraph {
    /// By address.
    pub(super) functions: BTreeMap<u32, Function>,
    /// Functions whose address is stored: those that an indirect call may reach.
    pub(super) stored: BTreeSet<u32>,
}

impl CallGraph {
    /// Returns the functions with a name that begins with `prefix`.
    pub fn functions<'a>(&'a self, prefix: &'a str) -> impl Iterator<Item = &'a Function> + 'a {
        let functions = self.functions.values();
        functions.filter(move |function| function.name.starts_with(prefix))
    }

    /// Returns the functions that an indirect call may reach.
    pub fn indirect_targets(&self) -> impl Iterator<Item = &Function> {
        self.stored.iter().filter_map(|at| self.functions.get(at))
    }

    /// Returns the functions that make indirect calls.
    pub fn indirect_callers(&self) -> impl Iterator<Item = &Function> {
        let functions = self.functions.values();
        functions.filter(|function| {
            function
                .calls
                .iter()
                .any(|call| call.callee == Callee::Indirect)
        })
    }

    /// Returns the number of functions.
    #[must_use]
    pub fn len(&self) -> usize {
        self.functions.len()
    }

    /// Returns whether there is no function.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.functions.is_empty()
    }

    /// Returns the number of loops in all functions.
    #[must_use]
    pub fn loops(&self) -> usize {
        let functions = self.functions.values();
        functions.map(|function| function.loops().len()).sum()
    }
}
