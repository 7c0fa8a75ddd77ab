//! The options of reading, the same in every command that reads a log.

use super::log_notes::note_left_out;
use crate::error::{Error, Result};
use crate::source::own_signals::{ChannelMapping, OwnSignals};
use crate::source::read_options::{ReadOptions, signal_named};
use crate::source::signal_table::ColumnsFile;
use estimator_core::Signal;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Options of every log, also where its frames are only passed on.
#[derive(Debug, clap::Args)]
pub struct FrameOptions {
    /// Refuse a log with any damage. By default, damage of up to 1 % is left out and reported.
    #[arg(long, hide_short_help = true)]
    strict: bool,
    /// Read a log whose clock was set back as one drive: time goes on from there. By default, a step
    /// back of more than 10 s is an error.
    #[arg(long, hide_short_help = true)]
    rejoin: bool,
    /// Read only the frames of this interface; may be repeated. `roadgrade inspect` lists them.
    #[arg(long = "interface", value_name = "NAME", hide_short_help = true)]
    interfaces: Vec<String>,
}

/// Options of logs whose signals are read.
#[derive(Debug, clap::Args)]
pub struct LogOptions {
    #[command(flatten)]
    frames: FrameOptions,
    /// Leave out a signal, as if the bus did not have it; may be repeated.
    #[arg(long, value_name = "SIGNAL", value_parser = signal_named, hide_short_help = true)]
    ignore: Vec<Signal>,
    #[command(flatten)]
    own: OwnOptions,
    /// Mapping of the columns of tables to our signals; `roadgrade inspect TABLE --out COLUMNS.toml`
    /// proposes one.
    #[arg(long, value_name = "COLUMNS.toml", hide_short_help = true)]
    columns: Option<PathBuf>,
}

/// Options of own signals.
#[derive(Debug, clap::Args)]
pub struct OwnOptions {
    /// Description of the bus, for messages that are not built in.
    #[arg(long, value_name = "FILE.dbc")]
    dbc: Option<PathBuf>,
    /// Mapping of signals of FILE.dbc to ours, or, without --dbc, of the channels of an MDF file with
    /// decoded signals; docs/formats.md describes it.
    #[arg(long, value_name = "SIGNALS.toml")]
    signals: Option<PathBuf>,
}

impl OwnOptions {
    /// Returns the files that are read.
    pub fn files(&self) -> impl Iterator<Item = &Path> {
        [&self.dbc, &self.signals]
            .into_iter()
            .filter_map(|path| path.as_deref())
    }

    /// Returns the description of the bus.
    pub fn dbc(&self) -> Option<&Path> {
        self.dbc.as_deref()
    }

    /// Reads the mapping of channels: one without a description of the bus.
    fn channels(&self) -> Result<Option<Arc<ChannelMapping>>> {
        match (&self.dbc, &self.signals) {
            (None, Some(signals)) => ChannelMapping::read(signals).map(Arc::new).map(Some),
            _ => Ok(None),
        }
    }

    /// Reads the mapping for a bus, whose messages need a description.
    ///
    /// # Errors
    /// Returns the error of either file, and a usage error for one without the other.
    #[cfg(target_os = "linux")]
    pub fn bus_mapping(&self) -> Result<Option<Arc<OwnSignals>>> {
        if self.signals.is_some() && self.dbc.is_none() {
            let problem = "--signals without --dbc; expected --dbc FILE.dbc, which describes the messages \
                           of the bus";
            return Err(Error::Usage(problem.to_owned()));
        }
        self.needed_mapping()
    }

    /// Reads the mapping, if there is one.
    ///
    /// # Errors
    /// Returns the error of either file.
    pub fn mapping(&self) -> Result<Option<Arc<OwnSignals>>> {
        match (&self.dbc, &self.signals) {
            (Some(dbc), Some(signals)) => {
                let own = OwnSignals::read(dbc, signals)?;
                note_left_out(dbc, own.left_out());
                Ok(Some(Arc::new(own)))
            }
            _ => Ok(None),
        }
    }

    /// Reads the mapping for an estimate, which has no use for a description alone.
    ///
    /// # Errors
    /// Returns the error of either file, and a usage error for a description without a mapping.
    pub fn needed_mapping(&self) -> Result<Option<Arc<OwnSignals>>> {
        if self.dbc.is_some() && self.signals.is_none() {
            let problem = "--dbc without --signals; `roadgrade inspect --dbc FILE.dbc LOG` prints a \
                           SIGNALS.toml to start from";
            return Err(Error::Usage(problem.to_owned()));
        }
        self.mapping()
    }
}

impl FrameOptions {
    /// Returns how to read a log.
    pub fn read_options(&self) -> ReadOptions {
        ReadOptions {
            strict: self.strict,
            rejoin: self.rejoin,
            interfaces: self.interfaces.clone(),
            ..ReadOptions::default()
        }
    }
}

impl LogOptions {
    /// Returns how to read a log for an estimate.
    ///
    /// # Errors
    /// Returns an error for own signals that cannot be read.
    pub fn read_options(&self) -> Result<ReadOptions> {
        self.with(self.own.needed_mapping()?)
    }

    /// Returns how to read a log for an inspection, for which a description of the bus is enough.
    ///
    /// # Errors
    /// Returns an error for own signals that cannot be read.
    pub fn inspect_options(&self) -> Result<ReadOptions> {
        self.with(self.own.mapping()?)
    }

    /// Returns the files that are read besides the log.
    pub fn files(&self) -> impl Iterator<Item = &Path> {
        self.own.files().chain(self.columns.as_deref())
    }

    /// Returns the options of own signals.
    pub const fn own(&self) -> &OwnOptions {
        &self.own
    }

    fn with(&self, signals: Option<Arc<OwnSignals>>) -> Result<ReadOptions> {
        let columns = self.columns.as_deref().map(ColumnsFile::read);
        Ok(ReadOptions {
            ignore: self.ignore.clone(),
            signals,
            channels: self.own.channels()?,
            columns: columns.transpose()?.map(Arc::new),
            ..self.frames.read_options()
        })
    }
}
