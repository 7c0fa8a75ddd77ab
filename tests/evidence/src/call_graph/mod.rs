//! The call graph of a linked image for Cortex-M, and the bounds that follow from it: no recursion,
//! the deepest stack and the most instructions of each call.
//!
//! Nothing is run. Where an instruction is not understood, or moves the stack pointer by what is not a
//! constant, reading fails: a bound holds for the whole image or is not given.

mod function;
mod graph;
mod instruction;
mod instruction_bound;
mod loop_bounds;
mod loops;
mod read;
mod stack;

pub use function::{Callee, Function};
pub use graph::CallGraph;
pub use instruction_bound::InstructionBounds;
pub use loop_bounds::LoopBounds;
pub use stack::StackBound;
