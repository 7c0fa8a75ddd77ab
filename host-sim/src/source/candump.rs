//! candump logs.
