//! Parameters of a vehicle file that the bus contradicted.

use estimator_core::{Model, Traction};
use std::fmt;

/// A parameter of which the bus says another value than the vehicle file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReplacedParameter {
    /// Key in the vehicle file.
    pub key: &'static str,
    /// Its unit.
    pub unit: &'static str,
    /// Digits behind the point.
    digits: usize,
    /// Value of the vehicle file.
    pub file: f32,
    /// Value of the bus, which is used.
    pub bus: f32,
}

impl fmt::Display for ReplacedParameter {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            key,
            unit,
            digits,
            file,
            bus,
        } = self;
        write!(
            f,
            "EC1 says {key} = {bus:.digits$} {unit}, the vehicle file {file:.digits$} {unit}: the \
             bus is used"
        )
    }
}

/// Returns the parameters in which the model that a drive ended with differs from the given one.
#[must_use]
pub fn replaced(given: &Model, used: &Model) -> Vec<ReplacedParameter> {
    let (Traction::Powertrain(file), Traction::Powertrain(bus)) =
        (&given.vehicle.traction, &used.vehicle.traction)
    else {
        return Vec::new();
    };
    let torque = ReplacedParameter {
        key: "reference_torque_nm",
        unit: "Nm",
        digits: 0,
        file: file.reference_torque_nm,
        bus: bus.reference_torque_nm,
    };
    let inertia = ReplacedParameter {
        key: "engine_inertia_kgm2",
        unit: "kg m²",
        digits: 3,
        file: file.engine_inertia_kgm2,
        bus: bus.engine_inertia_kgm2,
    };
    let both = [torque, inertia].into_iter();
    both.filter(|parameter| parameter.file != parameter.bus)
        .collect()
}
