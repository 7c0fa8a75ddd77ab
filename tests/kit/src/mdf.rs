//! A writer of small ASAM MDF 4 files with frames of a bus, in every form that readers must know.

use flate2::Compression;
use flate2::write::ZlibEncoder;
use lz4_flex::frame::FrameEncoder;
use ruzstd::encoding::{CompressionLevel, compress_to_vec};
use std::io::Write;

/// Bytes of the identification and of the header block.
const START_BYTES: usize = 64 + 104;
/// Bytes of a record: time, bus, identifier, its kind, length, data or their offset.
const RECORD_BYTES: usize = 23;
/// Types of channels: of fixed length, of variable length, time.
const FIXED: u8 = 0;
const VARIABLE: u8 = 1;
const MASTER: u8 = 2;
/// Types of data: unsigned number, number in floating point, bytes.
const UNSIGNED: u8 = 0;
const REAL: u8 = 4;
const BYTES: u8 = 10;

/// A frame to write.
#[derive(Clone, Debug)]
pub struct MdfFrame {
    /// Time since the start, µs.
    pub micros: u64,
    /// Number of the bus, from 1.
    pub bus: u8,
    /// The raw identifier.
    pub id: u32,
    /// Whether it has 29 bits.
    pub is_extended: bool,
    /// The data.
    pub data: Vec<u8>,
}

/// How the records are stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MdfBlocks {
    /// One plain block.
    Plain,
    /// One plain block without its length, as in a file that is not finished.
    Unfinished,
    /// A list of plain blocks; records begin in one and end in the next.
    List,
    /// A list of compressed blocks.
    Deflated,
    /// A list of compressed blocks, transposed.
    Transposed,
    /// A list of blocks compressed by Zstandard (MDF 4.3).
    Zstd,
    /// The same, transposed.
    ZstdTransposed,
    /// A list of blocks compressed by LZ4 (MDF 4.3).
    Lz4,
    /// The same, transposed.
    Lz4Transposed,
}

impl MdfBlocks {
    /// Returns the number of the compression method.
    ///
    /// # Panics
    /// Panics if the blocks are not compressed.
    fn method(self) -> u8 {
        match self {
            Self::Plain | Self::Unfinished | Self::List => panic!("{self:?} has no method"),
            Self::Deflated => 0,
            Self::Transposed => 1,
            Self::Zstd => 2,
            Self::ZstdTransposed => 3,
            Self::Lz4 => 4,
            Self::Lz4Transposed => 5,
        }
    }
}

/// Where the data of the frames are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MdfData {
    /// In the records.
    InRecord,
    /// In signal data of their own.
    SignalData,
    /// In records of another group.
    OtherGroup,
}

/// Every form.
pub const MDF_FORMS: [(MdfBlocks, MdfData); 15] = [
    (MdfBlocks::Plain, MdfData::InRecord),
    (MdfBlocks::Plain, MdfData::SignalData),
    (MdfBlocks::Plain, MdfData::OtherGroup),
    (MdfBlocks::Unfinished, MdfData::InRecord),
    (MdfBlocks::Unfinished, MdfData::OtherGroup),
    (MdfBlocks::List, MdfData::InRecord),
    (MdfBlocks::Deflated, MdfData::InRecord),
    (MdfBlocks::Transposed, MdfData::InRecord),
    (MdfBlocks::Transposed, MdfData::SignalData),
    (MdfBlocks::Zstd, MdfData::InRecord),
    (MdfBlocks::ZstdTransposed, MdfData::InRecord),
    (MdfBlocks::ZstdTransposed, MdfData::SignalData),
    (MdfBlocks::Lz4, MdfData::InRecord),
    (MdfBlocks::Lz4Transposed, MdfData::InRecord),
    (MdfBlocks::Lz4Transposed, MdfData::SignalData),
];

pub(crate) struct Writer(pub(crate) Vec<u8>);

impl Writer {
    /// Begins a file: room for the identification and the header block.
    pub(crate) fn new(blocks: MdfBlocks) -> Self {
        let mut file = Self(vec![0; START_BYTES]);
        let mark: &[u8] = match blocks {
            MdfBlocks::Unfinished => b"UnFinMF 4.11    kit     ",
            _ => b"MDF     4.11    kit     ",
        };
        file.0[..mark.len()].copy_from_slice(mark);
        file
    }

    /// Writes the header block: the first data group, and the start in nanoseconds.
    pub(crate) fn header(&mut self, first: u64, start_ns: u64) {
        let mut header = Self(vec![0; 64]);
        let data = [&start_ns.to_le_bytes()[..], &[0; 24]].concat();
        header.block(b"##HD", &[first, 0, 0, 0, 0, 0], &data);
        self.0[64..START_BYTES].copy_from_slice(&header.0[64..START_BYTES]);
    }

    /// Sets a link of a block.
    pub(crate) fn link(&mut self, block: u64, index: usize, to: u64) {
        let at = block as usize + 24 + 8 * index;
        self.0[at..at + 8].copy_from_slice(&to.to_le_bytes());
    }

    /// Leaves out the length of the last block, as in a file that is not finished.
    pub(crate) fn leave_open(&mut self, block: u64) {
        self.0[60] = 1 << 2;
        let length = block as usize + 8;
        self.0[length..length + 8].copy_from_slice(&24_u64.to_le_bytes());
    }

    /// Writes a block and returns its place.
    pub(crate) fn block(&mut self, id: &[u8; 4], links: &[u64], data: &[u8]) -> u64 {
        while !self.0.len().is_multiple_of(8) {
            self.0.push(0);
        }
        let at = self.0.len() as u64;
        let length = 24 + 8 * links.len() + data.len();
        self.0.extend_from_slice(id);
        self.0.extend_from_slice(&[0; 4]);
        self.0.extend_from_slice(&(length as u64).to_le_bytes());
        self.0
            .extend_from_slice(&(links.len() as u64).to_le_bytes());
        for link in links {
            self.0.extend_from_slice(&link.to_le_bytes());
        }
        self.0.extend_from_slice(data);
        at
    }

    pub(crate) fn text(&mut self, text: &str) -> u64 {
        self.block(b"##TX", &[], &[text.as_bytes(), &[0]].concat())
    }

    /// Writes a channel: name, type, data type, byte, bits, and its links.
    fn channel(&mut self, name: &str, kinds: [u8; 2], place: [u32; 2], links: [u64; 3]) -> u64 {
        let name = self.text(name);
        let [next, part, values] = links;
        let [byte, bits] = place.map(u32::to_le_bytes);
        let head = [
            &[kinds[0], u8::from(kinds[0] == MASTER), kinds[1], 0][..],
            &byte,
            &bits,
        ];
        let data = [&head.concat()[..], &[0; 60]].concat();
        self.block(b"##CN", &[next, part, name, 0, 0, values, 0, 0], &data)
    }

    /// Writes data as blocks and returns the link to them.
    pub(crate) fn data(
        &mut self,
        id: &[u8; 4],
        bytes: &[u8],
        blocks: MdfBlocks,
        columns: usize,
    ) -> u64 {
        if matches!(blocks, MdfBlocks::Plain | MdfBlocks::Unfinished) {
            return self.block(id, &[], bytes);
        }
        let mut links = vec![0];
        for part in bytes.chunks(bytes.len() / 3 + 5) {
            links.push(match blocks {
                MdfBlocks::List => self.block(id, &[], part),
                _ => self.packed(id, part, blocks, columns),
            });
        }
        let count = links.len() as u32 - 1;
        let data = [
            &[0; 4][..],
            &count.to_le_bytes(),
            &vec![0; 8 * count as usize],
        ]
        .concat();
        let list = self.block(b"##DL", &links, &data);
        self.block(b"##HL", &[list], &[0; 8])
    }

    pub(crate) fn packed(
        &mut self,
        id: &[u8; 4],
        part: &[u8],
        blocks: MdfBlocks,
        columns: usize,
    ) -> u64 {
        let method = blocks.method();
        // Of two methods with the same packing, the second one is transposed.
        let is_transposed = method % 2 == 1;
        let columns = if is_transposed { columns } else { 0 };
        let turned = if is_transposed {
            transposed(part, columns)
        } else {
            part.to_vec()
        };
        let content = match method {
            0 | 1 => {
                let mut encoder = ZlibEncoder::new(Vec::new(), Compression::default());
                encoder.write_all(&turned).expect("memory");
                encoder.finish().expect("memory")
            }
            2 | 3 => compress_to_vec(&turned[..], CompressionLevel::Fastest),
            _ => {
                let mut encoder = FrameEncoder::new(Vec::new());
                encoder.write_all(&turned).expect("memory");
                encoder.finish().expect("memory")
            }
        };
        let head = [
            &id[2..],
            &[method, 0],
            &(columns as u32).to_le_bytes(),
            &(part.len() as u64).to_le_bytes(),
            &(content.len() as u64).to_le_bytes(),
            &content,
        ];
        self.block(b"##DZ", &[], &head.concat())
    }
}

/// Returns the first bytes of all rows, then the second ones, and so on, and what is left over.
fn transposed(bytes: &[u8], columns: usize) -> Vec<u8> {
    let rows = bytes.len() / columns;
    let mut turned: Vec<u8> = (0..columns * rows)
        .map(|k| bytes[k % rows * columns + k / rows])
        .collect();
    turned.extend_from_slice(&bytes[columns * rows..]);
    turned
}

/// Returns a file with these frames.
///
/// # Panics
/// Panics if a frame has more than eight bytes.
#[must_use]
pub fn mdf(frames: &[MdfFrame], blocks: MdfBlocks, data: MdfData) -> Vec<u8> {
    let mut file = Writer::new(blocks);
    let is_unsorted = data == MdfData::OtherGroup;
    let other = is_unsorted.then(|| file.block(b"##CG", &[0; 6], &group(2, 1, 0)));
    let mut records = Vec::new();
    let mut values = Vec::new();
    for frame in frames {
        let length = frame.data.len() as u8;
        if is_unsorted {
            records.push(1);
        }
        records.extend_from_slice(&(frame.micros as f64 / 1e6).to_le_bytes());
        records.push(frame.bus);
        records.extend_from_slice(&frame.id.to_le_bytes());
        records.extend_from_slice(&[u8::from(frame.is_extended), length]);
        let value = [&u32::from(length).to_le_bytes()[..], &frame.data].concat();
        if data == MdfData::InRecord {
            records.extend_from_slice(&frame.data);
            records.resize(records.len() + 8 - frame.data.len(), 0);
        } else {
            records.extend_from_slice(&(values.len() as u64).to_le_bytes());
            values.extend_from_slice(&value);
        }
        if is_unsorted {
            records.push(2);
            records.extend_from_slice(&value);
        }
    }
    let link = match data {
        MdfData::InRecord => 0,
        MdfData::SignalData => file.data(b"##SD", &values, blocks, 12),
        MdfData::OtherGroup => other.unwrap_or(0),
    };
    let kind = if link == 0 { FIXED } else { VARIABLE };
    let mut part = 0;
    for (name, kinds, place, values) in [
        ("DataBytes", [kind, BYTES], [15, 64], link),
        ("DataLength", [FIXED, UNSIGNED], [14, 8], 0),
        ("IDE", [FIXED, UNSIGNED], [13, 8], 0),
        ("ID", [FIXED, UNSIGNED], [9, 32], 0),
        ("BusChannel", [FIXED, UNSIGNED], [8, 8], 0),
    ] {
        let name = format!("CAN_DataFrame.{name}");
        part = file.channel(&name, kinds, place, [part, 0, values]);
    }
    let frame = file.channel("CAN_DataFrame", [FIXED, BYTES], [8, 120], [0, part, 0]);
    let first = file.channel("Timestamp", [MASTER, REAL], [0, 64], [frame, 0, 0]);
    let links = [other.unwrap_or(0), first, 0, 0, 0, 0];
    let cg = file.block(b"##CG", &links, &group(1, 0, RECORD_BYTES as u32));
    // The data come last: an unfinished file ends with them.
    let dg = file.block(
        b"##DG",
        &[0, cg, 0, 0],
        &[u8::from(is_unsorted), 0, 0, 0, 0, 0, 0, 0],
    );
    let at = file.data(b"##DT", &records, blocks, RECORD_BYTES);
    if blocks == MdfBlocks::Unfinished {
        file.leave_open(at);
    }
    file.link(dg, 2, at);
    file.header(dg, 0);
    file.0
}

/// Returns the data of a channel group: number, flags, and bytes of a record.
fn group(number: u64, flags: u16, bytes: u32) -> Vec<u8> {
    let mut data = vec![0; 32];
    data[..8].copy_from_slice(&number.to_le_bytes());
    data[16..18].copy_from_slice(&flags.to_le_bytes());
    data[24..28].copy_from_slice(&bytes.to_le_bytes());
    data
}
