//! Smoothing: what later measurements say about earlier cells.
//!
//! * [`backward_pass`]: the recursion backwards over filter steps;
//! * [`block_smoother`]: the same over a block of steps at once, for any later information;
//! * [`fixed_lag`]: fixed-lag smoothing in fixed memory, made of the two, in shares of work;
//! * `lagged_cell`, `two_stacks`: cells that wait in it, and where they wait.

pub mod backward_pass;
pub mod block_smoother;
pub mod fixed_lag;
mod lagged_cell;
mod two_stacks;

pub use backward_pass::BackwardPass;
pub use block_smoother::BlockSmoother;
pub use fixed_lag::FixedLag;
