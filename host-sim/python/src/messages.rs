//! Messages of the work, as records of the logger `roadgrade`.

use host_sim::terminal::print::{Kind, pass_messages_to};
use pyo3::prelude::*;

/// Passes messages to Python's logging from now on.
pub fn begin() {
    pass_messages_to(log);
}

fn log(kind: Kind, text: &str) {
    let method = match kind {
        Kind::Note => "info",
        Kind::Alert => "warning",
    };
    // While the interpreter ends, no logger is there.
    Python::try_attach(|py| {
        let logging = py.import("logging")?;
        let logger = logging.call_method1("getLogger", ("roadgrade",))?;
        logger.call_method1(method, ("%s", text)).map(drop)
    });
}
