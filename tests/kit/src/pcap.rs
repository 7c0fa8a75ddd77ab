//! A writer of packet captures with frames of SocketCAN, in every form that readers must know.

use crate::mdf::MdfFrame;

/// Bit of an identifier with 29 bits.
const EXTENDED: u32 = 1 << 31;
/// Protocol of a classic frame in a cooked capture.
const CLASSIC: u16 = 0x000c;

/// The link types of frames.
pub const SOCKET_CAN: u16 = 227;
/// Linux cooked capture.
pub const COOKED: u16 = 113;
/// Linux cooked capture, version 2.
pub const COOKED_2: u16 = 276;

/// The form of a capture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PcapForm {
    /// pcap.
    Records {
        /// Whether the fractions of the seconds are nanoseconds.
        is_nano: bool,
    },
    /// pcapng.
    Blocks {
        /// The option `if_tsresol`.
        resolution: u8,
        /// The option `if_tsoffset`, s.
        offset_s: i64,
    },
}

/// A writer of a capture.
#[derive(Clone, Copy, Debug)]
pub struct Pcap {
    /// Its form.
    pub form: PcapForm,
    /// Its byte order.
    pub is_big_endian: bool,
    /// What the packets begin with.
    pub link: u16,
}

/// The forms.
#[must_use]
pub fn pcap_forms() -> Vec<Pcap> {
    let blocks = |resolution, offset_s| PcapForm::Blocks {
        resolution,
        offset_s,
    };
    let forms = [
        PcapForm::Records { is_nano: false },
        PcapForm::Records { is_nano: true },
        blocks(6, 0),
        blocks(9, 0),
        blocks(0x80 | 30, 0),
        blocks(6, -1_000),
    ];
    let mut all = Vec::new();
    for form in forms {
        for is_big_endian in [false, true] {
            for link in [SOCKET_CAN, COOKED, COOKED_2] {
                all.push(Pcap {
                    form,
                    is_big_endian,
                    link,
                });
            }
        }
    }
    all
}

impl Pcap {
    fn u16(&self, number: u16) -> [u8; 2] {
        if self.is_big_endian {
            number.to_be_bytes()
        } else {
            number.to_le_bytes()
        }
    }

    fn u32(&self, number: u32) -> [u8; 4] {
        if self.is_big_endian {
            number.to_be_bytes()
        } else {
            number.to_le_bytes()
        }
    }

    fn words(&self, numbers: &[u32]) -> Vec<u8> {
        numbers
            .iter()
            .flat_map(|number| self.u32(*number))
            .collect()
    }

    /// Returns a capture of frames; those of bus n in pcapng are of the interface `cann`.
    #[must_use]
    pub fn file(&self, frames: &[MdfFrame]) -> Vec<u8> {
        let mut file = self.header();
        for frame in frames {
            file.extend(self.record(frame.micros, frame.bus, &self.packet(frame)));
        }
        file
    }

    /// Returns what stands before the packets. A capture in pcapng has the interfaces can1 and can2.
    #[must_use]
    pub fn header(&self) -> Vec<u8> {
        let PcapForm::Blocks {
            resolution,
            offset_s,
        } = self.form
        else {
            let is_nano = self.form == PcapForm::Records { is_nano: true };
            let magic = if is_nano { 0xa1b2_3c4d } else { 0xa1b2_c3d4 };
            let version = [self.u16(2), self.u16(4)].concat();
            let rest = self.words(&[0, 0, 262_144, u32::from(self.link)]);
            return [self.u32(magic).to_vec(), version, rest].concat();
        };
        let section = [
            self.words(&[0x1a2b_3c4d]),
            [self.u16(1), self.u16(0)].concat(),
            vec![0xff; 8],
        ];
        let mut file = self.block(0x0a0d_0d0a, &section.concat());
        for name in [b"can1", b"can2"] {
            let offset = if self.is_big_endian {
                offset_s.to_be_bytes()
            } else {
                offset_s.to_le_bytes()
            };
            let option = |code: u16, value: &[u8]| {
                let head = [self.u16(code), self.u16(value.len() as u16)].concat();
                let padding = vec![0; value.len().next_multiple_of(4) - value.len()];
                [head, value.to_vec(), padding].concat()
            };
            let described = [
                [self.u16(self.link), self.u16(0)].concat(),
                self.words(&[262_144]),
                option(2, name),
                option(9, &[resolution]),
                option(14, &offset),
                option(0, &[]),
            ];
            file.extend(self.block(1, &described.concat()));
        }
        file
    }

    /// Returns a block of pcapng.
    #[must_use]
    pub fn block(&self, kind: u32, content: &[u8]) -> Vec<u8> {
        let length = content.len() as u32 + 12;
        let head = self.words(&[kind, length]);
        [&head[..], content, &self.u32(length)].concat()
    }

    /// Returns the packet of a frame.
    #[must_use]
    pub fn packet(&self, frame: &MdfFrame) -> Vec<u8> {
        let mark = if frame.is_extended { EXTENDED } else { 0 };
        self.packet_of(
            frame.id | mark,
            CLASSIC,
            frame.data.len() as u8,
            0,
            &frame.data,
        )
    }

    /// Returns the packet of a frame with these marks.
    #[must_use]
    pub fn packet_of(&self, id: u32, protocol: u16, length: u8, flags: u8, data: &[u8]) -> Vec<u8> {
        let protocol = protocol.to_be_bytes();
        let (header, id) = match self.link {
            COOKED => {
                let header = [0, 1, 1, 0x18, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0];
                ([&header[..], &protocol].concat(), self.u32(id))
            }
            COOKED_2 => {
                let header = [0, 0, 0, 0, 0, 3, 1, 0x18, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0];
                ([&protocol[..], &header].concat(), self.u32(id))
            }
            _ => (Vec::new(), id.to_be_bytes()),
        };
        [&header[..], &id, &[length, flags, 0, 0], data].concat()
    }

    /// Returns a packet with its header.
    #[must_use]
    pub fn record(&self, micros: u64, bus: u8, packet: &[u8]) -> Vec<u8> {
        let length = packet.len() as u32;
        match self.form {
            PcapForm::Records { is_nano } => {
                let parts = if is_nano { 1000 } else { 1 };
                let (seconds, fraction) = (micros / 1_000_000, micros % 1_000_000 * parts);
                let head = self.words(&[seconds as u32, fraction as u32, length, length]);
                [&head[..], packet].concat()
            }
            PcapForm::Blocks {
                resolution,
                offset_s,
            } => {
                let units = match resolution {
                    power if power & 0x80 == 0 => 10_u128.pow(power.into()),
                    power => 1 << (power & 0x7f),
                };
                let micros = i128::from(micros) - i128::from(offset_s) * 1_000_000;
                // Rounded up, so that a reader that cuts gets the same microseconds.
                let time = (micros.unsigned_abs() * units).div_ceil(1_000_000) as u64;
                let (high, low) = ((time >> 32) as u32, time as u32);
                let head = self.words(&[u32::from(bus - 1), high, low, length, length]);
                let padding = vec![0; packet.len().next_multiple_of(4) - packet.len()];
                self.block(6, &[&head[..], packet, &padding].concat())
            }
        }
    }
}
