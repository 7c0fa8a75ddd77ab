//! How far estimates are from the truth.
//!
//! The first and last 500 m are left out: there a smoother lacks one side (thesis section 7, 200
//! points cut at both ends). RMSE and bias are in % grade; the mean normalised squared error is
//! the mean of (error / sigma)², 1 if the sigmas are honest.
//!
//! * [`run_score`]: a run, alone or beside others;
//! * [`rivals`]: those others, estimated from the same log;
//! * [`companions`]: the files that this takes; [`judged`]: a file of a run, judged with them;
//! * [`of_map`]: a map against a reference;
//! * [`table`](mod@table): all of it as text.

pub mod companions;
pub mod judged;
pub mod of_map;
pub mod rivals;
pub mod run_score;
pub mod score_row;
pub mod table;

pub use of_map::{score_map, score_map_on_road};
pub use run_score::{RunScore, score_run, score_run_beside};
pub use score_row::{END_CUT_M, MEAN, ScoreRow, Unscorable, mean};
pub use table::{HEADER, json, table, text};
