//! OpenStreetMap extracts (PBF), written from the description of the format alone.

use crate::varint::{signed, unsigned, zigzag};
use flate2::Compression;
use flate2::write::ZlibEncoder;
use std::io::Write;

/// A node: identifier, latitude and longitude in 1e-7 degrees, tags.
pub type OsmNode<'t> = (i64, i64, i64, &'t [(&'t str, &'t str)]);
/// A way: identifier, nodes, tags.
pub type OsmWay<'t> = (i64, Vec<i64>, &'t [(&'t str, &'t str)]);

/// How the content of a block is stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Packing {
    /// As it is, nodes one by one.
    Raw,
    /// Compressed, nodes as differences.
    Zlib,
}

/// Returns a file with a header that requires these features, the nodes and the ways.
pub fn pbf(
    required: &[&str],
    nodes: &[OsmNode<'_>],
    ways: &[OsmWay<'_>],
    packing: Packing,
) -> Vec<u8> {
    let mut file = header(required, packing);
    file.extend(blob("OSMData", &nodes_block(nodes, packing), packing));
    file.extend(blob("OSMData", &ways_block(ways, &[]), packing));
    file
}

/// Returns a file without nodes, whose ways have the places of theirs, as `osmium add-locations-to-ways`
/// writes it.
pub fn pbf_with_locations(nodes: &[OsmNode<'_>], ways: &[OsmWay<'_>]) -> Vec<u8> {
    let mut file = header(&["OsmSchema-V0.6"], Packing::Zlib);
    file.extend(blob("OSMData", &ways_block(ways, nodes), Packing::Zlib));
    file
}

fn header(required: &[&str], packing: Packing) -> Vec<u8> {
    let mut header = Vec::new();
    for feature in required {
        field(&mut header, 4, feature.as_bytes());
    }
    blob("OSMHeader", &header, packing)
}

/// Returns a block with its header.
pub fn blob(kind: &str, content: &[u8], packing: Packing) -> Vec<u8> {
    let mut blob = Vec::new();
    match packing {
        Packing::Raw => field(&mut blob, 1, content),
        Packing::Zlib => {
            number(&mut blob, 2, content.len() as u64);
            let mut encoder = ZlibEncoder::new(Vec::new(), Compression::fast());
            encoder.write_all(content).expect("in memory");
            field(&mut blob, 3, &encoder.finish().expect("in memory"));
        }
    }
    let mut header = Vec::new();
    field(&mut header, 1, kind.as_bytes());
    number(&mut header, 3, blob.len() as u64);
    let mut file = u32::try_from(header.len())
        .expect("short")
        .to_be_bytes()
        .to_vec();
    file.extend(header);
    file.extend(blob);
    file
}

fn nodes_block(nodes: &[OsmNode<'_>], packing: Packing) -> Vec<u8> {
    let mut strings = Strings::default();
    let mut group = Vec::new();
    if packing == Packing::Raw {
        for (id, latitude, longitude, tags) in nodes {
            let mut node = Vec::new();
            number(&mut node, 1, zigzag(*id));
            strings.tag(&mut node, tags);
            number(&mut node, 8, zigzag(*latitude));
            number(&mut node, 9, zigzag(*longitude));
            field(&mut group, 1, &node);
        }
    } else {
        let mut dense = Vec::new();
        let column = |value: fn(&OsmNode<'_>) -> i64| differences(nodes.iter().map(value));
        field(&mut dense, 1, &column(|node| node.0));
        field(&mut dense, 8, &column(|node| node.1));
        field(&mut dense, 9, &column(|node| node.2));
        let mut tags_of_nodes = Vec::new();
        for (.., tags) in nodes {
            for (key, value) in *tags {
                unsigned(&mut tags_of_nodes, strings.index(key));
                unsigned(&mut tags_of_nodes, strings.index(value));
            }
            unsigned(&mut tags_of_nodes, 0_u32);
        }
        field(&mut dense, 10, &tags_of_nodes);
        field(&mut group, 2, &dense);
    }
    block(&strings, &group)
}

/// Each way has the places of its nodes that are given.
fn ways_block(ways: &[OsmWay<'_>], located: &[OsmNode<'_>]) -> Vec<u8> {
    let mut strings = Strings::default();
    let mut group = Vec::new();
    for (id, nodes, tags) in ways {
        let mut way = Vec::new();
        number(&mut way, 1, u64::from_ne_bytes(id.to_ne_bytes()));
        strings.tag(&mut way, tags);
        field(&mut way, 8, &differences(nodes.iter().copied()));
        let places = nodes
            .iter()
            .filter_map(|id| located.iter().find(|node| node.0 == *id));
        let column = |value: fn(&OsmNode<'_>) -> i64| differences(places.clone().map(value));
        if !located.is_empty() {
            field(&mut way, 9, &column(|node| node.1));
            field(&mut way, 10, &column(|node| node.2));
        }
        field(&mut group, 3, &way);
    }
    block(&strings, &group)
}

fn block(strings: &Strings, group: &[u8]) -> Vec<u8> {
    let mut table = Vec::new();
    field(&mut table, 1, b"");
    for string in &strings.0 {
        field(&mut table, 1, string.as_bytes());
    }
    let mut block = Vec::new();
    field(&mut block, 1, &table);
    field(&mut block, 2, group);
    block
}

/// Strings of a block, behind an empty one.
#[derive(Default)]
struct Strings(Vec<String>);

impl Strings {
    fn index(&mut self, string: &str) -> u64 {
        let known = self.0.iter().position(|known| known == string);
        let index = known.unwrap_or_else(|| {
            self.0.push(string.to_owned());
            self.0.len() - 1
        });
        index as u64 + 1
    }

    fn tag(&mut self, element: &mut Vec<u8>, tags: &[(&str, &str)]) {
        let (mut keys, mut values) = (Vec::new(), Vec::new());
        for (key, value) in tags {
            unsigned(&mut keys, self.index(key));
            unsigned(&mut values, self.index(value));
        }
        field(element, 2, &keys);
        field(element, 3, &values);
    }
}

fn differences(values: impl Iterator<Item = i64>) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut before = 0;
    for value in values {
        signed(&mut bytes, value - before);
        before = value;
    }
    bytes
}

fn number(message: &mut Vec<u8>, tag: u64, value: u64) {
    unsigned(message, tag << 3);
    unsigned(message, value);
}

fn field(message: &mut Vec<u8>, tag: u64, bytes: &[u8]) {
    unsigned(message, tag << 3 | 2);
    unsigned(message, bytes.len() as u64);
    message.extend(bytes);
}
