//! The blocks of an OpenStreetMap file in PBF
//! (<https://wiki.openstreetmap.org/wiki/PBF_Format>).

use crate::error::{Error, Result};
use osmpbf::{BlobDecode, BlobReader, PrimitiveBlock};
use std::cell::Cell;
use std::fs::File;
use std::io::{self, BufReader, Read};
use std::path::Path;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

/// Features that a file may require of its readers. A file with history has deleted ways.
const FEATURES: [&str; 2] = ["OsmSchema-V0.6", "DenseNodes"];
const EXPECTED: &str = "expected a whole OpenStreetMap extract (.osm.pbf)";

/// Calls a function with each block of the file.
///
/// # Errors
/// Returns an error for a file that is damaged or cut off, or that requires features which this
/// reader lacks; and the first error of the function.
pub(super) fn for_each_block(
    path: &Path,
    mut take: impl FnMut(&PrimitiveBlock) -> std::result::Result<(), String>,
) -> Result<()> {
    let file = File::open(path).map_err(Error::io(path))?;
    let read_bytes = AtomicU64::new(0);
    let reader = Counted {
        inner: BufReader::new(file),
        count: &read_bytes,
    };
    let wrong = |problem: String| Error::content(path, problem);
    let number = Cell::new(0);
    let damaged = |e: osmpbf::Error| wrong(format!("block {}: {e}; {EXPECTED}", number.get()));
    let mut has_header = false;
    let mut whole_bytes = 0;
    for blob in BlobReader::new(reader) {
        number.set(number.get() + 1);
        let blob = blob.map_err(damaged)?;
        match blob.decode().map_err(damaged)? {
            BlobDecode::OsmHeader(header) => {
                check_features(header.required_features()).map_err(wrong)?;
                has_header = true;
            }
            BlobDecode::OsmData(block) if has_header => take(&block).map_err(wrong)?,
            BlobDecode::OsmData(_) => return Err(wrong(format!("no header; {EXPECTED}"))),
            BlobDecode::Unknown(_) => {}
        }
        whole_bytes = read_bytes.load(Relaxed);
    }
    if !has_header {
        return Err(wrong(format!("no blocks; {EXPECTED}")));
    }
    // The library takes the size of a block that is cut off for the end of the file.
    if read_bytes.load(Relaxed) != whole_bytes {
        return Err(wrong(format!(
            "cut off after block {}; {EXPECTED}",
            number.get()
        )));
    }
    Ok(())
}

fn check_features(required: &[String]) -> std::result::Result<(), String> {
    required
        .iter()
        .find(|feature| !FEATURES.contains(&feature.as_str()))
        .map_or(Ok(()), |other| {
            Err(format!(
                "requires {other:?}; expected an extract of the present state without other features"
            ))
        })
}

/// Counts what is read.
struct Counted<'c, R> {
    inner: R,
    count: &'c AtomicU64,
}

impl<R: Read> Read for Counted<'_, R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let count = self.inner.read(buffer)?;
        self.count.fetch_add(count as u64, Relaxed);
        Ok(count)
    }
}
