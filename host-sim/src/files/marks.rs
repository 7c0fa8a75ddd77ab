//! First bytes that several readers look for.

/// Of a gzip file (RFC 1952).
pub(crate) const GZIP_MAGIC: &[u8] = &[0x1f, 0x8b];
/// Of an entry of a zip archive (PKWARE's APPNOTE, 4.3.7).
pub(crate) const ZIP_MAGIC: &[u8] = b"PK\x03\x04";
/// Of a text in UTF-8, which some programs mark.
pub(crate) const BYTE_ORDER_MARK: &[u8] = b"\xef\xbb\xbf";
