//! The options of reading, the same in every function that reads a log.

use host_sim::error::{Error, Result};
use host_sim::files::stop::Stop;
use host_sim::source::own_signals::{ChannelMapping, OwnSignals};
use host_sim::source::read_options::{ReadOptions, signal_named};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// How a log is read, as the keywords of Python have it.
#[derive(Debug, Default)]
pub struct Reading {
    pub strict: bool,
    pub interfaces: Option<Vec<String>>,
    pub ignore: Option<Vec<String>>,
    pub dbc: Option<PathBuf>,
    pub signals: Option<PathBuf>,
}

impl Reading {
    /// Returns the options of the host.
    ///
    /// # Errors
    /// Returns a usage error for a signal that does not exist and for a description without a mapping,
    /// and the error of its files.
    pub fn options(self, stop: &Stop) -> Result<ReadOptions> {
        let ignored = self.ignore.iter().flatten().map(|name| {
            signal_named(name).map_err(|problem| Error::Usage(format!("ignore: {name}: {problem}")))
        });
        Ok(ReadOptions {
            strict: self.strict,
            ignore: ignored.collect::<Result<_>>()?,
            channels: channels(self.dbc.as_deref(), self.signals.as_deref())?,
            signals: mapping(self.dbc, self.signals)?,
            interfaces: self.interfaces.unwrap_or_default(),
            stop: stop.clone(),
            ..ReadOptions::default()
        })
    }
}

fn mapping(dbc: Option<PathBuf>, signals: Option<PathBuf>) -> Result<Option<Arc<OwnSignals>>> {
    match (dbc, signals) {
        (Some(dbc), Some(signals)) => OwnSignals::read(&dbc, &signals).map(Arc::new).map(Some),
        (None, _) => Ok(None),
        (Some(_), None) => Err(Error::Usage(
            "dbc without signals; expected both".to_owned(),
        )),
    }
}

/// Reads a mapping without a description of a bus: that of the channels of a log.
fn channels(dbc: Option<&Path>, signals: Option<&Path>) -> Result<Option<Arc<ChannelMapping>>> {
    match (dbc, signals) {
        (None, Some(signals)) => ChannelMapping::read(signals).map(Arc::new).map(Some),
        _ => Ok(None),
    }
}
