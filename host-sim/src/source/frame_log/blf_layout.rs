//! The layout of BLF objects and containers, and what can be wrong with them.

use super::byte_file::{u16_at, u32_at};
use flate2::read::ZlibDecoder;
use memchr::memmem;
use std::io::{ErrorKind, Read};

/// First bytes of an object.
pub(super) const OBJECT_MAGIC: &[u8] = b"LOBJ";
/// Bytes of the part of an object's header that all objects have.
pub(super) const BASE_BYTES: usize = 16;
/// Bytes of a container between that part and its content.
const CONTAINER_BYTES: usize = 16;
/// Type of a container.
pub(super) const CONTAINER: u32 = 10;
/// Most bytes between two objects: writers differ in how they pad.
pub(super) const MOST_PADDING: usize = 4;
/// Largest object, container or content of a container, bytes. Vector's are 128 KiB.
const MOST_BYTES: usize = 64 << 20;
const METHOD_NONE: u16 = 0;
const METHOD_ZLIB: u16 = 2;
/// Types of objects that record frames and errors, and their largest size, bytes.
const FRAMES: [u32; 7] = [1, 2, 73, 86, 100, 101, 104];
const MOST_FRAME_BYTES: usize = 4096;

/// What is wrong with some bytes of the file or of the stream.
pub(super) struct Flaw {
    pub what: String,
    pub expected: String,
}

impl Flaw {
    pub(super) fn new(what: impl Into<String>, expected: impl Into<String>) -> Self {
        Self {
            what: what.into(),
            expected: expected.into(),
        }
    }

    pub(super) fn no_object() -> Self {
        Self::new("no object behind the one before", "the letters LOBJ")
    }
}

/// Returns where in these bytes the next object begins, behind its padding.
pub(super) fn beginning(bytes: &[u8]) -> Option<usize> {
    (0..=MOST_PADDING).find(|at| {
        bytes
            .get(*at..)
            .is_some_and(|b| b.starts_with(OBJECT_MAGIC))
    })
}

/// Returns the size of an object by its header.
pub(super) fn size_of(header: &[u8]) -> Result<usize, Flaw> {
    let size = u32_at(header, 8).map_or(0, |size| size as usize);
    let is_frame = u32_at(header, 12).is_some_and(|kind| FRAMES.contains(&kind));
    let most = if is_frame {
        MOST_FRAME_BYTES
    } else {
        MOST_BYTES
    };
    if (BASE_BYTES..=most).contains(&size) {
        return Ok(size);
    }
    let what = format!("an object of {size} bytes");
    Err(Flaw::new(what, format!("{BASE_BYTES} to {most}")))
}

/// Returns where in the bytes of a damaged object another container begins: the size of the damaged
/// one may be wrong.
pub(super) fn container_within(packed: &[u8]) -> Option<usize> {
    memmem::find_iter(packed, OBJECT_MAGIC).find(|at| {
        let header = packed.get(*at..).unwrap_or_default();
        *at > 0
            && u16_at(header, 4).map(usize::from) == Some(BASE_BYTES)
            && u32_at(header, 12) == Some(CONTAINER)
            && size_of(header).is_ok()
    })
}

/// Unpacks a container to the end of the stream. Of one that is cut off, what there is.
///
/// # Errors
/// Returns what is wrong with it; what could be unpacked is in the stream.
pub(super) fn unpack(packed: &[u8], is_whole: bool, stream: &mut Vec<u8>) -> Result<(), Flaw> {
    let declared = u32_at(packed, BASE_BYTES + 8);
    let (Some(method), Some(declared), Some(content)) = (
        u16_at(packed, BASE_BYTES),
        declared.map(|size| size as usize),
        packed.get(BASE_BYTES + CONTAINER_BYTES..),
    ) else {
        let flaw = Flaw::new("a container without header", "at least 32 bytes");
        return if is_whole { Err(flaw) } else { Ok(()) };
    };
    if declared > MOST_BYTES {
        let what = format!("a container of {declared} bytes");
        return Err(Flaw::new(what, format!("at most {MOST_BYTES}")));
    }
    match method {
        METHOD_NONE => stream.extend_from_slice(content),
        METHOD_ZLIB => {
            let before = stream.len();
            // One byte more than declared shows that there is more.
            let most = declared as u64 + 1;
            let mut content = ZlibDecoder::new(content).take(most);
            match content.read_to_end(stream) {
                Err(e) if is_whole || e.kind() != ErrorKind::UnexpectedEof => {
                    let what = format!("damaged zlib data ({e})");
                    return Err(Flaw::new(what, "a whole container"));
                }
                _ => {}
            }
            if stream.len() - before > declared {
                let what = format!("a container with more than the {declared} bytes it declares");
                return Err(Flaw::new(what, "as many"));
            }
        }
        _ => {
            let what = format!("compression method {method}");
            return Err(Flaw::new(what, "0 (none) or 2 (zlib)"));
        }
    }
    Ok(())
}
