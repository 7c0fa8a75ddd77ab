//! A finished cell.
//!
//! | words | content                                                                                |
//! |-------|----------------------------------------------------------------------------------------|
//! | 2     | time, µs                                                                               |
//! | 1     | number of the cell                                                                     |
//! | 1     | flags, from bit 0: shifting, braking, no traction, crawling, position known, live altitude known, lagged altitude known |
//! | 2     | latitude and longitude, 1e-7 degrees                                                   |
//! | 1     | measured speed, m/s                                                                    |
//! | 9     | live: grade %, altitude m, bias %, scale, each followed by its sigma; speed, m/s       |
//! | 9     | lagged: the same                                                                       |
//!
//! What is not known is zero.

use super::{halves, next_f32, next_u64, to_bytes, to_words};
use estimator_core::{Cell, Condition, Estimate, Instant, Place, Uncertain};

/// Length of a record, bytes.
pub const CELL_BYTES: usize = 100;

const FLAGS: usize = 7;

/// The record of a cell.
#[must_use]
pub fn encode(cell: &Cell) -> [u8; CELL_BYTES] {
    let place = &cell.place;
    let [low, high] = halves(place.time.micros());
    let flags: [bool; FLAGS] = [
        place.condition.shifting,
        place.condition.braking,
        place.condition.no_traction,
        place.condition.crawling,
        place.position_e7.is_some(),
        cell.live.altitude_m.is_some(),
        cell.lagged.altitude_m.is_some(),
    ];
    let flags = flags
        .iter()
        .rev()
        .fold(0, |word, flag| word << 1 | u32::from(*flag));
    let (latitude, longitude) = place.position_e7.unwrap_or_default();
    let head = [
        low,
        high,
        place.cell,
        flags,
        latitude.cast_unsigned(),
        longitude.cast_unsigned(),
        place.speed_mps.to_bits(),
    ];
    to_bytes(
        head.into_iter()
            .chain(estimate_words(&cell.live))
            .chain(estimate_words(&cell.lagged)),
    )
}

fn estimate_words(estimate: &Estimate) -> impl Iterator<Item = u32> {
    [
        estimate.grade_percent,
        estimate.altitude_m.unwrap_or_default(),
        estimate.bias_percent,
        estimate.scale,
    ]
    .into_iter()
    .flat_map(|uncertain| [uncertain.value, uncertain.sigma])
    .chain([estimate.speed_mps])
    .map(f32::to_bits)
}

/// The cell of a record.
#[must_use]
pub fn decode(record: &[u8]) -> Option<Cell> {
    let mut words = to_words(record, CELL_BYTES)?;
    let time = Instant::from_micros(next_u64(&mut words)?);
    let cell = words.next()?;
    let flags = words.next()?;
    if flags >> FLAGS != 0 {
        return None;
    }
    let flag = |bit: u32| flags >> bit & 1 == 1;
    let latitude = words.next()?.cast_signed();
    let longitude = words.next()?.cast_signed();
    Some(Cell {
        place: Place {
            cell,
            time,
            position_e7: flag(4).then_some((latitude, longitude)),
            speed_mps: next_f32(&mut words)?,
            condition: Condition {
                shifting: flag(0),
                braking: flag(1),
                no_traction: flag(2),
                crawling: flag(3),
            },
        },
        live: estimate(&mut words, flag(5))?,
        lagged: estimate(&mut words, flag(6))?,
    })
}

fn estimate(words: &mut impl Iterator<Item = u32>, altitude_known: bool) -> Option<Estimate> {
    let mut uncertain = || {
        Some(Uncertain {
            value: next_f32(words)?,
            sigma: next_f32(words)?,
        })
    };
    let grade_percent = uncertain()?;
    let altitude_m = uncertain()?;
    Some(Estimate {
        grade_percent,
        altitude_m: altitude_known.then_some(altitude_m),
        bias_percent: uncertain()?,
        scale: uncertain()?,
        speed_mps: next_f32(words)?,
    })
}
