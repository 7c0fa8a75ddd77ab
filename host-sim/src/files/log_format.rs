//! The format of a recording of a bus, by its first bytes.

use super::marks::{BYTE_ORDER_MARK, ZIP_MAGIC};
use std::fmt;
use std::path::Path;

/// A format that is known by its first bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LogFormat {
    /// Either layout of candump.
    Candump,
    /// Vector's text format.
    Asc,
    /// PEAK's text format.
    Trc,
    /// Vector's binary format.
    Blf,
    /// ASAM's measurement data format, version 4.
    Mdf,
    /// The CSV of SavvyCAN and GVRET.
    SavvyCan,
    /// The CSV of python-can.
    PythonCan,
    /// The CSV of the converter for a CANedge.
    CanEdge,
    /// The CSV of the loggers CL1000, CL2000 and CL3000.
    Clx,
    /// A packet capture, pcap or pcapng.
    Pcap,
    /// The text of BUSMASTER.
    Busmaster,
    /// NMEA 2000 in the text of canboat.
    Canboat,
    /// NMEA 2000 in the RAW of Yacht Devices.
    YachtDevices,
    /// NMEA 2000 in the N2K ASCII of Actisense.
    Actisense,
}

impl fmt::Display for LogFormat {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Candump => "candump log",
            Self::Asc => "Vector ASC log",
            Self::Trc => "PEAK TRC log",
            Self::Blf => "Vector BLF log",
            Self::Mdf => "ASAM MDF 4 log",
            Self::SavvyCan => "SavvyCAN log",
            Self::PythonCan => "python-can log",
            Self::CanEdge => "CANedge CSV log",
            Self::Clx => "log of a CL1000, CL2000 or CL3000",
            Self::Pcap => "packet capture",
            Self::Busmaster => "BUSMASTER log",
            Self::Canboat => "canboat log",
            Self::YachtDevices => "Yacht Devices RAW log",
            Self::Actisense => "Actisense N2K ASCII log",
        })
    }
}

/// First bytes of a BLF file.
pub(crate) const BLF_MAGIC: &[u8] = b"LOGG";
/// First bytes of an MDF file; the second ones of a file that its writer did not finish.
const MDF_MAGIC: [&[u8]; 2] = [b"MDF     4", b"UnFinMF 4"];

/// First bytes of a pcapng file; those of a pcap file in either byte order, with microseconds, with
/// nanoseconds, and in Kuznetzov's variant.
pub(crate) const PCAPNG_MAGIC: &[u8] = b"\x0a\x0d\x0d\x0a";
const PCAP_MAGIC: [&[u8]; 5] = [
    b"\xd4\xc3\xb2\xa1",
    b"\xa1\xb2\xc3\xd4",
    b"\x4d\x3c\xb2\xa1",
    b"\xa1\xb2\x3c\x4d",
    b"\x34\xcd\xb2\xa1",
];

/// Formats that are not read: first bytes, and the message.
const FOREIGN: [(&[u8], &str); 8] = [
    (ZIP_MAGIC, "is a zip archive; unpack it first"),
    (b"BZh", "is compressed with bzip2; unpack it first"),
    (b"\xfd7zXZ\0", "is compressed with xz; unpack it first"),
    (b"7z\xbc\xaf\x27\x1c", "is a 7z archive; unpack it first"),
    (b"MDF     3", MDF_3),
    (b"MDF     2", MDF_3),
    (b"SQLite format 3\0", SQLITE),
    (b"Generic File", CANEDGE),
];

/// Extensions of recordings of a CANedge that are compressed, encrypted, or both.
const PACKED_CANEDGE: [&str; 3] = ["mfc", "mfe", "mfm"];
const CANEDGE: &str = "is a compressed or encrypted recording of a CANedge (.MFC, .MFE, .MFM), which is \
                       not read; `mdf2finalized` of CSS Electronics makes .MF4 of it";
const MDF_3: &str =
    "is a recording in ASAM MDF 3, which is not read; `asammdf` exports signals as .csv";
const SQLITE: &str = "is an SQLite database, which is not read; convert a log of python-can with its \
                      `can_logconvert` to .blf, .asc or .log";

/// The formats of logs, for a file of none of them.
pub(crate) const KNOWN: &str = "candump, Vector ASC and BLF, PEAK TRC, ASAM MDF 4, packet captures of \
                                SocketCAN, BUSMASTER, the CSV of SavvyCAN, python-can, CANedge and CL1000 to \
                                CL3000, NMEA 2000 as text (canboat, Yacht Devices, Actisense), and signal \
                                tables with a column time_s";

/// Returns the format of a file that begins with these bytes; `None` if it is none of these. The format of
/// a text is that of most of its lines: a log may begin with comments or events.
#[must_use]
pub fn format_of(head: &[u8]) -> Option<LogFormat> {
    if head.starts_with(BLF_MAGIC) {
        return Some(LogFormat::Blf);
    }
    if MDF_MAGIC.iter().any(|magic| head.starts_with(magic)) {
        return Some(LogFormat::Mdf);
    }
    if head.starts_with(PCAPNG_MAGIC) || PCAP_MAGIC.iter().any(|magic| head.starts_with(magic)) {
        return Some(LogFormat::Pcap);
    }
    let text = head.strip_prefix(BYTE_ORDER_MARK).unwrap_or(head);
    let mut votes: Vec<(LogFormat, usize)> = Vec::new();
    for line in text.split(|byte| *byte == b'\n') {
        let Some(format) = format_of_line(line.trim_ascii()) else {
            continue;
        };
        let is_header = matches!(
            format,
            LogFormat::SavvyCan | LogFormat::PythonCan | LogFormat::CanEdge | LogFormat::Clx
        );
        if is_header && votes.is_empty() {
            return Some(format);
        }
        match votes.iter_mut().find(|(known, _)| *known == format) {
            Some((_, count)) => *count += 1,
            None => votes.push((format, 1)),
        }
    }
    // Of two with as many, the first one.
    let most = votes.iter().rev().max_by_key(|(_, count)| *count);
    most.map(|(format, _)| *format)
}

/// Returns the format whose line this is, if it is of one alone.
fn format_of_line(line: &[u8]) -> Option<LogFormat> {
    let begins = |word: &[u8]| {
        line.get(..word.len())
            .is_some_and(|start| start.eq_ignore_ascii_case(word))
    };
    match line {
        [b';', ..] => return Some(LogFormat::Trc),
        [b'(', b'0'..=b'9' | b'-', ..] => return Some(LogFormat::Candump),
        _ => {}
    }
    if is_header(line, &[b"time stamp", b"id", b"extended"]) {
        return Some(LogFormat::SavvyCan);
    }
    if is_header(line, &[b"timestamp", b"arbitration_id"]) {
        return Some(LogFormat::PythonCan);
    }
    if begins(b"timestampepoch") {
        return Some(LogFormat::CanEdge);
    }
    if begins(b"# logger type: cl") || is_clx_header(line) {
        return Some(LogFormat::Clx);
    }
    if let Some(format) = format_of_time(line) {
        return Some(format);
    }
    let headers = [
        &b"//"[..],
        b"base hex",
        b"base dec",
        b"begin trigger",
        b"end trigger",
        b"internal events",
        b"no internal events",
    ];
    if headers.into_iter().any(begins) || (begins(b"date ") && is_date(line)) || is_asc_line(line) {
        return Some(LogFormat::Asc);
    }
    let number_end = line.iter().position(|byte| !byte.is_ascii_digit())?;
    let is_trc = number_end > 0 && line.get(number_end..)?.starts_with(b") ");
    is_trc.then_some(LogFormat::Trc)
}

/// Returns true for a header that begins with these names, whatever separates them. A table of numbered
/// rows has an empty name before them.
fn is_header(line: &[u8], names: &[&[u8]]) -> bool {
    let mut found = line
        .split(|byte| matches!(byte, b',' | b';' | b'\t'))
        .map(|name| name.trim_ascii())
        .skip_while(|name| name.is_empty());
    names
        .iter()
        .all(|name| found.next().is_some_and(|it| it.eq_ignore_ascii_case(name)))
}

/// Returns true for `Timestamp;Type;ID;Data`, with or without `Lost` and `Length`.
fn is_clx_header(line: &[u8]) -> bool {
    const NAMES: [&str; 7] = ["timestamp", "type", "lost", "id", "length", "dlc", "data"];
    let line = String::from_utf8_lossy(line).to_ascii_lowercase();
    let names: Vec<&str> = line.split([';', ',', '\t']).map(str::trim).collect();
    let needed = ["timestamp", "type", "id", "data"];
    names.iter().all(|name| NAMES.contains(name)) && needed.iter().all(|it| names.contains(it))
}

/// Returns the format of a line with a typical time: `10:00:01:5000 Rx 1 …` and lines between stars of
/// BUSMASTER; `2026-11-22T10:00:01.500Z,2,129026,…` of canboat; `10:00:01.500 R 09F80207 …` of Yacht
/// Devices; `A100001.500 07FF2 1F802 …` of Actisense.
fn format_of_time(line: &[u8]) -> Option<LogFormat> {
    if line.starts_with(b"***") {
        return Some(LogFormat::Busmaster);
    }
    let mut fields = line.split(|byte| *byte == b',').map(<[u8]>::trim_ascii);
    let is_number = |field: &[u8]| !field.is_empty() && field.iter().all(u8::is_ascii_digit);
    if let Some([b'0'..=b'9', _, _, _, b'-', _, _, b'-', ..]) = fields.next() {
        let is_canboat = (0..5).all(|_| fields.next().is_some_and(is_number));
        return is_canboat.then_some(LogFormat::Canboat);
    }
    let mut words = words(line);
    let (time, second, third) = (words.next()?, words.next()?, words.next()?);
    let count = |mark: u8| time.iter().filter(|byte| **byte == mark).count();
    let is_hexadecimal =
        |word: &[u8], digits: usize| word.len() == digits && word.iter().all(u8::is_ascii_hexdigit);
    let is_clock = time
        .iter()
        .all(|byte| matches!(byte, b'0'..=b'9' | b':' | b'.'));
    match (count(b':'), count(b'.')) {
        (3, 0) if is_clock => Some(LogFormat::Busmaster),
        (2, 1) if is_clock && matches!(second, b"R" | b"T") && is_hexadecimal(third, 8) => {
            Some(LogFormat::YachtDevices)
        }
        (0, 1) if time.starts_with(b"A") => {
            let is_actisense = is_hexadecimal(second, 5) && is_hexadecimal(third, 5);
            is_actisense.then_some(LogFormat::Actisense)
        }
        _ => None,
    }
}

fn words(line: &[u8]) -> impl Iterator<Item = &[u8]> {
    let words = line.split(u8::is_ascii_whitespace);
    words.filter(|word| !word.is_empty())
}

/// Returns true for a line such as `date Sun Nov 22 10:00:00.000 am 2026`.
fn is_date(line: &[u8]) -> bool {
    let is_time = |word: &[u8]| word.iter().filter(|byte| **byte == b':').count() == 2;
    words(line).count() >= 5 && words(line).any(is_time)
}

/// Returns true for a line such as `0.001000 1  CF00400x  Rx  d 8 01 …`, or an event of ASC.
fn is_asc_line(line: &[u8]) -> bool {
    let mut words = words(line);
    let (Some(time), Some(channel), Some(what)) = (words.next(), words.next(), words.next()) else {
        return false;
    };
    let digits = time.strip_prefix(b"-").unwrap_or(time);
    let is_point = |byte: &u8| matches!(byte, b'.' | b',');
    let points = digits.iter().filter(|byte| is_point(byte)).count();
    let is_time = points == 1
        && digits
            .iter()
            .all(|byte| byte.is_ascii_digit() || is_point(byte));
    let direction = words.next();
    // Neither of a number nor of the mark behind an identifier.
    let is_of_word = |byte: &u8| {
        byte.is_ascii_alphabetic() && !matches!(byte.to_ascii_lowercase(), b'a'..=b'f' | b'x')
    };
    is_time
        && match channel {
            b"CANFD" | b"CANXL" | b"CAN" | b"Start" => true,
            number if number.iter().all(u8::is_ascii_digit) => {
                matches!(direction, Some(b"Rx" | b"Tx" | b"TxRq")) || what.iter().any(is_of_word)
            }
            _ => false,
        }
}

/// Returns the message for a file that begins with these bytes, if its format is known and not read.
#[must_use]
pub fn foreign(head: &[u8]) -> Option<&'static str> {
    let known = FOREIGN.iter().find(|(magic, _)| head.starts_with(magic));
    known.map(|(_, advice)| *advice)
}

/// Returns the message for a file whose extension is that of a format that is not read.
#[must_use]
pub fn foreign_by_name(path: &Path) -> Option<&'static str> {
    let extension = path.extension()?.to_str()?;
    let is_packed = PACKED_CANEDGE
        .iter()
        .any(|known| extension.eq_ignore_ascii_case(known));
    is_packed.then_some(CANEDGE)
}
