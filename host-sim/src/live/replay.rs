//! A recorded log put on an interface, in the log's own time or faster.

use crate::error::{Error, Result};
use crate::source::can_frame::TimedFrame;
use crate::source::log_time::LogTime;
use crate::source::socketcan::FrameSender;
use estimator_core::Instant;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::{Duration, Instant as Monotonic};

/// Frames sent before the listener is asked whether it has read them. A socket with the memory that
/// Linux gives to everyone holds some 250 frames.
const WINDOW: usize = 100;
/// How long the first answer is waited for, and each later one.
const FIRST_ANSWER: Duration = Duration::from_secs(10);
const NEXT_ANSWER: Duration = Duration::from_secs(10);
/// Between two questions, before the first answer.
const ASK_AGAIN: Duration = Duration::from_millis(100);
/// Longest sleep without a look whether to stop.
const NAP: Duration = Duration::from_millis(100);

/// How fast.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Pace {
    /// The log's own time, divided by this.
    Times(f64),
    /// As fast as the interface takes frames.
    Max,
}

/// What was sent.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sent {
    /// Frames of the log.
    pub frames: u64,
    /// First and last time in the log.
    pub span: Option<(Instant, Instant)>,
    /// How late a frame was at most.
    pub latest: Duration,
}

/// Sends the frames of a log.
#[derive(Debug)]
pub struct Replay<'a> {
    name: &'a str,
    sender: FrameSender,
    pace: Pace,
    sends_time: bool,
    stop: &'a AtomicBool,
    begun: Monotonic,
    /// Of frames on the bus, not yet answered for.
    unanswered: usize,
    sent_time: Option<Instant>,
    sent: Sent,
}

impl<'a> Replay<'a> {
    /// Begins on an interface. With `sends_time` the log's time goes along, for a listener that
    /// answers.
    #[must_use]
    pub fn new(
        name: &'a str,
        sender: FrameSender,
        pace: Pace,
        sends_time: bool,
        stop: &'a AtomicBool,
    ) -> Self {
        Self {
            name,
            sender,
            pace,
            sends_time,
            stop,
            begun: Monotonic::now(),
            unanswered: 0,
            sent_time: None,
            sent: Sent::default(),
        }
    }

    /// Sends one frame when it is its time; false if it was sent_time to stop.
    ///
    /// # Errors
    /// The interface is down, gone or takes nothing; nobody answers.
    pub fn send(&mut self, timed: &TimedFrame) -> Result<bool> {
        let first = match self.sent.span {
            Some((first, _)) => first,
            None => {
                if self.sends_time {
                    self.ask(LogTime::Ready(timed.time), FIRST_ANSWER)?;
                }
                self.begun = Monotonic::now();
                timed.time
            }
        };
        self.sent.span = Some((first, timed.time));
        if let Pace::Times(factor) = self.pace {
            let micros = timed.time.since(first).micros();
            let due = self.begun + Duration::from_secs_f64(micros as f64 * 1e-6 / factor);
            if !self.wait_until(due) {
                return Ok(false);
            }
            self.sent.latest = self.sent.latest.max(due.elapsed());
        }
        if self.stop.load(Ordering::Relaxed) {
            return Ok(false);
        }
        if self.sends_time {
            self.send_time(timed.time)?;
        }
        self.sender.send(&timed.frame)?;
        self.unanswered += 1;
        self.sent.frames += 1;
        Ok(true)
    }

    /// Ends the log.
    ///
    /// # Errors
    /// Nobody answers that the last frame is read.
    pub fn end(mut self) -> Result<Sent> {
        if let (true, Some((_, last))) = (self.sends_time, self.sent.span) {
            self.ask(LogTime::End(last), NEXT_ANSWER)?;
        }
        Ok(self.sent)
    }

    fn wait_until(&self, due: Monotonic) -> bool {
        loop {
            if self.stop.load(Ordering::Relaxed) {
                return false;
            }
            let left = due.saturating_duration_since(Monotonic::now());
            if left.is_zero() {
                return true;
            }
            thread::sleep(left.min(NAP));
        }
    }

    /// Tells the time if it changed, and asks for an answer now and then.
    fn send_time(&mut self, time: Instant) -> Result<()> {
        if self.unanswered >= WINDOW {
            return self.ask(LogTime::Ready(time), NEXT_ANSWER);
        }
        if self.sent_time != Some(time) {
            self.sent_time = Some(time);
            self.sender.send(&self.frame(LogTime::Now(time))?)?;
            self.unanswered += 1;
        }
        Ok(())
    }

    /// Asks until the answer comes.
    fn ask(&mut self, question: LogTime, patience: Duration) -> Result<()> {
        let (LogTime::Now(time)
        | LogTime::Ready(time)
        | LogTime::Answer(time)
        | LogTime::End(time)) = question;
        let begun = Monotonic::now();
        let frame = self.frame(question)?;
        while begun.elapsed() < patience {
            if self.stop.load(Ordering::Relaxed) {
                return Ok(());
            }
            self.sender.send(&frame)?;
            let asked = Monotonic::now();
            while let Some(left) = ASK_AGAIN.checked_sub(asked.elapsed()) {
                let Some(answer) = self.sender.receive(left)? else {
                    continue;
                };
                if LogTime::read(&answer) == Some(LogTime::Answer(time)) {
                    self.sent_time = Some(time);
                    self.unanswered = 0;
                    return Ok(());
                }
            }
        }
        let problem = format!(
            "nobody answers for {} s; expected `roadgrade listen --can {} --log-time …` on the \
             same bus, before the replay begins",
            patience.as_secs(),
            self.name
        );
        Err(Error::content(Path::new(self.name), problem))
    }

    fn frame(&self, message: LogTime) -> Result<crate::source::can_frame::CanFrame> {
        message.frame().ok_or_else(|| {
            let problem = "the log's time is beyond the year 4253, which --log-time cannot tell";
            Error::content(Path::new(self.name), problem)
        })
    }
}
