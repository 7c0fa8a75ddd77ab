//! Bad input: files that are damaged, huge, hostile or in the way, and a machine at its limits.

mod folders;
mod generated;
mod machine;
mod memory;
mod outputs;
mod ranges;
mod shell;
mod store;
mod terminal;
