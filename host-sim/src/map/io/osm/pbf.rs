//! Ways and nodes of an OpenStreetMap file in PBF
//! (<https://wiki.openstreetmap.org/wiki/PBF_Format>).

use super::roads::Roads;
use crate::error::{Error, Result};
use osmpbf::{BlobDecode, BlobReader, Element, PrimitiveBlock};
use std::cell::Cell;
use std::fs::File;
use std::io::{self, BufReader, Read};
use std::path::Path;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

/// Features that a file may require of its readers. A file with history has deleted ways.
const FEATURES: [&str; 2] = ["OsmSchema-V0.6", "DenseNodes"];
const EXPECTED: &str = "expected a whole OpenStreetMap extract (.osm.pbf)";

/// Reads the ways that are roads, and the places of their nodes where the ways have them.
///
/// # Errors
/// Returns an error that names the block, and what was expected.
pub(super) fn read_ways(path: &Path, roads: &mut Roads) -> Result<()> {
    for_each_block(path, |block| {
        for way in block.groups().flat_map(|group| group.ways()) {
            let tag = |key: &str| way.tags().find(|(k, _)| *k == key).map(|(_, value)| value);
            roads.way(way.id(), way.refs().collect(), tag)?;
            for (node, place) in way.refs().zip(way.node_locations()) {
                roads.node(node, (place.lat(), place.lon()));
            }
        }
        Ok(())
    })
}

/// Reads the nodes of the roads.
///
/// # Errors
/// Returns an error that names the block, and what was expected.
pub(super) fn read_nodes(path: &Path, roads: &mut Roads) -> Result<()> {
    for_each_block(path, |block| {
        for element in block.elements() {
            match element {
                Element::Node(node) => roads.node(node.id(), (node.lat(), node.lon())),
                Element::DenseNode(node) => roads.node(node.id(), (node.lat(), node.lon())),
                _ => {}
            }
        }
        Ok(())
    })
}

/// Calls a function with number, version and tags of each node.
///
/// # Errors
/// Returns an error that names the block, and what was expected.
pub(super) fn for_each_node(
    path: &Path,
    mut take: impl FnMut(i64, Option<i32>, &mut dyn Iterator<Item = (&str, &str)>),
) -> Result<()> {
    for_each_block(path, |block| {
        for element in block.elements() {
            match element {
                Element::Node(node) => take(node.id(), node.info().version(), &mut node.tags()),
                Element::DenseNode(node) => {
                    let version = node.info().map(|info| info.version());
                    take(node.id(), version, &mut node.tags());
                }
                _ => {}
            }
        }
        Ok(())
    })
}

/// Calls a function with each block of the file.
///
/// # Errors
/// Returns an error for a file that is damaged or cut off, or that requires features which this
/// reader lacks; and the first error of the function.
fn for_each_block(
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
