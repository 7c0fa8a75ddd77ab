//! Other Kalman filters on the same board, side by side.

use crate::budgets::CORTEX_M4F;
use crate::emulator::count;
use crate::image::{Image, build, root};
use host_sim::error::{Error, Result};
use host_sim::terminal::table::text_table;
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

/// Build profiles of the images, and their opt-levels.
const PROFILES: [(&str, &str); 2] = [("release", "3"), ("small", "s")];
/// The image without a filter.
const NOTHING: &str = "nothing";
/// The image of the estimator's filter. Its model differs from that of the peers.
const OURS: &str = "ours";
/// Largest difference of two filters that do the same work, absolute or relative.
const AGREEMENT: f32 = 1e-3;

/// The figures of one filter's image.
struct Peer {
    image: Image,
    instructions: u32,
    stack_bytes: u32,
    filter_bytes: u32,
    state: Vec<f32>,
}

/// Builds and runs the images of `tests/peers`. Returns a table of them.
///
/// # Errors
/// An image cannot be built or run, or filters disagree: one of them did not do the work.
pub fn table() -> Result<String> {
    let package = root().join("tests/peers");
    let names = names(&package.join("src/bin"))?;
    // By states, filter and opt-level.
    let mut rows: BTreeMap<(usize, String, &str), Vec<String>> = BTreeMap::new();
    for (profile, opt_level) in PROFILES {
        let images = build(&package, CORTEX_M4F.target, profile)?;
        let nothing = Image::read(&images.join(NOTHING))?;
        let mut agreed: BTreeMap<usize, Vec<f32>> = BTreeMap::new();
        for name in &names {
            let path = images.join(name);
            let peer = Peer::run(&path)?;
            let (filter, _) = name.rsplit_once('_').unwrap_or((name, ""));
            if filter != OURS {
                let expected = agreed.entry(peer.state.len()).or_insert(peer.state.clone());
                peer.check(expected, &path)?;
            }
            let row = vec![
                peer.state.len().to_string(),
                filter.to_owned(),
                opt_level.to_owned(),
                peer.instructions.to_string(),
                (peer.image.flash_bytes - nothing.flash_bytes).to_string(),
                peer.filter_bytes.to_string(),
                peer.stack_bytes.to_string(),
                (peer.image.panics.len() - nothing.panics.len()).to_string(),
            ];
            rows.insert((peer.state.len(), filter.to_owned(), opt_level), row);
        }
    }
    let header = [
        "states",
        "filter",
        "opt-level",
        "instructions",
        "flash",
        "RAM",
        "stack",
        "panicking functions",
    ];
    let rows: Vec<Vec<String>> = rows.into_values().collect();
    Ok(text_table(&header, &rows, 3).to_string())
}

/// Returns the names of the images of filters.
fn names(folder: &Path) -> Result<Vec<String>> {
    let mut names = Vec::new();
    for entry in fs::read_dir(folder).map_err(Error::io(folder))? {
        let path = entry.map_err(Error::io(folder))?.path();
        let name = path.file_stem().unwrap_or_default().to_string_lossy();
        if name != NOTHING {
            names.push(name.into_owned());
        }
    }
    names.sort();
    Ok(names)
}

impl Peer {
    fn run(path: &Path) -> Result<Self> {
        let printed = count(CORTEX_M4F.machine, path, &[], None)?;
        let (words, _) = printed.as_chunks();
        let words: Vec<u32> = words.iter().map(|word| u32::from_le_bytes(*word)).collect();
        let [instructions, _worst, stack_bytes, filter_bytes, state @ ..] = &*words else {
            return Err(Error::content(path, "counted nothing"));
        };
        Ok(Self {
            image: Image::read(path)?,
            instructions: *instructions,
            stack_bytes: *stack_bytes,
            filter_bytes: *filter_bytes,
            state: state.iter().map(|bits| f32::from_bits(*bits)).collect(),
        })
    }

    fn check(&self, expected: &[f32], path: &Path) -> Result<()> {
        let agrees = |(a, b): (&f32, &f32)| (a - b).abs() <= AGREEMENT * b.abs().max(1.0);
        if self.state.iter().zip(expected).all(agrees) {
            return Ok(());
        }
        let problem = format!("ended at {:?}, others at {expected:?}", self.state);
        Err(Error::content(path, problem))
    }
}
