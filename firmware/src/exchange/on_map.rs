//! What the map gives after a step.
//!
//! | words | content                                                                                |
//! |-------|----------------------------------------------------------------------------------------|
//! | 1     | number of the cell                                                                     |
//! | 1     | flags, from bit 0: place known, perhaps on the map, map grade known, combined, left out |
//! | 1     | offset of the way                                                                      |
//! | 3     | cell on the way, its sigma m, probability                                              |
//! | 4     | grade of the map %, combined grade %, each followed by its sigma                       |
//! | 2     | distance of the next grade m, next grade %                                             |
//! | 2     | data of the frame of the road ahead, if one was due                                    |
//!
//! Unknown values are zero. Hosts compare the file with their own; nobody decodes it.

use crate::on_map::OnMap;
use embedded_can::Frame;
use estimator_core::roadmap::MapMatch;
use estimator_core::word_record::{halves, to_bytes};
use estimator_core::{Live, broadcast};

/// Length of a record, bytes.
pub const ON_MAP_BYTES: usize = 56;

/// Source address of the frames.
const SOURCE: u8 = 0xFE;

/// Returns the record of a step. Does the next part of the work for the road ahead, whose frame `F`
/// has eight bytes.
pub fn encode<F: Frame>(on_map: &mut OnMap<'_>, live: &Live) -> [u8; ON_MAP_BYTES] {
    let part = on_map.next_part(live);
    let frame: Option<F> = part.and_then(|part| broadcast::ahead(&part, SOURCE));
    let data = frame.and_then(|frame| frame.data().try_into().ok());
    let [low, high] = halves(data.map_or(0, u64::from_le_bytes));
    let map = on_map.map();
    let found = map.matcher().place();
    let place = match found {
        MapMatch::On(place) => Some(place),
        _ => None,
    };
    let (grade, combined) = (map.map_grade_percent(), map.combined_percent());
    let flags = [
        place.is_some(),
        found == MapMatch::Unclear,
        grade.is_some(),
        combined.is_some(),
        map.is_left_out(),
    ];
    let flags = flags
        .iter()
        .rev()
        .fold(0, |word, flag| word << 1 | u32::from(*flag));
    let along = place.map_or([0.0; 3], |p| [p.cell, p.sigma_m, p.probability]);
    let (grade, combined) = (grade.unwrap_or_default(), combined.unwrap_or_default());
    let next = on_map.next_grade(live);
    let next = next.map_or([0.0; 2], |next| [next.ahead_m, next.grade_percent]);
    let grades = [grade.value, grade.sigma, combined.value, combined.sigma];
    let head = [live.end.cell, flags, place.map_or(0, |place| place.way)];
    let numbers = along.into_iter().chain(grades).chain(next);
    to_bytes(
        head.into_iter()
            .chain(numbers.map(f32::to_bits))
            .chain([low, high]),
    )
}
