//! One CAN interface: opened, read, lost and reopened.

use super::bus_event::{BusEvent, of_error_frame};
use crate::error::Error;
use crate::source::can_frame::CanFrame;
use embedded_can::Frame;
use nix::libc;
use socketcan::{CanFrame as RawFrame, CanSocket, Socket, SocketOptions};
use std::io;
use std::os::fd::{AsFd, BorrowedFd};
use std::path::Path;
use std::time::{Duration, Instant as Monotonic, SystemTime};

/// Size of the receive buffer, bytes: some ten seconds of a full bus at 500 kbit/s. Without the
/// privilege for it, the kernel gives what `net.core.rmem_max` allows.
const RECEIVE_BUFFER_BYTES: i32 = 32 << 20;
/// Time between two attempts to reopen a lost interface.
const RETRY: Duration = Duration::from_millis(200);
/// Socket option for memory statistics (asm-generic/socket.h): 32-bit words, of which number
/// [`libc::SK_MEMINFO_DROPS`] counts the frames dropped since the socket was opened. `SO_RXQ_OVFL`
/// has the same count, but only with the next frame, so never after the last one.
const SO_MEMINFO: i32 = 55;
const MEMINFO_WORDS: usize = 9;

/// A CAN interface for reading.
#[derive(Debug)]
pub(super) struct Interface {
    name: String,
    filters: Vec<(u32, u32)>,
    state: LinkState,
    drops_reported: u32,
}

#[derive(Debug)]
enum LinkState {
    Up(CanSocket),
    Lost { retry_at: Monotonic, is_gone: bool },
}

/// The result of a read.
#[derive(Debug)]
pub(super) enum Read {
    Frame(CanFrame, SystemTime),
    Events(Vec<BusEvent>),
    Nothing,
}

impl Interface {
    /// Opens an interface, which must exist and be up, for frames that pass `filters`.
    pub(super) fn open(name: &str, filters: &[(u32, u32)]) -> Result<Self, Error> {
        let socket = open(name, filters).map_err(|error| open_error(name, &error))?;
        Ok(Self {
            name: name.to_owned(),
            filters: filters.to_owned(),
            state: LinkState::Up(socket),
            drops_reported: 0,
        })
    }

    /// Returns the file descriptor to wait on, while the interface is up.
    pub(super) fn descriptor(&self) -> Option<BorrowedFd<'_>> {
        match &self.state {
            LinkState::Up(socket) => Some(socket.as_fd()),
            LinkState::Lost { .. } => None,
        }
    }

    /// Reads an available item without waiting.
    pub(super) fn read(&mut self) -> Read {
        let LinkState::Up(socket) = &self.state else {
            return Read::Nothing;
        };
        match socket.read_frame_with_timestamps() {
            Ok((RawFrame::Error(report), _)) => Read::Events(of_error_frame(&report)),
            Ok((frame, stamps)) => {
                let stamp = stamps.socket.unwrap_or_else(SystemTime::now);
                let frame = match &frame {
                    RawFrame::Remote(frame) => CanFrame::new_remote(frame.id(), frame.dlc()),
                    frame => CanFrame::new(frame.id(), frame.data()),
                };
                frame.map_or(Read::Nothing, |frame| Read::Frame(frame, stamp))
            }
            Err(error) => match error.raw_os_error() {
                // A frame without a code is not from the kernel: it is of another kind.
                Some(libc::EAGAIN | libc::EINTR) | None => Read::Nothing,
                Some(libc::ENETDOWN) => self.lose(BusEvent::InterfaceDown),
                _ => self.lose(BusEvent::InterfaceGone),
            },
        }
    }

    /// Returns the number of frames that the kernel dropped since the last call, because they were
    /// not read fast enough.
    pub(super) fn dropped(&mut self) -> u32 {
        let LinkState::Up(socket) = &self.state else {
            return 0;
        };
        let mut words = [0; 4 * MEMINFO_WORDS];
        let option = socket.get_socket_option_bytes(libc::SOL_SOCKET, SO_MEMINFO, &mut words);
        let drops = &words[4 * libc::SK_MEMINFO_DROPS as usize..];
        match (option, drops.first_chunk()) {
            (Ok(length), Some(drops)) if length == words.len() => {
                let drops = u32::from_ne_bytes(*drops);
                drops.wrapping_sub(std::mem::replace(&mut self.drops_reported, drops))
            }
            // Kernels before 4.12.
            _ => 0,
        }
    }

    /// Tries to reopen a lost interface from time to time. Returns an event when its state changes.
    pub(super) fn try_reopen(&mut self, now: Monotonic) -> Option<BusEvent> {
        let LinkState::Lost { retry_at, is_gone } = &mut self.state else {
            return None;
        };
        if now < *retry_at {
            return None;
        }
        *retry_at = now + RETRY;
        match open(&self.name, &self.filters) {
            Ok(socket) => {
                self.state = LinkState::Up(socket);
                self.drops_reported = 0;
                Some(BusEvent::InterfaceBack)
            }
            // An interface is set down before it is removed.
            Err(error) if error.raw_os_error() == Some(libc::ENODEV) && !*is_gone => {
                *is_gone = true;
                Some(BusEvent::InterfaceGone)
            }
            Err(_) => None,
        }
    }

    fn lose(&mut self, event: BusEvent) -> Read {
        self.state = LinkState::Lost {
            retry_at: Monotonic::now(),
            is_gone: event == BusEvent::InterfaceGone,
        };
        Read::Events(vec![event])
    }
}

fn open(name: &str, filters: &[(u32, u32)]) -> io::Result<CanSocket> {
    let socket = CanSocket::open(name)?;
    socket.set_nonblocking(true)?;
    socket.set_filters(filters)?;
    socket.set_error_filter_accept_all()?;
    socket.set_recv_timestamp(true)?;
    let force = libc::SO_RCVBUFFORCE;
    socket
        .set_socket_option_int(libc::SOL_SOCKET, force, RECEIVE_BUFFER_BYTES)
        .or_else(|_| {
            let size = RECEIVE_BUFFER_BYTES as usize;
            socket.as_raw_socket().set_recv_buffer_size(size)
        })?;
    // A socket bound to an interface that is down has this as a pending error.
    match socket.as_raw_socket().take_error()? {
        Some(error) => Err(error),
        None => Ok(socket),
    }
}

/// Returns the error of an interface that cannot be opened, with what to do.
#[must_use]
pub fn open_error(name: &str, error: &io::Error) -> Error {
    let advice = match error.raw_os_error() {
        Some(libc::EAFNOSUPPORT | libc::EPROTONOSUPPORT) => {
            "this kernel has no CAN; expected the modules can and can-raw (modprobe can-raw)"
                .to_owned()
        }
        Some(libc::ENODEV) => format!(
            "no CAN interface of this name; `ip -brief link` lists the interfaces, and `ip link \
             add dev {name} type vcan && ip link set {name} up` makes a virtual one"
        ),
        Some(libc::ENETDOWN) => format!(
            "the interface is down; `ip link set {name} up` starts a virtual one, `ip link set \
             {name} up type can bitrate 250000` one of a J1939 bus"
        ),
        _ => error.to_string(),
    };
    Error::content(Path::new(name), advice)
}
