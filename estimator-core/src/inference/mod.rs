//! The inference of the variances: the one mechanism that decides how much each noise counts.
//!
//! The filter is linear and knows no fault. Each fault is a noise whose variance is large for once:
//! a step of the model's error, a kink of the road, an outlier of the receiver, a torque that is not
//! renewed, another load. All these variances are inferred from the scores of one backward pass.
//!
//! | file | content |
//! |---|---|
//! | [`variances`], [`levels`] | what is inferred: a segment, a cell, a drive |
//! | [`cell_model`] | F and the noises of a cell, as a pass uses them |
//! | [`doubt`] | where the force is in doubt |
//! | [`fixed_point`] | the one place where variances are inferred |
//! | [`round`] | one round: forward and backward over a stretch of cells |
//! | [`window`], `work` | the window behind the vehicle, and what its update is at |
//! | `hypothesis` | what the window infers with or without brakes that no signal reports |
//! | `trial`, [`hidden_brakes`] | the second hypothesis beside the first, and what decides |
//! | `past_steps` | steps of the bias behind the window |
//! | `live`, `update` | the live grade; rounds in shares of work, and the lagged grade |

pub mod cell_model;
pub mod doubt;
pub mod fixed_point;
pub mod hidden_brakes;
mod hypothesis;
pub mod levels;
mod live;
mod past_steps;
pub mod round;
mod trial;
mod update;
pub mod variances;
pub mod window;
mod work;

pub use crate::tuning::Numbers;
pub use cell_model::{CellModel, CellTerms};
pub use fixed_point::FixedPoint;
pub use hidden_brakes::HiddenBrakes;
pub use levels::{LevelSums, Levels};
pub use round::{Pass, Round, Stretch};
pub use variances::{CellVariances, DoubtCell, SEGMENT_CELLS, SegmentVariances};
pub use window::Window;
