//! The reader of a log, by its format.

use super::asc::Asc;
use super::blf::BlfReader;
use super::busmaster::Busmaster;
use super::candump::Candump;
use super::csv_columns::Dialect;
use super::csv_logs::CsvLog;
use super::frame_reader::FrameReader;
use super::mdf::MdfReader;
use super::n2k_text::{N2kText, Writer};
use super::pcap::PcapReader;
use super::text::{LineFormat, TextReader};
use super::trc::Trc;
use crate::error::Result;
use crate::files::log_format::LogFormat;
use crate::source::log_file::LogFile;
use crate::source::mdf::mdf_file::MdfFile;

fn text<F: LineFormat + 'static>(file: LogFile, format: F, strict: bool) -> Box<dyn FrameReader> {
    Box::new(TextReader::new(file, format, strict))
}

/// Returns the reader of a log.
///
/// # Errors
/// Returns an error if a binary log cannot be opened.
pub(super) fn opened(
    mut file: LogFile,
    format: LogFormat,
    strict: bool,
) -> Result<Box<dyn FrameReader>> {
    let csv = |file, dialect| text(file, CsvLog::of(dialect), strict);
    let n2k = |file, writer| text(file, N2kText::of(writer), strict);
    Ok(match format {
        LogFormat::Candump => {
            let format = Candump::of_head(file.look_at_head());
            text(file, format, strict)
        }
        LogFormat::Asc => text(file, Asc::default(), strict),
        LogFormat::Trc => text(file, Trc::default(), strict),
        LogFormat::Blf => BlfReader::boxed(file, strict),
        LogFormat::Mdf => MdfReader::boxed(MdfFile::open(file)?, strict)?,
        LogFormat::Pcap => PcapReader::boxed(file, strict)?,
        LogFormat::Busmaster => text(file, Busmaster::default(), strict),
        LogFormat::SavvyCan => csv(file, Dialect::SavvyCan),
        LogFormat::PythonCan => csv(file, Dialect::PythonCan),
        LogFormat::CanEdge => csv(file, Dialect::CanEdge),
        LogFormat::Clx => csv(file, Dialect::Clx),
        LogFormat::Canboat => n2k(file, Writer::Canboat),
        LogFormat::YachtDevices => n2k(file, Writer::YachtDevices),
        LogFormat::Actisense => n2k(file, Writer::Actisense),
    })
}
