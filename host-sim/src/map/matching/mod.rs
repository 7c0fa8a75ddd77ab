//! Where on a network each point of a run was, and its cells on the grid of each way.

pub mod alignment;
pub mod placing;
pub mod track;
pub mod viterbi;
