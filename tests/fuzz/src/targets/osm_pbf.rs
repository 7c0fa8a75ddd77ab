//! OpenStreetMap extracts: a network of ways with possible places, or an error that names the file.

use crate::as_file;
use host_sim::map::read_network;

/// Bytes that an input may take: where the stated length of a list is damaged, the protobuf library
/// reserves room for ten million numbers, and does not touch it.
pub const MOST_BYTES: usize = 80_000_000 + crate::MOST_BYTES;

/// Checks an extract.
pub fn osm_pbf(bytes: &[u8]) {
    as_file(".osm.pbf", bytes, |path| match read_network(path) {
        Ok(network) => {
            assert!(
                !network.ways().is_empty(),
                "an extract without roads is an error"
            );
            for way in network.ways() {
                let (latitude_deg, longitude_deg) = way.line.position_at(way.line.end_m());
                assert!(latitude_deg.abs() <= 90.0 && longitude_deg.abs() <= 180.0);
            }
        }
        Err(error) => assert!(error.to_string().contains(&path.display().to_string())),
    });
}
