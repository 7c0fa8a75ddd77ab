//! Outputs: none may be an input, and each has a folder and a known ending.

use crate::error::{Error, Result, on_one_line};
use crate::files::output::{is_stdout, is_written_through};
use crate::files::parquet::check_output;
use crate::files::same::handle;
use crate::terminal::print::leave_stdout;
use same_file::Handle;
use std::path::{Path, PathBuf};

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

/// Checks the name of an output file before the work begins: its folder exists, and it ends as a
/// known format does or has no ending. What is written through has any name.
///
/// # Errors
/// Returns a usage error that names the formats, or an error that names the missing folder.
pub(super) fn check_file(path: &Path, endings: &[&str]) -> Result<()> {
    check_output(path)?;
    if is_written_through(path) {
        return check_folder(path);
    }
    let ending = path.extension().unwrap_or_default().to_string_lossy();
    let ending = ending.to_ascii_lowercase();
    if !ending.is_empty() && !endings.contains(&&*ending) {
        return Err(unknown_ending(path, &ending, endings));
    }
    check_folder(path)
}

/// Checks, before the work begins, that the folder of an output file exists. If the output is
/// standard output, tables go to standard error.
///
/// # Errors
/// Names the missing folder.
pub(super) fn check_folder(path: &Path) -> Result<()> {
    if is_stdout(path) {
        leave_stdout();
    }
    let folder = path
        .parent()
        .filter(|of| !of.as_os_str().is_empty() && !is_stdout(path));
    match folder.filter(|folder| !folder.is_dir()) {
        Some(folder) => Err(Error::content(
            path,
            format!(
                "there is no folder {}; create it, or name another one",
                on_one_line(folder)
            ),
        )),
        None => Ok(()),
    }
}

fn unknown_ending(path: &Path, ending: &str, endings: &[&str]) -> Error {
    let endings: Vec<String> = endings.iter().map(|ending| format!(".{ending}")).collect();
    let geojson = match ending {
        "geojson" | "json" | "html" | "htm" => "; `roadgrade export` writes GeoJSON and pages",
        _ => "",
    };
    Error::Usage(format!(
        "{}: ends in .{ending}; expected {}{geojson}",
        on_one_line(path),
        endings.join(" or ")
    ))
}
