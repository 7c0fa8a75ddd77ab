//! Bad input: files that are damaged, huge, hostile or in the way, and a machine at its limits.

mod disk;
mod folders;
mod generated;
mod kill;
mod machine;
mod memory;
mod mistakes;
mod objects;
mod outputs;
mod ranges;
mod shell;
mod store;
mod terminal;
