//! What went wrong with an object, and what to do about it.

use super::address::ObjectUrl;
use crate::error::Error;
use std::error::Error as _;

/// Variables of which one is set where credentials are given.
const CREDENTIALS: [&str; 5] = [
    "AWS_ACCESS_KEY_ID",
    "AWS_WEB_IDENTITY_TOKEN_FILE",
    "AWS_CONTAINER_CREDENTIALS_RELATIVE_URI",
    "AWS_CONTAINER_CREDENTIALS_FULL_URI",
    "AWS_SKIP_SIGNATURE",
];

/// Returns the error of an object that is not what was read before.
pub(super) fn changed(url: &ObjectUrl) -> Error {
    url.error("was changed by another program meanwhile; run again")
}

/// Returns whether the server, or the environment, has no conditions for what is sent.
pub(super) fn is_unconditional(error: &object_store::Error) -> bool {
    matches!(error, object_store::Error::NotImplemented { .. })
        || reply_code(&error.to_string()) == Some("NotImplemented")
}

/// Returns the error of an object in the words of this program.
pub(super) fn problem_of(url: &ObjectUrl, error: &object_store::Error) -> Error {
    use object_store::Error as Found;
    let text = error.to_string();
    let problem = match error {
        _ if text.contains("NoSuchBucket") => format!(
            "there is no bucket {}; expected one that exists in this region (AWS_REGION) and at \
             this server (AWS_ENDPOINT_URL)",
            url.bucket
        ),
        Found::NotFound { .. } => {
            "there is no such object, or no such bucket; expected ones that exist".to_owned()
        }
        Found::Precondition { .. } | Found::AlreadyExists { .. } => return changed(url),
        _ if is_refused(error, &text) => {
            let asked = reply_code(&text).map_or_else(String::new, |code| format!(" ({code})"));
            format!(
                "the server refuses access{asked}; check AWS_ACCESS_KEY_ID, \
                 AWS_SECRET_ACCESS_KEY, AWS_SESSION_TOKEN and the rights on the bucket"
            )
        }
        // Without any, the service for virtual machines of AWS is asked for some.
        _ if !has_credentials() || text.contains("Missing SecretAccessKey") => {
            "there are no credentials; set AWS_ACCESS_KEY_ID and \
             AWS_SECRET_ACCESS_KEY, or AWS_SKIP_SIGNATURE=true for a public bucket"
                .to_owned()
        }
        _ if innermost(error).contains("URL scheme is not allowed") => {
            "AWS_ENDPOINT_URL is http:// without encryption; expected https://, or \
             AWS_ALLOW_HTTP=true"
                .to_owned()
        }
        _ => format!(
            "{}; check the network, AWS_ENDPOINT_URL and AWS_REGION, and run again",
            words_of(error)
        ),
    };
    url.error(problem)
}

/// Returns whether access was refused. The crate has a kind for it, but not for a folder.
fn is_refused(error: &object_store::Error, text: &str) -> bool {
    use object_store::Error as Found;
    let is_kind = matches!(
        error,
        Found::PermissionDenied { .. } | Found::Unauthenticated { .. }
    );
    let statuses = ["status code: 401", "status code: 403"];
    is_kind || statuses.iter().any(|status| text.contains(status))
}

fn has_credentials() -> bool {
    CREDENTIALS
        .iter()
        .any(|name| std::env::var_os(name).is_some())
}

/// Returns the code in a reply of the server: `<Code>AccessDenied</Code>`.
fn reply_code(text: &str) -> Option<&str> {
    let (_, rest) = text.split_once("<Code>")?;
    Some(rest.split_once("</Code>")?.0)
}

/// Returns what the server or the network said, without the request.
fn words_of(error: &object_store::Error) -> String {
    let text = error.to_string();
    if let Some(code) = reply_code(&text) {
        return format!("the server replies {code}");
    }
    let cause = innermost(error);
    if cause.is_empty() || text.contains(&cause) {
        text
    } else {
        format!("the server cannot be reached, or the connection was cut: {cause}")
    }
}

/// Returns the words of the cause of all causes.
fn innermost(error: &object_store::Error) -> String {
    let mut cause = error.source();
    let mut words = String::new();
    while let Some(found) = cause {
        words = found.to_string();
        cause = found.source();
    }
    words
}
