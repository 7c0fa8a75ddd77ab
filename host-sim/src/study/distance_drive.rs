//! Simulated drives in the distance domain (thesis section 4): the vehicle model of eq. 9 under a
//! PI cruise control, and the readings of its sensors.

use crate::comparison::{G, MeasuredDrive, MeasuredPoint, STEP_M};
use crate::simulator::driver::{BRAKE_OFF_MPS, BRAKE_ON_MPS, CruiseControl, SET_SPEED_MPS};
use crate::simulator::random::normal;
use crate::simulator::truck::Truck;
use estimator_core::VehicleParameters;
use estimator_core::vehicle::STANDARD_AIR_DENSITY;
use rand_chacha::ChaCha8Rng;

/// Deceleration that the brakes add, m/s².
const BRAKE_MPS2: f64 = 0.5;
/// Time without torque at the wheels while the gear changes, s.
const SHIFT_S: f64 = 1.0;
/// The gearbox shifts down below this engine speed, rpm.
const SHIFT_DOWN_BELOW_RPM: f64 = 1_000.0;
/// The gearbox shifts up if the next gear gives at least this engine speed, rpm. With ratio steps
/// of 1.27 between the gears this leaves a hysteresis between shifting up and down.
const SHIFT_UP_TO_RPM: f64 = 1_100.0;
/// Lower limit of the speed, m/s. No truck of the experiments drove slower. The limit keeps the
/// distance domain defined.
const SLOWEST_MPS: f64 = 2.0;

/// Assumed parameters of the vehicle, as factors of the truth (thesis: N(1, 0.2) in each run).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Belief {
    /// Factor of the mass.
    pub mass: f64,
    /// Factor of the air drag.
    pub drag: f64,
    /// Factor of the rolling resistance.
    pub rolling: f64,
    /// Factor of the engine torque.
    pub torque: f64,
}

impl Belief {
    /// All parameters true.
    pub const TRUTH: Self = Self {
        mass: 1.0,
        drag: 1.0,
        rolling: 1.0,
        torque: 1.0,
    };
}

/// Disturbances of the measurements of a drive, in addition to a false [`Belief`].
#[derive(Clone, Copy, Debug, Default)]
pub struct Disturbances<'a> {
    /// Standard deviation of the white noise on wheel speed, m/s.
    pub speed_mps: f64,
    /// Error of GPS altitude at each point, m. Points beyond the end have no fix.
    pub gps_m: &'a [f64],
    /// Error of the vehicle model at each point, %: a resisting force that the model lacks, over
    /// the weight. Zero beyond the end.
    pub model_percent: &'a [f64],
}

/// A measured drive with its true grade.
#[derive(Clone, Debug)]
pub struct DistanceDrive {
    /// Measurements and assumed parameters.
    pub drive: MeasuredDrive,
    /// True grade at each point, %.
    pub true_grade_percent: Vec<f64>,
}

/// A gear change in progress.
struct GearChange {
    /// Number of points that the gear change takes.
    points: usize,
    /// Number of points so far.
    done: usize,
    /// Force before the gear change, N.
    force_n: f64,
}

/// The moving vehicle.
struct MovingVehicle {
    truck: Truck,
    cruise: CruiseControl,
    speed_mps: f64,
    gear: usize,
    shift: Option<GearChange>,
    braking: bool,
}

/// Forces over one step.
struct Forces {
    /// True traction force of the engine, N.
    traction_n: f64,
    /// Traction force as reported on the bus, N.
    reported_n: f64,
    /// Brake force, N.
    brake_n: f64,
    /// Engaged gear; 0 for none.
    engaged: usize,
}

/// Simulates a drive along a road with one grade (%) per [`STEP_M`]. It starts at a steady
/// 80 km/h.
///
/// Returns `None` if the vehicle has no engine and gearbox parameters.
#[must_use]
pub fn simulate(
    grade_percent: &[f64],
    truck: &VehicleParameters,
    belief: &Belief,
    errors: &Disturbances<'_>,
    rng: &mut ChaCha8Rng,
) -> Option<DistanceDrive> {
    let air_density = f64::from(STANDARD_AIR_DENSITY);
    let mut vehicle = MovingVehicle::new(Truck::new(truck)?, *grade_percent.first()?, air_density);
    let mut points = Vec::with_capacity(grade_percent.len());
    let mut altitude_m = 0.0;
    for (k, grade) in grade_percent.iter().enumerate() {
        let sine = grade / grade.hypot(100.0);
        let shifting = vehicle.shift_gears();
        let forces = vehicle.forces();
        points.push(MeasuredPoint {
            distance_m: k as f64 * STEP_M,
            speed_mps: vehicle.speed_mps + errors.speed_mps * normal(rng),
            traction_n: belief.torque * forces.reported_n,
            rotating_kg: vehicle.truck.accelerated_kg(vehicle.gear) - vehicle.truck.mass_kg,
            air_density,
            altitude_m: errors.gps_m.get(k).map(|error| altitude_m + error),
            shifting,
            braking: vehicle.braking,
        });
        let slope_n = vehicle.truck.mass_kg
            * G
            * (sine + 0.01 * errors.model_percent.get(k).copied().unwrap_or(0.0));
        vehicle.advance(&forces, slope_n, air_density);
        altitude_m += STEP_M * sine;
    }
    Some(DistanceDrive {
        drive: MeasuredDrive {
            mass_kg: belief.mass * f64::from(truck.mass_kg),
            drag_area_m2: belief.drag * f64::from(truck.drag_area_m2),
            rolling_resistance: belief.rolling * f64::from(truck.rolling_resistance),
            points,
        },
        true_grade_percent: grade_percent.to_vec(),
    })
}

impl MovingVehicle {
    fn new(truck: Truck, first_grade_percent: f64, air_density: f64) -> Self {
        let gear = truck.top_gear();
        let slope_n = truck.mass_kg * G * 0.01 * first_grade_percent;
        let force_n = truck.resistance_n(SET_SPEED_MPS, air_density) + slope_n;
        Self {
            cruise: CruiseControl::balanced_at(force_n / truck.accelerated_kg(gear)),
            speed_mps: SET_SPEED_MPS,
            gear,
            shift: None,
            braking: false,
            truck,
        }
    }

    /// Returns the duration of the next step, s.
    fn step_s(&self) -> f64 {
        STEP_M / self.speed_mps
    }

    /// Starts or continues a gear change. Returns whether one is in progress.
    fn shift_gears(&mut self) -> bool {
        if let Some(shift) = &mut self.shift {
            shift.done += 1;
            if shift.done < shift.points {
                return true;
            }
            self.shift = None;
            return false;
        }
        let rpm = |gear| self.truck.engine_rpm(gear, self.speed_mps);
        let gear = if self.gear > 1 && rpm(self.gear) < SHIFT_DOWN_BELOW_RPM {
            self.gear - 1
        } else if self.gear < self.truck.top_gear() && rpm(self.gear + 1) > SHIFT_UP_TO_RPM {
            self.gear + 1
        } else {
            return false;
        };
        let force_n = self.engine_force_n();
        self.gear = gear;
        self.shift = Some(GearChange {
            points: (SHIFT_S / self.step_s()).ceil() as usize,
            done: 0,
            force_n,
        });
        true
    }

    /// Returns the engine force that cruise control requests, or that of engine braking while the
    /// brakes are on.
    fn engine_force_n(&mut self) -> f64 {
        let rpm = self.truck.engine_rpm(self.gear, self.speed_mps);
        let lever = self.truck.force_per_torque(self.gear);
        let drag_nm = -self.truck.friction_nm(rpm);
        if self.braking {
            return drag_nm * lever;
        }
        let limits_nm = (drag_nm, self.truck.full_load_nm(rpm));
        let per_kg = lever / self.truck.accelerated_kg(self.gear);
        let wish = self
            .cruise
            .request(self.speed_mps, per_kg, limits_nm, self.step_s());
        wish.net_nm * lever
    }

    fn forces(&mut self) -> Forces {
        self.braking =
            self.speed_mps > BRAKE_ON_MPS || self.braking && self.speed_mps > BRAKE_OFF_MPS;
        let brake_n = if self.braking {
            self.truck.mass_kg * BRAKE_MPS2
        } else {
            0.0
        };
        if let Some(shift) = &self.shift {
            // The clutch is open. The reported torque fades out and in again.
            let part = (1.0 - 2.0 * shift.done as f64 / shift.points as f64).abs();
            return Forces {
                traction_n: 0.0,
                reported_n: part * shift.force_n,
                brake_n,
                engaged: 0,
            };
        }
        let traction_n = self.engine_force_n();
        Forces {
            traction_n,
            reported_n: traction_n,
            brake_n,
            engaged: self.gear,
        }
    }

    /// Applies eq. 9 over one step. Forces are constant over it, so v² changes linearly.
    fn advance(&mut self, forces: &Forces, slope_n: f64, air_density: f64) {
        let resistance_n = self.truck.resistance_n(self.speed_mps, air_density);
        let net_n = forces.traction_n - forces.brake_n - resistance_n - slope_n;
        let acceleration = net_n / self.truck.accelerated_kg(forces.engaged);
        let squared = self.speed_mps.powi(2) + 2.0 * STEP_M * acceleration;
        self.speed_mps = squared.max(SLOWEST_MPS.powi(2)).sqrt();
    }
}
