//! A warning about the input of an estimate.

use serde::Serialize;

/// What is not plausible about the input of an estimate, and what to do.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Warning {
    /// Short name of the kind, which does not change.
    pub code: &'static str,
    /// What was found.
    pub message: String,
    /// What to do.
    pub advice: &'static str,
    /// What the verdict says, if the estimate is not to be trusted.
    #[serde(skip)]
    pub spoils: Option<&'static str>,
}

impl Warning {
    /// Creates a warning about an input that the estimate can do without.
    pub(crate) fn minor(code: &'static str, message: String, advice: &'static str) -> Self {
        Self {
            code,
            message,
            advice,
            spoils: None,
        }
    }

    /// Creates a warning about an input that the estimate depends on. `spoils` is for the verdict.
    pub(in super::super) fn major(
        code: &'static str,
        spoils: &'static str,
        message: String,
        advice: &'static str,
    ) -> Self {
        Self {
            spoils: Some(spoils),
            ..Self::minor(code, message, advice)
        }
    }
}
