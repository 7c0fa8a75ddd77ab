//! The bytes of a log, unpacked: plain, gzip (RFC 1952) or Zstandard (RFC 8878).

use super::packed_bytes::{ZSTD_MAGIC, is_skippable};
use super::packed_members::Members;
use std::io::{self, Cursor, ErrorKind, Read};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// First bytes of a gzip file.
const GZIP_MAGIC: &[u8] = &[0x1f, 0x8b];

/// How a log is packed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Packing {
    Plain,
    Gzip,
    Zstd,
}

impl Packing {
    /// Returns its name for messages.
    pub(super) const fn name(self) -> &'static str {
        match self {
            Self::Plain => "file",
            Self::Gzip => "gzip",
            Self::Zstd => "zstd",
        }
    }
}

/// How bytes before and behind damage of packed data are joined.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Joint {
    /// Not at all: the content ends at the damage.
    #[default]
    None,
    /// With a mark between them that no line has.
    Lines,
    /// As they are: the format finds its next object by itself.
    Bytes,
}

/// Damage within packed data.
#[derive(Clone, Debug, Default)]
pub(super) struct PackedDamage {
    /// Where it was found, in packed bytes.
    pub at: u64,
    /// Packed bytes that are left out.
    pub bytes: u64,
    pub problem: String,
}

/// What is known of the packed bytes.
#[derive(Clone, Default)]
pub(super) struct RawState {
    bytes: Arc<AtomicU64>,
    is_over: Arc<AtomicBool>,
    has_failed: Arc<AtomicBool>,
    damage: Arc<Mutex<DamageState>>,
}

#[derive(Default)]
struct DamageState {
    joint: Joint,
    found: Vec<PackedDamage>,
    /// Damage behind which nobody has read on.
    pending: Option<PackedDamage>,
    /// True if the rest of the member is to be left out.
    is_skip_asked: bool,
    /// Where the newest member begins, in unpacked bytes.
    member_start: u64,
}

/// Most places of damage that are told one by one.
const MOST_PLACES: usize = 1000;

impl RawState {
    /// Returns the number of packed bytes read.
    pub(super) fn bytes(&self) -> u64 {
        self.bytes.load(Ordering::Relaxed)
    }

    /// Counts bytes that were read in another way.
    pub(super) fn add(&self, bytes: u64) {
        self.bytes.fetch_add(bytes, Ordering::Relaxed);
    }

    /// Returns true if all packed bytes were read.
    pub(super) fn is_over(&self) -> bool {
        self.is_over.load(Ordering::Relaxed)
    }

    /// Returns true if the packed bytes could not be read.
    pub(super) fn has_failed(&self) -> bool {
        self.has_failed.load(Ordering::Relaxed)
    }

    fn damage(&self) -> MutexGuard<'_, DamageState> {
        self.damage.lock().unwrap_or_else(PoisonError::into_inner)
    }

    pub(super) fn joint(&self) -> Joint {
        self.damage().joint
    }

    /// Says how to go on behind damage.
    pub(super) fn set_joint(&self, joint: Joint) {
        self.damage().joint = joint;
    }

    pub(super) fn add_damage(&self, at: u64, bytes: u64, problem: &str) {
        let mut damage = self.damage();
        if damage.found.len() < MOST_PLACES {
            damage.found.push(PackedDamage {
                at,
                bytes,
                problem: problem.to_owned(),
            });
        } else if let Some(last) = damage.found.last_mut() {
            last.bytes += bytes;
        }
    }

    /// Asks to leave out the rest of the member: its content is damaged.
    pub(super) fn ask_to_skip(&self) {
        self.damage().is_skip_asked = true;
    }

    pub(super) fn take_skip(&self) -> bool {
        std::mem::take(&mut self.damage().is_skip_asked)
    }

    pub(super) fn set_member_start(&self, at: u64) {
        self.damage().member_start = at;
    }

    pub(super) fn member_start(&self) -> u64 {
        self.damage().member_start
    }

    pub(super) fn set_pending(&self, at: u64, problem: &str) {
        self.damage().pending = Some(PackedDamage {
            at,
            bytes: 0,
            problem: problem.to_owned(),
        });
    }

    pub(super) fn clear_pending(&self) {
        self.damage().pending = None;
    }

    /// Returns the damage found, if the packed data have so many bytes.
    pub(super) fn packed_damage(&self, bytes_total: u64) -> Vec<PackedDamage> {
        let damage = self.damage();
        let mut all = damage.found.clone();
        all.extend(damage.pending.clone().map(|pending| PackedDamage {
            bytes: bytes_total.saturating_sub(pending.at),
            ..pending
        }));
        all
    }
}

/// Counts the packed bytes.
struct Counting<R> {
    inner: R,
    state: RawState,
}

impl<R: Read> Read for Counting<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let count = match self.inner.read(buffer) {
            Err(e) if e.kind() != ErrorKind::Interrupted => {
                self.state.has_failed.store(true, Ordering::Relaxed);
                return Err(e);
            }
            other => other?,
        };
        self.state.bytes.fetch_add(count as u64, Ordering::Relaxed);
        if count == 0 && !buffer.is_empty() {
            self.state.is_over.store(true, Ordering::Relaxed);
        }
        Ok(count)
    }
}

/// Unpacks bytes. The first ones, not a name, decide how they are packed.
pub(super) fn unpacked(
    mut packed: impl Read + Send + 'static,
) -> io::Result<(Box<dyn Read + Send>, Packing, RawState)> {
    let mut head = Vec::new();
    packed
        .by_ref()
        .take(ZSTD_MAGIC.len() as u64)
        .read_to_end(&mut head)?;
    let packing = if head.starts_with(GZIP_MAGIC) {
        Packing::Gzip
    } else if head == ZSTD_MAGIC || is_skippable(&head) {
        Packing::Zstd
    } else {
        Packing::Plain
    };
    let state = RawState::default();
    // Chained, not rewound: a pipe cannot be rewound.
    let raw = Counting {
        inner: Cursor::new(head).chain(packed),
        state: state.clone(),
    };
    let content: Box<dyn Read + Send> = match packing {
        Packing::Plain => Box::new(raw),
        packing => Box::new(Members::new(raw, packing, state.clone())),
    };
    Ok((content, packing, state))
}
