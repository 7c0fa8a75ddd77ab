//! Interfaces read in a thread of their own and merged by time.

use super::bus_event::BusEvent;
use super::interface::{Interface, Read};
use super::steady_clock::{ClockReading, SteadyClock};
use crate::error::{Error, Result};
use crate::source::can_frame::{CanFrame, TimedFrame};
use estimator_core::{Duration as Span, Instant};
use nix::poll::{PollFd, PollFlags, poll};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver as Channel, RecvTimeoutError, SyncSender, sync_channel};
use std::thread;
use std::time::{Duration, Instant as Monotonic, SystemTime};

/// An item received from an interface.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Received {
    /// Index of the interface, in the order of the command line.
    pub interface: usize,
    /// Time; for frames the kernel's time stamp.
    pub time: Instant,
    /// The item.
    pub item: ReceivedItem,
}

/// A frame, an event or a loss.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ReceivedItem {
    /// A frame.
    Frame(CanFrame),
    /// An event of the bus.
    Event(BusEvent),
    /// This number of frames was lost, because they were not read fast enough.
    Dropped(u32),
}

impl Received {
    /// Returns the frame; `None` for other items.
    #[must_use]
    pub fn frame(&self) -> Option<TimedFrame> {
        match self.item {
            ReceivedItem::Frame(frame) => Some(TimedFrame {
                time: self.time,
                frame,
            }),
            _ => None,
        }
    }
}

/// Maximum number of frames read from one interface before the next one is read.
const BATCH: usize = 4096;
/// Capacity of the queue, in batches: millions of frames, minutes of a full bus.
const WAITING: usize = 4096;
/// Longest wait for a frame before lost interfaces and the stop flag are checked.
const WAIT_MILLIS: u16 = 50;
/// Time that a frame is held for older frames of other interfaces.
const MERGE: Span = Span::from_millis(2);

/// The receiving end of the thread.
#[derive(Debug)]
pub struct FrameReceiver {
    batches: Channel<Vec<Received>>,
}

impl FrameReceiver {
    /// Opens the interfaces and reads the frames that pass `filters` until `stop` is set.
    ///
    /// # Errors
    /// Returns an error if an interface is missing or down. The message says what to do.
    pub fn start(names: &[String], filters: &[(u32, u32)], stop: Arc<AtomicBool>) -> Result<Self> {
        let interfaces = names
            .iter()
            .map(|name| Interface::open(name, filters))
            .collect::<Result<_>>()?;
        let (sink, batches) = sync_channel(WAITING);
        let reading = ReceiveThread {
            interfaces,
            clock: SteadyClock::new(ClockReading::now()),
            held: Vec::new(),
            newest: Instant::ZERO,
        };
        thread::Builder::new()
            .name("can".to_owned())
            .spawn(move || reading.run(&sink, &stop))
            .map_err(Error::io(Path::new("reading thread")))?;
        Ok(Self { batches })
    }

    /// Returns the next items in order of time; the list is empty if none arrives within
    /// `patience`. Returns `None` after the stop flag is set and all items are returned.
    #[must_use]
    pub fn next(&self, patience: Duration) -> Option<Vec<Received>> {
        match self.batches.recv_timeout(patience) {
            Ok(stretch) => Some(stretch),
            Err(RecvTimeoutError::Timeout) => Some(Vec::new()),
            Err(RecvTimeoutError::Disconnected) => None,
        }
    }
}

struct ReceiveThread {
    interfaces: Vec<Interface>,
    clock: SteadyClock,
    /// Items that were read, but perhaps not yet in order.
    held: Vec<Received>,
    newest: Instant,
}

impl ReceiveThread {
    fn run(mut self, sink: &SyncSender<Vec<Received>>, stop: &AtomicBool) {
        while !stop.load(Ordering::Relaxed) {
            self.wait();
            let complete_to = self.read();
            let stretch = self.in_order(complete_to);
            if !stretch.is_empty() && sink.send(stretch).is_err() {
                return;
            }
        }
        // The sockets may still hold frames from before the stop.
        let stopped = self.clock.time(SystemTime::now(), Monotonic::now());
        while self.read() < stopped {}
        let rest = self.in_order(Instant::from_micros(u64::MAX));
        // The receiving end may be dropped already.
        let _ = sink.send(rest);
    }

    /// Waits for a frame.
    fn wait(&self) {
        let wait = if self.held.is_empty() {
            WAIT_MILLIS
        } else {
            MERGE.micros().div_ceil(1000) as u16
        };
        let mut descriptors: Vec<PollFd> = self
            .interfaces
            .iter()
            .filter_map(Interface::descriptor)
            .map(|descriptor| PollFd::new(descriptor, PollFlags::POLLIN))
            .collect();
        // A signal ends the wait early; no other error can occur.
        let _ = poll(&mut descriptors, wait);
    }

    /// Reads all frames that are available. Returns the time up to which no frame is missing.
    fn read(&mut self) -> Instant {
        let clocks = ClockReading::now();
        let now = self.clock.time(clocks.of_day, clocks.monotonic);
        let mut complete_to = now;
        if self.clock.check(clocks) {
            let event = ReceivedItem::Event(BusEvent::ClockSet);
            self.held
                .extend((0..self.interfaces.len()).map(|interface| Received {
                    interface,
                    time: now,
                    item: event,
                }));
        }
        for (number, interface) in self.interfaces.iter_mut().enumerate() {
            let mut newest = now;
            let mut push = |time, item| {
                self.held.push(Received {
                    interface: number,
                    time,
                    item,
                });
            };
            if let Some(event) = interface.try_reopen(clocks.monotonic) {
                push(now, ReceivedItem::Event(event));
            }
            let mut left = BATCH;
            while left > 0 {
                left -= 1;
                match interface.read() {
                    Read::Frame(frame, stamp) => {
                        newest = self.clock.time(stamp, Monotonic::now());
                        push(newest, ReceivedItem::Frame(frame));
                    }
                    Read::Events(events) => {
                        for event in events {
                            push(newest, ReceivedItem::Event(event));
                        }
                    }
                    Read::Nothing => break,
                }
            }
            if left == 0 {
                complete_to = complete_to.min(newest);
            }
            match interface.dropped() {
                0 => {}
                dropped => push(newest, ReceivedItem::Dropped(dropped)),
            }
        }
        complete_to
    }

    /// Returns the items that no older item can precede; with a single interface these are all
    /// items.
    fn in_order(&mut self, complete_to: Instant) -> Vec<Received> {
        let mut ready = if self.interfaces.len() == 1 {
            std::mem::take(&mut self.held)
        } else {
            self.held.sort_by_key(|received| received.time);
            let is_ready = |received: &Received| received.time <= complete_to - MERGE;
            let count = self.held.partition_point(is_ready);
            self.held.drain(..count).collect()
        };
        // A stamp may be wrong at the moment when the clock is set.
        for received in &mut ready {
            self.newest = self.newest.max(received.time);
            received.time = self.newest;
        }
        ready
    }
}
