//! The files of elevation tiles in a folder: under which names they are, and how they are packed.

use crate::error::{Error, Result};
use crate::files::marks::{GZIP_MAGIC, ZIP_MAGIC};
use flate2::read::{DeflateDecoder, MultiGzDecoder};
use std::collections::BTreeMap;
use std::fs::File;
use std::io::{self, BufReader, Read};
use std::path::{Path, PathBuf};
use walkdir::WalkDir;

/// Bytes of the finest tile.
pub(super) const MOST_BYTES: u64 = 2 * 3601 * 3601;
/// Folders within the folder: `N59/N59E017.hgt`.
const DEEPEST: usize = 3;
/// Most files that are looked at. The land of the world has 14,000 tiles.
const MOST_FILES: usize = 200_000;

/// The south-western corner of a tile, deg.
pub(super) type Corner = (i8, i16);

/// Returns the tiles in a folder and the folders in it. Of two for one corner, it is the one with the
/// shorter path: that of NASA's name, not packed.
///
/// # Errors
/// Returns an error if the folder cannot be read.
pub(super) fn tiles_in(folder: &Path) -> Result<BTreeMap<Corner, PathBuf>> {
    let mut found: BTreeMap<Corner, PathBuf> = BTreeMap::new();
    let files = WalkDir::new(folder).max_depth(DEEPEST).follow_links(true);
    for entry in files.into_iter().take(MOST_FILES) {
        let entry = match entry {
            Ok(entry) => entry,
            // A folder in it that may not be read.
            Err(error) if error.depth() > 0 => continue,
            Err(error) => return Err(Error::io(folder)(error.into())),
        };
        let name = entry.file_name().to_string_lossy().to_ascii_uppercase();
        let Some(corner) = corner_of(&name).filter(|_| entry.file_type().is_file()) else {
            continue;
        };
        let length = |path: &Path| (path.as_os_str().len(), path.to_owned());
        let path = entry.into_path();
        match found.get(&corner) {
            Some(known) if length(known) <= length(&path) => {}
            _ => {
                found.insert(corner, path);
            }
        }
    }
    Ok(found)
}

/// Returns the corner of a name in capitals, such as `N59E017.HGT` or `S34W071.SRTMGL1.HGT.ZIP`.
fn corner_of(name: &str) -> Option<Corner> {
    let (place, rest) = name.split_at_checked(7)?;
    let is_tile = rest.starts_with('.')
        && [".HGT", ".HGT.GZ", ".HGT.ZIP"]
            .iter()
            .any(|end| rest.ends_with(end));
    let number = |at: usize, end: usize| place.get(at..end)?.parse::<i16>().ok();
    let latitude = i8::try_from(number(1, 3)?).ok()?;
    let longitude = number(4, 7)?;
    let latitude = match place.get(..1)? {
        "N" => latitude,
        "S" => -latitude,
        _ => return None,
    };
    let longitude = match place.get(3..4)? {
        "E" => longitude,
        "W" => -longitude,
        _ => return None,
    };
    is_tile.then_some((latitude, longitude))
}

/// Reads the bytes of a tile, unpacked; one more than a tile has if there are more.
///
/// # Errors
/// Returns the error of the disk or of the packed data.
pub(super) fn read_unpacked(path: &Path) -> Result<Vec<u8>> {
    let file = File::open(path).map_err(Error::io(path))?;
    let mut head = Vec::new();
    let mut file = BufReader::new(file);
    let read = file.by_ref().take(4).read_to_end(&mut head);
    read.map_err(Error::io(path))?;
    let rest = head.chain(file);
    let content: io::Result<Box<dyn Read + '_>> = if head.starts_with(GZIP_MAGIC) {
        Ok(Box::new(MultiGzDecoder::new(rest)))
    } else if head == ZIP_MAGIC {
        zip_entry(rest)
    } else {
        Ok(Box::new(rest))
    };
    let mut bytes = Vec::new();
    let read = content.and_then(|content| content.take(MOST_BYTES + 1).read_to_end(&mut bytes));
    match read {
        Ok(_) => Ok(bytes),
        Err(error) => {
            let problem =
                format!("is damaged ({error}); expected an elevation tile, also as .gz or .zip");
            Err(Error::content(path, problem))
        }
    }
}

/// Returns the content of the first entry of a zip archive that is a tile.
fn zip_entry<'a>(mut archive: impl Read + 'a) -> io::Result<Box<dyn Read + 'a>> {
    const HEADER_BYTES: usize = 30;
    let wrong = |words: &str| io::Error::new(io::ErrorKind::InvalidData, words.to_owned());
    loop {
        let mut header = [0; HEADER_BYTES];
        archive.read_exact(&mut header)?;
        let short = |at: usize| u16::from_le_bytes([header[at], header[at + 1]]);
        if !header.starts_with(ZIP_MAGIC) {
            return Err(wrong("no .hgt in the archive"));
        }
        let (flags, method) = (short(6), short(8));
        let packed = u32::from_le_bytes([header[18], header[19], header[20], header[21]]);
        let mut name = vec![0; usize::from(short(26))];
        archive.read_exact(&mut name)?;
        io::copy(
            &mut archive.by_ref().take(short(28).into()),
            &mut io::sink(),
        )?;
        if name.to_ascii_lowercase().ends_with(b".hgt") {
            return match method {
                0 => Ok(Box::new(archive.take(packed.into()))),
                8 => Ok(Box::new(DeflateDecoder::new(archive))),
                _ => Err(wrong("packed in a way that is not read")),
            };
        }
        // The size of such an entry stands behind it.
        if flags & 8 != 0 {
            return Err(wrong("no .hgt at the head of the archive"));
        }
        io::copy(&mut archive.by_ref().take(packed.into()), &mut io::sink())?;
    }
}
