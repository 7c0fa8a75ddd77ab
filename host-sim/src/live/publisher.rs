//! Publication of the estimate on the bus.

use super::status_timing::StatusTiming;
use crate::error::Result;
use crate::source::can_frame::CanFrame;
use crate::source::log_time::LogTime;
use crate::source::socketcan::FrameSender;
use embedded_can::{Frame, Id};
use estimator_core::roadmap::{HorizonParts, MapLive, NumberedPart};
use estimator_core::{Cell, Live, broadcast};
use std::time::{Duration, Instant as Monotonic};

/// Period of the published estimate.
const PERIOD: Duration = Duration::from_millis(100);
/// Time between two attempts to reopen a lost interface.
const RETRY: Duration = Duration::from_millis(500);

/// Sends on one interface. Frames that cannot be sent at once are dropped and counted, because a
/// late estimate is of no use.
#[derive(Debug)]
pub struct Publisher {
    name: String,
    sender: Option<FrameSender>,
    retry_at: Monotonic,
    /// Source address; `None` if the estimate is not published.
    address: Option<u8>,
    next: Monotonic,
    status: StatusTiming,
    newest_cell: Option<Cell>,
    ahead: HorizonParts<'static>,
    unsent: u64,
    /// Identifier of the published PCC1. Of what is published, it alone is also read.
    pcc1: Option<Id>,
}

impl Publisher {
    /// Opens an interface. The estimate is sent from `address`; with `None`, only acknowledgements
    /// are sent.
    ///
    /// # Errors
    /// Returns an error if the interface is missing or down. The message says what to do.
    pub fn open(name: &str, address: Option<u8>) -> Result<Self> {
        let now = Monotonic::now();
        Ok(Self {
            name: name.to_owned(),
            sender: Some(FrameSender::open(name, &[])?),
            retry_at: now,
            address,
            next: now,
            status: StatusTiming::default(),
            newest_cell: None,
            ahead: HorizonParts::new(),
            unsent: 0,
            pcc1: None,
        })
    }

    /// Sends these cells, and what is due of estimate, status, and, with a map, of PCC1 and the road
    /// ahead. `cells_suspect` is the core's counter.
    pub fn publish(
        &mut self,
        live: Option<&Live>,
        cells: &[Cell],
        cells_suspect: u32,
        map: Option<&MapLive<'static>>,
    ) {
        let Some(address) = self.address else {
            return;
        };
        for cell in cells {
            self.send(broadcast::cell(cell, address));
        }
        let now = Monotonic::now();
        if now >= self.next {
            // After a delay the period starts again from now; missed estimates are not sent.
            self.next = now.max(self.next + PERIOD);
            self.send(broadcast::live(live, address));
            if let (Some(map), Some(live)) = (map, live) {
                self.send_ahead(map, live, address);
            }
        }
        self.newest_cell = cells.last().copied().or(self.newest_cell);
        let newest = self.newest_cell;
        if self.status.is_due(now, live, newest.as_ref()) {
            let frame = broadcast::status(live, newest.as_ref(), cells_suspect, address);
            self.send(frame);
        }
    }

    fn send_ahead(&mut self, map: &MapLive<'static>, live: &Live, address: u8) {
        let parts: Vec<NumberedPart> = self.ahead.due_parts(map, live).collect();
        for part in parts {
            self.send(broadcast::ahead(&part, address));
        }
        let grade = live.estimate.grade_percent.value;
        let next = self.ahead.next_grade(live);
        let frame: Option<CanFrame> = broadcast::pcc1(Some(grade), next, address);
        self.pcc1 = frame.map(|frame| frame.id());
        self.send(frame);
    }

    /// Returns whether a received frame is one of these: the kernel hands them to other sockets.
    #[must_use]
    pub fn has_sent(&self, frame: &CanFrame) -> bool {
        self.pcc1.is_some_and(|id| frame.id() == id)
    }

    /// Returns the time until the next estimate is due; `None` if publishing is off.
    #[must_use]
    pub fn due_in(&self) -> Option<Duration> {
        let until = self.next.saturating_duration_since(Monotonic::now());
        self.address.map(|_| until)
    }

    /// Sends an acknowledgement to a replay.
    pub fn answer(&mut self, answer: LogTime) {
        self.send(answer.frame());
    }

    /// Returns the number of frames that could not be sent; `None` if publishing is off.
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
