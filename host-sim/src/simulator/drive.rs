//! One traversal in time: the force balance (thesis eq. 9) integrated in fine steps.
//!
//! v' = (F_traction − F_air − F_roll − F_grade − F_planted − F_brake) / m_accelerated

use super::driver::{Brake, CruiseControl, SET_SPEED_MPS};
use super::gearbox::{Flow, Gearbox, Situation, cruising_gear, launch_gear};
use super::planted::{ContactPoint, PlantedEffects};
use super::random::{OrnsteinUhlenbeck, Purpose, stream};
use super::road::Road;
use super::scenario::Scenario;
use super::scenario_file::{Tyres, Wind};
use super::truck::{GRAVITY, IDLE_RPM, Truck};
use crate::error::{Error, Result};
use crate::numeric::slope::sine;
use rand_chacha::ChaCha8Rng;

/// Step of the integration, s. Speed changes by less than 0.02 m/s in it.
pub const STEP_S: f64 = 0.01;
/// Waiting time of a run from standstill, s.
const WAIT_S: f64 = 5.0;
/// Rate of change of torque, full load to none or back, 1/s: by the driver, and by the gearbox.
const TORQUE_RATE_PER_S: (f64, f64) = (1.5, 8.0);
/// Time in which a truck must advance by [`STUCK_M`], s.
const STUCK_S: f64 = 60.0;
const STUCK_M: f64 = 10.0;

/// The true state at the start of a step, and the forces during it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DriveState {
    /// Distance on the travelled road, m.
    pub distance_m: f64,
    /// Speed, m/s.
    pub speed_mps: f64,
    /// Acceleration, m/s².
    pub acceleration_mps2: f64,
    /// Traction force before planted losses, N.
    pub traction_n: f64,
    /// Accelerated mass, rotating parts included, kg.
    pub accelerated_kg: f64,
    /// Force of the service brake, N.
    pub brake_n: f64,
    /// Position of the brake pedal, %.
    pub brake_pedal_percent: f64,
    /// The parking brake is set.
    pub parked: bool,
    /// Net engine torque, Nm.
    pub net_torque_nm: f64,
    /// Friction torque of the engine, Nm, positive.
    pub friction_torque_nm: f64,
    /// Engine speed, rpm.
    pub engine_rpm: f64,
    /// Current gear as the gearbox reports it; 0 is neutral.
    pub gear: usize,
    /// Target gear.
    pub selected_gear: usize,
    /// True during a gear shift.
    pub shifting: bool,
    /// True if the driveline transmits torque without slip.
    pub engaged: bool,
    /// Slip of the clutch, %.
    pub clutch_slip_percent: f64,
    /// Fan speed as reported on the bus, %.
    pub fan_percent: f64,
}

impl DriveState {
    /// Returns true if a brake is applied.
    #[must_use]
    pub fn braking(&self) -> bool {
        self.brake_pedal_percent > 0.0 || self.brake_n > 0.0
    }
}

/// A simulated traversal.
#[derive(Clone, Debug)]
pub struct SimulatedDrive {
    /// The road in the direction of travel.
    pub road: Road,
    /// The true vehicle.
    pub truck: Truck,
    /// One state per step of [`STEP_S`], from time 0.
    pub states: Vec<DriveState>,
}

impl SimulatedDrive {
    /// Returns the start of the last step, s.
    #[must_use]
    pub fn duration_s(&self) -> f64 {
        self.states.len().saturating_sub(1) as f64 * STEP_S
    }

    /// Returns the state at a time. Continuous quantities are interpolated between steps. Before
    /// the start and after the end it is the first or the last state.
    #[must_use]
    pub fn at(&self, time_s: f64) -> DriveState {
        let steps = (time_s / STEP_S).clamp(0.0, (self.states.len() - 1) as f64);
        let index = steps as usize;
        let from = self.states[index];
        let to = self.states[(index + 1).min(self.states.len() - 1)];
        let part = steps - index as f64;
        let between = |a: f64, b: f64| a + part * (b - a);
        DriveState {
            distance_m: between(from.distance_m, to.distance_m),
            speed_mps: between(from.speed_mps, to.speed_mps),
            engine_rpm: between(from.engine_rpm, to.engine_rpm),
            ..from
        }
    }
}

/// The truck in motion.
struct Journey<'a> {
    truck: &'a Truck,
    road: &'a Road,
    air_density: f64,
    wind: Wind,
    gust: OrnsteinUhlenbeck,
    gust_mps: f64,
    gust_rng: ChaCha8Rng,
    tyres: Tyres,
    /// Time that the tyres have rolled, s.
    rolled_s: f64,
    planted: PlantedEffects,
    /// Length of the road if it is driven against its direction, m.
    turned_m: Option<f64>,
    /// Time of the log clock, s.
    clock_s: f64,
    cruise: CruiseControl,
    brake: Brake,
    gearbox: Gearbox,
    situation: Situation,
    net_torque_nm: f64,
    engine_rpm: f64,
    distance_m: f64,
    speed_mps: f64,
}

/// Drives run `index` of the scenario to its end.
///
/// # Errors
/// Returns an error if the truck comes to a stop on its road.
///
/// # Panics
/// Panics if the scenario has no run `index`.
pub fn drive(scenario: &Scenario, index: usize) -> Result<SimulatedDrive> {
    let run = &scenario.runs[index];
    let road = if run.backward {
        scenario.road.reversed()
    } else {
        scenario.road.clone()
    };
    let truck = run.truck.clone();
    let mut journey = Journey::new(&truck, &road, scenario, index);
    journey.distance_m = run.start_distance_m;
    if run.from_standstill {
        journey.stand();
    } else {
        journey.cruise();
    }
    let end_m = run.start_distance_m + run.length_m;
    let mut states: Vec<DriveState> = Vec::new();
    while journey.distance_m < end_m {
        let time_s = states.len() as f64 * STEP_S;
        let waiting = run.from_standstill && time_s < WAIT_S;
        states.push(journey.step(waiting));
        let earlier = states.len().checked_sub((STUCK_S / STEP_S) as usize);
        if let Some(earlier) = earlier
            && journey.distance_m - states[earlier].distance_m < STUCK_M
        {
            return Err(Error::content(
                &scenario.origin,
                format!(
                    "run {}: the truck is stuck at {:.0} m with a grade of {:.1} %; \
                     expected a road and a mass that its engine can manage",
                    run.name,
                    journey.distance_m,
                    100.0 * road.grade(journey.distance_m)
                ),
            ));
        }
    }
    Ok(SimulatedDrive {
        road,
        truck,
        states,
    })
}

impl<'a> Journey<'a> {
    fn new(truck: &'a Truck, road: &'a Road, scenario: &Scenario, index: usize) -> Self {
        let run = &scenario.runs[index];
        let wind = run.wind;
        let mut gust_rng = stream(scenario.seed, index, Purpose::Wind);
        Self {
            truck,
            road,
            air_density: scenario.air_density(),
            wind,
            gust: OrnsteinUhlenbeck::new(wind.gust_sigma_mps, wind.gust_time_s, &mut gust_rng),
            gust_mps: 0.0,
            gust_rng,
            tyres: scenario.tyres,
            rolled_s: run.tyres_driven_s,
            planted: PlantedEffects::new(&scenario.planted, scenario.seed, index),
            turned_m: run.backward.then(|| road.length_m()),
            clock_s: run.start_time_s,
            cruise: CruiseControl::default(),
            brake: Brake::default(),
            gearbox: Gearbox::new(0, stream(scenario.seed, index, Purpose::Gearbox)),
            situation: Situation {
                speed_mps: 0.0,
                acceleration_mps2: 0.0,
                resisting_n: 0.0,
                at_full_load: false,
            },
            net_torque_nm: 0.0,
            engine_rpm: IDLE_RPM,
            distance_m: 0.0,
            speed_mps: 0.0,
        }
    }

    /// Sets the state of standing in neutral.
    const fn stand(&mut self) {
        self.speed_mps = 0.0;
    }

    /// Sets the state of steady driving at the set speed.
    fn cruise(&mut self) {
        self.speed_mps = SET_SPEED_MPS;
        let gear = cruising_gear(self.truck, self.speed_mps);
        self.gearbox.engage(gear);
        let rpm = self.truck.engine_rpm(gear, self.speed_mps);
        let per_torque = self.truck.force_per_torque(gear);
        let resistance_n = self.resistance_n();
        let lost_n =
            self.planted
                .driveline_n(self.truck, resistance_n / per_torque, per_torque, rpm);
        let balance_nm = (resistance_n + lost_n) / per_torque;
        self.net_torque_nm =
            balance_nm.clamp(-self.truck.friction_nm(rpm), self.truck.full_load_nm(rpm));
        let force_n = self.net_torque_nm * per_torque;
        self.cruise = CruiseControl::balanced_at(force_n / self.truck.mass_kg);
    }

    /// Returns air, rolling and grade resistance and the planted forces, half a step ahead, N.
    fn resistance_n(&self) -> f64 {
        let ahead_m = self.distance_m + 0.5 * STEP_S * self.speed_mps;
        let airspeed_mps = self.speed_mps + self.headwind_mps();
        let cold = self.tyres.cold_amount * (-self.rolled_s / self.tyres.cold_time_s).exp();
        self.truck.air_resistance_n(airspeed_mps, self.air_density)
            + self.truck.rolling_resistance_n() * (1.0 + cold)
            + self.truck.mass_kg * GRAVITY * sine(self.road.grade(ahead_m))
            + self
                .planted
                .resistance_n(self.truck, self.place(ahead_m), self.speed_mps)
    }

    fn place(&self, distance_m: f64) -> ContactPoint {
        ContactPoint {
            stored_m: self
                .turned_m
                .map_or(distance_m, |length_m| length_m - distance_m),
            forward: self.turned_m.is_none(),
            curvature_per_m: self.road.curvature_per_m(distance_m),
        }
    }

    /// Returns the headwind, m/s.
    fn headwind_mps(&self) -> f64 {
        let from_rad = self.wind.from_deg.to_radians();
        let course_rad = self.road.course_rad(self.distance_m);
        self.wind.speed_mps * (from_rad - course_rad).cos() + self.gust_mps
    }

    /// Advances by one step; returns the state at its start.
    fn step(&mut self, waiting: bool) -> DriveState {
        if self.wind.gust_sigma_mps > 0.0 {
            self.gust_mps = self.gust.advance(STEP_S, &mut self.gust_rng);
        }
        self.rolled_s += STEP_S;
        self.clock_s += STEP_S;
        self.planted.advance(self.clock_s, STEP_S);
        let resistance_n = self.resistance_n();
        if !waiting && self.gearbox.gear() == 0 {
            self.gearbox.engage(launch_gear(self.truck, resistance_n));
        }
        let brake_n = self.truck.mass_kg * self.brake.step(self.speed_mps, waiting, STEP_S);
        self.situation.speed_mps = self.speed_mps;
        let flow = self.gearbox.step(self.truck, &self.situation, STEP_S);
        let before_rpm = self.engine_rpm;
        let (closed_gear, slip_percent) = self.run_engine(flow);
        let per_torque = match flow {
            Flow::Through(gear) | Flow::Leaving(gear) => self.truck.force_per_torque(gear),
            Flow::Open { .. } => 0.0,
        };
        let traction_n = self.net_torque_nm * per_torque;
        let lost_n =
            self.planted
                .driveline_n(self.truck, self.net_torque_nm, per_torque, self.engine_rpm);
        let accelerated_kg = self.truck.accelerated_kg(closed_gear);
        let mut acceleration = (traction_n - resistance_n - lost_n - brake_n) / accelerated_kg;
        if self.speed_mps + acceleration * STEP_S < 0.0 {
            // Brakes and tyres hold the truck; they do not push it back.
            acceleration = -self.speed_mps / STEP_S;
        }
        let state = DriveState {
            distance_m: self.distance_m,
            speed_mps: self.speed_mps,
            acceleration_mps2: acceleration,
            traction_n,
            accelerated_kg,
            brake_n,
            brake_pedal_percent: self.brake.pedal_percent(),
            parked: waiting,
            net_torque_nm: self.net_torque_nm,
            friction_torque_nm: self.truck.friction_nm(before_rpm),
            engine_rpm: before_rpm,
            gear: self.gearbox.gear(),
            selected_gear: self.gearbox.selected(),
            shifting: self.gearbox.is_shifting(),
            engaged: closed_gear > 0,
            clutch_slip_percent: slip_percent,
            fan_percent: self.planted.fan_percent(),
        };
        self.situation.acceleration_mps2 = acceleration;
        self.situation.resisting_n = traction_n - accelerated_kg * acceleration;
        self.distance_m += STEP_S * (self.speed_mps + 0.5 * STEP_S * acceleration);
        self.speed_mps += STEP_S * acceleration;
        state
    }

    /// Sets engine speed and torque. Returns the gear that couples engine and wheels (0 if none)
    /// and the slip of the clutch in %.
    fn run_engine(&mut self, flow: Flow) -> (usize, f64) {
        match flow {
            Flow::Through(0) => {
                self.net_torque_nm = 0.0;
                self.engine_rpm = IDLE_RPM;
                (0, 100.0)
            }
            Flow::Through(gear) => {
                let turned_rpm = self.truck.engine_rpm(gear, self.speed_mps);
                self.engine_rpm = turned_rpm.max(IDLE_RPM);
                let slipping = turned_rpm < IDLE_RPM;
                let lowest_nm = if slipping {
                    0.0
                } else {
                    -self.truck.friction_nm(self.engine_rpm)
                };
                let limits_nm = (lowest_nm, self.truck.full_load_nm(self.engine_rpm));
                let per_kg = self.truck.force_per_torque(gear) / self.truck.mass_kg;
                let wish = self
                    .cruise
                    .request(self.speed_mps, per_kg, limits_nm, STEP_S);
                self.situation.at_full_load = wish.at_full_load;
                self.move_torque(wish.net_nm, TORQUE_RATE_PER_S.0);
                // The torque was set at another engine speed and may exceed the limit at this one.
                self.net_torque_nm = self.net_torque_nm.clamp(limits_nm.0, limits_nm.1);
                if slipping {
                    (0, 100.0 * (1.0 - turned_rpm / IDLE_RPM))
                } else {
                    (gear, 0.0)
                }
            }
            Flow::Leaving(gear) => {
                self.engine_rpm = self.truck.engine_rpm(gear, self.speed_mps).max(IDLE_RPM);
                self.move_torque(0.0, TORQUE_RATE_PER_S.1);
                (gear, 0.0)
            }
            Flow::Open { to, left_s } => {
                let target_rpm = self.truck.engine_rpm(to, self.speed_mps).max(IDLE_RPM);
                let rpm_per_s = (target_rpm - self.engine_rpm) / left_s.max(STEP_S);
                self.engine_rpm += rpm_per_s * STEP_S;
                self.net_torque_nm = self.truck.spin_up_nm(rpm_per_s).clamp(
                    -self.truck.friction_nm(self.engine_rpm),
                    self.truck.full_load_nm(self.engine_rpm),
                );
                (0, 100.0)
            }
        }
    }

    fn move_torque(&mut self, to_nm: f64, rate_per_s: f64) {
        let most_nm = rate_per_s * self.truck.reference_torque_nm * STEP_S;
        self.net_torque_nm += (to_nm - self.net_torque_nm).clamp(-most_nm, most_nm);
    }
}
