//! The targets. A check panics if what must hold does not.

pub mod decode;
pub mod estimator;
pub mod logs;
pub mod osm_pbf;
pub mod own_signals;
pub mod persistent_state;
pub mod signal_table;
pub mod transport;
pub mod vehicle_toml;

use arbitrary::{Arbitrary, Unstructured};

/// A target: its name, which is that of its seeds in `corpus`, and its check of an input.
pub type Target = (&'static str, fn(&[u8]));

/// All targets.
pub const ALL: [Target; 22] = [
    ("asc", logs::asc),
    ("blf", logs::blf),
    ("busmaster", logs::busmaster),
    ("candump", logs::candump),
    ("canedge", logs::canedge),
    ("clx", logs::clx),
    ("decode", decode::decode),
    ("estimator", estimator::estimator),
    ("mdf", logs::mdf),
    ("n2k_text", logs::n2k_text),
    ("osm_pbf", osm_pbf::osm_pbf),
    ("own_signals", own_signals::own_signals),
    ("packed", logs::packed),
    ("parquet_table", logs::parquet_table),
    ("pcap", logs::pcap),
    ("persistent_state", persistent_state::persistent_state),
    ("python_can", logs::python_can),
    ("savvy_can", logs::savvy_can),
    ("signal_table", signal_table::signal_table),
    ("transport", transport::transport),
    ("trc", logs::trc),
    ("vehicle_toml", vehicle_toml::vehicle_toml),
];

/// Makes a value of bytes, as libFuzzer does.
fn from_bytes<'a, T: Arbitrary<'a>>(bytes: &'a [u8]) -> Option<T> {
    T::arbitrary_take_rest(Unstructured::new(bytes)).ok()
}
