//! Frames sent on an interface.

use super::interface::open_error;
use crate::error::{Error, Result};
use crate::source::can_frame::CanFrame;
use embedded_can::Frame;
use nix::libc;
use socketcan::{CanFrame as RawFrame, CanSocket, Socket, SocketOptions};
use std::io;
use std::path::Path;
use std::thread;
use std::time::{Duration, Instant as Monotonic};

/// Time between two attempts while the queue of the interface is full.
const RETRY: Duration = Duration::from_micros(500);
/// Timeout of a full queue: no node on the bus acknowledges.
const PATIENCE: Duration = Duration::from_secs(10);

/// An interface for sending. It does not receive its own frames.
#[derive(Debug)]
pub struct FrameSender {
    name: String,
    socket: CanSocket,
}

impl FrameSender {
    /// Opens an interface for sending, and for receiving the frames that pass `filters`.
    ///
    /// # Errors
    /// Returns an error if the interface is missing or down. The message says what to do.
    pub fn open(name: &str, filters: &[(u32, u32)]) -> Result<Self> {
        let open = || {
            let socket = CanSocket::open(name)?;
            socket.set_nonblocking(true)?;
            // Without filters nothing is received, so that nothing accumulates.
            socket.set_filters(filters)?;
            match socket.as_raw_socket().take_error()? {
                Some(error) => Err(error),
                None => Ok(socket),
            }
        };
        Ok(Self {
            name: name.to_owned(),
            socket: open().map_err(|error| open_error(name, &error))?,
        })
    }

    /// Sends a frame without waiting. Returns false if the queue is full.
    ///
    /// # Errors
    /// Returns the kernel's error: the interface is down or gone.
    pub fn try_send(&self, frame: &CanFrame) -> io::Result<bool> {
        let raw = if frame.is_remote_frame() {
            RawFrame::new_remote(frame.id(), frame.dlc())
        } else {
            RawFrame::new(frame.id(), frame.data())
        };
        let Some(raw) = raw else {
            return Err(io::ErrorKind::InvalidData.into());
        };
        match self.socket.write_frame(&raw) {
            Ok(()) => Ok(true),
            Err(error) => match error.raw_os_error() {
                Some(libc::ENOBUFS | libc::EAGAIN | libc::EINTR) => Ok(false),
                _ => Err(error),
            },
        }
    }

    /// Sends a frame, and waits while the interface's queue is full.
    ///
    /// # Errors
    /// Returns an error if the interface is down or gone, or accepts nothing for ten seconds.
    pub fn send(&self, frame: &CanFrame) -> Result<()> {
        let begun = Monotonic::now();
        loop {
            match self.try_send(frame) {
                Ok(true) => return Ok(()),
                Ok(false) if begun.elapsed() < PATIENCE => thread::sleep(RETRY),
                Ok(false) => {
                    let problem = "accepts no frame for 10 s; expected another node on the bus that \
                                   acknowledges, with the same bit rate";
                    return Err(Error::content(Path::new(&self.name), problem));
                }
                Err(error) => return Err(open_error(&self.name, &error)),
            }
        }
    }

    /// Receives a frame; `None` if none arrives within `patience`.
    ///
    /// # Errors
    /// Returns an error if the interface is down or gone.
    pub fn receive(&self, patience: Duration) -> Result<Option<CanFrame>> {
        match self.socket.read_frame_timeout(patience) {
            Ok(frame) => Ok(CanFrame::new(frame.id(), frame.data())),
            Err(error) => match (error.kind(), error.raw_os_error()) {
                (io::ErrorKind::TimedOut | io::ErrorKind::Interrupted, _)
                | (_, Some(libc::EAGAIN)) => Ok(None),
                _ => Err(open_error(&self.name, &error)),
            },
        }
    }
}
