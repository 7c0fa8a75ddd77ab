//! Scores: errors against the truth, beside other methods, over windows.

mod beside_others;
mod inertial_judge;
mod planted_errors;
mod windows_and_drift;
