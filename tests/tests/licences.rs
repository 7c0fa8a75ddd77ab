//! The licences of all packages, those of tests and boards included, permit use and distribution.

use cargo_metadata::{CargoOpt, MetadataCommand};
use cross_tests::image::root;
use spdx::{Expression, LicenseReq};

/// Licences that require no more than their own text or, for MPL, the package's own source.
const ALLOWED: [&str; 16] = [
    "0BSD",
    "Apache-2.0",
    "BSD-2-Clause",
    "BSD-3-Clause",
    "BSL-1.0",
    "CC0-1.0",
    "CDLA-Permissive-2.0",
    "ISC",
    "MIT",
    "MIT-0",
    "MPL-2.0",
    "NCSA",
    "Unicode-3.0",
    "Unlicense",
    "WTFPL",
    "Zlib",
];
/// Folders of the workspaces.
const WORKSPACES: [&str; 4] = [".", "tests/peers", "firmware/stm32g4", "tests/benches"];

#[test]
fn licences_of_all_packages_are_permissive() {
    let mut problems = Vec::new();
    let mut packages = 0;
    for workspace in WORKSPACES {
        let metadata = MetadataCommand::new()
            .manifest_path(root().join(workspace).join("Cargo.toml"))
            .features(CargoOpt::AllFeatures)
            .other_options(vec!["--locked".into()])
            .exec()
            .unwrap_or_else(|e| panic!("{workspace}: {e}"));
        for package in &metadata.packages {
            packages += 1;
            let licence = package.license.as_deref().unwrap_or("none declared");
            let expression = Expression::parse_mode(licence, spdx::ParseMode::LAX);
            if !expression.is_ok_and(|licence| licence.evaluate(allows)) {
                problems.push(format!("{} {}: {licence}", package.name, package.version));
            }
        }
    }
    assert!(packages > 100, "{packages}");
    assert!(problems.is_empty(), "{problems:#?}");
}

fn allows(required: &LicenseReq) -> bool {
    let name = required.license.id().map(|id| id.name);
    name.is_some_and(|name| ALLOWED.contains(&name))
}
