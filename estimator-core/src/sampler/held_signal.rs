//! Whether a signal is held: sent often, and renewed seldom.
//!
//! A gateway may repeat the torque of some seconds ago with every frame. Nothing in a frame shows it.
//! But a torque that is renewed with every frame moves over many frames, and one that is held moves
//! after long rests only. Where nearly all movement follows a long rest, repeated values are no new
//! ones.

use crate::scalar::Scalar;
use crate::time::Instant;
use crate::tuning::Detection;

/// The movement of a signal, and the part of it that followed a long rest.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct HeldSignal {
    last: Option<(f32, Instant)>,
    moved: f32,
    moved_after_rest: f32,
    has_changed: bool,
}

impl HeldSignal {
    /// Takes a value. Returns whether it is a new one, and not the last one held.
    #[inline(never)] // Called from two places.
    pub(super) fn is_new(&mut self, value: f32, now: Instant, tuning: &Detection) -> bool {
        let Some((last, since)) = self.last else {
            self.last = Some((value, now));
            self.has_changed = true;
            return true;
        };
        if value == last {
            return !self.is_held(tuning);
        }
        self.last = Some((value, now));
        self.has_changed = true;
        let change = (value - last).abs();
        let keep = 1.0 - Scalar::min(change / (10.0 * tuning.held_after_percent), 1.0);
        self.moved = keep * self.moved + change;
        self.moved_after_rest *= keep;
        if now.since(since) >= tuning.held_rest {
            self.moved_after_rest += change;
        }
        true
    }

    /// Returns whether the value has changed since the last call.
    pub(super) fn take_change(&mut self) -> bool {
        core::mem::take(&mut self.has_changed)
    }

    /// Returns whether repeated values are no new ones.
    pub(super) fn is_held(&self, tuning: &Detection) -> bool {
        self.moved > tuning.held_after_percent
            && self.moved_after_rest > tuning.held_part * self.moved
    }
}
