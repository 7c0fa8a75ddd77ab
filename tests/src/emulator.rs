//! The firmware's image on the board that QEMU emulates.

use crate::image::{IMAGE_PROFILE, root, target_folder};
use assert_cmd::Command;
use defmt_decoder::Table;
use estimator_core::packed_vehicle;
use estimator_core::roadmap::PackedMap;
use estimator_core::{Cell, Estimator, Model, Step, Tuning};
use firmware::exchange::frame::RecordedFrame;
use firmware::exchange::{CELLS_FILE, DRIVE_FILE, ON_MAP_FILE, frame, on_map};
use firmware::on_map::OnMap;
use host_sim::error::{Error, Result};
use host_sim::source::can_frame::TimedFrame;
use std::ffi::CStr;
use std::iter::from_fn;
use std::path::{Path, PathBuf};
use std::time::Duration;
use std::{env, fs, process};

const TARGET: &str = "thumbv7em-none-eabihf";
const QEMU: &str = "qemu-system-arm";
const IMAGE: &str = "mps2_an386";

/// File of the map beside the drive, and where the emulator loads it: the region `MAP` of the linker
/// scripts.
const MAP_FILE: &str = "map.grade";
const MAP_ADDRESS: u32 = 0x2100_0000;

/// Timeout for an image that hangs. A fault of the processor ends in a loop.
const LONGEST_RUN: Duration = Duration::from_secs(300);

/// The results of a run on the board.
#[derive(Debug)]
pub struct EmulatorRun {
    /// Exit status of the image; `None` if it hung.
    pub status: Option<i32>,
    /// Lines of its log.
    pub log: Vec<String>,
    /// Its output on stderr.
    pub stderr: String,
    /// The file of cells, if it was written.
    pub cells: Option<Vec<u8>>,
    /// The file of the map's part of each step, if it was written.
    pub on_map: Option<Vec<u8>>,
}

/// Returns what this machine lacks to build and run the image; `None` if it lacks nothing.
#[must_use]
pub fn missing() -> Option<String> {
    let runs = |program: &str| process::Command::new(program).arg("--version").output();
    if runs(QEMU).is_err() {
        return Some(format!("{QEMU} is not installed"));
    }
    let rustc = env::var_os("RUSTC").unwrap_or_else(|| "rustc".into());
    let libraries = process::Command::new(rustc)
        .args(["--print", "target-libdir", "--target", TARGET])
        .output()
        .map(|output| PathBuf::from(String::from_utf8_lossy(&output.stdout).trim()));
    match libraries {
        Ok(folder) if folder.is_dir() => None,
        _ => Some(format!("the Rust target {TARGET} is not installed")),
    }
}

/// Returns the drive as the file that the board reads.
#[must_use]
pub fn drive_file(model: &Model, frames: &[TimedFrame]) -> Vec<u8> {
    let mut bytes = packed_vehicle::encode(model).to_vec();
    for timed in frames {
        let record = frame::encode(timed.time, &timed.frame);
        bytes.extend_from_slice(&record.expect("a frame has at most 8 bytes"));
    }
    bytes
}

/// Builds the image and runs it on the board, with `drive` or without a file of a drive, and with a
/// map in flash or without.
///
/// It uses `cargo run` and the runner of `.cargo/config.toml`, as a user does.
///
/// # Panics
/// Panics if a temporary folder cannot be used or the image cannot be built.
#[must_use]
pub fn replay(drive: Option<&[u8]>, map: Option<&[u8]>) -> EmulatorRun {
    let folder = tempfile::tempdir().expect("a temporary folder");
    if let Some(drive) = drive {
        fs::write(inside(folder.path(), DRIVE_FILE), drive).expect("the drive can be written");
    }
    cargo("build", folder.path()).assert().success();
    let loader = map.map(|map| loader(folder.path(), map).expect("the map can be written"));
    let output = cargo("run", folder.path())
        .arg("--")
        .args(loader.iter().flatten())
        .timeout(LONGEST_RUN)
        .output()
        .expect("cargo runs");
    EmulatorRun {
        status: output.status.code(),
        log: logged(&output.stdout),
        stderr: String::from_utf8_lossy(&output.stderr).into_owned(),
        cells: fs::read(inside(folder.path(), CELLS_FILE)).ok(),
        on_map: fs::read(inside(folder.path(), ON_MAP_FILE)).ok(),
    }
}

/// Writes a map to a folder. Returns the options with which QEMU loads it into flash.
fn loader(folder: &Path, map: &[u8]) -> Result<[String; 2]> {
    let path = folder.join(MAP_FILE);
    fs::write(&path, map).map_err(Error::io(&path))?;
    let device = format!("loader,file={MAP_FILE},addr={MAP_ADDRESS:#x},force-raw=on");
    Ok(["-device".to_owned(), device])
}

/// Returns the lines of a defmt log. Their text is in the image.
fn logged(bytes: &[u8]) -> Vec<String> {
    let image = target_folder().join(TARGET).join(IMAGE_PROFILE).join(IMAGE);
    let image = fs::read(&image).expect("it was just built");
    let table = Table::parse(&image)
        .expect("an image that logs has a table")
        .expect("an image that logs has a table");
    let mut decoder = table.new_stream_decoder();
    decoder.received(bytes);
    let mut lines = Vec::new();
    while let Ok(frame) = decoder.decode() {
        lines.push(frame.display_message().to_string());
    }
    lines
}

/// Returns the cells that this machine computes for the same drive, also in single precision.
///
/// # Panics
/// Panics if the vehicle is impossible.
#[must_use]
pub fn on_host(model: &Model, frames: &[TimedFrame]) -> Vec<Cell> {
    let mut estimator =
        Estimator::<f32>::new(model.clone(), Tuning::default()).expect("a vehicle that can be");
    let mut cells = Vec::new();
    for timed in frames {
        estimator.on_frame(timed.time, &timed.frame);
        while estimator.step().is_some() {
            cells.extend(from_fn(|| estimator.next_cell()));
        }
    }
    cells.extend(from_fn(|| estimator.drain_cell()));
    cells
}

/// Returns what this machine computes with a map for each step of the same drive, as the board writes
/// it.
///
/// # Panics
/// Panics if the vehicle is impossible.
#[must_use]
pub fn on_host_with_map(model: &Model, frames: &[TimedFrame], map: PackedMap<'_>) -> Vec<u8> {
    let mut estimator =
        Estimator::<f32>::new(model.clone(), Tuning::default()).expect("a vehicle that can be");
    let mut on_map = OnMap::new(map);
    let mut bytes = Vec::new();
    for timed in frames {
        estimator.on_frame(timed.time, &timed.frame);
        while let Some(step) = estimator.step() {
            if let (Step::Moved, Some(live)) = (step, estimator.live()) {
                on_map.advance(&live);
                bytes.extend(on_map::encode::<RecordedFrame>(&mut on_map, &live));
            }
            while let Some(cell) = estimator.next_cell() {
                on_map.finish(&cell);
            }
        }
    }
    bytes
}

/// Starts an image on a machine that counts instructions (`firmware::meter`), with a file of
/// `drive` beside it and, if given, a map in flash. Returns its output.
///
/// # Errors
/// QEMU cannot be started, or the image fails.
pub fn count(machine: &str, image: &Path, drive: &[u8], map: Option<&[u8]>) -> Result<Vec<u8>> {
    let folder = tempfile::tempdir().map_err(Error::io(Path::new("temporary folder")))?;
    let drive_file = inside(folder.path(), DRIVE_FILE);
    fs::write(&drive_file, drive).map_err(Error::io(&drive_file))?;
    let loader = map.map(|map| loader(folder.path(), map)).transpose()?;
    let output = Command::new(QEMU)
        .args(["-machine", machine, "-icount", "shift=6", "-nographic"])
        .args(["-semihosting-config", "enable=on,target=native"])
        .arg("-kernel")
        .arg(image)
        .args(loader.iter().flatten())
        .current_dir(folder.path())
        .timeout(LONGEST_RUN)
        .output()
        .map_err(Error::io(Path::new(QEMU)))?;
    if output.status.success() {
        return Ok(output.stdout);
    }
    let status = output.status;
    let complaint = String::from_utf8_lossy(&output.stderr);
    Err(Error::content(image, format!("{status}: {complaint}")))
}

fn cargo(command: &str, folder: &Path) -> Command {
    let root = root();
    let mut cargo = Command::new(env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    cargo
        .args([command, "--quiet", "--profile", IMAGE_PROFILE])
        .args(["--target", TARGET, "--package", "firmware"])
        .args(["--bin", IMAGE])
        .arg("--manifest-path")
        .arg(root.join("Cargo.toml"))
        .arg("--config")
        .arg(root.join(".cargo/config.toml"))
        .current_dir(folder);
    cargo
}

fn inside(folder: &Path, name: &CStr) -> PathBuf {
    folder.join(name.to_string_lossy().as_ref())
}
