//! Outputs that must not be inputs.

use crate::error::{Error, Result, on_one_line};
use crate::files::same::handle;
use same_file::Handle;
use std::path::{Path, PathBuf};

/// Endings of formats in which other files are.
const OTHER_FORMATS: [&str; 13] = [
    "parquet", "geojson", "json", "html", "htm", "gz", "zst", "toml", "log", "svg", "grade",
    "xlsx", "txt",
];

/// Checks, before anything is written, that no output is an input or another output, under
/// whatever name.
///
/// # Errors
/// Names both files.
pub(super) fn check<'p>(
    inputs: impl IntoIterator<Item = &'p Path>,
    outputs: impl IntoIterator<Item = &'p Path>,
) -> Result<()> {
    let mut known: Vec<(PathBuf, Option<Handle>, &str)> = inputs
        .into_iter()
        .map(|path| (path.to_owned(), handle(path), "an input"))
        .collect();
    for path in outputs {
        let own = handle(path);
        let same = known.iter().find(|(other, handle, _)| {
            other == path || (own.is_some() && own.as_ref() == handle.as_ref())
        });
        if let Some((other, _, what)) = same {
            let name = if other == path {
                String::new()
            } else {
                format!(" ({})", on_one_line(other))
            };
            let problem = format!("is {what} too{name}; expected another file for the output");
            return Err(Error::content(path, problem));
        }
        known.push((path.to_owned(), own, "another output"));
    }
    Ok(())
}

/// Checks that the name of a table does not promise another format: the content would be CSV all
/// the same.
///
/// # Errors
/// Returns a usage error that names the formats.
pub(super) fn check_table(path: &Path, endings: &[&str]) -> Result<()> {
    let ending = path.extension().unwrap_or_default().to_string_lossy();
    let ending = ending.to_ascii_lowercase();
    if !OTHER_FORMATS.contains(&&*ending) || endings.contains(&&*ending) {
        return Ok(());
    }
    let endings: Vec<String> = endings.iter().map(|ending| format!(".{ending}")).collect();
    let geojson = match &*ending {
        "geojson" | "json" | "html" | "htm" => "; `roadgrade export` writes GeoJSON and pages",
        _ => "",
    };
    Err(Error::Usage(format!(
        "{}: ends in .{ending}; expected {}{geojson}",
        on_one_line(path),
        endings.join(" or ")
    )))
}
