//! A file as it is, or packed: gzip, or an entry of a zip archive.

use super::marks::{GZIP_MAGIC, ZIP_MAGIC};
use crate::error::{Error, Result};
use flate2::read::{DeflateDecoder, MultiGzDecoder};
use std::fs::File;
use std::io::{self, BufReader, Read};
use std::path::Path;

/// Bytes of the header of an entry, without its name.
const ENTRY_HEADER_BYTES: usize = 30;

/// Endings of the files of roads that an archive may have: a .kmz has doc.kml.
pub(crate) const ROAD_ENDINGS: &[&str] = &[".kml", ".gpx", ".geojson", ".json", ".osm"];

/// Opens a file. Of a zip archive, it is the first entry whose name ends with one of `endings`, in
/// small letters.
///
/// # Errors
/// Returns the error of the disk, or one that says what an archive lacks. What is packed can be
/// damaged further on.
pub(crate) fn open(path: &Path, endings: &[&str]) -> Result<Box<dyn Read>> {
    let file = File::open(path).map_err(Error::io(path))?;
    unpack(file, endings).map_err(|error| {
        let problem = format!("is damaged ({error}); expected a whole file, also as .gz or .zip");
        Error::content(path, problem)
    })
}

fn unpack(file: File, endings: &[&str]) -> io::Result<Box<dyn Read>> {
    let mut file = BufReader::new(file);
    let mut head = Vec::new();
    file.by_ref()
        .take(ZIP_MAGIC.len() as u64)
        .read_to_end(&mut head)?;
    let is_zip = head == ZIP_MAGIC;
    let is_gzip = head.starts_with(GZIP_MAGIC);
    let whole = io::Cursor::new(head).chain(file);
    if is_gzip {
        Ok(Box::new(MultiGzDecoder::new(whole)))
    } else if is_zip {
        zip_entry(whole, endings)
    } else {
        Ok(Box::new(whole))
    }
}

fn zip_entry(mut archive: impl Read + 'static, endings: &[&str]) -> io::Result<Box<dyn Read>> {
    let wrong = |words: String| io::Error::new(io::ErrorKind::InvalidData, words);
    loop {
        let mut header = [0; ENTRY_HEADER_BYTES];
        archive.read_exact(&mut header)?;
        let short = |at: usize| u16::from_le_bytes([header[at], header[at + 1]]);
        if !header.starts_with(ZIP_MAGIC) {
            return Err(wrong(format!("no {} in the archive", endings.join(", "))));
        }
        let (flags, method) = (short(6), short(8));
        let packed = u32::from_le_bytes([header[18], header[19], header[20], header[21]]);
        let mut name = vec![0; usize::from(short(26))];
        archive.read_exact(&mut name)?;
        let extra = u64::from(short(28));
        io::copy(&mut archive.by_ref().take(extra), &mut io::sink())?;
        name.make_ascii_lowercase();
        // Its size stands behind its content.
        let has_size_behind = flags & 8 != 0;
        if endings.iter().any(|end| name.ends_with(end.as_bytes())) {
            return match method {
                0 if !has_size_behind => Ok(Box::new(archive.take(packed.into()))),
                8 => Ok(Box::new(DeflateDecoder::new(archive))),
                _ => Err(wrong("packed in a way that is not read".to_owned())),
            };
        }
        if has_size_behind {
            let ends = endings.join(", ");
            return Err(wrong(format!("no {ends} at the head of the archive")));
        }
        io::copy(&mut archive.by_ref().take(packed.into()), &mut io::sink())?;
    }
}
