//! Wheel speed and force as means over slots of a quarter of a second.

use super::latest::TimedValue;
use crate::scalar::Scalar;
use crate::time::{Duration, Instant};

/// Length of a slot.
pub(super) const SLOT: Duration = Duration::from_micros(250_000);
pub(super) const SLOT_S: f32 = 0.25;
/// Number of slots that are kept: 8 s.
pub(super) const SLOTS: usize = 32;
/// Longest time between two wheel speeds that is bridged.
const LONGEST: Duration = Duration::from_micros(1_250_000);

/// Means over a slot: wheel speed, m/s, and force, in units of 10 kN; zero if there was none in a part
/// of the slot.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Slot {
    pub wheels_mps: f32,
    pub force: f32,
}

impl Slot {
    /// Returns the power, to which the speed of slip is proportional, in units of 100 kW.
    pub(super) const fn slip(&self) -> f32 {
        0.1 * self.wheels_mps * self.force
    }
}

/// The slots, and the open one.
#[derive(Clone, Debug)]
pub(super) struct SpeedSlots {
    last: Option<TimedValue>,
    /// End of the open slot, way in it so far, m, and impulse, in units of 10 kN s.
    end: Instant,
    way_m: f32,
    impulse: f32,
    /// Whether there was a force all the time.
    is_driven: bool,
    /// A ring: to move many takes long.
    slots: [Slot; SLOTS],
    newest: u8,
    filled: u8,
}

impl SpeedSlots {
    #[inline(always)] // See Estimator::new_in().
    pub(super) fn new() -> Self {
        Self {
            last: None,
            end: Instant::ZERO,
            way_m: 0.0,
            impulse: 0.0,
            is_driven: true,
            slots: [Slot::default(); SLOTS],
            newest: 0,
            filled: 0,
        }
    }

    /// Returns whether all slots are filled.
    pub(super) fn are_filled(&self) -> bool {
        usize::from(self.filled) == SLOTS
    }

    /// Returns a slot, the newest first; nothing beyond the last.
    #[inline(never)] // Called from several places.
    pub(super) fn get(&self, age: usize) -> Slot {
        let place = (usize::from(self.newest) + age) % SLOTS;
        self.slots.get(place).copied().unwrap_or_default()
    }

    /// Returns wheel speed and force so many slots before the middle of the newest slot.
    #[inline(never)] // Called from several places.
    pub(super) fn between(&self, age: f32) -> Slot {
        let (newer, part) = (age as usize, age - (age as usize) as f32);
        let (newer, older) = (self.get(newer), self.get(newer + 1));
        Slot {
            wheels_mps: newer.wheels_mps + part * (older.wheels_mps - newer.wheels_mps),
            force: newer.force + part * (older.force - newer.force),
        }
    }

    /// Begins with this wheel speed if it does not follow from the last one. Returns whether it does
    /// that.
    pub(super) fn begin(&mut self, speed: TimedValue) -> bool {
        let follows = self
            .last
            .is_some_and(|last| speed.time.since(last.time) <= LONGEST);
        if !follows {
            self.last = Some(speed);
            self.end = speed.time + SLOT;
            self.way_m = 0.0;
            self.impulse = 0.0;
            self.is_driven = true;
            self.filled = 0;
        }
        !follows
    }

    /// Drives towards a wheel speed, with the mean force since the last one, in units of 10 kN. Returns
    /// whether a slot ended on the way: then call it again, five times at most.
    pub(super) fn drive(&mut self, to: TimedValue, force: f32) -> bool {
        let Some(from) = self.last.filter(|from| from.time < to.time) else {
            return false;
        };
        let time = self.end.min(to.time);
        let seconds = time.seconds_since(from.time);
        let slope = (to.value - from.value) / to.time.seconds_since(from.time);
        let value = from.value + slope * seconds;
        self.way_m += 0.5 * (from.value + value) * seconds;
        self.impulse += force * seconds;
        self.is_driven &= force != 0.0;
        self.last = Some(TimedValue { value, time });
        if time < self.end {
            return false;
        }
        self.close();
        true
    }

    fn close(&mut self) {
        let before = self.newest.checked_sub(1).unwrap_or(SLOTS as u8 - 1);
        self.newest = before;
        if let Some(slot) = self.slots.get_mut(usize::from(before)) {
            slot.wheels_mps = self.way_m / SLOT_S;
            slot.force = if self.is_driven {
                self.impulse / SLOT_S
            } else {
                0.0
            };
        }
        self.filled = (self.filled + 1).min(SLOTS as u8);
        self.way_m = 0.0;
        self.impulse = 0.0;
        self.is_driven = true;
        self.end = self.end + SLOT;
    }

    /// Returns the way in so many seconds before now, m; `None` if it is not known.
    #[inline(never)] // Called from several places.
    pub(super) fn way_m(&self, now: Instant, seconds: f32) -> Option<f32> {
        let last = self.last.filter(|last| now.since(last.time) <= LONGEST)?;
        let since_s = Scalar::min(now.seconds_since(last.time), seconds);
        let open_s = SLOT_S - self.end.seconds_since(last.time);
        let mut left_s = seconds - since_s;
        let mut way_m = since_s * last.value;
        if open_s > 0.0 {
            let piece_s = Scalar::min(left_s, open_s);
            way_m += piece_s / open_s * self.way_m;
            left_s -= piece_s;
        }
        for age in 0..usize::from(self.filled) {
            if left_s <= 0.0 {
                break;
            }
            let piece_s = Scalar::min(left_s, SLOT_S);
            way_m += piece_s * self.get(age).wheels_mps;
            left_s -= piece_s;
        }
        (left_s <= 0.0).then_some(way_m)
    }
}
