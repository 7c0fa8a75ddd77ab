//! Vehicle files: parameters that an estimator accepts and that are read back after writing, or an
//! error that names the file.

use crate::as_file;
use estimator_core::{Context, Tuning};
use host_sim::files::vehicle::VehicleFile;

/// Checks an input.
pub fn vehicle_toml(bytes: &[u8]) {
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
}
