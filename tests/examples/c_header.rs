//! Makes the header of the C interface from its sources: compares it, or writes it with `--write`.

use cross_tests::image::root;
use std::process::ExitCode;

fn main() -> ExitCode {
    let folder = root().join("firmware/c");
    let path = folder.join("include/road_grade.h");
    let mut made = Vec::new();
    // The plain structures of the core that C sees as they are.
    let core = root().join("estimator-core/src");
    let builder = cbindgen::Builder::new()
        .with_config(cbindgen::Config::from_root_or_default(&folder))
        .with_crate(&folder)
        .with_src(core.join("cell.rs"))
        .with_src(core.join("counters.rs"));
    match builder.generate() {
        Ok(bindings) => bindings.write(&mut made),
        Err(error) => {
            eprintln!("{error}");
            return ExitCode::FAILURE;
        }
    }
    if std::env::args().any(|argument| argument == "--write") {
        if let Err(error) = std::fs::write(&path, &made) {
            eprintln!("{}: {error}", path.display());
            return ExitCode::FAILURE;
        }
    } else if std::fs::read(&path).ok() != Some(made) {
        eprintln!(
            "include/road_grade.h is not what the sources say; run this with --write and look at the change"
        );
        return ExitCode::FAILURE;
    }
    ExitCode::SUCCESS
}
