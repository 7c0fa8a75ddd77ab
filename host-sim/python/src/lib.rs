//! The bench of the road-grade estimator as a Python package.
//!
//! A thin layer: arguments of Python become those of `host-sim`, results become Arrow tables, text
//! and plain values. `roadgrade/__init__.pyi` has the types and `docs/python.md` the examples.

mod convert;
mod errors;
mod estimate;
mod frame_table;
mod fusion;
mod identify;
mod messages;
mod read;
mod reading;
mod signal_table;
mod table;
mod work;

use pyo3::prelude::*;

/// The compiled part of the package `roadgrade`.
#[pymodule(gil_used = false)]
mod _native {
    use super::{errors, messages};
    use host_sim::files::signals;
    use pyo3::prelude::*;

    #[pymodule_export]
    use super::errors::Error;
    #[pymodule_export]
    use super::estimate::{Run, estimate};
    #[pymodule_export]
    use super::fusion::{Map, fuse, read_map};
    #[pymodule_export]
    use super::identify::{Vehicle, identify};
    #[pymodule_export]
    use super::read::{read_frames, read_log};
    #[pymodule_export]
    use super::table::Table;

    #[pymodule_init]
    fn begin(module: &Bound<'_, PyModule>) -> PyResult<()> {
        // Ctrl-C belongs to Python, and messages to its logging.
        signals::leave_signals();
        messages::begin();
        errors::begin(module)?;
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }
}
