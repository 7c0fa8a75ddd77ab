//! The records of a pcap file: a file header, then each packet behind a header of 16 bytes.
//!
//! Records have no mark. Behind damage, the next one is where a header is plausible, and the header behind
//! its packet too.

use super::super::byte_file::{ByteFile, number};
use super::super::line_problem::{LineProblem, Parsed, problem};
use super::packet::Link;
use super::step::{Captured, Step};
use crate::error::Result;
use pcap_parser::{
    PcapHeader, parse_pcap_frame, parse_pcap_frame_be, parse_pcap_frame_modified, parse_pcap_header,
};

/// Bytes of the file header, and of that of a record.
const FILE_HEADER_BYTES: u64 = 24;
const RECORD_BYTES: usize = 16;
/// Bytes of that of a record in Kuznetzov's variant.
const MODIFIED_RECORD_BYTES: usize = 24;
/// Most bytes of a packet: libpcap's limit.
const MOST_BYTES: u32 = 256 << 10;
/// Most bytes of a packet behind damage, where nothing else tells that it is one.
const MOST_BYTES_IN_DOUBT: u32 = 4096;
/// Furthest time of a record from the one before, s, in doubt.
const NEAR_S: u32 = 86_400;

/// What was read of the file.
pub(super) struct Records {
    header: PcapHeader,
    magic: [u8; 4],
    newest_s: Option<u32>,
}

/// The header of a record.
struct RecordHeader {
    seconds: u32,
    fraction: u32,
    kept_bytes: u32,
    whole_bytes: u32,
}

const NO_RECORD: LineProblem = problem(
    "no header of a packet",
    "seconds, a fraction below a second and a length",
);

impl Records {
    /// Reads the file header.
    ///
    /// # Errors
    /// Returns an error of the disk, or what is wrong with the header.
    pub(super) fn open(file: &mut ByteFile, bytes: &mut Vec<u8>) -> Result<Parsed<Self>> {
        let is_whole = file.take(bytes, FILE_HEADER_BYTES)?;
        let header = parse_pcap_header(bytes).ok().map(|(_, header)| header);
        let magic = number(bytes, 0).filter(|_| is_whole);
        Ok(match (header, magic) {
            (Some(header), Some(magic)) => Ok(Self {
                header,
                magic,
                newest_s: None,
            }),
            _ => Err(problem("no header of a packet capture", "24 bytes of it")),
        })
    }

    /// Returns the kind of the packets. The upper bits have the length of a checksum.
    pub(super) const fn link(&self) -> Link {
        Link::of(self.header.network.0 as u16)
    }

    /// Reads the next packet.
    ///
    /// # Errors
    /// Returns an error of the disk.
    pub(super) fn next(&mut self, file: &mut ByteFile, bytes: &mut Vec<u8>) -> Result<Step> {
        let is_modified = self.header.is_modified_format();
        let header_bytes = if is_modified {
            MODIFIED_RECORD_BYTES
        } else {
            RECORD_BYTES
        };
        if !file.take(bytes, header_bytes as u64)? {
            let is_end = bytes.is_empty();
            return Ok(if is_end { Step::End } else { Step::CutOff });
        }
        if bytes.starts_with(&self.magic) && bytes.get(4..8) == Some(self.version().as_slice()) {
            return self.next_file(file, bytes);
        }
        let header = self.header_at(bytes, 0);
        let Some(header) = header.filter(|header| self.is_record(header)) else {
            return self.skip(file, bytes);
        };
        if !file.take_more(bytes, header.kept_bytes.into())? {
            return self.skip(file, bytes).map(Step::or_cut_off);
        }
        let parse = match (is_modified, self.header.is_bigendian()) {
            (true, _) => parse_pcap_frame_modified,
            (false, true) => parse_pcap_frame_be,
            (false, false) => parse_pcap_frame,
        };
        let Ok((_, record)) = parse(bytes) else {
            return self.skip(file, bytes);
        };
        self.newest_s = Some(record.ts_sec);
        let per_micro = if self.header.is_nanosecond_precision() {
            1000
        } else {
            1
        };
        Ok(Step::Packet(Captured {
            micros: i64::from(record.ts_sec) * 1_000_000 + i64::from(record.ts_usec / per_micro),
            link: self.link(),
            interface: None,
            whole_bytes: record.origlen,
            data: header_bytes..header_bytes + record.data.len(),
            is_big_endian: self.header.is_bigendian(),
        }))
    }

    /// Goes on behind the header of another file that was appended.
    fn next_file(&mut self, file: &mut ByteFile, bytes: &mut Vec<u8>) -> Result<Step> {
        let rest = FILE_HEADER_BYTES.saturating_sub(bytes.len() as u64);
        if !file.take_more(bytes, rest)? {
            return Ok(Step::CutOff);
        }
        if let Ok((_, header)) = parse_pcap_header(bytes) {
            self.header = header;
        }
        Ok(Step::Other)
    }

    fn version(&self) -> [u8; 4] {
        let (major, minor) = (self.header.version_major, self.header.version_minor);
        if self.header.is_bigendian() {
            let [a, b] = major.to_be_bytes();
            let [c, d] = minor.to_be_bytes();
            return [a, b, c, d];
        }
        let [a, b] = major.to_le_bytes();
        let [c, d] = minor.to_le_bytes();
        [a, b, c, d]
    }

    fn header_at(&self, bytes: &[u8], at: usize) -> Option<RecordHeader> {
        let word = |k: usize| {
            let word = number(bytes, at + 4 * k)?;
            Some(if self.header.is_bigendian() {
                u32::from_be_bytes(word)
            } else {
                u32::from_le_bytes(word)
            })
        };
        Some(RecordHeader {
            seconds: word(0)?,
            fraction: word(1)?,
            kept_bytes: word(2)?,
            whole_bytes: word(3)?,
        })
    }

    fn is_record(&self, header: &RecordHeader) -> bool {
        let parts = if self.header.is_nanosecond_precision() {
            1_000_000_000
        } else {
            1_000_000
        };
        let is_length = header.kept_bytes <= header.whole_bytes && header.whole_bytes <= MOST_BYTES;
        header.fraction < parts && is_length
    }

    /// Skips to the next packet behind damage.
    fn skip(&self, file: &mut ByteFile, bytes: &mut Vec<u8>) -> Result<Step> {
        let reach = 2 * MODIFIED_RECORD_BYTES + MOST_BYTES_IN_DOUBT as usize;
        let left_out = file.skip_until(bytes, reach, |bytes, is_over| {
            (0..bytes.len()).find(|at| self.begins_record(bytes, *at, is_over))
        })?;
        Ok(Step::Damaged(NO_RECORD, left_out))
    }

    /// Returns true if a record begins at this place, beyond doubt.
    fn begins_record(&self, bytes: &[u8], at: usize, is_over: bool) -> bool {
        let plausible = |at: usize| {
            self.header_at(bytes, at).filter(|header| {
                let near = self.newest_s.unwrap_or(header.seconds);
                self.is_record(header)
                    && header.seconds.abs_diff(near) <= NEAR_S
                    && (1..=MOST_BYTES_IN_DOUBT).contains(&header.kept_bytes)
            })
        };
        let header_bytes = if self.header.is_modified_format() {
            MODIFIED_RECORD_BYTES
        } else {
            RECORD_BYTES
        };
        let Some(header) = plausible(at) else {
            return false;
        };
        let next = at + header_bytes + header.kept_bytes as usize;
        plausible(next).is_some() || (is_over && next == bytes.len())
    }
}
