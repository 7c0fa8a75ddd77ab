//! A writer of small ASAM MDF 4 files with decoded signals, in every form that readers must know.

mod writer;

use crate::mdf::{MdfBlocks, Writer};

/// Types of channels.
const FIXED: u8 = 0;
const MASTER: u8 = 2;
const VIRTUAL_MASTER: u8 = 3;
const VIRTUAL: u8 = 6;
/// Data types.
const UNSIGNED: u8 = 0;
const REAL: u8 = 4;

/// A conversion.
#[derive(Clone, Debug, Default)]
pub struct MdfConversion {
    /// Its type, as the format counts them.
    pub kind: u8,
    /// Its numbers.
    pub numbers: Vec<f64>,
    /// Its texts and conversions.
    pub references: Vec<MdfReference>,
    /// Its unit.
    pub unit: &'static str,
}

/// What a conversion refers to.
#[derive(Clone, Debug)]
pub enum MdfReference {
    /// Nothing.
    None,
    /// A text.
    Text(&'static str),
    /// Another conversion.
    Conversion(MdfConversion),
}

/// A channel.
#[derive(Clone, Debug)]
pub struct MdfChannel {
    /// Its name.
    pub name: String,
    /// Its unit; one that begins with `<` is written as XML.
    pub unit: &'static str,
    /// Type of the channel.
    pub kind: u8,
    /// What a master channel counts: 1 is time.
    pub sync: u8,
    /// Type of the data.
    pub data_type: u8,
    /// Where its bits begin in the record.
    pub byte: u32,
    /// The first bit of that byte.
    pub bit: u8,
    /// The number of bits.
    pub bits: u32,
    /// Its conversion.
    pub conversion: Option<MdfConversion>,
    /// Its invalidation bit.
    pub invalid_bit: Option<u32>,
}

impl MdfChannel {
    /// Returns a number of 64 bits in floating point.
    #[must_use]
    pub fn real(name: &str, unit: &'static str, byte: u32) -> Self {
        Self::of_type(name, REAL, byte, 64).with_unit(unit)
    }

    /// Returns a number of any type.
    #[must_use]
    pub fn of_type(name: &str, data_type: u8, byte: u32, bits: u32) -> Self {
        Self {
            name: name.to_owned(),
            unit: "",
            kind: FIXED,
            sync: 0,
            data_type,
            byte,
            bit: 0,
            bits,
            conversion: None,
            invalid_bit: None,
        }
    }

    /// Returns the time at the head of a record: seconds in floating point of 64 bits.
    #[must_use]
    pub fn time() -> Self {
        Self {
            kind: MASTER,
            sync: 1,
            ..Self::real("time", "s", 0)
        }
    }

    /// Returns a time by the number of the record.
    #[must_use]
    pub fn virtual_time(offset_s: f64, step_s: f64) -> Self {
        Self {
            kind: VIRTUAL_MASTER,
            sync: 1,
            bits: 0,
            ..Self::of_type("time", UNSIGNED, 0, 0)
        }
        .converted(1, &[offset_s, step_s])
    }

    /// Returns a channel whose raw number is that of the record.
    #[must_use]
    pub fn virtual_data(name: &str) -> Self {
        Self {
            kind: VIRTUAL,
            ..Self::of_type(name, UNSIGNED, 0, 0)
        }
    }

    /// Returns the channel with a unit.
    #[must_use]
    pub fn with_unit(self, unit: &'static str) -> Self {
        Self { unit, ..self }
    }

    /// Returns the channel with a conversion of numbers.
    #[must_use]
    pub fn converted(self, kind: u8, numbers: &[f64]) -> Self {
        self.converted_by(MdfConversion {
            kind,
            numbers: numbers.to_vec(),
            ..MdfConversion::default()
        })
    }

    /// Returns the channel with a conversion.
    #[must_use]
    pub fn converted_by(self, conversion: MdfConversion) -> Self {
        Self {
            conversion: Some(conversion),
            ..self
        }
    }
}

/// A channel group.
#[derive(Clone, Debug)]
pub struct MdfGroup {
    /// Its acquisition name; none if empty.
    pub name: &'static str,
    /// The name of its source; none if empty.
    pub source: &'static str,
    /// Its channels.
    pub channels: Vec<MdfChannel>,
    /// Bytes of invalidation bits at the end of each record.
    pub invalidation_bytes: u32,
    /// Its records, each with its time, by which unsorted ones are put in order.
    pub records: Vec<(f64, Vec<u8>)>,
}

/// How groups are stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MdfLayout {
    /// Each in a data group of its own.
    Sorted,
    /// All in one data group, their records in the order of time.
    Unsorted,
    /// Each channel in a group of its own, with the times of another group (MDF 4.2). Channels must
    /// have whole bytes.
    Columns,
}

/// Every form of a file.
pub const MDF_SIGNAL_FORMS: [(MdfBlocks, MdfLayout); 5] = [
    (MdfBlocks::Plain, MdfLayout::Sorted),
    (MdfBlocks::Unfinished, MdfLayout::Sorted),
    (MdfBlocks::Transposed, MdfLayout::Unsorted),
    (MdfBlocks::Plain, MdfLayout::Columns),
    (MdfBlocks::Deflated, MdfLayout::Columns),
];

/// Returns two groups of a few records: channels with the names of signals, with a conversion of each
/// kind and marks of what is invalid.
#[must_use]
pub fn few_records() -> [MdfGroup; 2] {
    let text = MdfReference::Text;
    let linear = MdfConversion {
        kind: 1,
        numbers: vec![1.0, 0.5],
        ..MdfConversion::default()
    };
    let coded = MdfConversion {
        kind: 8,
        numbers: vec![0.0, 250.0, 251.0, 255.0],
        references: vec![
            MdfReference::Conversion(linear),
            text("n/a"),
            MdfReference::None,
        ],
        unit: "",
    };
    let speed = MdfChannel {
        invalid_bit: Some(0),
        ..MdfChannel::of_type("wheel_speed_mps", 0, 8, 16).with_unit("km/h")
    };
    let byte = |name, at| MdfChannel::of_type(name, 0, at, 8);
    let fast = [
        speed,
        byte("gear", 10).converted_by(coded),
        byte("mass_kg", 11).with_unit("t"),
        byte("fan_percent", 12).converted(2, &[0.0, 2.0, 0.0, 0.0, 0.0, 5.0]),
        byte("hdop", 13).converted(6, &[0.0, 4.0, 1.0, 5.0, 9.0, 2.0, -1.0]),
    ];
    let slow = [
        MdfChannel::of_type("altitude_m", 5, 8, 32).with_unit("<CNunit><TX>m</TX></CNunit>"),
        byte("vdop", 12).converted(4, &[0.0, 10.0, 10.0, 30.0]),
    ];
    let record = |time: f64, bytes: &[u8]| (time, [&time.to_le_bytes()[..], bytes].concat());
    [
        MdfGroup {
            name: "10 ms",
            source: "XCP:1",
            channels: [&[MdfChannel::time()][..], &fast].concat(),
            invalidation_bytes: 1,
            records: (0..12_u8)
                .map(|k| record(f64::from(k) * 0.1, &[k, 1, 244 + k, 40, 3, k, k / 7]))
                .collect(),
        },
        MdfGroup {
            name: "1 s",
            source: "",
            channels: [&[MdfChannel::time()][..], &slow].concat(),
            invalidation_bytes: 0,
            records: (0..4_u8)
                .map(|k| record(f64::from(k), &[67, 200, k, 0, k]))
                .collect(),
        },
    ]
}

/// Returns a file with these groups.
///
/// # Panics
/// Panics for a group without records.
#[must_use]
pub fn mdf_signals(groups: &[MdfGroup], blocks: MdfBlocks, layout: MdfLayout) -> Vec<u8> {
    let mut file = Writer::new(blocks);
    let mut first = 0;
    let last = groups.len() - 1;
    match layout {
        MdfLayout::Sorted => {
            for (k, group) in groups.iter().rev().enumerate() {
                let cg = file.group(group, 0, 0);
                let bytes = group.records.iter().map(|(_, record)| &record[..]);
                // The one that is written last may be open.
                let is_open = blocks != MdfBlocks::Unfinished || k == last;
                let blocks = if is_open { blocks } else { MdfBlocks::Plain };
                let bytes = bytes.collect::<Vec<_>>().concat();
                first = file.data_group(first, cg, 0, &bytes, blocks, group.size());
            }
        }
        MdfLayout::Unsorted => {
            let mut cg = 0;
            for (k, group) in groups.iter().enumerate() {
                cg = file.group(group, cg, k as u64 + 1);
            }
            let records = groups.iter().enumerate().flat_map(|(k, group)| {
                let id = k as u8 + 1;
                let records = group.records.iter();
                records.map(move |(time, record)| (*time, [&[id][..], record].concat()))
            });
            let mut records: Vec<(f64, Vec<u8>)> = records.collect();
            records.sort_by(|a, b| a.0.total_cmp(&b.0));
            let bytes: Vec<u8> = records.into_iter().flat_map(|(_, bytes)| bytes).collect();
            let columns = groups[0].size() + 1;
            first = file.data_group(0, cg, 1, &bytes, blocks, columns);
        }
        MdfLayout::Columns => {
            for group in groups {
                first = file.columns(first, group, blocks);
            }
        }
    }
    file.header(first, 1_700_000_000_000_000_000);
    file.0
}
