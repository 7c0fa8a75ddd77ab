//! A file as it is, or packed: gzip, or an entry of a zip archive.

use super::marks::{GZIP_MAGIC, ZIP_MAGIC};
use crate::error::{Error, Result};
use flate2::read::{DeflateDecoder, MultiGzDecoder};
use std::borrow::Cow;
use std::fs::File;
use std::io::{self, BufRead, BufReader, Read, Seek, SeekFrom};
use std::path::Path;
use zip::{CompressionMethod, ZipArchive};

/// The entry of a .kmz that shows the others (OGC 12-007r2).
const KMZ_MAIN: &str = "doc.kml";

/// Endings of the files of roads that an archive may have: a .kmz has doc.kml.
pub(crate) const ROAD_ENDINGS: &[&str] = &[".kml", ".gpx", ".geojson", ".json", ".osm"];

/// Opens a file. Of a zip archive, it is the only entry whose name ends with one of `endings`, in
/// small letters, or the main one of a .kmz.
///
/// # Errors
/// Returns the error of the disk, or one that says what an archive lacks. What is packed can be
/// damaged further on.
pub(crate) fn open(path: &Path, endings: &[&str]) -> Result<Box<dyn Read>> {
    let file = File::open(path).map_err(Error::io(path))?;
    unpack(file, endings).map_err(|error| {
        let problem = format!("{error}; expected one whole file, also as .gz or .zip");
        Error::content(path, problem)
    })
}

fn unpack(file: File, endings: &[&str]) -> io::Result<Box<dyn Read>> {
    let mut file = BufReader::new(file);
    let head = file.fill_buf()?;
    if head.starts_with(GZIP_MAGIC) {
        Ok(Box::new(MultiGzDecoder::new(file)))
    } else if head.starts_with(ZIP_MAGIC) {
        zip_entry(file, endings)
    } else {
        Ok(Box::new(file))
    }
}

/// Opens an entry whose name ends so. Hidden ones are what a Mac keeps beside each file.
fn zip_entry(file: BufReader<File>, endings: &[&str]) -> io::Result<Box<dyn Read>> {
    let wrong = |words: String| io::Error::new(io::ErrorKind::InvalidData, words);
    let mut archive = ZipArchive::new(file)?;
    let is_wanted = |name: &str| {
        let lower = name.to_ascii_lowercase();
        let is_hidden = name
            .split('/')
            .any(|part| part.starts_with('.') || part == "__MACOSX");
        !is_hidden && endings.iter().any(|end| lower.ends_with(end))
    };
    let names = archive.file_names().flatten();
    let names: Vec<String> = names
        .filter(|name| is_wanted(name))
        .map(Cow::into_owned)
        .collect();
    let main = names
        .iter()
        .find(|name| name.eq_ignore_ascii_case(KMZ_MAIN));
    let name = match (main, &*names) {
        (Some(main), _) => main,
        (None, [only]) => only,
        (None, []) => return Err(wrong(format!("it has no {}", endings.join(", ")))),
        (None, several) => {
            let several = several.join(", ");
            return Err(wrong(format!("it has several files to read: {several}")));
        }
    };
    let index = archive.index_for_name(name).unwrap_or_default();
    let entry = archive.by_index_raw(index)?;
    let (method, is_secret) = (entry.compression(), entry.encrypted());
    let (start, length) = (entry.data_start(), entry.compressed_size());
    drop(entry);
    let mut file = archive.into_inner();
    file.seek(SeekFrom::Start(start.unwrap_or_default()))?;
    let packed = file.take(length);
    match method {
        CompressionMethod::Stored if !is_secret => Ok(Box::new(packed)),
        CompressionMethod::DEFLATE if !is_secret => Ok(Box::new(DeflateDecoder::new(packed))),
        _ => Err(wrong(format!("{name} is packed in a way that is not read"))),
    }
}
