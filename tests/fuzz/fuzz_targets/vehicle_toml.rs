//! Vehicle files: parameters that an estimator accepts and that are read back after writing, or an
//! error that names the file.

#![no_main]

use estimator_core::{Context, Tuning};
use fuzz_targets::as_file;
use host_sim::files::vehicle::VehicleFile;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    as_file(".toml", bytes, |path| match VehicleFile::read(path) {
        Ok(vehicle) => {
            let context = Context::new(vehicle.model.clone(), Tuning::default());
            assert!(context.is_ok(), "{:?}", context.err());
            as_file(".toml", vehicle.to_toml().as_bytes(), |written| {
                let again = VehicleFile::read(written).expect("what was written can be read");
                assert_eq!(again, vehicle);
            });
        }
        Err(error) => assert!(error.to_string().contains(&path.display().to_string())),
    });
});
