//! A block of a packed map, written.

use super::plan_view::{Place, points};
use crate::map::fusion::map_row::MapRow;
use estimator_core::roadmap::format::{
    ALTITUDE_CELLS, ALTITUDE_UNITS_PER_CM, GRADE_UNITS_PER_PERCENT, SIGMA_CELLS,
    SIGMA_CODES_PER_OCTAVE, SIGMA_UNIT_PERCENT, checksum,
};
use serde::Serialize;

/// Longest form of a number of 32 bits, bytes.
const LONGEST_NUMBER: usize = 5;

/// Appends a number in postcard's form.
fn put<T: Serialize>(out: &mut Vec<u8>, number: T) {
    if let Ok(bytes) = postcard::to_slice(&number, &mut [0; LONGEST_NUMBER]) {
        out.extend_from_slice(bytes);
    }
}

/// Ends a record with its checksum.
pub(super) fn sealed(mut record: Vec<u8>) -> Vec<u8> {
    let sum = checksum(&record);
    record.extend(sum.to_le_bytes());
    record
}

/// Ends a record, whose first two bytes are free, with its length and its checksum.
pub(super) fn sized(mut record: Vec<u8>) -> Option<Vec<u8>> {
    let length = u16::try_from(record.len() + 4).ok()?;
    record[..2].copy_from_slice(&length.to_le_bytes());
    Some(sealed(record))
}

/// Returns a block of these rows, which follow each other without a gap. `next` is the row after
/// them, if it follows too. `None` if a number does not fit.
pub(super) fn encode_block(
    way: u32,
    first_cell: i32,
    rows: &[MapRow],
    next: Option<&MapRow>,
) -> Option<Vec<u8>> {
    let places: Vec<Place> = rows.iter().chain(next).map(Place::of).collect();
    let kept = points(&places);
    let has_altitude = rows[0].altitude_m.is_some();
    let mut out = vec![0, 0, u8::try_from(rows.len()).ok()?, has_altitude.into()];
    out.extend(way.to_le_bytes());
    out.extend(first_cell.to_le_bytes());
    out.extend((places[0].latitude_e6 * 10).to_le_bytes());
    out.extend((places[0].longitude_e6 * 10).to_le_bytes());
    out.extend(u16::try_from(kept.len() - 1).ok()?.to_le_bytes());
    for pair in kept.windows(2) {
        let (latitude, longitude) = places[pair[1]].since(places[pair[0]]);
        put(&mut out, u16::try_from(pair[1] - pair[0]).ok()?);
        put(&mut out, latitude);
        put(&mut out, longitude);
    }
    let grades: Vec<i32> = rows
        .iter()
        .map(|row| (row.grade_percent * f64::from(GRADE_UNITS_PER_PERCENT)).round() as i32)
        .collect();
    if has_altitude {
        put_altitudes(&mut out, rows, &grades);
    }
    for same in rows.chunk_by(|a, b| a.runs == b.runs) {
        put(&mut out, same[0].runs);
        put(&mut out, u16::try_from(same.len()).ok()?);
    }
    out.extend(rows.chunks(SIGMA_CELLS).map(sigma_code));
    put_grades(&mut out, &grades);
    sized(out)
}

/// Appends the altitude of the first cell and the corrections of the climb. A reader adds the climb
/// by the grades; what rounding leaves is corrected at the end of the next stretch.
fn put_altitudes(out: &mut Vec<u8>, rows: &[MapRow], grades: &[i32]) {
    let wanted_cm: Vec<i64> = rows
        .iter()
        .map(|row| (row.altitude_m.unwrap_or_default() * 100.0).round() as i64)
        .collect();
    let unit = i64::from(ALTITUDE_UNITS_PER_CM);
    put(out, wanted_cm[0] as i32);
    let mut altitude = wanted_cm[0] * unit;
    let mut from = 0;
    while from + 1 < rows.len() {
        let to = (from + ALTITUDE_CELLS).min(rows.len() - 1);
        let climb: i64 = (from + 1..=to)
            .map(|i| i64::from(grades[i - 1]) + i64::from(grades[i]))
            .sum();
        let missing = wanted_cm[to] * unit - (altitude + climb);
        let correction_cm = (missing + unit / 2).div_euclid(unit);
        put(out, correction_cm as i32);
        altitude += climb + correction_cm * unit;
        from = to;
    }
}

/// Appends the grades: the first one, the first difference, and second differences.
fn put_grades(out: &mut Vec<u8>, grades: &[i32]) {
    let mut difference = 0;
    for (i, grade) in grades.iter().enumerate() {
        let number = match i {
            0 => *grade,
            _ => {
                let now = grade - grades[i - 1];
                let number = now - difference;
                difference = now;
                number
            }
        };
        put(out, number);
    }
}

/// Returns the code of the root mean square of sigmas.
fn sigma_code(rows: &[MapRow]) -> u8 {
    let squares: f64 = rows.iter().map(|row| row.grade_sigma_percent.powi(2)).sum();
    let sigma = (squares / rows.len() as f64).sqrt();
    let octaves = (sigma / f64::from(SIGMA_UNIT_PERCENT)).log2();
    let code = (octaves * f64::from(SIGMA_CODES_PER_OCTAVE)).round();
    code.clamp(0.0, 255.0) as u8
}
