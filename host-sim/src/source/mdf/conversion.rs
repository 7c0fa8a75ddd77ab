//! The conversion of a channel: from the raw number of a record to its value.

use super::mdf_file::{Block, MdfFile, number, u16_at};
use crate::error::Result;
use estimator_core::signal::raw_field::RawNumber;
use rustc_hash::FxHashMap;
use std::sync::Arc;

/// Conversions within conversions; deeper ones would be a circle.
const DEEPEST: usize = 3;
/// Most numbers of all conversions of a file: 32 MiB.
const MOST_NUMBERS: usize = 1 << 22;
/// Where the numbers begin, bytes, and the links to texts and other conversions.
const NUMBERS_AT: usize = 24;
const FIRST_REFERENCE: usize = 4;

/// How a raw number becomes a value.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::source) enum Conversion {
    /// It is the value. So it is where all texts are: what they mean is left to the user.
    None,
    Linear {
        offset: f64,
        factor: f64,
    },
    /// The quotient of two polynomials of second degree.
    Rational([f64; 6]),
    /// Pairs of a number and its value, ascending.
    Table {
        pairs: Vec<(f64, f64)>,
        is_interpolated: bool,
    },
    /// Ranges of numbers with what they mean, and what the others mean.
    Ranges(Vec<Range>, Meaning),
    /// One that is not read: its type.
    Unknown(u8),
}

/// A range of raw numbers.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::source) struct Range {
    least: f64,
    greatest: f64,
    /// True if it ends before `greatest`, for numbers in floating point.
    is_open: bool,
    meaning: Meaning,
}

/// What a raw number means.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::source) enum Meaning {
    Number(f64),
    Text,
    Converted(Arc<Conversion>),
}

/// A converted number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::source) enum Converted {
    /// Not finite if the conversion has none.
    Number(f64),
    /// A text such as "not available".
    Text,
}

/// The conversions of a file, each read once.
#[derive(Default)]
pub(in crate::source) struct Conversions {
    known: FxHashMap<u64, Arc<Conversion>>,
    numbers: usize,
}

impl Conversions {
    /// Reads the conversion that a link points to.
    ///
    /// # Errors
    /// Returns an error of the disk, and of a damaged block.
    pub(in crate::source) fn read(
        &mut self,
        file: &mut MdfFile,
        link: u64,
    ) -> Result<Arc<Conversion>> {
        self.read_to(file, link, DEEPEST)
    }

    fn read_to(
        &mut self,
        file: &mut MdfFile,
        link: u64,
        deepest: usize,
    ) -> Result<Arc<Conversion>> {
        if link == 0 {
            return Ok(Arc::new(Conversion::None));
        }
        if let Some(known) = self.known.get(&link) {
            return Ok(Arc::clone(known));
        }
        let block = file.described(link, b"##CC")?;
        let conversion = Arc::new(self.parse(file, &block, deepest)?);
        self.known.insert(link, Arc::clone(&conversion));
        Ok(conversion)
    }

    fn parse(&mut self, file: &mut MdfFile, block: &Block, deepest: usize) -> Result<Conversion> {
        let data = file.data(block)?;
        let kind = data.first().copied().unwrap_or(u8::MAX);
        let count = u16_at(&data, 6).map_or(0, usize::from);
        let values = data.get(NUMBERS_AT..).unwrap_or_default().chunks_exact(8);
        let numbers: Vec<f64> = values
            .take(count)
            .filter_map(|value| number(value, 0).map(f64::from_le_bytes))
            .collect();
        self.numbers += numbers.len();
        if self.numbers > MOST_NUMBERS {
            return Ok(Conversion::Unknown(kind));
        }
        Ok(match (kind, &numbers[..]) {
            (0, _) => Conversion::None,
            (1, [offset, factor, ..]) => Conversion::Linear {
                offset: *offset,
                factor: *factor,
            },
            (2, [a, b, c, d, e, f, ..]) => Conversion::Rational([*a, *b, *c, *d, *e, *f]),
            (4 | 5, _) => Conversion::Table {
                pairs: numbers.chunks_exact(2).map(|p| (p[0], p[1])).collect(),
                is_interpolated: kind == 4,
            },
            (6, [.., default]) => {
                let ranges = numbers.chunks_exact(3);
                let range = |of: &[f64]| Range::new(of[0], of[1], Meaning::Number(of[2]));
                let default = Meaning::Number(*default);
                Conversion::Ranges(ranges.map(range).collect(), default)
            }
            (7 | 8, _) if deepest > 0 => self.texts(file, block, kind, &numbers, deepest - 1)?,
            _ => Conversion::Unknown(kind),
        })
    }

    /// Reads the texts of numbers (7) or of ranges (8). Some may be conversions.
    fn texts(
        &mut self,
        file: &mut MdfFile,
        block: &Block,
        kind: u8,
        numbers: &[f64],
        deepest: usize,
    ) -> Result<Conversion> {
        let mut ranges = Vec::new();
        for (k, of) in numbers.chunks_exact(usize::from(kind - 6)).enumerate() {
            let meaning = self.meaning(file, block.link(FIRST_REFERENCE + k), deepest)?;
            ranges.push(match of {
                [least, greatest] => Range::new(*least, *greatest, meaning),
                _ => Range {
                    is_open: false,
                    ..Range::new(of[0], of[0], meaning)
                },
            });
        }
        let default = block.link(FIRST_REFERENCE + ranges.len());
        let default = match default {
            0 => Meaning::Converted(Arc::new(Conversion::None)),
            link => self.meaning(file, link, deepest)?,
        };
        let is_text = |range: &Range| range.meaning == Meaning::Text;
        let none = Meaning::Converted(Arc::new(Conversion::None));
        Ok(
            if ranges.iter().all(is_text) && (default == Meaning::Text || default == none) {
                Conversion::None
            } else {
                Conversion::Ranges(ranges, default)
            },
        )
    }

    fn meaning(&mut self, file: &mut MdfFile, link: u64, deepest: usize) -> Result<Meaning> {
        Ok(if link != 0 && file.is_conversion(link)? {
            Meaning::Converted(self.read_to(file, link, deepest)?)
        } else {
            Meaning::Text
        })
    }
}

impl Range {
    const fn new(least: f64, greatest: f64, meaning: Meaning) -> Self {
        Self {
            least,
            greatest,
            is_open: true,
            meaning,
        }
    }

    fn has(&self, raw: RawNumber) -> bool {
        let number = raw.to_f64();
        let is_below = if self.is_open && matches!(raw, RawNumber::Real(_)) {
            number < self.greatest
        } else {
            number <= self.greatest
        };
        self.least <= number && is_below
    }
}

impl Meaning {
    fn value(&self, raw: RawNumber) -> Option<Converted> {
        match self {
            Self::Number(number) => Some(Converted::Number(*number)),
            Self::Text => Some(Converted::Text),
            Self::Converted(conversion) => conversion.value(raw),
        }
    }
}

impl Conversion {
    /// Reads the conversion of a channel.
    ///
    /// # Errors
    /// Returns an error of the disk, and of a damaged block.
    pub(in crate::source) fn of(file: &mut MdfFile, channel: &Block) -> Result<Self> {
        let read = Conversions::default().read(file, channel.link(4))?;
        Ok(Arc::unwrap_or_clone(read))
    }

    /// Returns why it is not read; `None` if it is.
    pub(in crate::source) fn problem(&self) -> Option<String> {
        match self {
            Self::Unknown(3) => Some("has a formula as conversion".to_owned()),
            Self::Unknown(9 | 10) => Some("is a text".to_owned()),
            Self::Unknown(kind) => Some(format!("has a conversion of type {kind}")),
            _ => None,
        }
    }

    /// Converts a raw number; `None` if it is not known how.
    pub(in crate::source) fn value(&self, raw: RawNumber) -> Option<Converted> {
        let x = raw.to_f64();
        Some(Converted::Number(match self {
            Self::None => x,
            Self::Linear { offset, factor } => x * factor + offset,
            Self::Rational([a, b, c, d, e, f]) => (a * x * x + b * x + c) / (d * x * x + e * x + f),
            Self::Table {
                pairs,
                is_interpolated,
            } => looked_up(pairs, *is_interpolated, x)?,
            Self::Ranges(ranges, default) => {
                let found = ranges.iter().find(|range| range.has(raw));
                return found.map_or(default, |range| &range.meaning).value(raw);
            }
            Self::Unknown(_) => return None,
        }))
    }

    /// Converts a whole number; `None` for a value that is no whole one.
    pub(in crate::source) fn whole(&self, raw: u64) -> Option<u64> {
        let value = match self {
            Self::None => return Some(raw),
            Self::Linear { offset, factor } => offset + factor * raw as f64,
            // Whole numbers need no interpolation.
            Self::Table { pairs, .. } => pairs.iter().find(|(key, _)| *key == raw as f64)?.1,
            _ => return None,
        };
        let is_whole = value.fract() == 0.0 && (0.0..=9e15).contains(&value);
        is_whole.then_some(value as u64)
    }
}

/// Returns the value of the key that is nearest, the lower one of two; or one between the values of
/// both. Beyond the ends it is that of the end.
fn looked_up(pairs: &[(f64, f64)], is_interpolated: bool, x: f64) -> Option<f64> {
    let above = pairs.partition_point(|(key, _)| *key < x);
    let (Some(below), Some(next)) = (above.checked_sub(1).map(|k| pairs[k]), pairs.get(above))
    else {
        return pairs.get(above).or(pairs.last()).map(|(_, value)| *value);
    };
    let (from_below, to_next) = (x - below.0, next.0 - x);
    Some(if is_interpolated {
        below.1 + (next.1 - below.1) * from_below / (from_below + to_next)
    } else if from_below <= to_next {
        below.1
    } else {
        next.1
    })
}
