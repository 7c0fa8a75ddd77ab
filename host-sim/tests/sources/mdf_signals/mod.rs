//! Decoded signals in MDF 4.

mod damage;
mod inspected;
mod mapping;
mod merging;
mod values;

use estimator_core::{Reading, Signal, Value};
use host_sim::source::input::{LogInput, for_each_input};
use host_sim::source::log_report::LogReport;
use host_sim::source::own_signals::ChannelMapping;
use host_sim::source::read_options::ReadOptions;
use std::sync::Arc;
use test_kit::mdf::MdfBlocks;
use test_kit::mdf_signals::{MdfChannel, MdfGroup, MdfLayout, mdf_signals};

/// A reading: its time in microseconds, its signal, its value.
type Found = (u64, Signal, Value);

/// Reads a file with a mapping; empty for none. Errors are without the folder.
fn read(file: &[u8], toml: &str) -> Result<(Vec<Found>, LogReport), String> {
    read_as(file, toml, &ReadOptions::default())
}

fn read_as(
    file: &[u8],
    toml: &str,
    options: &ReadOptions,
) -> Result<(Vec<Found>, LogReport), String> {
    let folder = test_kit::command::folder();
    let prefix = format!("{}/", folder.path().display());
    let words = |e: host_sim::error::Error| e.to_string().replace(&prefix, "");
    let (log, mapping) = (folder.path().join("a.mf4"), folder.path().join("S.toml"));
    std::fs::write(&log, file).unwrap();
    std::fs::write(&mapping, toml).unwrap();
    let channels = (!toml.is_empty()).then(|| ChannelMapping::read(&mapping).map(Arc::new));
    let options = ReadOptions {
        channels: channels.transpose().map_err(words)?,
        ..options.clone()
    };
    let mut found = Vec::new();
    let take = |input| match input {
        LogInput::Reading(time, Reading { signal, value }) => {
            found.push((time.micros(), signal, value));
        }
        LogInput::Frame(_) => panic!("a file of signals has no frames"),
    };
    let report = for_each_input(&log, &options, |_| {}, take).map_err(words)?;
    Ok((found, report))
}

fn readings(file: &[u8], toml: &str) -> Vec<Found> {
    read(file, toml).unwrap().0
}

fn error(file: &[u8], toml: &str) -> String {
    read(file, toml).expect_err("it is refused")
}

/// Returns a group whose records have a time and these bytes.
fn group(channels: Vec<MdfChannel>, records: impl IntoIterator<Item = (f64, Vec<u8>)>) -> MdfGroup {
    let records = records
        .into_iter()
        .map(|(time, bytes)| (time, [&time.to_le_bytes()[..], &bytes].concat()));
    MdfGroup {
        name: "",
        source: "",
        channels: [vec![MdfChannel::time()], channels].concat(),
        invalidation_bytes: 0,
        records: records.collect(),
    }
}

/// Returns a group with one channel of numbers in floating point.
fn reals(name: &str, unit: &'static str, values: &[(f64, f64)]) -> MdfGroup {
    let records = values.iter().map(|(t, v)| (*t, v.to_le_bytes().to_vec()));
    group(vec![MdfChannel::real(name, unit, 8)], records)
}

fn plain(groups: &[MdfGroup]) -> Vec<u8> {
    mdf_signals(groups, MdfBlocks::Plain, MdfLayout::Sorted)
}

const fn at(seconds: f64) -> u64 {
    (seconds * 1e6) as u64
}
