//! Logs of frames: frames in the order of time, or an error that names the file.

use crate::as_file;
use estimator_core::Instant;
use host_sim::error::Result;
use host_sim::source::frame_log::FrameLog;
use host_sim::source::log::Log;
use host_sim::source::mdf_signals::MdfSignals;
use host_sim::source::parquet_table::ParquetTable;
use host_sim::source::read_options::ReadOptions;
use std::path::Path;

const PCAP_BIG_ENDIAN: &[u8] = b"\xa1\xb2\xc3\xd4";
const PCAPNG: &[u8] = b"\x0a\x0d\x0d\x0a";

/// Checks candump logs, plain or gzip.
pub fn candump(bytes: &[u8]) {
    check_frames(bytes, FrameLog::open_candump);
}

/// Checks Vector ASC logs.
pub fn asc(bytes: &[u8]) {
    check(b"base hex", bytes);
}

/// Checks PEAK TRC logs.
pub fn trc(bytes: &[u8]) {
    check(b";$FILEVERSION=", bytes);
}

/// Checks Vector BLF logs.
pub fn blf(bytes: &[u8]) {
    check(b"LOGG", bytes);
}

/// Checks ASAM MDF 4 logs, of frames and of signals.
pub fn mdf(bytes: &[u8]) {
    as_file(".mf4", &with_letters(b"MDF     4", bytes), |path| {
        let read = match Log::open(path, &ReadOptions::default()) {
            Ok(Log::Frames(log)) => drain(*log),
            Ok(Log::Signals(log)) => drain_rows(*log),
            Ok(Log::Table(_) | Log::Parquet(_)) => panic!("a log in MDF is no table"),
            Err(error) => Err(error),
        };
        if let Err(error) = read {
            assert!(error.to_string().contains(&path.display().to_string()));
        }
    });
}

/// Checks CSV logs of SavvyCAN.
pub fn savvy_can(bytes: &[u8]) {
    check(b"Time Stamp,ID,Extended,", bytes);
}

/// Checks CSV logs of python-can.
pub fn python_can(bytes: &[u8]) {
    check(b"timestamp,arbitration_id,", bytes);
}

/// Checks CSV logs of a CANedge.
pub fn canedge(bytes: &[u8]) {
    check(b"TimestampEpoch;", bytes);
}

/// Checks logs of a CL1000, CL2000 or CL3000.
pub fn clx(bytes: &[u8]) {
    check(b"# Logger type: CL2000\n", bytes);
}

/// Checks logs of BUSMASTER.
pub fn busmaster(bytes: &[u8]) {
    check(b"***", bytes);
}

/// Checks NMEA 2000 as text: the first line says whose it is.
pub fn n2k_text(bytes: &[u8]) {
    let line: &[u8] = match bytes.first() {
        Some(b'A') => b"A100001.500 07FF2 1F802 FF\n",
        Some(b'2') => b"2026-11-22T10:00:01.500Z,2,129026,7,255,1,ff\n",
        _ => b"10:00:01.500 R 09F80207 FF\n",
    };
    check_frames(&[line, bytes].concat(), open);
}

/// Checks packet captures.
pub fn pcap(bytes: &[u8]) {
    check(b"\xd4\xc3\xb2\xa1", bytes);
}

/// Checks logs of lines in gzip or Zstandard. Bytes that are neither get the letters of gzip in front.
pub fn packed(bytes: &[u8]) {
    const GZIP: &[u8] = b"\x1f\x8b";
    const ZSTD: &[u8] = b"\x28\xb5\x2f\xfd";
    let is_packed = bytes.starts_with(GZIP) || bytes.starts_with(ZSTD);
    let head = if is_packed { &[] } else { GZIP };
    check_frames(&[head, bytes].concat(), FrameLog::open_candump);
}

/// Checks signal tables in Parquet: rows in the order of time, or an error that names the file.
pub fn parquet_table(bytes: &[u8]) {
    as_file(".parquet", bytes, |path| {
        let read = ParquetTable::open(path, &ReadOptions::default()).and_then(|mut table| {
            let mut newest = Instant::ZERO;
            while let Some(row) = table.next_row()? {
                assert!(newest <= row.time);
                newest = row.time;
            }
            Ok(())
        });
        if let Err(error) = read {
            assert!(error.to_string().contains(&path.display().to_string()));
        }
    });
}

/// Checks the frames of a log that begins with these letters. Bytes that do not begin so get them in
/// front, so that all are of the format.
fn check(letters: &[u8], bytes: &[u8]) {
    check_frames(&with_letters(letters, bytes), open);
}

fn open(path: &Path) -> Result<FrameLog> {
    match Log::open(path, &ReadOptions::default())? {
        Log::Frames(log) => Ok(*log),
        Log::Table(_) | Log::Parquet(_) | Log::Signals(_) => panic!("a log of frames has no rows"),
    }
}

fn with_letters(letters: &[u8], bytes: &[u8]) -> Vec<u8> {
    // The other letters that two formats may begin with.
    let others = [&b"UnFinMF 4"[..], PCAP_BIG_ENDIAN, PCAPNG];
    let is_other = others.iter().any(|others| bytes.starts_with(others));
    let head = if bytes.starts_with(letters) || is_other {
        &[]
    } else {
        letters
    };
    [head, bytes].concat()
}

/// Reads a log to its end: its frames are in the order of time, or the error names the file.
fn check_frames(bytes: &[u8], open: impl FnOnce(&Path) -> Result<FrameLog>) {
    as_file(".log", bytes, |path| {
        if let Err(error) = open(path).and_then(drain) {
            assert!(error.to_string().contains(&path.display().to_string()));
        }
    });
}

/// Counts the channels of a file of signals, and reads its rows to the end.
fn drain_rows(mut log: MdfSignals) -> Result<()> {
    log.census()?;
    let mut newest = Instant::ZERO;
    while let Some(row) = log.next_row()? {
        assert!(newest <= row.time);
        assert!(row.readings.is_sorted_by_key(|reading| reading.signal));
        newest = row.time;
    }
    Ok(())
}

fn drain(mut log: FrameLog) -> Result<()> {
    let mut newest = None;
    while let Some(timed) = log.next_frame()? {
        assert!(newest.is_none_or(|newest| newest <= timed.time));
        newest = Some(timed.time);
    }
    assert!(newest.is_some(), "a log without a frame is an error");
    Ok(())
}
