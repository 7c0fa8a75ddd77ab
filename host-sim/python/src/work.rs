//! Long work: other threads of Python go on meanwhile, and Ctrl-C stops it.

use crate::errors::exception;
use host_sim::error::Result;
use host_sim::files::stop::Stop;
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::thread;
use std::time::Duration;

/// Time between two looks at the signals of Python.
const SIGNALS_EVERY: Duration = Duration::from_millis(50);
/// Longest wait for work that was asked to stop. It leaves nothing behind: files appear at its end.
const STOPS_WITHIN: Duration = Duration::from_secs(2);
/// Stack of the worker, bytes: an estimator is moved around by value.
const STACK_BYTES: usize = 16 << 20;

/// Does the work in a thread of its own, without the interpreter lock. Returns its result, or the
/// exception of a signal handler, as `KeyboardInterrupt`, after the work was asked to stop.
pub fn in_background<T: Send + 'static>(
    py: Python<'_>,
    work: impl FnOnce(&Stop) -> Result<T> + Send + 'static,
) -> PyResult<T> {
    let stop = Stop::default();
    let (sender, mut receiver) = channel();
    let own_stop = stop.clone();
    let worker = move || {
        // The receiver is gone where the work was stopped.
        let _ = sender.send(work(&own_stop));
    };
    thread::Builder::new()
        .name("roadgrade".to_owned())
        .stack_size(STACK_BYTES)
        .spawn(worker)?;
    loop {
        let (back, result) = wait(py, receiver, SIGNALS_EVERY);
        receiver = back;
        match result {
            Ok(result) => return result.map_err(|error| exception(py, &error)),
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => {
                return Err(PyRuntimeError::new_err("the work ended with a panic"));
            }
        }
        if let Err(signal) = py.check_signals() {
            stop.request();
            drop(wait(py, receiver, STOPS_WITHIN));
            return Err(signal);
        }
    }
}

/// Waits without the interpreter lock.
fn wait<T: Send>(
    py: Python<'_>,
    receiver: Receiver<T>,
    at_most: Duration,
) -> (Receiver<T>, std::result::Result<T, RecvTimeoutError>) {
    py.detach(move || {
        let result = receiver.recv_timeout(at_most);
        (receiver, result)
    })
}
