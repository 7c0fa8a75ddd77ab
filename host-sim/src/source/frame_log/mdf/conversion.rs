//! The conversion of a channel: from the raw number of a record to its value.

use super::mdf_file::{Block, MdfFile, number, u16_at};
use crate::error::Result;

/// Most numbers of a table: data lengths of CAN FD have 16 pairs.
const MOST_NUMBERS: usize = 512;

/// How a raw number becomes a value.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Conversion {
    /// It is the value.
    None,
    Linear {
        offset: f64,
        factor: f64,
    },
    /// Pairs of a number and its value.
    Table(Vec<(f64, f64)>),
    /// One that is not read.
    Unknown,
}

impl Conversion {
    /// Reads the conversion of a channel.
    pub(super) fn of(file: &mut MdfFile, channel: &Block) -> Result<Self> {
        let link = channel.link(4);
        if link == 0 {
            return Ok(Self::None);
        }
        let block = file.described(link, b"##CC")?;
        let data = file.data(&block)?;
        let value = |k: usize| number(&data, 24 + 8 * k).map(f64::from_le_bytes);
        let count = u16_at(&data, 6).map_or(0, usize::from).min(MOST_NUMBERS);
        Ok(match (data.first(), value(0), value(1)) {
            (Some(0), ..) => Self::None,
            (Some(1), Some(offset), Some(factor)) => Self::Linear { offset, factor },
            // With and without interpolation: whole numbers need none.
            (Some(4 | 5), ..) => {
                let pair = |k| Some((value(2 * k)?, value(2 * k + 1)?));
                let pairs: Option<Vec<(f64, f64)>> = (0..count / 2).map(pair).collect();
                pairs.map_or(Self::Unknown, Self::Table)
            }
            _ => Self::Unknown,
        })
    }

    /// Converts a whole number; `None` for a value that is no whole one.
    pub(super) fn whole(&self, raw: u64) -> Option<u64> {
        let value = match self {
            Self::None => return Some(raw),
            Self::Linear { offset, factor } => offset + factor * raw as f64,
            Self::Table(pairs) => pairs.iter().find(|(key, _)| *key == raw as f64)?.1,
            Self::Unknown => return None,
        };
        let is_whole = value.fract() == 0.0 && (0.0..=9e15).contains(&value);
        is_whole.then_some(value as u64)
    }
}
