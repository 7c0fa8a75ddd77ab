//! The format of a recording of a bus, by its first bytes.

/// A format that its first bytes tell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LogFormat {
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
}

/// First bytes of a BLF file.
pub(crate) const BLF_MAGIC: &[u8] = b"LOGG";
/// First bytes of an MDF file; the second ones of a file that its writer did not finish.
const MDF_MAGIC: [&[u8]; 2] = [b"MDF     4", b"UnFinMF 4"];

/// Formats that are not read: first bytes, and what to tell the user.
const FOREIGN: [(&[u8], &str); 11] = [
    (b"PK\x03\x04", "is a zip archive; unpack it first"),
    (b"BZh", "is compressed with bzip2; unpack it first"),
    (b"\xfd7zXZ\0", "is compressed with xz; unpack it first"),
    (b"7z\xbc\xaf\x27\x1c", "is a 7z archive; unpack it first"),
    (b"MDF     3", MDF_3),
    (b"MDF     2", MDF_3),
    (b"SQLite format 3\0", SQLITE),
    (b"\xd4\xc3\xb2\xa1", PCAP),
    (b"\xa1\xb2\xc3\xd4", PCAP),
    (b"\x4d\x3c\xb2\xa1", PCAP),
    (b"\x0a\x0d\x0d\x0a", PCAP),
];

const MDF_3: &str =
    "is a recording in ASAM MDF 3, which is not read; `asammdf` exports signals as .csv";
const SQLITE: &str = "is an SQLite database, which is not read; convert a log of python-can with its \
                      `can_logconvert` to .blf, .asc or .log";
const PCAP: &str = "is a packet capture (PCAP), which is not read; expected a log such as `candump -l` \
                    writes, or .asc, .trc, .blf or .mf4";

/// Returns the format of a file that begins with these bytes; `None` if they do not tell. A candump
/// log has no header, and a table has the one of its columns.
#[must_use]
pub fn format_of(head: &[u8]) -> Option<LogFormat> {
    if head.starts_with(BLF_MAGIC) {
        return Some(LogFormat::Blf);
    }
    if MDF_MAGIC.iter().any(|magic| head.starts_with(magic)) {
        return Some(LogFormat::Mdf);
    }
    let text = head.strip_prefix(b"\xef\xbb\xbf").unwrap_or(head);
    let text = text.trim_ascii_start();
    let line = text.split(|byte| *byte == b'\n').next()?;
    if line.starts_with(b";") {
        return Some(LogFormat::Trc);
    }
    let begins = |word: &[u8]| {
        line.get(..word.len())
            .is_some_and(|start| start.eq_ignore_ascii_case(word))
    };
    if begins(b"time stamp,id,extended,") {
        return Some(LogFormat::SavvyCan);
    }
    if begins(b"timestamp,arbitration_id,") {
        return Some(LogFormat::PythonCan);
    }
    // The header of a table may begin with a column `date`.
    let is_asc = begins(b"//")
        || begins(b"base hex")
        || begins(b"base dec")
        || begins(b"begin trigger")
        || (begins(b"date ") && !line.contains(&b','))
        || is_asc_frame(line);
    is_asc.then_some(LogFormat::Asc)
}

/// Returns true for a line such as `0.001000 1  CF00400x  Rx  d 8 01 …`: an ASC log without header.
fn is_asc_frame(line: &[u8]) -> bool {
    let mut words = line
        .split(u8::is_ascii_whitespace)
        .filter(|word| !word.is_empty());
    let is_number = |word: &[u8]| {
        word.iter()
            .all(|byte| byte.is_ascii_digit() || *byte == b'.')
    };
    let (time, channel, _id) = (words.next(), words.next(), words.next());
    time.is_some_and(|word| is_number(word) && word.contains(&b'.'))
        && channel.is_some_and(is_number)
        && matches!(words.next(), Some(b"Rx" | b"Tx"))
        && matches!(words.next(), Some(b"d" | b"r"))
}

/// Returns what to tell the user of a file that begins with these bytes, if they tell a format that
/// is not read.
#[must_use]
pub fn foreign(head: &[u8]) -> Option<&'static str> {
    let known = FOREIGN.iter().find(|(magic, _)| head.starts_with(magic));
    known.map(|(_, advice)| *advice)
}
