//! The members of a gzip file (RFC 1952), or the frames of a Zstandard one (RFC 8878), unpacked one
//! after the other.
//!
//! What follows damage within a member cannot be unpacked. What is before it is used, and reading goes
//! on at the next member, as rotating loggers write them.

use super::packed_bytes::PackedBytes;
use super::packing::{Joint, Packing, RawState};
use flate2::bufread::GzDecoder;
use ruzstd::decoding::{BlockDecodingStrategy, FrameDecoder};
use std::io::{self, ErrorKind, Read};

/// Largest window of Zstandard, bytes: more than its level 19 uses; only `--long` may use more.
const MOST_WINDOW_BYTES: u64 = 32 << 20;
/// What stands between the bytes before and behind damage, in a log of lines: no two halves of lines
/// become one, and both halves are seen to be damaged.
const BETWEEN_LINES: &[u8] = b"\0\n\0";
/// The last block of a Zstandard frame, without content, and a checksum.
const LAST_BLOCK: [u8; 7] = [1, 0, 0, 0, 0, 0, 0];

/// Reader of all members.
pub(super) struct Members<R: Read> {
    packing: Packing,
    state: RawState,
    now: Now<R>,
    /// Bytes to hand out before the next member.
    joint: &'static [u8],
    /// True if a member began before.
    has_begun: bool,
    /// Unpacked bytes so far, with those between members.
    handed_out: u64,
    /// Where the rest of the member begins that is left out, in packed bytes.
    skipped_from: Option<u64>,
}

/// What is read now.
enum Now<R: Read> {
    Between(PackedBytes<R>),
    Gzip(Box<GzDecoder<PackedBytes<R>>>),
    Zstd(PackedBytes<R>, Box<FrameDecoder>),
    /// What a damaged Zstandard frame still held back.
    Rest(PackedBytes<R>, Box<FrameDecoder>, io::Error),
    /// Damage: the reader of the log says how to go on.
    Damaged(PackedBytes<R>, io::Error),
    Over,
}

impl<R: Read> Members<R> {
    pub(super) const fn new(raw: R, packing: Packing, state: RawState) -> Self {
        Self {
            packing,
            state,
            now: Now::Between(PackedBytes::new(raw)),
            joint: &[],
            has_begun: false,
            handed_out: 0,
            skipped_from: None,
        }
    }

    /// Begins the next member. Returns false at the end.
    fn begin(&mut self, mut raw: PackedBytes<R>) -> io::Result<bool> {
        if self.packing == Packing::Zstd {
            raw.skip_skippable()?;
        }
        let Some(is_start) = raw.is_start(self.packing)? else {
            self.now = Now::Between(raw);
            return Ok(false);
        };
        // Blocks of a disk that were never written may follow, and damaged members.
        if self.has_begun && !is_start {
            let (lost, is_found) = raw.skip_to_start(self.packing)?;
            if !is_found {
                self.now = Now::Over;
                return Err(ErrorKind::UnexpectedEof.into());
            }
            let at = raw.taken() - lost;
            self.state.add_damage(at, lost, "no member begins here");
            self.join();
        }
        self.has_begun = true;
        let start = self.handed_out + self.joint.len() as u64;
        self.state.set_member_start(start);
        if self.packing == Packing::Gzip {
            self.now = Now::Gzip(Box::new(GzDecoder::new(raw)));
            return Ok(true);
        }
        let mut decoder = Box::new(FrameDecoder::new());
        decoder.set_max_window_size(MOST_WINDOW_BYTES);
        self.now = match decoder.init(&mut raw) {
            Ok(()) => Now::Zstd(raw, decoder),
            Err(e) => Now::Damaged(raw, invalid(&e)),
        };
        Ok(true)
    }

    /// Goes on behind damage. Returns false if the log is used only up to there.
    fn resume(&mut self, mut raw: PackedBytes<R>, problem: io::Error) -> io::Result<bool> {
        if self.state.has_failed() {
            return Err(problem);
        }
        if problem.kind() == ErrorKind::UnexpectedEof || self.state.is_over() {
            return Err(ErrorKind::UnexpectedEof.into());
        }
        let at = raw.taken();
        if self.state.joint() == Joint::None {
            self.state.set_pending(at, &problem.to_string());
            self.now = Now::Damaged(raw, problem);
            return Ok(false);
        }
        self.state.clear_pending();
        let from = self.skipped_from.take().unwrap_or(at);
        let (_, is_found) = raw.skip_to_start(self.packing)?;
        let lost = raw.taken() - from;
        self.state.add_damage(from, lost, &problem.to_string());
        // A wrong checksum stands at the end of a member, and nothing is lost behind it.
        if is_found && lost > 0 {
            self.join();
        }
        self.now = Now::Between(raw);
        Ok(true)
    }

    /// Begins to leave out the rest of the member, if one is read.
    fn begin_to_skip(&mut self) {
        self.skipped_from = match &self.now {
            Now::Gzip(member) => Some(member.get_ref().taken()),
            Now::Zstd(raw, _) => Some(raw.taken()),
            _ => None,
        };
    }

    /// Goes on behind a whole member.
    fn end_of_member(&mut self, raw: PackedBytes<R>) {
        if let Some(from) = self.skipped_from.take() {
            let problem = "what it unpacks to is damaged";
            self.state.add_damage(from, raw.taken() - from, problem);
            self.join();
        }
        self.now = Now::Between(raw);
    }

    fn join(&mut self) {
        if self.state.joint() == Joint::Lines {
            self.joint = BETWEEN_LINES;
        }
    }
}

impl<R: Read> Read for Members<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        if buffer.is_empty() {
            return Ok(0);
        }
        if self.state.take_skip() {
            self.begin_to_skip();
        }
        let count = self.read_on(buffer)?;
        self.handed_out += count as u64;
        Ok(count)
    }
}

impl<R: Read> Members<R> {
    fn read_on(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        loop {
            if !self.joint.is_empty() {
                return self.joint.read(buffer);
            }
            let count = match std::mem::replace(&mut self.now, Now::Over) {
                Now::Between(raw) => {
                    if !self.begin(raw)? {
                        return Ok(0);
                    }
                    0
                }
                Now::Gzip(mut member) => match member.read(buffer) {
                    Ok(0) => {
                        self.end_of_member(member.into_inner());
                        0
                    }
                    Ok(count) => {
                        self.now = Now::Gzip(member);
                        count
                    }
                    Err(e) if e.kind() == ErrorKind::Interrupted => {
                        self.now = Now::Gzip(member);
                        return Err(e);
                    }
                    Err(e) => {
                        self.now = Now::Damaged(member.into_inner(), e);
                        0
                    }
                },
                Now::Zstd(raw, decoder) => self.read_zstd(raw, decoder, buffer)?,
                Now::Rest(raw, mut decoder, problem) => {
                    let count = decoder.read(buffer)?;
                    self.now = if count == 0 {
                        Now::Damaged(raw, problem)
                    } else {
                        Now::Rest(raw, decoder, problem)
                    };
                    count
                }
                Now::Damaged(raw, problem) => {
                    if !self.resume(raw, problem)? {
                        return Ok(0);
                    }
                    0
                }
                Now::Over => return Ok(0),
            };
            if count > 0 && self.skipped_from.is_none() {
                return Ok(count);
            }
        }
    }

    fn read_zstd(
        &mut self,
        mut raw: PackedBytes<R>,
        mut decoder: Box<FrameDecoder>,
        buffer: &mut [u8],
    ) -> io::Result<usize> {
        let decoded = unpack_some(&mut raw, &mut decoder);
        let count = decoder.read(buffer)?;
        match decoded {
            Ok(()) if count == 0 => match wrong_checksum(&decoder) {
                Some(problem) => self.now = Now::Damaged(raw, problem),
                None => self.end_of_member(raw),
            },
            Ok(()) => self.now = Now::Zstd(raw, decoder),
            Err(problem) => {
                // It holds back as much as its window has until it sees the last block.
                let all = BlockDecodingStrategy::All;
                let _ = decoder.decode_blocks(&LAST_BLOCK[..], all);
                self.now = Now::Rest(raw, decoder, problem);
            }
        }
        Ok(count)
    }
}

fn invalid(problem: &impl ToString) -> io::Error {
    io::Error::new(ErrorKind::InvalidData, problem.to_string())
}

/// Unpacks blocks until there are bytes, or the frame is over.
fn unpack_some<R: Read>(raw: &mut PackedBytes<R>, decoder: &mut FrameDecoder) -> io::Result<()> {
    while decoder.can_collect() == 0 && !decoder.is_finished() {
        let one = BlockDecodingStrategy::UptoBlocks(1);
        decoder
            .decode_blocks(&mut *raw, one)
            .map_err(|e| invalid(&e))?;
    }
    Ok(())
}

/// Returns that the checksum of a whole frame is wrong, if it has one. It is of all of its content.
fn wrong_checksum(decoder: &FrameDecoder) -> Option<io::Error> {
    let told = decoder.get_checksum_from_data();
    (told.is_some() && told != decoder.get_calculated_checksum())
        .then(|| invalid(&"the checksum of a frame is wrong"))
}
