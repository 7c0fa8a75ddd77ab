//! Gives each image its linker script: `src/bin/NAME.x` is the memory of `src/bin/NAME.rs` and of
//! `src/bin/NAME_*.rs` that have none of their own.
//!
//! This is not done by `rustflags` in `.cargo/config.toml`. The environment variable `RUSTFLAGS`
//! silently replaces those, and the image would link without a vector table.

use std::path::{Path, PathBuf};
use std::{env, fs};

fn main() {
    let images = Path::new("src/bin");
    println!("cargo::rerun-if-changed={}", images.display());
    if env::var("CARGO_CFG_TARGET_OS").as_deref() != Ok("none") {
        return;
    }
    let out = PathBuf::from(env::var_os("OUT_DIR").expect("cargo sets OUT_DIR"));
    for entry in fs::read_dir(images).expect("src/bin can be listed") {
        let path = entry.expect("src/bin can be listed").path();
        if path.extension().is_none_or(|extension| extension != "rs") {
            continue;
        }
        let image = path.file_stem().expect("a file has a name").display();
        let image = image.to_string();
        let family = image.split('_').next().expect("a name has a part");
        let script = [&image, family]
            .map(|name| images.join(name).with_extension("x"))
            .into_iter()
            .find(|script| script.exists())
            .unwrap_or_else(|| panic!("no linker script for {image}"));
        // cortex-m-rt's link.x includes `memory.x`, so each image has it in a folder of its own.
        let folder = out.join(&image);
        fs::create_dir_all(&folder).expect("the build folder takes a folder");
        fs::copy(&script, folder.join("memory.x")).expect("the build folder takes the script");
        println!("cargo::rustc-link-arg-bin={image}=-L{}", folder.display());
        println!("cargo::rustc-link-arg-bin={image}=-Tlink.x");
        println!("cargo::rustc-link-arg-bin={image}=-Tdefmt.x");
    }
}
