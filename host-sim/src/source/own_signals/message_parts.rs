//! What the statements of a `.dbc` file say of a message.

use super::dbc_statement::SignalStatement;
use estimator_core::signal::raw_field::NumberKind;
use std::collections::BTreeMap;

/// A part of a message; or, why it cannot be read.
type Read<T> = Result<T, String>;
/// The name of a switch, and pairs of the least and the greatest number that select a signal.
type Selection = (String, Vec<(u64, u64)>);

/// What the statements of a message say.
#[derive(Debug)]
pub(super) struct MessageParts {
    pub number: u32,
    pub name: String,
    /// By name, in the order of the file.
    pub signals: Vec<(String, Read<SignalStatement>)>,
    /// Kinds of numbers (`SIG_VALTYPE_`), by signal.
    pub kinds: BTreeMap<String, Read<NumberKind>>,
    /// Switches (`SG_MUL_VAL_`), by signal.
    pub switches: BTreeMap<String, Read<Selection>>,
}
