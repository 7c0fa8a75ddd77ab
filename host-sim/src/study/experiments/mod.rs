//! The ten experiments of the thesis, replicated: trucks A (runs 1-3) and B (runs 4-5), south and
//! north between Södertälje and Nyköping.
//!
//! * [`replica`]: the disturbances of each run, and its two fitted numbers;
//! * [`thesis`]: the measured results of the thesis;
//! * [`method`], [`ours`]: the methods compared, and the inputs of ours;
//! * [`measure`]: errors of a profile, and maps merged by P;
//! * [`beside`], [`campaigns`]: ours against the thesis's methods, on one campaign and on ten;
//! * [`comparison`]: the replicas against the thesis, and the contributions to the errors;
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
