//! Errors of estimates against the truth.
//!
//! The first and last 500 m are left out, because a smoother has data on one side only there
//! (thesis section 7, 200 points cut at both ends). RMSE and bias are in % grade. The mean
//! normalised squared error is the mean of (error / sigma)²; it is 1 if the sigmas are consistent.
//!
//! * [`run_score`]: scores of a run, with or without comparison estimates;
//! * [`rivals`]: comparison estimates from the same log;
//! * [`companions`]: the files for them; [`judged`]: a run file scored with these files;
//! * [`of_map`]: a map against a reference;
//! * [`table`](mod@table): the error table as text and JSON.

pub mod companions;
pub mod judged;
pub mod of_map;
pub mod rivals;
pub mod run_score;
pub mod score_row;
pub mod table;

pub use of_map::{score_map, score_map_on_road, true_grades};
pub use run_score::{RunScore, score_run, score_run_beside};
pub use score_row::{END_CUT_M, MEAN, ScoreRow, Unscorable, mean};
pub use table::{HEADER, json, table, text};
