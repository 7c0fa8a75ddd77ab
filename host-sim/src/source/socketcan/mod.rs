//! SocketCAN: Linux's CAN interfaces, `can0` or `vcan0`, as a source of frames and a place to send
//! them.
//!
//! [`FrameReceiver`] reads one or more interfaces in its own thread, so that a slow terminal or
//! disk loses no frame. It returns the frames in the order of the kernel's time stamps.
//! [`FrameSender`] sends. An interface that goes down or disappears is reported once and reopened
//! when it is back.

mod bus_event;
mod filter;
mod interface;
mod receiver;
mod sender;
mod steady_clock;

pub use bus_event::{BusEvent, of_error_frame};
pub use filter::{accepts, of_frames, of_group, wanted};
pub use interface::open_error;
pub use receiver::{FrameReceiver, Received, ReceivedItem};
pub use sender::FrameSender;
pub use steady_clock::{ClockReading, SteadyClock};
