//! The options of reading, the same in every command that reads a log.

use crate::source::read_options::ReadOptions;
use estimator_core::Signal;

/// Options of every log, also where its frames are only passed on.
#[derive(Debug, clap::Args)]
pub struct FrameOptions {
    /// Refuse a log with any damage. By default, damage of up to 1 % is left out and reported.
    #[arg(long)]
    strict: bool,
    /// Read only the frames of this interface; may be repeated. `roadgrade inspect` lists them.
    #[arg(long = "interface", value_name = "NAME")]
    interfaces: Vec<String>,
}

/// Options of logs whose signals are read.
#[derive(Debug, clap::Args)]
pub struct LogOptions {
    #[command(flatten)]
    frames: FrameOptions,
    /// Leave out a signal, as if the bus did not have it; may be repeated.
    #[arg(long, value_name = "SIGNAL", value_parser = signal)]
    ignore: Vec<Signal>,
}

impl FrameOptions {
    /// Returns how to read a log.
    pub fn read_options(&self) -> ReadOptions {
        ReadOptions {
            strict: self.strict,
            interfaces: self.interfaces.clone(),
            ..ReadOptions::default()
        }
    }
}

impl LogOptions {
    /// Returns how to read a log.
    pub fn read_options(&self) -> ReadOptions {
        ReadOptions {
            ignore: self.ignore.clone(),
            ..self.frames.read_options()
        }
    }
}

fn signal(name: &str) -> Result<Signal, String> {
    // Words that begin alike: `fan` means `fan_percent`.
    let likeness = |signal: &Signal| strsim::jaro_winkler(name, signal.column());
    Signal::from_column(name).ok_or_else(|| {
        let mut known = Signal::ALL.to_vec();
        known.sort_by(|a, b| likeness(b).total_cmp(&likeness(a)));
        let nearest = known.first().map_or("", |signal| signal.column());
        format!("no such signal; did you mean `{nearest}`?")
    })
}
