//! A finished cell.
//!
//! | words | content                                                                                |
//! |-------|----------------------------------------------------------------------------------------|
//! | 2     | time, µs                                                                               |
//! | 1     | number of the cell                                                                     |
//! | 1     | flags, from bit 0: shifting, braking, no traction, crawling, position known, altitude known, live consistent, lagged consistent |
//! | 2     | latitude and longitude, 1e-7 degrees                                                   |
//! | 1     | measured speed, m/s                                                                    |
//! | 6     | live grade %, lagged grade %, altitude m, each followed by its sigma                   |
//!
//! Unknown values are zero.

use estimator_core::word_record::{halves, next_f32, next_u64, to_bytes, to_words};
use estimator_core::{Cell, CellEnd, Condition, Instant, Uncertain};

/// Length of a record, bytes.
pub const CELL_BYTES: usize = 52;

const FLAGS: usize = 8;

/// Returns the record of a cell.
#[must_use]
pub fn encode(cell: &Cell) -> [u8; CELL_BYTES] {
    let end = &cell.end;
    let [low, high] = halves(end.time.micros());
    let flags: [bool; FLAGS] = [
        end.condition.shifting,
        end.condition.braking,
        end.condition.no_traction,
        end.condition.crawling,
        end.position_e7.is_some(),
        cell.altitude_m.is_some(),
        cell.live_consistent,
        cell.lagged_consistent,
    ];
    let flags = flags
        .iter()
        .rev()
        .fold(0, |word, flag| word << 1 | u32::from(*flag));
    let (latitude, longitude) = end.position_e7.unwrap_or_default();
    let head = [
        low,
        high,
        end.cell,
        flags,
        latitude.cast_unsigned(),
        longitude.cast_unsigned(),
        end.speed_mps.to_bits(),
    ];
    let estimates = [
        cell.live_grade_percent,
        cell.lagged_grade_percent,
        cell.altitude_m.unwrap_or_default(),
    ];
    to_bytes(
        head.into_iter().chain(
            estimates
                .into_iter()
                .flat_map(|known| [known.value, known.sigma])
                .map(f32::to_bits),
        ),
    )
}

/// Returns the cell of a record; `None` if the record is invalid.
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
    let end = CellEnd {
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
    };
    let mut uncertain = || {
        Some(Uncertain {
            value: next_f32(&mut words)?,
            sigma: next_f32(&mut words)?,
        })
    };
    Some(Cell {
        end,
        live_grade_percent: uncertain()?,
        lagged_grade_percent: uncertain()?,
        altitude_m: uncertain().map(|altitude_m| flag(5).then_some(altitude_m))?,
        live_consistent: flag(6),
        lagged_consistent: flag(7),
    })
}
