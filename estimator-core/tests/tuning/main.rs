//! The tuning: its table of parameters, and access by key.

mod parameters;
