//! The ten experiments of the thesis, replicated: trucks A (runs 1-3) and B (runs 4-5), south and
//! north between Södertälje and Nyköping.
//!
//! * [`replica`]: what disturbs each run, and the two numbers of it that are fitted;
//! * [`thesis`]: what the thesis measured;
//! * [`method`], [`ours`]: the methods that are set side by side, and how ours is fed;
//! * [`measure`]: errors of a profile, and maps merged by P;
//! * [`beside`], [`campaigns`]: whether ours is better than the thesis's methods, on one campaign
//!   and on ten;
//! * [`comparison`]: the replicas beside the thesis, and what the errors are made of;
//! * [`tuning`]: how the noise of the filters was chosen;
//! * [`pointwise`], [`model_errors`], [`modified`]: sections 4.2, 7 and 8.

pub mod beside;
pub mod campaign;
pub mod campaigns;
pub mod comparison;
pub mod experiment;
pub mod heading;
pub mod measure;
pub mod method;
pub mod model_errors;
pub mod modified;
pub mod ours;
pub mod pointwise;
pub mod replica;
pub mod thesis;
pub mod tuning;
