//! One traversal in time: the force balance (thesis eq. 9) integrated in fine steps.
//!
//! v' = (F_traction − F_air − F_roll − F_grade − F_planted − F_brake) / m_accelerated
//!
//! Reversing is the same balance solved for the torque: its speed is given.

mod engine;
mod reverse;
mod state;

pub use state::{DriveState, STEP_S, SimulatedDrive};

use super::driver::{Brake, CruiseControl, Retarder, SET_SPEED_MPS};
use super::gearbox::{Flow, Gearbox, Situation, cruising_gear, launch_gear};
use super::manoeuvre_file::Section;
use super::manoeuvres::{Here, Order, Stops};
use super::planted::{ContactPoint, PlantedEffects};
use super::random::{OrnsteinUhlenbeck, Purpose, stream};
use super::road::Road;
use super::scenario::Scenario;
use super::surroundings_file::{Tyres, Wind};
use super::truck::{GRAVITY, IDLE_RPM, Truck};
use crate::error::{Error, Result};
use crate::files::limits;
use crate::numeric::slope::sine;
use rand_chacha::ChaCha8Rng;

/// Waiting time of a run from standstill, s.
const WAIT_S: f64 = 5.0;
/// Time in which a truck must advance by [`STUCK_M`], s.
const STUCK_S: f64 = 60.0;
const STUCK_M: f64 = 10.0;
/// Steps of a drive, which is in memory: about three days.
const MOST_STEPS: usize = limits::rows_in_memory::<DriveState>();
/// Speed below which a held truck stands, m/s.
const STANDSTILL_MPS: f64 = 1e-6;

/// The truck in motion.
struct Journey<'a> {
    truck: Truck,
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
    stops: Stops,
    sections: &'a [Section],
    here: Here,
    set_back_m: f64,
    cruise: CruiseControl,
    brake: Brake,
    retarder: Retarder,
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
/// Returns an error if the truck comes to a stop on its road, or if the drive does not fit into
/// memory.
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
    let mut journey = Journey::new(truck.clone(), &road, scenario, index);
    journey.distance_m = run.start_distance_m;
    if run.from_standstill {
        journey.stand();
    } else {
        journey.cruise();
    }
    let end_m = run.start_distance_m + run.length_m;
    let mut states: Vec<DriveState> = Vec::new();
    // Since when the truck ought to advance.
    let mut since = 0;
    while journey.distance_m < end_m {
        let time_s = states.len() as f64 * STEP_S;
        let waiting = run.from_standstill && time_s < WAIT_S;
        let order = if waiting {
            Order::Stand {
                carried_mps: 0.0,
                in_reverse: false,
            }
        } else {
            journey.order()
        };
        let state = journey.step(order);
        limits::push(&mut states, state, MOST_STEPS, &scenario.origin).map_err(|_| {
            let problem = format!(
                "run {}: a drive of more than {time_s:.0} s, for which there is no memory; \
                 expected a shorter one (length_m)",
                run.name
            );
            Error::content(&scenario.origin, problem)
        })?;
        if order != Order::Drive && !waiting {
            since = states.len();
        }
        let earlier = states.len().checked_sub((STUCK_S / STEP_S) as usize);
        if let Some(earlier) = earlier
            && earlier >= since
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
    fn new(truck: Truck, road: &'a Road, scenario: &'a Scenario, index: usize) -> Self {
        let run = &scenario.runs[index];
        let wind = run.wind;
        let mut gust_rng = stream(scenario.seed, index, Purpose::Wind);
        Self {
            truck,
            road,
            air_density: run.air.density(),
            wind,
            gust: OrnsteinUhlenbeck::new(wind.gust_sigma_mps, wind.gust_time_s, &mut gust_rng),
            gust_mps: 0.0,
            gust_rng,
            tyres: scenario.tyres,
            rolled_s: run.tyres_driven_s,
            planted: PlantedEffects::new(
                &scenario.planted,
                scenario.seed,
                index,
                run.air.temperature_celsius,
            ),
            turned_m: run.backward.then(|| road.length_m()),
            clock_s: run.start_time_s,
            stops: Stops::new(&run.stops, run.start_distance_m),
            sections: &run.sections,
            here: Here::at(&run.sections, run.start_distance_m),
            set_back_m: 0.0,
            cruise: CruiseControl::default(),
            brake: Brake::default(),
            retarder: Retarder::default(),
            gearbox: Gearbox::new(0, stream(scenario.seed, index, Purpose::Gearbox)),
            situation: Situation {
                speed_mps: 0.0,
                set_speed_mps: SET_SPEED_MPS,
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
        let gear = cruising_gear(&self.truck, self.speed_mps);
        self.gearbox.engage(gear);
        let rpm = self.truck.engine_rpm(gear, self.speed_mps);
        let per_torque = self.truck.force_per_torque(gear);
        let resistance_n = self.resistance_n();
        let lost_n =
            self.planted
                .driveline_n(&self.truck, resistance_n / per_torque, per_torque, rpm);
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
            + self.truck.rolling_resistance_n() * (1.0 + cold) * self.here.rolling_factor
            + self.truck.mass_kg * GRAVITY * sine(self.road.grade(ahead_m))
            + self
                .planted
                .resistance_n(&self.truck, self.place(ahead_m), self.speed_mps)
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
        self.wind.speed_mps * (from_rad - course_rad).cos() + self.gust_mps + self.here.headwind_mps
    }

    /// Advances the stops by one step; returns what the driver does in it.
    fn order(&mut self) -> Order {
        let order = self.stops.order(self.distance_m, self.speed_mps, STEP_S);
        if let Some(mass_kg) = self.stops.mass_kg() {
            self.truck.mass_kg = mass_kg;
        }
        if matches!(order, Order::Stand { .. }) {
            self.gearbox.park();
        }
        order
    }

    /// Advances by one step; returns the state at its start.
    fn step(&mut self, order: Order) -> DriveState {
        if self.wind.gust_sigma_mps > 0.0 {
            self.gust_mps = self.gust.advance(STEP_S, &mut self.gust_rng);
        }
        self.rolled_s += STEP_S;
        self.clock_s += STEP_S;
        self.planted.advance(self.clock_s, STEP_S);
        self.look_around();
        match order {
            Order::Reverse {
                speed_mps,
                acceleration_mps2,
            } => self.reverse(speed_mps, acceleration_mps2),
            _ => self.go_on(order),
        }
    }

    /// Takes in what the sections at this place change.
    fn look_around(&mut self) {
        if self.sections.is_empty() {
            return;
        }
        self.here = Here::at(self.sections, self.distance_m);
        self.truck.engage_range(self.here.range_ratio);
        self.cruise.set_speed(self.here.set_speed_mps);
        self.situation.set_speed_mps = self.here.set_speed_mps;
    }

    /// Advances forwards, or stands.
    fn go_on(&mut self, order: Order) -> DriveState {
        let (waiting, carried_mps, in_reverse) = match order {
            Order::Stand {
                carried_mps,
                in_reverse,
            } => (true, carried_mps, in_reverse),
            _ => (false, 0.0, false),
        };
        let resistance_n = self.resistance_n();
        if !waiting && self.gearbox.gear() == 0 {
            self.gearbox.engage(launch_gear(&self.truck, resistance_n));
        }
        let hold = waiting || order == Order::Halt;
        let set_speed_mps = self.here.set_speed_mps;
        let brake_n = self.truck.mass_kg
            * self
                .brake
                .step_about(set_speed_mps, self.speed_mps, hold, STEP_S);
        let excess_mps = self.speed_mps - set_speed_mps;
        let retarder_n = self.truck.mass_kg
            * self
                .retarder
                .step(self.here.retarder && !hold, excess_mps, STEP_S);
        self.situation.speed_mps = self.speed_mps;
        let flow = self.gearbox.step(&self.truck, &self.situation, STEP_S);
        let before_rpm = self.engine_rpm;
        let (closed_gear, slip_percent) = self.run_engine(flow, order == Order::Halt);
        let per_torque = match flow {
            Flow::Through(gear) | Flow::Leaving(gear) => self.truck.force_per_torque(gear),
            Flow::Open { .. } => 0.0,
        };
        let traction_n = self.net_torque_nm * per_torque;
        let lost_n =
            self.planted
                .driveline_n(&self.truck, self.net_torque_nm, per_torque, self.engine_rpm)
                + self.here.pto_nm * per_torque;
        let accelerated_kg = self.truck.accelerated_kg(closed_gear);
        let mut acceleration =
            (traction_n - resistance_n - lost_n - (brake_n + retarder_n)) / accelerated_kg;
        if self.speed_mps + acceleration * STEP_S < 0.0 {
            // Brakes and tyres hold the truck; they do not push it back.
            acceleration = -self.speed_mps / STEP_S;
        }
        let state = DriveState {
            distance_m: self.distance_m,
            set_back_m: self.set_back_m,
            speed_mps: self.speed_mps,
            acceleration_mps2: acceleration,
            traction_n,
            accelerated_kg,
            brake_n,
            retarder_n,
            brake_pedal_percent: self.brake.pedal_percent(),
            parked: waiting,
            net_torque_nm: self.net_torque_nm,
            friction_torque_nm: self.truck.friction_nm(before_rpm),
            engine_rpm: before_rpm,
            gear: self.gearbox.gear(),
            in_reverse,
            range_ratio: self.truck.range_ratio(),
            carried_mps,
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
        if hold && self.speed_mps < STANDSTILL_MPS {
            self.speed_mps = 0.0;
        }
        self.distance_m += STEP_S * carried_mps;
        self.set_back_m -= STEP_S * carried_mps;
        state
    }
}
