//! What each of the dropped files is: a log, a vehicle file, or a description of own signals.

use host_sim::error::{Error, Result};
use host_sim::files::vehicle::VehicleFile;
use host_sim::source::own_signals::{ChannelMapping, OwnSignals};
use host_sim::source::read_options::ReadOptions;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// The dropped files.
pub struct Dropped {
    /// The logs, each a drive.
    pub logs: Vec<PathBuf>,
    /// The vehicle; `None` if it is to be identified.
    pub vehicle: Option<VehicleFile>,
    /// How the logs are read.
    pub options: ReadOptions,
}

/// Files of each kind.
#[derive(Default)]
struct Sorted<'a> {
    logs: Vec<PathBuf>,
    vehicle: Option<&'a Path>,
    dbc: Option<&'a Path>,
    mapping: Option<&'a Path>,
}

impl Dropped {
    /// Sorts files by their endings; of a `.toml` file its tables decide.
    ///
    /// # Errors
    /// Returns an error if there is no log, if there are two files where one is expected, or if a
    /// vehicle file or a description cannot be read.
    pub fn sort(files: &[PathBuf]) -> Result<Self> {
        let mut sorted = Sorted::default();
        for file in files {
            sorted.take(file)?;
        }
        if sorted.logs.is_empty() {
            let first = files.first().map_or(Path::new("page"), PathBuf::as_path);
            return Err(Error::content(
                first,
                "no log among the files; expected one",
            ));
        }
        let vehicle = sorted.vehicle.map(VehicleFile::read).transpose()?;
        let options = ReadOptions {
            signals: sorted.own_signals()?,
            channels: sorted.channels()?,
            ..ReadOptions::default()
        };
        Ok(Self {
            logs: sorted.logs,
            vehicle,
            options,
        })
    }
}

impl<'a> Sorted<'a> {
    fn take(&mut self, file: &'a Path) -> Result<()> {
        let ending = file.extension().unwrap_or_default().to_ascii_lowercase();
        let (place, what) = match ending.to_str() {
            Some("dbc") => (&mut self.dbc, "description of a bus"),
            Some("toml") if is_mapping(file)? => (&mut self.mapping, "mapping of signals"),
            Some("toml") => (&mut self.vehicle, "vehicle file"),
            _ => {
                self.logs.push(file.to_owned());
                return Ok(());
            }
        };
        match place.replace(file) {
            Some(_) => Err(Error::content(
                file,
                format!("a second {what}; expected one"),
            )),
            None => Ok(()),
        }
    }

    fn own_signals(&self) -> Result<Option<Arc<OwnSignals>>> {
        match (self.dbc, self.mapping) {
            (Some(dbc), Some(mapping)) => Ok(Some(Arc::new(OwnSignals::read(dbc, mapping)?))),
            (Some(alone), None) => {
                let problem = "alone; expected a .dbc file and a .toml file that maps its signals";
                Err(Error::content(alone, problem))
            }
            (None, _) => Ok(None),
        }
    }

    /// Reads a mapping without a description of a bus: that of the channels of a log.
    fn channels(&self) -> Result<Option<Arc<ChannelMapping>>> {
        match (self.dbc, self.mapping) {
            (None, Some(mapping)) => Ok(Some(Arc::new(ChannelMapping::read(mapping)?))),
            _ => Ok(None),
        }
    }
}

/// Returns true for a mapping of signals. What cannot be read as one is read as a vehicle file,
/// which then gives the error.
fn is_mapping(file: &Path) -> Result<bool> {
    let text = std::fs::read_to_string(file).map_err(Error::io(file))?;
    let table: std::result::Result<toml::Table, _> = text.parse();
    Ok(table.is_ok_and(|table| table.contains_key("signals")))
}
