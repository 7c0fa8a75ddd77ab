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
}

/// First bytes of a BLF file.
pub(crate) const BLF_MAGIC: &[u8] = b"LOGG";

/// Formats that are not read: first bytes, and what to tell the user.
const FOREIGN: [(&[u8], &str); 13] = [
    (b"PK\x03\x04", "is a zip archive; unpack it first"),
    (b"BZh", "is compressed with bzip2; unpack it first"),
    (b"\xfd7zXZ\0", "is compressed with xz; unpack it first"),
    (
        b"\x28\xb5\x2f\xfd",
        "is compressed with zstd; unpack it first",
    ),
    (b"7z\xbc\xaf\x27\x1c", "is a 7z archive; unpack it first"),
    (b"MDF     3", MDF_3),
    (b"MDF     ", MDF_4),
    (b"UnFinMF ", MDF_4),
    (b"SQLite format 3\0", SQLITE),
    (b"\xd4\xc3\xb2\xa1", PCAP),
    (b"\xa1\xb2\xc3\xd4", PCAP),
    (b"\x4d\x3c\xb2\xa1", PCAP),
    (b"\x0a\x0d\x0d\x0a", PCAP),
];

const MDF_4: &str = "is a recording in ASAM MDF 4, which is not read yet; `asammdf` exports the frames of a \
                     bus as .asc, or signals as .csv";
const MDF_3: &str =
    "is a recording in ASAM MDF 3, which is not read; `asammdf` exports signals as .csv";
const SQLITE: &str = "is an SQLite database, which is not read; convert a log of python-can with its \
                      `can_logconvert` to .blf, .asc or .log";
const PCAP: &str = "is a packet capture (PCAP), which is not read; expected a log such as `candump -l` \
                    writes, or .asc, .trc or .blf";

/// Returns the format of a file that begins with these bytes; `None` if they do not tell. A candump
/// log has no header, and a table has the one of its columns.
#[must_use]
pub fn format_of(head: &[u8]) -> Option<LogFormat> {
    if head.starts_with(BLF_MAGIC) {
        return Some(LogFormat::Blf);
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
    // The header of a table may begin with a column `date`.
    let is_asc = begins(b"//")
        || begins(b"base hex")
        || begins(b"base dec")
        || begins(b"begin trigger")
        || (begins(b"date ") && !line.contains(&b','));
    is_asc.then_some(LogFormat::Asc)
}

/// Returns what to tell the user of a file that begins with these bytes, if they tell a format that
/// is not read.
#[must_use]
pub fn foreign(head: &[u8]) -> Option<&'static str> {
    let known = FOREIGN.iter().find(|(magic, _)| head.starts_with(magic));
    known.map(|(_, advice)| *advice)
}
