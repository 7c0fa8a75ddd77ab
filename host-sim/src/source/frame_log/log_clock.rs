//! The clock of a log: what is wrong with its time stamps, and what can be mended.
//!
//! Within one message of one interface, times do not fall. Where they do, the clock began again, was set
//! back, or one stamp is wrong; the next frame tells which. Where only other messages fall, the log is
//! not in the order of time, and is put in order later.

use super::frame_reader::{LoggedFrame, Seconds};
use crate::error::Error;
use embedded_can::{Frame, Id};
use rustc_hash::FxHashMap;

/// Largest disorder of the frames of a message, µs: two senders on a virtual interface, two processors.
pub(super) const DISORDER_US: i64 = 100_000;
/// A frame that is further from its neighbours than this, µs, may have a wrong stamp.
const JUMP_US: i64 = 60_000_000;
/// A latest frame that is further ahead of all others than this, µs, may have a wrong stamp, ...
const ALONE_US: i64 = 300_000;
/// ... if the next one of its message comes within this behind the others, µs.
const GOES_ON_US: i64 = 1_000_000;
/// A clock that is set back by no more than this, µs, is set by a time server; the drive goes on.
const SMALL_STEP_US: i64 = 10_000_000;
/// Times that are further apart, µs, are those of two clocks.
const OTHER_CLOCK_US: i64 = 30 * 86_400_000_000;
/// Counters of microseconds with 32 bits begin again after 71.6 min.
const WRAP_US: i64 = 1 << 32;
/// Most messages whose times are remembered.
const MOST_MESSAGES: usize = 1 << 16;

/// What is expected of the times of a log, for messages.
pub(super) const IN_ORDER: &str = "times that do not fall within a message";

/// What became of the frames that were in doubt, in the order of the log.
pub(super) enum Placed {
    Taken(LoggedFrame),
    /// A frame has a wrong stamp, or is older than those before it.
    LeftOut(Error),
    /// The first frame of the log has the time of another clock; forget it.
    FirstIsWrong(Error),
    /// The latest frame, with this time in µs, has a wrong stamp; forget it.
    LatestIsWrong(i64, Error),
}

/// A frame that is far from its neighbours.
struct Held {
    logged: LoggedFrame,
    problem: Error,
    is_ahead: bool,
}

/// What was done to times.
#[derive(Debug, Default)]
struct Mended {
    wraps: u64,
    steps: u64,
    largest_step_us: i64,
    late: u64,
    latest_us: i64,
}

/// The clock so far.
#[derive(Default)]
pub(super) struct LogClock {
    /// True if any step back is mended.
    is_rejoined: bool,
    /// Added to times, µs.
    offset_us: i64,
    /// The times of the frame before and of the latest one, µs.
    before_us: i64,
    newest_us: i64,
    /// The latest time but that one, and the message of the latest frame.
    others_us: i64,
    newest_key: u64,
    frames: u64,
    first_problem: Option<Error>,
    first_is_wrong: bool,
    too_old: u64,
    /// Newest time of each message of each interface, µs.
    messages: FxHashMap<u64, i64>,
    held: Option<Held>,
    /// True while times are before a step back that is not mended.
    is_behind: bool,
    mended: Mended,
}

fn key_of(logged: &LoggedFrame) -> u64 {
    let id = match logged.frame.id() {
        Id::Standard(id) => 1 << 32 | u64::from(id.as_raw()),
        Id::Extended(id) => u64::from(id.as_raw()),
    };
    u64::from(logged.interface) << 40 | id
}

impl LogClock {
    pub(super) fn new(is_rejoined: bool) -> Self {
        Self {
            is_rejoined,
            ..Self::default()
        }
    }

    /// Takes the next frame of the log, at its mended time, if nothing is wrong with that.
    pub(super) fn takes(&mut self, logged: &mut LoggedFrame) -> bool {
        if self.held.is_some() || self.frames == 0 {
            return false;
        }
        let micros = logged.micros.saturating_add(self.offset_us);
        if !(-DISORDER_US..=JUMP_US).contains(&micros.saturating_sub(self.newest_us)) {
            return false;
        }
        logged.micros = micros;
        self.is_behind = false;
        self.accept(*logged);
        true
    }

    /// Places the next frame of the log where [`takes`](Self::takes) does not. `error` makes the error of
    /// its place.
    pub(super) fn place(
        &mut self,
        logged: LoggedFrame,
        error: impl Fn(&str) -> Error,
    ) -> Vec<Placed> {
        let mut placed = Vec::new();
        if self.frames == 0 {
            self.newest_us = logged.micros;
            let problem = format!("{} is the time of another clock", Seconds(logged.micros));
            self.first_problem = Some(error(&problem));
        }
        if let Some(held) = self.held.take() {
            let micros = logged.micros.saturating_add(self.offset_us);
            placed.push(self.decide_before(held, micros));
            if std::mem::take(&mut self.first_is_wrong)
                && let Some(problem) = self.first_problem.take()
            {
                placed.insert(0, Placed::FirstIsWrong(problem));
            }
        }
        if let Some(wrong_us) = self.wrong_latest(&logged) {
            let (newest, others) = (Seconds(wrong_us), Seconds(self.newest_us));
            let problem = error(&format!("time jumps from {others} to {newest} and back"));
            placed.push(Placed::LatestIsWrong(wrong_us, problem));
        }
        placed.extend(self.take(logged, &error));
        placed
    }

    /// Forgets the latest frame, if this one of its message shows that its stamp is wrong: it is alone
    /// there, and time goes on from that of the others. Returns its time.
    fn wrong_latest(&mut self, logged: &LoggedFrame) -> Option<i64> {
        let micros = logged.micros.saturating_add(self.offset_us);
        let goes_on = (-DISORDER_US..=GOES_ON_US).contains(&(micros - self.others_us));
        let is_alone = self.newest_us - self.others_us > ALONE_US && self.frames > 2;
        let is_wrong =
            is_alone && goes_on && key_of(logged) == self.newest_key && self.is_falling(logged);
        is_wrong.then(|| {
            self.messages.remove(&self.newest_key);
            std::mem::replace(&mut self.newest_us, self.others_us)
        })
    }

    /// Decides on a frame that was held back, by the time of the next one.
    fn decide_before(&mut self, held: Held, next_us: i64) -> Placed {
        let held_us = held.logged.micros;
        let is_apart = (held_us - next_us).abs() > DISORDER_US;
        let goes_on =
            next_us >= self.before_us - DISORDER_US && next_us - self.newest_us <= JUMP_US;
        if is_apart && goes_on {
            return Placed::LeftOut(held.problem);
        }
        let limit_us = if held.is_ahead {
            OTHER_CLOCK_US
        } else {
            JUMP_US
        };
        if self.frames == 1 && (held_us - self.newest_us).abs() > limit_us {
            self.first_is_wrong = true;
            self.newest_us = held_us;
            self.messages.clear();
            return Placed::Taken(self.accept(held.logged));
        }
        self.decide(held)
    }

    /// Takes a frame, unless the next one must decide.
    fn take(&mut self, mut logged: LoggedFrame, error: &impl Fn(&str) -> Error) -> Option<Placed> {
        logged.micros = logged.micros.saturating_add(self.offset_us);
        let micros = logged.micros;
        let ahead_us = micros.saturating_sub(self.newest_us);
        let (newest, time) = (Seconds(self.newest_us), Seconds(micros));
        if ahead_us > JUMP_US {
            let problem = error(&format!("time jumps from {newest} to {time} and back"));
            self.hold(logged, problem, true);
            return None;
        }
        if ahead_us >= -DISORDER_US {
            self.is_behind = false;
            return Some(Placed::Taken(self.accept(logged)));
        }
        let is_falling = self.is_falling(&logged);
        // A message that was not there before may be none.
        let is_known = self.messages.contains_key(&key_of(&logged));
        let is_near = self.before_us - micros <= if is_known { JUMP_US } else { DISORDER_US };
        if !self.is_behind && !is_falling && is_near {
            return Some(Placed::Taken(self.accept(logged)));
        }
        let problem = error(&format!("time runs backwards, from {newest} to {time}"));
        if self.is_behind {
            self.too_old += 1;
            return Some(Placed::LeftOut(problem));
        }
        if micros >= self.before_us - DISORDER_US {
            // Time fell before this frame, with one of another message.
            let is_ahead = false;
            return Some(self.decide(Held {
                logged,
                problem,
                is_ahead,
            }));
        }
        self.hold(logged, problem, false);
        None
    }

    fn hold(&mut self, logged: LoggedFrame, problem: Error, is_ahead: bool) {
        self.held = Some(Held {
            logged,
            problem,
            is_ahead,
        });
    }

    /// Decides on a frame behind which the log goes on from its time.
    fn decide(&mut self, held: Held) -> Placed {
        let mut logged = held.logged;
        let step_us = self.newest_us.saturating_sub(logged.micros);
        if held.is_ahead || (!self.is_falling(&logged) && step_us < OTHER_CLOCK_US) {
            return Placed::Taken(self.accept(logged));
        }
        let is_wrap = (step_us - WRAP_US).abs() <= JUMP_US;
        if is_wrap {
            self.offset_us += WRAP_US;
            logged.micros += WRAP_US;
            self.mended.wraps += 1;
        } else if self.is_rejoined || step_us <= SMALL_STEP_US {
            self.offset_us = self.offset_us.saturating_add(step_us);
            logged.micros = self.newest_us;
            self.mended.steps += 1;
            self.mended.largest_step_us = self.mended.largest_step_us.max(step_us);
        } else {
            self.is_behind = true;
            self.too_old += 1;
            return Placed::LeftOut(held.problem);
        }
        Placed::Taken(self.accept(logged))
    }

    /// Returns true if a message has a later frame already.
    fn is_falling(&self, logged: &LoggedFrame) -> bool {
        let newest = self.messages.get(&key_of(logged));
        newest.is_some_and(|newest| newest - logged.micros > DISORDER_US)
    }

    fn accept(&mut self, logged: LoggedFrame) -> LoggedFrame {
        let late_us = self.newest_us - logged.micros;
        if late_us > DISORDER_US {
            self.mended.late += 1;
            self.mended.latest_us = self.mended.latest_us.max(late_us);
        }
        self.frames += 1;
        self.before_us = logged.micros;
        if logged.micros > self.newest_us {
            self.others_us = self.newest_us;
            self.newest_us = logged.micros;
            self.newest_key = key_of(&logged);
        } else {
            self.others_us = self.others_us.max(logged.micros);
        }
        if self.messages.len() < MOST_MESSAGES {
            self.messages.insert(key_of(&logged), logged.micros);
        } else if let Some(newest) = self.messages.get_mut(&key_of(&logged)) {
            *newest = logged.micros;
        }
        logged
    }

    /// Decides on the last frame of the log, if it was held back.
    pub(super) fn end(&mut self) -> Option<Placed> {
        let held = self.held.take()?;
        let ahead_us = held.logged.micros.saturating_sub(self.newest_us);
        if !held.is_ahead || ahead_us > OTHER_CLOCK_US {
            self.too_old += 1;
            return Some(Placed::LeftOut(held.problem));
        }
        Some(self.decide(held))
    }

    /// Returns the number of frames that are older than those before them.
    pub(super) const fn too_old(&self) -> u64 {
        self.too_old
    }

    /// Returns what was mended, in words.
    pub(super) fn mended(&self) -> impl Iterator<Item = String> {
        let Mended {
            wraps,
            steps,
            largest_step_us,
            late,
            latest_us,
        } = self.mended;
        let seconds = |us: i64| us as f64 / 1e6;
        let times = |count: u64| match count {
            1 => "once".to_owned(),
            _ => format!("{count} times"),
        };
        let late = (late > 0).then(|| {
            let by = seconds(latest_us);
            format!(
                "{late} frames stand behind later ones, by up to {by:.1} s; put in order of time"
            )
        });
        let wraps = (wraps > 0).then(|| {
            let times = times(wraps);
            format!("the counter of microseconds began again {times} (32 bits); time goes on")
        });
        let steps = (steps > 0).then(|| {
            let (times, by) = (times(steps), seconds(largest_step_us));
            format!("the clock was set back {times}, by up to {by:.1} s; time goes on from there")
        });
        [late, wraps, steps].into_iter().flatten()
    }
}
