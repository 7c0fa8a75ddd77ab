//! ASAM MDF 4 with decoded signals, as INCA, CANape and asammdf write them: each channel group with its
//! own time becomes rows of readings.
//!
//! | file | content |
//! |---|---|
//! | `catalog` | the groups of a file, with their times |
//! | `scan`, `group_scan` | the reading of its blocks |
//! | `channel` | a channel: where its numbers are, and what they mean |
//! | `channel_scan` | the channels of a group |
//! | `text` | names and units |
//! | `selection` | which channels become signals of ours |
//! | `source` | the records of one group |
//! | `stream` | the records of all groups that share their times |
//! | `reader` | rows of all streams in the order of time |
//! | `census` | what the channels have, for `inspect` |
//!
//! * Each group is read on its own, also of a data group that has several: so every stream is in the
//!   order of time, and to merge them takes no memory.
//! * A damaged block costs itself. A circle of links ends.

mod catalog;
mod census;
mod channel;
mod channel_scan;
mod group_scan;
mod reader;
mod scan;
mod selection;
mod source;
mod stream;
mod text;

pub use census::ChannelCount;
pub use reader::MdfSignals;

use super::damage::DamageCheck;
use super::frame_log::FrameLog;
use super::log_file::LogFile;
use super::mdf::mdf_file::MdfFile;
use super::read_options::ReadOptions;
use crate::error::{Error, Result};

/// What an MDF file is read for.
pub(super) enum Opened {
    Frames(FrameLog),
    Signals(MdfSignals),
}

/// Opens an MDF file. Where it has frames of a bus, these are read, unless channels are mapped.
///
/// # Errors
/// Returns an error for a file with neither, and for a mapping that does not fit its channels.
pub(super) fn open(log: LogFile, options: &ReadOptions) -> Result<Opened> {
    let mut file = MdfFile::open(log)?;
    let mut damage = DamageCheck::new(options.strict);
    let catalog = group_scan::read(&mut file, &mut damage);
    file.begin_again();
    let catalog = match catalog {
        Ok(catalog) => catalog,
        // Its frames may be sound; where there are none, the first problem says more.
        Err(problem) => return frames(file, None, options).map_err(|_| problem),
    };
    let signals = catalog.signal_count();
    if signals == 0 || (catalog.has_frames && options.channels.is_none()) {
        let beside = (signals > 0).then(|| {
            let channels = match signals {
                1 => "1 channel of signals is".to_owned(),
                count => format!("{count} channels of signals are"),
            };
            format!("{channels} not read beside the frames; --signals without --dbc reads them")
        });
        return frames(file, beside, options);
    }
    if !catalog.has_frames && options.signals.is_some() {
        let problem = "has signals and no frames of a bus, for which --dbc has no use; give \
                       --signals alone, with names of its channels";
        return Err(Error::content(file.log().path(), problem));
    }
    let reader = MdfSignals::new(file, catalog, damage, options)?;
    Ok(Opened::Signals(reader))
}

fn frames(file: MdfFile, beside: Option<String>, options: &ReadOptions) -> Result<Opened> {
    let frames = FrameLog::of_mdf(file, beside, options)?;
    Ok(Opened::Frames(frames))
}
