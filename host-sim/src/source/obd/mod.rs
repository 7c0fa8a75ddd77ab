//! Answers of on-board diagnostics (OBD-II) on a bus, as a tester or a logger asks for them.
//!
//! | file | content |
//! |---|---|
//! | `transport` | the parts of an answer, put together (ISO 15765-2) |
//! | `parameters` | lengths and values of the parameters (SAE J1979, service 01) |
//! | `answers` | which answers count: one responder for each signal, behind the bus's own messages |

mod answers;
mod parameters;
mod transport;

pub use answers::{ObdAnswers, ObdCount};
