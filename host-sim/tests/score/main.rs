//! Scores: errors against the truth, beside other methods, over windows.

mod beside_others;
mod planted_errors;
mod windows_and_drift;
