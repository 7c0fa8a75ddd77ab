//! Names of sessions.

use crate::files::row_check::Flaw;

/// A name that a session can have in files and messages.
///
/// # Errors
/// What is wrong with it, and what would do.
pub fn check_session_name(name: &str) -> Result<(), Flaw> {
    if name.trim().is_empty() || name.chars().any(char::is_control) {
        return Err(Flaw {
            problem: format!("session name {name:?}"),
            expected: "some letters or digits, no line breaks",
        });
    }
    Ok(())
}
