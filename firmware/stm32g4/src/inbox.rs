//! The queue from the interrupts to the estimator, in the order of arrival.

use core::cell::RefCell;
use core::sync::atomic::{AtomicU32, Ordering};
use embassy_stm32::can::Frame;
use embassy_sync::blocking_mutex::CriticalSectionMutex;
use embassy_sync::blocking_mutex::raw::CriticalSectionRawMutex;
use embassy_sync::signal::Signal;
use estimator_core::{Instant, Reading};
use heapless::spsc::{Consumer, Producer, Queue};
use static_cell::StaticCell;

/// Capacity: 60 ms of a full bus of 500 kbit/s, which is longer than a block of the lag takes.
const SIZE: usize = 256;

/// An input of the estimator and its time of arrival.
pub enum InboxItem {
    /// A frame from a bus.
    Frame(Instant, Frame),
    /// A reading from a serial line.
    #[cfg_attr(
        not(feature = "gnss-serial"),
        expect(dead_code, reason = "no serial line")
    )]
    Reading(Instant, Reading),
}

/// The end of the queue for the receiving tasks.
pub struct InboxSender {
    // Several tasks send, one at a time: they share a priority.
    queue: CriticalSectionMutex<RefCell<Producer<'static, InboxItem>>>,
    arrived: Signal<CriticalSectionRawMutex, ()>,
    lost: AtomicU32,
}

/// The end of the queue for the estimator.
pub struct InboxReceiver {
    queue: Consumer<'static, InboxItem>,
    sender: &'static InboxSender,
}

/// Creates the queue.
///
/// # Panics
/// Panics when called twice.
pub fn open() -> (&'static InboxSender, InboxReceiver) {
    static QUEUE: StaticCell<Queue<InboxItem, SIZE>> = StaticCell::new();
    static SENDER: StaticCell<InboxSender> = StaticCell::new();
    let (producer, consumer) = QUEUE.init(Queue::new()).split();
    let sender: &'static InboxSender = SENDER.init(InboxSender {
        queue: CriticalSectionMutex::new(RefCell::new(producer)),
        arrived: Signal::new(),
        lost: AtomicU32::new(0),
    });
    let receiver = InboxReceiver {
        queue: consumer,
        sender,
    };
    (sender, receiver)
}

impl InboxSender {
    /// Puts an item into the queue. Counts it as lost if the queue is full.
    pub fn put(&self, input: InboxItem) {
        let full = self
            .queue
            .lock(|queue| queue.borrow_mut().enqueue(input).is_err());
        if full {
            let lost = self.lost.load(Ordering::Relaxed);
            self.lost.store(lost.saturating_add(1), Ordering::Relaxed);
        }
        self.arrived.signal(());
    }
}

impl InboxReceiver {
    /// Waits until an item has arrived since the last wait.
    pub async fn arrived(&self) {
        self.sender.arrived.wait().await;
    }

    /// Takes the oldest item.
    pub fn take(&mut self) -> Option<InboxItem> {
        self.queue.dequeue()
    }

    /// Returns the number of lost items.
    pub fn lost(&self) -> u32 {
        self.sender.lost.load(Ordering::Relaxed)
    }
}
