//! Time that only goes forward, whatever the listener's clock does.
//!
//! A clock is set, a counter of 32 bits begins anew, a stamp is garbled. What comes late by a little
//! is left out, and so is a single input far ahead of all others: believed, it would make all that
//! follow late. Where the inputs go on from another time, time goes on from where it was.

use crate::time::{Duration, Instant};

/// Time for which inputs go on from an earlier time before the clock is taken to be set back.
const SET_BACK: Duration = Duration::from_millis(1000);
/// Silence after which an input has to be followed by another one. All that is known of a bus is
/// stale by then, so that one input less is no loss.
const FAR_AHEAD: Duration = Duration::from_millis(10_000);

/// The inputs that were out of time last.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Doubt {
    /// Nothing was heard yet.
    Unheard,
    None,
    /// Earlier than the newest: from a time to another, in order.
    Back(Instant, Instant),
    /// One far ahead.
    Ahead(Instant),
}

/// What an input's time means.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Verdict {
    /// It follows the one before.
    Follows,
    /// It follows, but the clock was set back in between.
    SetBack,
    /// It is far ahead, and so was the one before: it was silent, or the clock leapt ahead.
    Silent,
    /// It is older than the input before it.
    Late,
    /// It is far ahead of the input before it, and alone in that.
    FarAhead,
}

/// The time of the newest input, and how that of inputs is told.
#[derive(Clone, Debug)]
pub(crate) struct Clock {
    now: Instant,
    /// What the listener's clock is behind since it was set back.
    behind_us: u64,
    doubt: Doubt,
}

impl Clock {
    /// Before the first input.
    pub(crate) const fn new() -> Self {
        Self {
            now: Instant::ZERO,
            behind_us: 0,
            doubt: Doubt::Unheard,
        }
    }

    /// The time of the newest input that was not out of time.
    pub(crate) const fn now(&self) -> Instant {
        self.now
    }

    /// Takes the time that an input is told to be of.
    pub(crate) fn hear(&mut self, told: Instant) -> Verdict {
        let time = Instant::from_micros(told.micros().wrapping_add(self.behind_us));
        // One comparison: a time before now is very far ahead of it in this.
        let since_us = time.micros().wrapping_sub(self.now.micros());
        if since_us <= FAR_AHEAD.micros() {
            self.now = time;
            self.doubt = Doubt::None;
            return Verdict::Follows;
        }
        self.out_of_time(time)
    }

    #[inline(never)] // Not where each frame passes.
    fn out_of_time(&mut self, time: Instant) -> Verdict {
        let now = self.now;
        if self.doubt == Doubt::Unheard {
            self.now = time;
            self.doubt = Doubt::None;
            Verdict::Follows
        } else if time >= now {
            let confirmed = matches!(self.doubt, Doubt::Ahead(before) if time >= before);
            if !confirmed {
                self.doubt = Doubt::Ahead(time);
                return Verdict::FarAhead;
            }
            self.now = time;
            self.doubt = Doubt::None;
            Verdict::Silent
        } else {
            let first = match self.doubt {
                Doubt::Back(first, last) if time >= last => first,
                _ => time,
            };
            let since = time.since(first);
            if since < SET_BACK {
                self.doubt = Doubt::Back(first, time);
                return Verdict::Late;
            }
            self.behind_us = self.behind_us.wrapping_add(now.since(first).micros());
            self.now = now + since;
            self.doubt = Doubt::None;
            Verdict::SetBack
        }
    }
}
