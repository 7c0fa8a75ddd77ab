//! Damages the content of a file at random.

use super::good::zipped;
use crate::shell::rows;
use flate2::Crc;
use flate2::read::GzDecoder;
use host_sim::files::parquet::{ParquetColumn, is_parquet, stage};
use host_sim::files::run::RunRow;
use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use std::fs;
use std::io::Read;
use std::path::Path;
use test_kit::damage::{damage_bytes, pick};

/// Damages a file. In half of the cases the damage lies behind what would find it at once: below a
/// compression, or under a checksum that fits.
pub fn damage(path: &Path, content: &mut Vec<u8>, random: &mut ChaCha8Rng) {
    let name = path.to_string_lossy();
    let is_deep = random.random_bool(0.5);
    if is_deep && name.ends_with(".gz") {
        damage_inside(content, random);
    } else if is_deep && is_parquet(path) {
        *content = foreign_parquet(random);
    } else if is_deep && name.starts_with("store") {
        drop_checksum(content);
        damage_bytes(content, random);
    } else if is_deep && name == "kept" {
        damage_bytes(content, random);
        renew_checksum(content);
    } else {
        damage_bytes(content, random);
    }
}

fn damage_inside(content: &mut Vec<u8>, random: &mut ChaCha8Rng) {
    let mut inside = Vec::new();
    // An earlier damage may have cut it.
    let _ = GzDecoder::new(&content[..]).read_to_end(&mut inside);
    damage_bytes(&mut inside, random);
    *content = zipped(&inside);
}

/// A store without a checksum is an older one, and is read.
fn drop_checksum(content: &mut Vec<u8>) {
    const MARK: &[u8] = b", xxh3: ";
    if let Some(at) = content.windows(MARK.len()).position(|part| part == MARK) {
        let end = content[at..].iter().position(|byte| *byte == b'\n');
        content.drain(at..end.map_or(content.len(), |end| at + end));
    }
}

/// The last four bytes of a kept state are the CRC-32 of those before.
fn renew_checksum(content: &mut Vec<u8>) {
    if let Some(length) = content.len().checked_sub(4) {
        let mut sum = Crc::new();
        sum.update(&content[..length]);
        content.splice(length.., sum.sum().to_le_bytes());
    }
}

/// Values for the columns of tables: what another program may write.
const VALUES: [f64; 12] = [
    f64::NAN,
    f64::INFINITY,
    1e308,
    -1e308,
    0.0,
    -1.0,
    1e-12,
    400.0,
    47.0,
    181.0,
    1e6,
    -20_000.0,
];

/// Takes the value of a column from a row.
type Value = fn(&RunRow) -> f64;

/// Returns a Parquet file of the columns of runs and maps, with some values that are none.
fn foreign_parquet(random: &mut ChaCha8Rng) -> Vec<u8> {
    let rows = rows(60, 0);
    let columns: [(&str, Value); 8] = [
        ("distance_m", |row| row.distance_m),
        ("latitude_deg", |row| row.latitude_deg.unwrap_or_default()),
        ("longitude_deg", |row| row.longitude_deg.unwrap_or_default()),
        ("altitude_m", |row| row.altitude_m.unwrap_or_default()),
        ("altitude_sigma_m", |row| {
            row.altitude_sigma_m.unwrap_or_default()
        }),
        ("grade_percent", |row| row.grade_percent),
        ("grade_sigma_percent", |row| row.grade_sigma_percent),
        ("runs", |_| 1.0),
    ];
    let odds = *pick(&[0.0, 0.001, 0.01, 1.0], random);
    let columns = columns.into_iter().filter_map(|(name, value)| {
        let odds = if random.random_bool(0.3) { odds } else { 0.0 };
        let values: Vec<f64> = rows
            .iter()
            .map(|row| match random.random_bool(odds) {
                true => *pick(&VALUES, random),
                false => value(row),
            })
            .collect();
        let is_there = random.random_bool(0.97);
        is_there.then(|| ParquetColumn::numbers(name, values.into_iter()))
    });
    let columns: Vec<ParquetColumn> = columns.collect();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("foreign.parquet");
    let session = *pick(&["", "day", "a\tb"], random);
    let metadata = [("session", session.to_owned())];
    let metadata = &metadata[..random.random_range(0..2)];
    stage(&path, columns, metadata).unwrap().commit().unwrap();
    fs::read(path).unwrap()
}
