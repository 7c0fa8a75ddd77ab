//! Logs, signal tables and map extracts.

use flate2::write::ZlibEncoder;
use flate2::{Compression, GzBuilder};
use host_sim::files::parquet::{ParquetColumn, stage};
use ruzstd::encoding::{CompressionLevel, compress_to_vec};
use std::io;
use std::io::Write;
use std::path::Path;
use test_kit::mdf::MdfFrame;
use test_kit::osm::{OsmNode, OsmWay, Packing, pbf};

pub fn few_frames() -> Vec<MdfFrame> {
    let frame = |k: u64| MdfFrame {
        micros: 1000 * k,
        bus: 1,
        id: 0x0CF0_0400,
        is_extended: true,
        data: k.to_le_bytes().to_vec(),
    };
    (1..9).map(frame).collect()
}

/// Returns a log in gzip and in Zstandard, in one and two members, with and without damage.
pub fn packed(text: &[u8]) -> io::Result<[(&'static str, Vec<u8>); 4]> {
    let gzip = compressed(text)?;
    let zstd = compress_to_vec(text, CompressionLevel::Fastest);
    let damaged = |member: &[u8]| {
        let mut member = member.to_vec();
        let middle = member.len() / 2;
        member[middle..].fill(0xff);
        member
    };
    Ok([
        ("gzip_members", [&gzip[..], &gzip].concat()),
        ("gzip_damaged", [&damaged(&gzip)[..], &gzip].concat()),
        ("zstd_frames", [&zstd[..], &zstd].concat()),
        ("zstd_damaged", [&damaged(&zstd)[..], &zstd].concat()),
    ])
}

/// Writes a signal table.
pub fn write_table(path: &Path) {
    let numbers = |scale: f64| (0..20).map(move |k| scale * f64::from(k));
    let columns = vec![
        ParquetColumn::numbers("time_s", numbers(0.1)),
        ParquetColumn::optional("wheel_speed_mps", numbers(0.3).map(Some)),
        ParquetColumn::whole("gear", (0..20).map(|k| k / 4)),
        ParquetColumn::numbers("altitude_m", numbers(-2.0)),
        ParquetColumn::text("driver", Some("x"), 20),
    ];
    let staged = stage(path, columns, &[]).expect("a table");
    staged.commit().expect("a table");
}

/// Returns a BLF file with one container, plain (0) or zlib (2).
pub fn blf(frames: &[MdfFrame], method: u16) -> io::Result<Vec<u8>> {
    let object = |header: u16, kind: u32, body: &[u8]| {
        let length = 16 + body.len() as u32;
        let mut bytes = b"LOBJ".to_vec();
        bytes.extend([header.to_le_bytes(), 1_u16.to_le_bytes()].concat());
        bytes.extend([length.to_le_bytes(), kind.to_le_bytes()].concat());
        bytes.extend(body);
        bytes
    };
    let mut objects = Vec::new();
    for frame in frames {
        let mut body = [2, 0, 0, 0, 0, 0, 0, 0].to_vec();
        body.extend((1000 * frame.micros).to_le_bytes());
        body.extend([1, 0, 0, frame.data.len() as u8]);
        body.extend((frame.id | 1 << 31).to_le_bytes());
        body.extend(&frame.data);
        objects.extend(object(32, 1, &body));
    }
    let declared = objects.len() as u32;
    if method == 2 {
        let mut encoder = ZlibEncoder::new(Vec::new(), Compression::default());
        encoder.write_all(&objects)?;
        objects = encoder.finish()?;
    }
    let mut content = [method, 0, 0, 0].map(u16::to_le_bytes).concat();
    content.extend([declared.to_le_bytes(), [0; 4]].concat());
    content.extend(objects);
    let mut file = b"LOGG".to_vec();
    file.extend(144_u32.to_le_bytes());
    file.resize(144, 0);
    file.extend(object(16, 10, &content));
    Ok(file)
}

/// Compresses text to the same bytes each time: without time, name and system.
pub fn compressed(text: &[u8]) -> io::Result<Vec<u8>> {
    let mut encoder = GzBuilder::new().write(Vec::new(), Compression::best());
    encoder.write_all(text)?;
    encoder.finish()
}

/// Returns a bridge between two roads, with a tag on a node.
pub fn extract(packing: Packing) -> Vec<u8> {
    let node = |id: i64| -> OsmNode<'_> { (id, 474_000_000 + 10_000 * id, 85_000_000, &[]) };
    let mut nodes: Vec<OsmNode> = (1..=6).map(node).collect();
    nodes[2].3 = &[("highway", "crossing")];
    let ways: [OsmWay; 3] = [
        (
            1,
            vec![1, 2, 3],
            &[("highway", "primary"), ("oneway", "yes")],
        ),
        (
            2,
            vec![3, 4],
            &[("highway", "primary_link"), ("bridge", "yes")],
        ),
        (
            3,
            vec![4, 5, 6],
            &[("highway", "service"), ("junction", "roundabout")],
        ),
    ];
    pbf(&["OsmSchema-V0.6", "DenseNodes"], &nodes, &ways, packing)
}
