//! Names and units: texts (TX), or texts within XML (MD).

use crate::error::Result;
use crate::source::mdf::mdf_file::MdfFile;

/// Letters of a name that are kept.
const MOST_LETTERS: usize = 256;
/// What XML writes for letters that it uses itself.
const ENTITIES: [(&str, &str); 5] = [
    ("&lt;", "<"),
    ("&gt;", ">"),
    ("&quot;", "\""),
    ("&apos;", "'"),
    ("&amp;", "&"),
];

/// Reads the text that a link points to; empty if there is none.
pub(super) fn text(file: &mut MdfFile, link: u64) -> Result<String> {
    let bytes = file.text(link)?;
    let whole = String::from_utf8_lossy(&bytes);
    let plain = whole.trim();
    let inside = plain.starts_with('<').then(|| of_xml(plain)).flatten();
    let text = inside.unwrap_or_else(|| plain.to_owned());
    Ok(text.chars().take(MOST_LETTERS).collect())
}

/// Returns the content of the first element `TX`.
fn of_xml(xml: &str) -> Option<String> {
    let (_, rest) = xml.split_once("<TX")?;
    let (_, rest) = rest.split_once('>')?;
    let (content, _) = rest.split_once("</TX>")?;
    let mut text = content.trim().to_owned();
    for (entity, letter) in ENTITIES {
        text = text.replace(entity, letter);
    }
    Some(text)
}
