//! Names of sessions.

use crate::files::row_check::Flaw;

/// Checks the name of a session for files and messages.
///
/// # Errors
/// Returns an error that names the problem and the expected value.
pub fn check_session_name(name: &str) -> Result<(), Flaw> {
    if name.trim().is_empty() || name.chars().any(char::is_control) {
        return Err(Flaw {
            problem: format!("session name {name:?}"),
            expected: "letters or digits, no line breaks",
        });
    }
    Ok(())
}
