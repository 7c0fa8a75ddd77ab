//! A mission, and the assumed parameters of its bus.

use crate::files::vehicle::VehicleFile;
use estimator_core::{Model, Traction, VehicleParameters};

/// Mass of the empty bus, kg (the paper: about 19 t).
pub const KERB_MASS_KG: f64 = 19_000.0;
/// Mass of a passenger, kg; the prior of the literature for this bus.
pub const PASSENGER_MASS_KG: f64 = 70.0;

/// One second of a mission; `None` is missing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MissionRow {
    /// Time since the mission's first row, s.
    pub time_s: f64,
    /// Speed from the shaft of the middle axle's motor, m/s; the paper calibrated it on GNSS.
    pub speed_mps: Option<f64>,
    /// Force of both motors at the wheels, N.
    pub traction_force_n: Option<f64>,
    /// Mean pressure in the friction brakes, Pa.
    pub brake_pressure_pa: Option<f64>,
    /// Whether the friction brakes, the halt brake or the parking brake are applied.
    pub braking: Option<bool>,
    /// Latitude (WGS 84), degrees.
    pub latitude_deg: Option<f64>,
    /// Longitude (WGS 84), degrees.
    pub longitude_deg: Option<f64>,
    /// Raw GNSS altitude above sea level, m.
    pub altitude_m: Option<f64>,
    /// Course over ground, degrees; `None` at standstill, where the receiver holds or zeroes it.
    pub course_deg: Option<f64>,
    /// Ambient temperature, °C.
    pub ambient_celsius: Option<f64>,
    /// Passengers on board as counted at the last stop.
    pub passengers: Option<f64>,
}

impl MissionRow {
    /// Returns kerb mass plus passengers, kg; that of the empty bus before the first count.
    #[must_use]
    pub fn mass_kg(&self) -> f64 {
        KERB_MASS_KG + PASSENGER_MASS_KG * self.passengers.unwrap_or(0.0)
    }

    /// Returns latitude and longitude, if there is a fix.
    #[must_use]
    pub fn position_deg(&self) -> Option<(f64, f64)> {
        self.latitude_deg.zip(self.longitude_deg)
    }
}

/// A whole mission.
#[derive(Clone, Debug)]
pub struct Mission {
    pub(super) rows: Vec<MissionRow>,
    pub(super) odometer_m: Vec<f64>,
    pub(super) first_fix: usize,
    pub(super) bus: Option<String>,
}

impl Mission {
    /// Returns its rows, in order of time.
    #[must_use]
    pub fn rows(&self) -> &[MissionRow] {
        &self.rows
    }

    /// Returns the driven distance since the first row, m, one value per row.
    #[must_use]
    pub fn odometer_m(&self) -> &[f64] {
        &self.odometer_m
    }

    /// Returns the index of the first row with a GNSS fix.
    #[must_use]
    pub fn first_fix(&self) -> usize {
        self.first_fix
    }

    /// Returns the assumed parameters of the bus.
    ///
    /// Drag area (8 m² frontal, cd 0.65) and rolling resistance are the priors of the literature
    /// for this bus; nothing is fitted. The wheel radius is that of the tyre size, 275/70 R 22.5.
    /// The inertia is that of ten such wheels (two on the front axle, four on each other axle) at
    /// about 10 kg m². The rotors of the motors are not included, because no value is published.
    #[must_use]
    pub fn vehicle(&self) -> VehicleFile {
        VehicleFile {
            name: self
                .bus
                .as_ref()
                .map_or_else(|| "ZTBus".to_owned(), |bus| format!("ZTBus {bus}")),
            model: Model::from(VehicleParameters {
                mass_kg: KERB_MASS_KG as f32,
                drag_area_m2: 5.2,
                rolling_resistance: 0.008,
                wheel_radius_m: 0.48,
                wheel_inertia_kgm2: 100.0,
                traction: Traction::Force,
            }),
        }
    }
}
