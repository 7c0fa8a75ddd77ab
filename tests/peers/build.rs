//! Gives the images the memory of the emulated board.

use std::path::PathBuf;
use std::{env, fs};

fn main() {
    let script = "../../firmware/src/bin/budget.x";
    println!("cargo::rerun-if-changed={script}");
    let out = PathBuf::from(env::var_os("OUT_DIR").expect("cargo sets OUT_DIR"));
    fs::copy(script, out.join("memory.x")).expect("the build folder takes the script");
    println!("cargo::rustc-link-arg-bins=-L{}", out.display());
    println!("cargo::rustc-link-arg-bins=-Tlink.x");
}
