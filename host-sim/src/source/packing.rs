//! How a log is packed, and what is known of its packed bytes.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

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

    /// Counts bytes.
    pub(super) fn add(&self, bytes: u64) {
        self.bytes.fetch_add(bytes, Ordering::Relaxed);
    }

    /// Returns true if all packed bytes were read.
    pub(super) fn is_over(&self) -> bool {
        self.is_over.load(Ordering::Relaxed)
    }

    pub(super) fn set_over(&self) {
        self.is_over.store(true, Ordering::Relaxed);
    }

    pub(super) fn set_failed(&self) {
        self.has_failed.store(true, Ordering::Relaxed);
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
