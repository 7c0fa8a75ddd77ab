//! Arguments that are addresses of objects, `s3://BUCKET/KEY`: the commands get files instead.

use crate::error::{Error, Result};
use crate::files::object_storage::{Object, ObjectStorage, ObjectUrl, Wanted};
use crate::terminal::print::show_instead;
use crate::terminal::progress;
use clap::{ArgMatches, Command};
use indicatif::ProgressFinish;
use std::cmp::Reverse;
use std::ffi::{OsStr, OsString};
use std::fs;
use std::path::Path;

/// Commands that take addresses. The others work beside a bus, or on files that name others.
const COMMANDS: [&str; 11] = [
    "diagnose", "estimate", "export", "fuse", "horizon", "identify", "inspect", "map", "pack",
    "place", "score",
];
/// Arguments of outputs, and of files that are read and then replaced.
const OUTPUTS: [&str; 4] = ["out", "dataset", "page", "placed"];
const REPLACED: [&str; 3] = ["store", "kept", "memory"];
/// Arguments that may be folders, with the endings of what is read in them. All others are inputs.
const FOLDERS: [(&str, &[&str]); 3] = [
    ("runs", &["parquet", "csv"]),
    ("sessions", &["parquet", "csv"]),
    ("terrain", &["hgt"]),
];

/// The objects of a command line, as files until this is dropped.
pub(super) struct Objects {
    /// The command line with files.
    pub(super) arguments: Vec<OsString>,
    _storage: ObjectStorage,
}

/// An address in the command line.
struct Named {
    argument: String,
    text: String,
    url: ObjectUrl,
}

impl Objects {
    /// Brings the objects that a valid command line reads; `None` if it names none.
    ///
    /// # Errors
    /// Returns an error that names the object, or that the command takes no objects.
    pub(super) fn of(command: &Command, arguments: &[OsString]) -> Result<Option<Self>> {
        let is_address = |argument: &OsString| argument.to_string_lossy().contains("s3://");
        if !arguments.iter().any(is_address) {
            return Ok(None);
        }
        let matches = command.clone().get_matches_from(arguments);
        let named = named(command, &matches)?;
        if named.is_empty() {
            return Ok(None);
        }
        let storage = ObjectStorage::open(sending)?;
        let folder = format!("{}/", storage.folder().display());
        show_instead(folder.clone(), "s3://".to_owned());
        prepare(&storage, &named)?;
        let local = |argument: &OsString| local(argument, &named, &storage);
        Ok(Some(Self {
            arguments: arguments.iter().map(local).collect(),
            _storage: storage,
        }))
    }
}

/// Returns the addresses in the arguments of the subcommand.
fn named(command: &Command, matches: &ArgMatches) -> Result<Vec<Named>> {
    if let Some((name, matches)) = matches.subcommand()
        && let Some(subcommand) = command.find_subcommand(name)
    {
        let found = named(subcommand, matches)?;
        return match found.first() {
            Some(first) if !COMMANDS.contains(&name) => Err(Error::Storage {
                url: first.text.clone(),
                problem: format!("`{name}` takes files only; expected a path"),
            }),
            _ => Ok(found),
        };
    }
    let mut found = Vec::new();
    for argument in command.get_arguments().map(|of| of.get_id().as_str()) {
        let values = matches.try_get_raw(argument).ok().flatten();
        for value in values.into_iter().flatten().filter_map(OsStr::to_str) {
            for text in paths(argument, value) {
                if let Some(url) = ObjectUrl::parse(text)? {
                    found.push(Named {
                        argument: argument.to_owned(),
                        text: text.to_owned(),
                        url,
                    });
                }
            }
        }
    }
    Ok(found)
}

/// Returns the paths in the value of an argument. Those of a session stand behind its name.
fn paths<'v>(argument: &str, value: &'v str) -> Vec<&'v str> {
    match value.split_once('=') {
        Some((_, paths)) if argument == "sessions" => paths.split(',').collect(),
        _ => vec![value],
    }
}

/// Brings what is read, and makes the folders of what is written.
fn prepare(storage: &ObjectStorage, named: &[Named]) -> Result<()> {
    let mut objects: Vec<Object> = Vec::new();
    for Named { argument, url, .. } in named {
        let path = storage.path_of(url);
        let wanted = if OUTPUTS.contains(&&**argument) {
            let folder = if url.is_folder() {
                Some(&*path)
            } else {
                path.parent()
            };
            make_folder(folder)?;
            continue;
        } else if REPLACED.contains(&&**argument) {
            make_folder(path.parent())?;
            Wanted::ToReplace
        } else {
            let folder = FOLDERS.iter().find(|(of, _)| of == argument);
            folder.map_or(Wanted::Object, |(_, endings)| Wanted::Below(endings))
        };
        objects.extend(storage.find(url, wanted)?);
    }
    // Folders may overlap.
    objects.sort();
    objects.dedup();
    let bar = progress::bytes(objects.iter().map(|object| object.size).sum());
    let fetched = storage.fetch(&objects, &|bytes| bar.inc(bytes));
    bar.finish_and_clear();
    fetched
}

/// Shows how much of an object has been sent.
fn sending(bytes: u64) -> Box<dyn Fn(u64)> {
    let bar = progress::bytes(bytes).with_finish(ProgressFinish::AndClear);
    Box::new(move |bytes| bar.inc(bytes))
}

fn make_folder(path: Option<&Path>) -> Result<()> {
    path.map_or(Ok(()), |path| {
        fs::create_dir_all(path).map_err(Error::io(path))
    })
}

/// Returns an argument with files in place of addresses: PATH, --option=PATH or NAME=PATH,PATH.
fn local(argument: &OsString, named: &[Named], storage: &ObjectStorage) -> OsString {
    let Some(text) = argument.to_str() else {
        return argument.clone();
    };
    let mut named: Vec<&Named> = named.iter().collect();
    // An address may be the beginning of another one.
    named.sort_by_key(|named| Reverse(named.text.len()));
    let replace = |text: String, named: &Named| {
        let path = storage.path_of(&named.url);
        replaced(&text, &named.text, &path.to_string_lossy())
    };
    named.into_iter().fold(text.to_owned(), replace).into()
}

/// Returns a text with a path in place of an address, where the address stands alone.
fn replaced(text: &str, address: &str, path: &str) -> String {
    let mut done = String::new();
    let mut rest = text;
    while let Some((before, after)) = rest.split_once(address) {
        done += before;
        let begins = done.is_empty() || done.ends_with(['=', ',']);
        let ends = after.is_empty() || after.starts_with(',');
        done += if begins && ends { path } else { address };
        rest = after;
    }
    done + rest
}
