//! Replay of a recorded log on an interface, at the log's times or faster.

use crate::error::{Error, Result};
use crate::source::can_frame::TimedFrame;
use crate::source::log_time::LogTime;
use crate::source::socketcan::FrameSender;
use estimator_core::Instant;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::{Duration, Instant as Monotonic};

/// Frames sent before the listener is asked for an acknowledgement. A socket with Linux's default
/// buffer holds some 250 frames.
const WINDOW: usize = 100;
/// Timeouts of the first acknowledgement and of each later one.
const FIRST_ANSWER: Duration = Duration::from_secs(10);
const NEXT_ANSWER: Duration = Duration::from_secs(10);
/// Time between two requests for the same acknowledgement.
const ASK_AGAIN: Duration = Duration::from_millis(100);
/// Longest sleep between two checks of the stop flag.
const NAP: Duration = Duration::from_millis(100);

/// Replay speed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Pace {
    /// Faster than the log by this factor.
    Times(f64),
    /// As fast as the interface accepts frames.
    Max,
}

/// Summary of a replay.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sent {
    /// Number of frames of the log that were sent.
    pub frames: u64,
    /// First and last time stamp of these frames.
    pub span: Option<(Instant, Instant)>,
    /// Largest delay of a frame.
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
    /// Number of frames sent since the last acknowledgement.
    unanswered: usize,
    sent_time: Option<Instant>,
    sent: Sent,
}

impl<'a> Replay<'a> {
    /// Creates a replay on an interface. With `sends_time` the log's time stamps are sent too, to a
    /// listener that acknowledges.
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

    /// Sends one frame when it is due. Returns false if the stop flag is set.
    ///
    /// # Errors
    /// Returns an error if the interface is down, gone or accepts no frame, or if no listener
    /// acknowledges.
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

    /// Ends the replay and returns its summary.
    ///
    /// # Errors
    /// Returns an error if no listener acknowledges the last frame.
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

    /// Sends the time stamp if it changed, and asks for an acknowledgement every [`WINDOW`] frames.
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

    /// Asks until the acknowledgement arrives.
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
            "no acknowledgement for {} s; start `roadgrade listen --can {} --log-time …` on the \
             same bus before the replay",
            patience.as_secs(),
            self.name
        );
        Err(Error::content(Path::new(self.name), problem))
    }

    fn frame(&self, message: LogTime) -> Result<crate::source::can_frame::CanFrame> {
        message.frame().ok_or_else(|| {
            let problem = "the time of the log is beyond the year 4253, the limit of --log-time";
            Error::content(Path::new(self.name), problem)
        })
    }
}
