//! A small truck on a hilly road: what its bus and its receivers say, every 100 ms.
//!
//! It is no judge of accuracy: it only has to reach what real drives reach.

use crate::scenario::Scenario;
use estimator_core::{Reading, Signal, Traction, Value, VehicleParameters};
// Not those of the platform: the digests are those of any.
use libm::{asinf, cosf, sinf};
use std::collections::VecDeque;
use std::f32::consts::PI;
use test_kit::Noise;

const GRAVITY: f32 = 9.806_65;
const STEP_S: f32 = 0.1;
const SHIFT_S: f32 = 0.8;
const SET_MPS: f32 = 22.0;
const LARGEST_POWER_W: f32 = 330_000.0;
const FRICTION_PERCENT: f32 = 8.0;
/// Metres in a degree of latitude, and of longitude at the latitude of the road.
const LATITUDE_M: f32 = 111_200.0;
const LONGITUDE_M: f32 = 57_000.0;

/// What is true at a time of the drive.
#[derive(Clone, Copy, Debug, Default)]
pub struct Moment {
    pub time_s: f32,
    pub distance_m: f32,
    speed_mps: f32,
    acceleration_mps2: f32,
    altitude_m: f32,
    north_m: f32,
    east_m: f32,
    heading_rad: f32,
    traction_n: f32,
    brake_n: f32,
    gear: usize,
    shift_left_s: f32,
    stands_s: f32,
    back_left_m: f32,
}

impl Moment {
    /// Returns whether it goes back: it stood at its stop, and has not gone as far as it wants to.
    fn goes_back(&self) -> bool {
        self.stands_s <= 0.0 && self.back_left_m > 0.0
    }
}

/// The drive.
pub struct Drive<'a> {
    scenario: &'a Scenario,
    vehicle: VehicleParameters,
    noise: Noise,
    mass_kg: f32,
    moment: Moment,
    /// Coloured errors: of the altitude, m, and of the wind, m/s.
    altitude_error_m: f32,
    gust_mps: f32,
    stops_left: Vec<f32>,
    /// What the receiver has read and not said yet, by tick.
    late: VecDeque<Vec<(Signal, f32)>>,
    smooth_altitude_m: f32,
    smooth_speed_mps: f32,
}

/// Moves a low-pass filter on by a tick. Without a time constant, it passes everything.
fn smoothed(before: f32, now: f32, time_constant_s: f32) -> f32 {
    if time_constant_s <= 0.0 {
        return now;
    }
    before + (now - before) * STEP_S / (time_constant_s + STEP_S)
}

/// Returns the sine of the slope angle of the road, with long descents of this slope.
fn slope(distance_m: f32, descents: f32) -> f32 {
    -descents * sinf(distance_m / 600.0).max(0.0)
        + 0.016 * sinf(distance_m / 180.0)
        + 0.012 * sinf(distance_m / 53.0 + 1.0)
        - 0.018 * cosf(distance_m / 700.0)
}

impl<'a> Drive<'a> {
    pub fn new(scenario: &'a Scenario, vehicle: VehicleParameters) -> Self {
        let mut stops_left = scenario.stops_m.to_vec();
        stops_left.reverse();
        Self {
            scenario,
            mass_kg: vehicle.mass_kg * scenario.mass_factor,
            vehicle,
            noise: Noise(scenario.seed),
            moment: Moment {
                speed_mps: scenario.begin_mps,
                altitude_m: 120.0,
                gear: 11,
                ..Moment::default()
            },
            altitude_error_m: 1.0,
            gust_mps: 0.0,
            stops_left,
            late: VecDeque::new(),
            smooth_altitude_m: 120.0,
            smooth_speed_mps: scenario.begin_mps,
        }
    }

    /// Drives for 100 ms, and returns what is read.
    pub fn step(&mut self) -> (Moment, Vec<Reading>) {
        self.moment.time_s += STEP_S;
        self.advance();
        (self.moment, self.readings())
    }

    /// Returns the ratio of the gear to the wheels, and its efficiency.
    fn ratio(&self) -> (f32, f32) {
        match &self.vehicle.traction {
            Traction::Powertrain(of) => {
                let gear = of.gears[self.moment.gear];
                let efficiency = gear.efficiency * of.final_drive_efficiency;
                (gear.ratio * of.final_drive_ratio, efficiency)
            }
            Traction::Force => (3.0, 1.0),
        }
    }

    fn engine_rpm(&self) -> f32 {
        let turning = self.moment.speed_mps / self.vehicle.wheel_radius_m * self.ratio().0;
        (turning * 30.0 / PI).max(550.0)
    }

    fn resistance_n(&self) -> f32 {
        let moment = &self.moment;
        let air_mps = moment.speed_mps + self.scenario.headwind_mps + self.gust_mps;
        let rolling = self.vehicle.rolling_resistance * self.scenario.rolling_factor;
        self.mass_kg * GRAVITY * (rolling + slope(moment.distance_m, self.scenario.descents))
            + 0.5 * 1.2 * self.vehicle.drag_area_m2 * air_mps * air_mps.abs()
    }

    fn advance(&mut self) {
        self.gust_mps = 0.98 * self.gust_mps + 0.2 * self.scenario.gusts * self.noise.draw();
        let keep = 1.0 - STEP_S / 120.0;
        self.altitude_error_m = keep * self.altitude_error_m + 0.08 * self.noise.draw();
        if self.moment.stands_s > 0.0 {
            self.stand();
            return;
        }
        if self.moment.goes_back() {
            self.reverse();
            return;
        }
        let resistance_n = self.resistance_n();
        let to_stop_m = self
            .stops_left
            .last()
            .map_or(f32::INFINITY, |at_m| at_m - self.moment.distance_m);
        let speed_mps = self.moment.speed_mps;
        let wanted_mps2 = if to_stop_m < speed_mps * speed_mps / 1.6 + 3.0 {
            -0.5 * speed_mps * speed_mps / to_stop_m.max(1.0)
        } else {
            (0.3 * (SET_MPS - speed_mps)).clamp(-1.0, 0.6)
        };
        let wanted_n = resistance_n + self.mass_kg * wanted_mps2;
        let (ratio, efficiency) = self.ratio();
        let largest_n = (LARGEST_POWER_W / speed_mps.max(1.0))
            .min(1_700.0 * ratio * efficiency / self.vehicle.wheel_radius_m);
        let shifting = self.moment.shift_left_s > 0.0;
        self.moment.traction_n = if shifting {
            0.0
        } else {
            wanted_n.clamp(-0.15 * largest_n, largest_n)
        };
        self.moment.brake_n = (self.moment.traction_n - wanted_n).max(0.0);
        if shifting {
            self.moment.brake_n = 0.0;
        }
        let moving_n = self.moment.traction_n - self.moment.brake_n - resistance_n;
        self.roll(moving_n / (self.mass_kg + 600.0));
        self.shift();
        if to_stop_m < 2.0 || (to_stop_m < 20.0 && self.moment.speed_mps < 0.3) {
            self.stops_left.pop();
            self.moment.stands_s = self.scenario.stands_s;
            self.moment.back_left_m = self.scenario.reverses_m;
            self.moment.speed_mps = 0.0;
        }
    }

    fn stand(&mut self) {
        let moment = &mut self.moment;
        (moment.speed_mps, moment.acceleration_mps2, moment.gear) = (0.0, 0.0, 2);
        (moment.traction_n, moment.brake_n) = (0.0, 50_000.0);
        moment.stands_s -= STEP_S;
        if moment.stands_s <= 0.0 {
            self.mass_kg *= self.scenario.load_factor;
        }
    }

    /// Rolls back slowly, then stands again.
    fn reverse(&mut self) {
        let moment = &mut self.moment;
        let back_m = 1.5 * STEP_S;
        (moment.speed_mps, moment.acceleration_mps2) = (1.5, 0.0);
        (moment.traction_n, moment.brake_n) = (-3_000.0, 0.0);
        moment.altitude_m -= back_m * slope(moment.distance_m, self.scenario.descents);
        moment.distance_m -= back_m;
        moment.north_m -= back_m * cosf(moment.heading_rad);
        moment.east_m -= back_m * sinf(moment.heading_rad);
        moment.back_left_m -= back_m;
        if moment.back_left_m <= 0.0 {
            (moment.speed_mps, moment.stands_s) = (0.0, 3.0);
        }
    }

    fn roll(&mut self, acceleration_mps2: f32) {
        let moment = &mut self.moment;
        let before_mps = moment.speed_mps;
        moment.speed_mps = (before_mps + STEP_S * acceleration_mps2).max(0.0);
        moment.acceleration_mps2 = (moment.speed_mps - before_mps) / STEP_S;
        let driven_m = STEP_S * 0.5 * (before_mps + moment.speed_mps);
        moment.altitude_m +=
            driven_m * slope(moment.distance_m + 0.5 * driven_m, self.scenario.descents);
        moment.distance_m += driven_m;
        moment.heading_rad = 0.8 * sinf(moment.distance_m / 400.0);
        moment.north_m += driven_m * cosf(moment.heading_rad);
        moment.east_m += driven_m * sinf(moment.heading_rad);
    }

    fn shift(&mut self) {
        self.moment.shift_left_s -= STEP_S;
        let Traction::Powertrain(of) = &self.vehicle.traction else {
            return;
        };
        let (gears, gear) = (of.gears.len(), self.moment.gear);
        let rpm = self.engine_rpm();
        let next = if rpm > 1_750.0 && gear + 1 < gears {
            gear + 1
        } else if rpm < 950.0 && gear > 2 {
            gear - 1
        } else {
            return;
        };
        self.moment.gear = next;
        self.moment.shift_left_s = SHIFT_S;
    }

    fn readings(&mut self) -> Vec<Reading> {
        let mut values = self.of_the_bus();
        let tick = (self.moment.time_s / STEP_S).round() as u32;
        let is_fix = tick % self.scenario.fix_ticks == 2 % self.scenario.fix_ticks;
        self.smooth_altitude_m = smoothed(
            self.smooth_altitude_m,
            self.moment.altitude_m,
            self.scenario.altitude_smoothed_s,
        );
        let fix = if is_fix {
            self.of_the_receiver()
        } else {
            Vec::new()
        };
        self.late.push_back(fix);
        if self.late.len() > self.scenario.late_ticks {
            values.extend(self.late.pop_front().unwrap_or_default());
        }
        self.smooth_speed_mps = smoothed(
            self.smooth_speed_mps,
            self.moment.speed_mps,
            self.scenario.speed_smoothed_s,
        );
        let speed_mps = self.smooth_speed_mps + 0.01 * self.noise.draw();
        values.push((Signal::WheelSpeed, speed_mps.max(0.0)));
        let faults = self.scenario.faults;
        let moment = self.moment;
        let readings = values.into_iter().filter_map(|(signal, value)| {
            let value = faults(&moment, signal, value)?;
            Some(Reading { signal, value })
        });
        readings.collect()
    }

    fn of_the_bus(&mut self) -> Vec<(Signal, f32)> {
        let moment = self.moment;
        let (ratio, efficiency) = self.ratio();
        let shifting = moment.shift_left_s > 0.0;
        let mut values = match &self.vehicle.traction {
            Traction::Force => vec![(Signal::TractionForce, moment.traction_n)],
            Traction::Powertrain(of) => {
                let torque_nm =
                    moment.traction_n * self.vehicle.wheel_radius_m / ratio / efficiency;
                let percent = 100.0 * torque_nm / of.reference_torque_nm + FRICTION_PERCENT;
                vec![
                    (Signal::FrictionTorque, FRICTION_PERCENT),
                    (Signal::EngineTorque, percent.max(0.0)),
                    (Signal::EngineSpeed, self.engine_rpm()),
                    (Signal::ShiftInProcess, f32::from(u8::from(shifting))),
                    (
                        Signal::CurrentGear,
                        if moment.goes_back() {
                            -1.0
                        } else {
                            moment.gear as f32 + 1.0
                        },
                    ),
                    (Signal::NetEngineTorque, torque_nm),
                    (Signal::MotorTorque, torque_nm),
                    (Signal::MotorSpeed, self.engine_rpm()),
                    (Signal::ParasiticTorque, 1.5),
                    (Signal::GearRatio, of.gears[moment.gear].ratio),
                    (
                        Signal::OutputShaftSpeed,
                        self.engine_rpm() / of.gears[moment.gear].ratio,
                    ),
                ]
            }
        };
        let retarder = self.scenario.retarder && moment.speed_mps > 5.0;
        let braking = f32::from(u8::from(moment.brake_n > 100.0 && !retarder));
        let is_off = f32::from(u8::from(shifting));
        values.extend([
            (Signal::BrakeSwitch, braking),
            (Signal::BrakeLight, braking),
            (Signal::FoundationBrake, braking),
            (Signal::BrakePedal, moment.brake_n / 1_000.0),
            (Signal::BrakePressure, 8.0 * moment.brake_n),
            (
                Signal::ParkingBrake,
                f32::from(u8::from(moment.stands_s > 5.0)),
            ),
            (Signal::DrivelineEngaged, 1.0 - is_off),
            (Signal::ClutchSlip, 100.0 * is_off),
            (Signal::ClutchSwitch, is_off),
        ]);
        if self.scenario.retarder {
            let percent = if retarder {
                -moment.brake_n / 500.0
            } else {
                0.0
            };
            values.push((Signal::RetarderTorque, percent.max(-100.0)));
        }
        let felt_mps2 =
            moment.acceleration_mps2 + GRAVITY * slope(moment.distance_m, self.scenario.descents);
        let noise = self.noise.draw();
        values.extend([
            (Signal::AmbientTemperature, 4.0),
            (Signal::AirPressure, 99_000.0),
            (Signal::Fan, 40.0 + 30.0 * sinf(moment.time_s / 50.0)),
            (
                Signal::LongitudinalAcceleration,
                1.04 * felt_mps2 + 0.1 + 0.1 * noise,
            ),
            (
                Signal::Pitch,
                asinf(slope(moment.distance_m, self.scenario.descents)).to_degrees()
                    + 0.3 * felt_mps2
                    - 0.4
                    + 0.1 * noise,
            ),
            (Signal::YawRate, self.turn_rate_radps()),
            (Signal::Mass, self.mass_kg),
        ]);
        values.retain(|(signal, _)| self.scenario.has(*signal));
        values
    }

    fn turn_rate_radps(&self) -> f32 {
        let moment = &self.moment;
        -0.002 * cosf(moment.distance_m / 400.0) * moment.speed_mps
    }

    fn of_the_receiver(&mut self) -> Vec<(Signal, f32)> {
        let moment = self.moment;
        let late_m = 0.2 * moment.speed_mps;
        let turned_deg = if moment.goes_back() { 180.0 } else { 0.0 };
        let sine = slope(moment.distance_m, self.scenario.descents);
        let altitude_m = self.smooth_altitude_m - late_m * sine + self.altitude_error_m;
        let mut values = vec![
            (Signal::FixMethod, 1.0),
            (Signal::Satellites, 9.0),
            (Signal::Hdop, 0.9),
            (
                Signal::Course,
                (moment.heading_rad.to_degrees() + turned_deg).rem_euclid(360.0),
            ),
            (
                Signal::GnssSpeed,
                moment.speed_mps + 0.05 * self.noise.draw(),
            ),
            (
                Signal::VerticalSpeed,
                moment.speed_mps * sine + 0.08 * self.noise.draw(),
            ),
            (Signal::Latitude, 58.0 + moment.north_m / LATITUDE_M),
            (Signal::Longitude, 15.0 + moment.east_m / LONGITUDE_M),
            (Signal::Altitude, altitude_m + 0.3 * self.noise.draw()),
        ];
        values.retain(|(signal, _)| self.scenario.has(*signal));
        values
    }
}

/// Returns a value as a bus gives it: positions as integers.
pub fn value_of(signal: Signal, value: f32) -> Value {
    match signal {
        Signal::Latitude | Signal::Longitude => {
            Value::DegreesE7((f64::from(value) * 1e7).round() as i32)
        }
        _ => Value::Real(value),
    }
}
