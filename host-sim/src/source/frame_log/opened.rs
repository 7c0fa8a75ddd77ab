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
use crate::source::log_kind::LogKind;
use crate::source::mdf::mdf_file::MdfFile;

fn text<F: LineFormat + 'static>(file: LogFile, format: F, strict: bool) -> Box<dyn FrameReader> {
    Box::new(TextReader::new(file, format, strict))
}

/// Returns the reader of a log; without a format it may be one of candump.
///
/// # Errors
/// Returns an error if a binary log cannot be opened.
pub(super) fn opened(
    mut file: LogFile,
    format: Option<LogFormat>,
    strict: bool,
) -> Result<(LogKind, Box<dyn FrameReader>)> {
    let csv = |file, dialect, kind| (kind, text(file, CsvLog::of(dialect), strict));
    let n2k = |file, writer, kind| (kind, text(file, N2kText::of(writer), strict));
    Ok(match format {
        Some(LogFormat::Asc) => (LogKind::Asc, text(file, Asc::default(), strict)),
        Some(LogFormat::Trc) => (LogKind::Trc, text(file, Trc::default(), strict)),
        Some(LogFormat::Blf) => (LogKind::Blf, BlfReader::boxed(file, strict)),
        Some(LogFormat::Mdf) => (
            LogKind::Mdf,
            MdfReader::boxed(MdfFile::open(file)?, strict)?,
        ),
        Some(LogFormat::Pcap) => (LogKind::Pcap, PcapReader::boxed(file, strict)?),
        Some(LogFormat::Busmaster) => {
            let reader = text(file, Busmaster::default(), strict);
            (LogKind::Busmaster, reader)
        }
        Some(LogFormat::SavvyCan) => csv(file, Dialect::SavvyCan, LogKind::SavvyCan),
        Some(LogFormat::PythonCan) => csv(file, Dialect::PythonCan, LogKind::PythonCan),
        Some(LogFormat::CanEdge) => csv(file, Dialect::CanEdge, LogKind::CanEdge),
        Some(LogFormat::Clx) => csv(file, Dialect::Clx, LogKind::Clx),
        Some(LogFormat::Canboat) => n2k(file, Writer::Canboat, LogKind::Canboat),
        Some(LogFormat::YachtDevices) => n2k(file, Writer::YachtDevices, LogKind::YachtDevices),
        Some(LogFormat::Actisense) => n2k(file, Writer::Actisense, LogKind::Actisense),
        Some(LogFormat::Candump) | None => {
            let format = Candump::of_head(file.look_at_head());
            (LogKind::Candump, text(file, format, strict))
        }
    })
}
