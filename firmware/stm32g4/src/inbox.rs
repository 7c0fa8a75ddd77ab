//! From interrupts to the estimator: one queue for all that arrives, in the order in which it did.

use core::cell::RefCell;
use core::sync::atomic::{AtomicU32, Ordering};
use embassy_stm32::can::Frame;
use embassy_sync::blocking_mutex::CriticalSectionMutex;
use embassy_sync::blocking_mutex::raw::CriticalSectionRawMutex;
use embassy_sync::signal::Signal;
use estimator_core::{Instant, Reading};
use heapless::spsc::{Consumer, Producer, Queue};
use static_cell::StaticCell;

/// What fits: 60 ms of a full bus of 500 kbit/s, which is longer than a block of the lag takes.
const SIZE: usize = 256;

/// Something for the estimator, and when it arrived.
pub enum InboxItem {
    /// Off a bus.
    Frame(Instant, Frame),
    /// Off a serial line.
    #[cfg_attr(
        not(feature = "gnss-serial"),
        expect(dead_code, reason = "no serial line")
    )]
    Reading(Instant, Reading),
}

/// Where receiving tasks put what arrived.
pub struct InboxSender {
    // Several tasks put in, one at a time: they share a priority.
    queue: CriticalSectionMutex<RefCell<Producer<'static, InboxItem>>>,
    arrived: Signal<CriticalSectionRawMutex, ()>,
    lost: AtomicU32,
}

/// Where the estimator takes it out.
pub struct InboxReceiver {
    queue: Consumer<'static, InboxItem>,
    sender: &'static InboxSender,
}

/// Makes the queue; once.
///
/// # Panics
/// When called twice.
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
    /// Puts one in; it is counted as lost if the queue is full.
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
    /// Waits until something has arrived since the last wait.
    pub async fn arrived(&self) {
        self.sender.arrived.wait().await;
    }

    /// Takes the oldest out.
    pub fn take(&mut self) -> Option<InboxItem> {
        self.queue.dequeue()
    }

    /// Returns how many found the queue full.
    pub fn lost(&self) -> u32 {
        self.sender.lost.load(Ordering::Relaxed)
    }
}
