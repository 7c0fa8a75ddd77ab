//! Zip archives (PKWARE's APPNOTE).

use flate2::Compression;
use flate2::write::DeflateEncoder;
use std::io::Write;

/// Length and name, which both records of an entry end in.
fn sizes_and_name(packed: u32, content: &[u8], name: &str) -> Vec<u8> {
    let mut part = packed.to_le_bytes().to_vec();
    part.extend((content.len() as u32).to_le_bytes());
    part.extend((name.len() as u16).to_le_bytes());
    part
}

/// Returns a zip archive of files with their names, deflated or as they are. The sizes are at the
/// head of each, or behind it, as programs write them that do not know them before.
pub fn zip(files: &[(&str, &[u8])], is_deflated: bool, has_sizes: bool) -> Vec<u8> {
    let (mut archive, mut directory) = (Vec::new(), Vec::new());
    for (name, content) in files {
        let packed = if is_deflated {
            let mut packed = DeflateEncoder::new(Vec::new(), Compression::fast());
            packed.write_all(content).expect("memory");
            packed.finish().expect("memory")
        } else {
            content.to_vec()
        };
        let mut crc = flate2::Crc::new();
        crc.update(content);
        let crc = crc.sum().to_le_bytes();
        let flags = if has_sizes { 0 } else { 8_u16 };
        let method = if is_deflated { 8_u16 } else { 0 };
        let mut common = 20_u16.to_le_bytes().to_vec();
        common.extend(flags.to_le_bytes());
        common.extend(method.to_le_bytes());
        common.extend([0; 4]);
        let start = archive.len() as u32;
        archive.extend(b"PK\x03\x04");
        archive.extend(&common);
        let length = packed.len() as u32;
        let head = if has_sizes {
            (crc, length, *content)
        } else {
            ([0; 4], 0, &[][..])
        };
        archive.extend(head.0);
        archive.extend(sizes_and_name(head.1, head.2, name));
        archive.extend([0; 2]);
        archive.extend(name.as_bytes());
        archive.extend(&packed);
        if !has_sizes {
            archive.extend(b"PK\x07\x08");
            archive.extend(crc);
            archive.extend(length.to_le_bytes());
            archive.extend((content.len() as u32).to_le_bytes());
        }
        directory.extend(b"PK\x01\x02");
        directory.extend([20, 0]);
        directory.extend(&common);
        directory.extend(crc);
        directory.extend(sizes_and_name(length, content, name));
        directory.extend([0; 12]);
        directory.extend(start.to_le_bytes());
        directory.extend(name.as_bytes());
    }
    let count = (files.len() as u16).to_le_bytes();
    let start = archive.len() as u32;
    archive.extend(&directory);
    archive.extend(b"PK\x05\x06");
    archive.extend([0; 4]);
    archive.extend(count);
    archive.extend(count);
    archive.extend((directory.len() as u32).to_le_bytes());
    archive.extend(start.to_le_bytes());
    archive.extend([0; 2]);
    archive
}
