//! Gives each image its linker script: `src/bin/BOARD.x` is the memory of `src/bin/BOARD.rs`.
//!
//! Done here and not by `rustflags` in `.cargo/config.toml`, which an environment that sets
//! `RUSTFLAGS` silently replaces: the image would link, without a vector table.

use std::path::{Path, PathBuf};
use std::{env, fs};

fn main() {
    let boards = Path::new("src/bin");
    println!("cargo::rerun-if-changed={}", boards.display());
    if env::var("CARGO_CFG_TARGET_OS").as_deref() != Ok("none") {
        return;
    }
    let out = PathBuf::from(env::var_os("OUT_DIR").expect("cargo sets OUT_DIR"));
    for entry in fs::read_dir(boards).expect("src/bin can be listed") {
        let path = entry.expect("src/bin can be listed").path();
        if path.extension().is_none_or(|extension| extension != "x") {
            continue;
        }
        let board = path.file_stem().expect("a file has a name");
        // cortex-m-rt's link.x includes `memory.x`, so each board has it in a folder of its own.
        let folder = out.join(board);
        fs::create_dir_all(&folder).expect("the build folder takes a folder");
        fs::copy(&path, folder.join("memory.x")).expect("the build folder takes the script");
        let board = board.display();
        println!("cargo::rustc-link-arg-bin={board}=-L{}", folder.display());
        println!("cargo::rustc-link-arg-bin={board}=-Tlink.x");
    }
}
