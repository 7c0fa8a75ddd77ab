//! Where on a network each point of a run was, and its cells on the grid of each way.

pub mod alignment;
mod candidates;
mod knots;
pub mod match_run;
pub mod placing;
pub mod track;
pub mod track_point;
pub mod viterbi;
