//! The true vehicle: the thesis's eq. 1-4 and the left side of eq. 9 in f64, with an engine.

use estimator_core::{Gear, Powertrain, Traction, VehicleParameters};
use std::f64::consts::PI;

/// Standard gravity, m/s².
pub const GRAVITY: f64 = 9.806_65;
/// Largest torque of the retarder, at the output shaft, Nm.
pub(super) const RETARDER_NM: f64 = 3_500.0;
/// Idle speed of the engine, rpm.
pub const IDLE_RPM: f64 = 600.0;

/// Indicated full-load torque over the reference torque, at engine speeds in rpm. The shape of a
/// turbocharged diesel: flat from 1100 to 1350, constant power above.
const FULL_LOAD: [(f64, f64); 8] = [
    (500.0, 0.55),
    (800.0, 0.78),
    (1000.0, 0.93),
    (1100.0, 0.96),
    (1350.0, 0.96),
    (1600.0, 0.86),
    (1900.0, 0.76),
    (2400.0, 0.3),
];
/// Friction torque over the reference torque: at standstill, and per rpm. About 7 % at cruising
/// speed.
const FRICTION: (f64, f64) = (0.03, 3.5e-5);

/// Ratios of the 12-speed gearbox of both presets, first gear first; the last is direct.
const RATIOS: [f32; 12] = [
    14.94, 11.73, 9.04, 7.09, 5.54, 4.35, 3.44, 2.70, 2.08, 1.63, 1.27, 1.0,
];

/// Vehicles A and B of the thesis (table 1): a 39 t tractor and semi-trailer of 310 hp, and a
/// 12 t solo tractor of 420 hp. Drag area, rolling resistance and driveline are not given there;
/// they are common values for such vehicles.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Deserialize)]
pub enum Preset {
    /// 39 t.
    A,
    /// 12 t.
    B,
}

impl Preset {
    /// Returns the name in files.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::A => "A",
            Self::B => "B",
        }
    }

    /// Returns its parameters.
    #[must_use]
    pub fn parameters(self) -> VehicleParameters {
        let gears = RATIOS
            .into_iter()
            .map(|ratio| Gear {
                ratio,
                efficiency: if ratio == 1.0 { 0.995 } else { 0.985 },
            })
            .collect();
        match self {
            Self::A => VehicleParameters {
                mass_kg: 39_000.0,
                drag_area_m2: 6.0,
                rolling_resistance: 0.0065,
                wheel_radius_m: 0.5,
                wheel_inertia_kgm2: 110.0,
                traction: Traction::Powertrain(Powertrain {
                    engine_inertia_kgm2: 3.8,
                    reference_torque_nm: 1750.0,
                    final_drive_ratio: 2.92,
                    final_drive_efficiency: 0.98,
                    gears,
                }),
            },
            Self::B => VehicleParameters {
                mass_kg: 12_000.0,
                drag_area_m2: 5.5,
                rolling_resistance: 0.007,
                wheel_radius_m: 0.5,
                wheel_inertia_kgm2: 60.0,
                traction: Traction::Powertrain(Powertrain {
                    engine_inertia_kgm2: 4.4,
                    reference_torque_nm: 2370.0,
                    final_drive_ratio: 2.71,
                    final_drive_efficiency: 0.98,
                    gears,
                }),
            },
        }
    }
}

/// One gear, referred to the wheels.
#[derive(Clone, Copy, Debug)]
struct Transmission {
    /// Ratio of the gearbox alone.
    gear_ratio: f64,
    /// Engine revolutions per revolution of the wheels.
    ratio: f64,
    /// Fraction of the power that reaches the wheels.
    efficiency: f64,
}

/// The true vehicle.
#[derive(Clone, Debug)]
pub struct Truck {
    /// Mass, kg.
    pub mass_kg: f64,
    drag_area_m2: f64,
    rolling_resistance: f64,
    wheel_radius_m: f64,
    wheel_inertia_kgm2: f64,
    final_drive_ratio: f64,
    /// Ratio of a transfer case between gearbox and final drive.
    range_ratio: f64,
    engine_inertia_kgm2: f64,
    /// True torque at a reported 100 %, Nm.
    pub reference_torque_nm: f64,
    transmissions: Vec<Transmission>,
}

impl Truck {
    /// Creates the vehicle with these true parameters; `None` without engine and gearbox.
    #[must_use]
    pub fn new(parameters: &VehicleParameters) -> Option<Self> {
        let Traction::Powertrain(powertrain) = &parameters.traction else {
            return None;
        };
        let final_drive_ratio = f64::from(powertrain.final_drive_ratio);
        let transmissions = powertrain
            .gears
            .iter()
            .map(|gear| Transmission {
                gear_ratio: f64::from(gear.ratio),
                ratio: f64::from(gear.ratio) * final_drive_ratio,
                efficiency: f64::from(gear.efficiency)
                    * f64::from(powertrain.final_drive_efficiency),
            })
            .collect();
        Some(Self {
            mass_kg: f64::from(parameters.mass_kg),
            drag_area_m2: f64::from(parameters.drag_area_m2),
            rolling_resistance: f64::from(parameters.rolling_resistance),
            wheel_radius_m: f64::from(parameters.wheel_radius_m),
            wheel_inertia_kgm2: f64::from(parameters.wheel_inertia_kgm2),
            final_drive_ratio,
            range_ratio: 1.0,
            engine_inertia_kgm2: f64::from(powertrain.engine_inertia_kgm2),
            reference_torque_nm: f64::from(powertrain.reference_torque_nm),
            transmissions,
        })
    }

    /// Engages this ratio of a transfer case between gearbox and final drive.
    pub fn engage_range(&mut self, range_ratio: f64) {
        if self.range_ratio != range_ratio {
            self.range_ratio = range_ratio;
            for transmission in &mut self.transmissions {
                transmission.ratio = transmission.gear_ratio * self.final_drive_ratio * range_ratio;
            }
        }
    }

    /// Returns the ratio of the transfer case.
    #[must_use]
    pub const fn range_ratio(&self) -> f64 {
        self.range_ratio
    }

    /// Returns the retarder's torque for its force at the wheels, % of its largest one.
    #[must_use]
    pub fn retarder_percent(&self, force_n: f64) -> f64 {
        100.0 * force_n * self.wheel_radius_m / (self.final_drive_ratio * RETARDER_NM)
    }

    /// Returns the number of the highest gear. Gears count from 1; 0 is neutral.
    #[must_use]
    pub fn top_gear(&self) -> usize {
        self.transmissions.len()
    }

    /// Returns the ratio of a gear; 0 in neutral.
    #[must_use]
    pub fn gear_ratio(&self, gear: usize) -> f64 {
        self.transmission(gear).map_or(0.0, |t| t.gear_ratio)
    }

    fn transmission(&self, gear: usize) -> Option<&Transmission> {
        self.transmissions.get(gear.checked_sub(1)?)
    }

    /// Returns the speed of the gearbox's output shaft, rpm.
    #[must_use]
    pub fn output_shaft_rpm(&self, speed_mps: f64) -> f64 {
        speed_mps / self.wheel_radius_m * self.final_drive_ratio * (30.0 / PI)
    }

    /// Returns the engine speed in `gear` without slip, rpm; 0 in neutral.
    #[must_use]
    pub fn engine_rpm(&self, gear: usize, speed_mps: f64) -> f64 {
        self.output_shaft_rpm(speed_mps) * self.range_ratio * self.gear_ratio(gear)
    }

    /// Returns the full-load net torque, Nm.
    #[must_use]
    pub fn full_load_nm(&self, rpm: f64) -> f64 {
        let after = FULL_LOAD
            .partition_point(|point| point.0 <= rpm)
            .clamp(1, FULL_LOAD.len() - 1);
        let (from, to) = (FULL_LOAD[after - 1], FULL_LOAD[after]);
        let part = ((rpm - from.0) / (to.0 - from.0)).clamp(0.0, 1.0);
        let indicated = from.1 + part * (to.1 - from.1);
        (indicated * self.reference_torque_nm - self.friction_nm(rpm)).max(0.0)
    }

    /// Returns the friction torque, Nm, positive.
    #[must_use]
    pub fn friction_nm(&self, rpm: f64) -> f64 {
        (FRICTION.0 + FRICTION.1 * rpm) * self.reference_torque_nm
    }

    /// Returns the net torque that accelerates the free engine by `rpm_per_s`, Nm.
    #[must_use]
    pub fn spin_up_nm(&self, rpm_per_s: f64) -> f64 {
        self.engine_inertia_kgm2 * rpm_per_s * (PI / 30.0)
    }

    /// Returns the force at the wheels per newton metre of net engine torque in `gear` (eq. 4),
    /// N/Nm.
    #[must_use]
    pub fn force_per_torque(&self, gear: usize) -> f64 {
        self.transmission(gear)
            .map_or(0.0, |t| t.ratio * t.efficiency / self.wheel_radius_m)
    }

    /// Returns the accelerated mass (eq. 9), kg: with that of the wheels and, through a closed
    /// driveline, of the engine. `gear` is 0 if the driveline is open.
    #[must_use]
    pub fn accelerated_kg(&self, gear: usize) -> f64 {
        let engine = self.transmission(gear).map_or(0.0, |t| {
            t.ratio * t.ratio * t.efficiency * self.engine_inertia_kgm2
        });
        self.mass_kg + (self.wheel_inertia_kgm2 + engine) / self.wheel_radius_m.powi(2)
    }

    /// Returns the air resistance (eq. 5) at a speed through the air, N; negative if a tail wind is
    /// faster than the truck.
    #[must_use]
    pub fn air_resistance_n(&self, airspeed_mps: f64, air_density: f64) -> f64 {
        0.5 * self.drag_area_m2 * air_density * airspeed_mps * airspeed_mps.abs()
    }

    /// Returns the air and rolling resistance in still air with warm tyres (eq. 5 and 6), N.
    #[must_use]
    pub fn resistance_n(&self, speed_mps: f64, air_density: f64) -> f64 {
        self.air_resistance_n(speed_mps, air_density) + self.rolling_resistance_n()
    }

    /// Returns the rolling resistance of warm tyres (eq. 6), N.
    #[must_use]
    pub fn rolling_resistance_n(&self) -> f64 {
        self.mass_kg * GRAVITY * self.rolling_resistance
    }
}
