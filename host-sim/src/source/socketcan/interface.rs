//! One CAN interface: opened, read, lost and found again.

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

/// Memory for frames that wait to be read, bytes: some ten seconds of a full bus of 500 kbit/s.
/// Without the right to more, the kernel gives what `net.core.rmem_max` allows.
const RECEIVE_BUFFER_BYTES: i32 = 32 << 20;
/// Between two looks whether a lost interface is back.
const RETRY: Duration = Duration::from_millis(200);
/// Option that tells about a socket's memory (asm-generic/socket.h): 32-bit words, of which number
/// [`libc::SK_MEMINFO_DROPS`] counts the frames dropped since the socket was opened. The count of
/// `SO_RXQ_OVFL` is the same, but comes only with the next frame, and so never after the last.
const SO_MEMINFO: i32 = 55;
const MEMINFO_WORDS: usize = 9;

/// A CAN interface that is read from.
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

/// What reading gave.
#[derive(Debug)]
pub(super) enum Read {
    Frame(CanFrame, SystemTime),
    Events(Vec<BusEvent>),
    Nothing,
}

impl Interface {
    /// Opens an interface, which must be there and up, for what passes `filters`.
    pub(super) fn open(name: &str, filters: &[(u32, u32)]) -> Result<Self, Error> {
        let socket = open(name, filters).map_err(|error| open_error(name, &error))?;
        Ok(Self {
            name: name.to_owned(),
            filters: filters.to_owned(),
            state: LinkState::Up(socket),
            drops_reported: 0,
        })
    }

    /// What to wait on, while it is up.
    pub(super) fn descriptor(&self) -> Option<BorrowedFd<'_>> {
        match &self.state {
            LinkState::Up(socket) => Some(socket.as_fd()),
            LinkState::Lost { .. } => None,
        }
    }

    /// Reads what is there, without waiting.
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
                // Without a code it is not the kernel's: a frame of another kind.
                Some(libc::EAGAIN | libc::EINTR) | None => Read::Nothing,
                Some(libc::ENETDOWN) => self.lose(BusEvent::InterfaceDown),
                _ => self.lose(BusEvent::InterfaceGone),
            },
        }
    }

    /// Frames that the kernel had to drop since the last question, because they were not read fast
    /// enough.
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

    /// Looks now and then whether a lost interface is back; tells what it finds, once.
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
            // What is removed is set down first.
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
    // Bound to an interface that is down, a socket has that as an error to tell.
    match socket.as_raw_socket().take_error()? {
        Some(error) => Err(error),
        None => Ok(socket),
    }
}

/// Why an interface could not be opened, and what to do about it.
#[must_use]
pub fn open_error(name: &str, error: &io::Error) -> Error {
    let advice = match error.raw_os_error() {
        Some(libc::EAFNOSUPPORT | libc::EPROTONOSUPPORT) => {
            "this kernel has no CAN; expected the modules can and can-raw (modprobe can-raw)"
                .to_owned()
        }
        Some(libc::ENODEV) => format!(
            "no CAN interface of that name; `ip -brief link` lists those there are, and `ip link \
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
