//! The estimate, sent to whoever else is on the bus.

use crate::error::Result;
use crate::source::can_frame::CanFrame;
use crate::source::log_time::LogTime;
use crate::source::socketcan::FrameSender;
use estimator_core::{Cell, Live, broadcast};
use std::time::{Duration, Instant as Monotonic};

/// Ten times a second.
const PERIOD: Duration = Duration::from_millis(100);
/// Between two attempts to open an interface that was lost.
const RETRY: Duration = Duration::from_millis(500);

/// Sends on one interface. What cannot be sent now is not worth sending later, and is counted.
#[derive(Debug)]
pub struct Publisher {
    name: String,
    sender: Option<FrameSender>,
    retry_at: Monotonic,
    /// Our address, if the estimate is to be sent.
    address: Option<u8>,
    next: Monotonic,
    unsent: u64,
}

impl Publisher {
    /// Opens an interface. The estimate is sent from `address`; without one, answers only.
    ///
    /// # Errors
    /// An interface that is not there or not up, with what to do about it.
    pub fn open(name: &str, address: Option<u8>) -> Result<Self> {
        let now = Monotonic::now();
        Ok(Self {
            name: name.to_owned(),
            sender: Some(FrameSender::open(name, &[])?),
            retry_at: now,
            address,
            next: now,
            unsent: 0,
        })
    }

    /// Sends these cells, and the estimate if it is time.
    pub fn publish(&mut self, live: Option<&Live>, cells: &[Cell]) {
        let Some(address) = self.address else {
            return;
        };
        for cell in cells {
            self.send(broadcast::cell(cell, address));
        }
        let now = Monotonic::now();
        if now >= self.next {
            // After a delay the beat goes on from now, without catching up.
            self.next = now.max(self.next + PERIOD);
            self.send(broadcast::live(live, address));
        }
    }

    /// Until the estimate is to be sent again.
    #[must_use]
    pub fn due_in(&self) -> Option<Duration> {
        let until = self.next.saturating_duration_since(Monotonic::now());
        self.address.map(|_| until)
    }

    /// Sends an answer to a replay.
    pub fn answer(&mut self, answer: LogTime) {
        self.send(answer.frame());
    }

    /// Frames of the estimate that could not be sent; `None` if none are to be.
    #[must_use]
    pub fn unsent(&self) -> Option<u64> {
        self.address.map(|_| self.unsent)
    }

    fn send(&mut self, frame: Option<CanFrame>) {
        let is_sent = frame.is_some_and(|frame| self.try_send(&frame));
        self.unsent += u64::from(!is_sent);
    }

    fn try_send(&mut self, frame: &CanFrame) -> bool {
        if self.sender.is_none() && Monotonic::now() >= self.retry_at {
            self.sender = FrameSender::open(&self.name, &[]).ok();
            self.retry_at = Monotonic::now() + RETRY;
        }
        let sent = self.sender.as_ref().map(|sender| sender.try_send(frame));
        if let Some(Err(_)) = sent {
            self.sender = None;
        }
        matches!(sent, Some(Ok(true)))
    }
}
