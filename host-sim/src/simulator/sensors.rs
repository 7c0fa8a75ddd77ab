//! The sensors of the vehicle: the values that each controller sends.
//!
//! Values have the age of their latency and the noise of the sensor. The encoder rounds to the
//! resolution of the message, except for the torque, which is split between two signals.

use super::drive::{DriveState, SimulatedDrive};
use super::random::{Purpose, normal, stream};
use super::scenario::Scenario;
use super::sensor_file::{Latencies, SensorNoiseLevels};
use super::surroundings_file::Air;
use estimator_core::{Signal, Value};
use rand_chacha::ChaCha8Rng;

/// SPN 899: cruise control sets the torque.
const CRUISE_CONTROL_MODE: f32 = 2.0;

/// The sensors of one run.
#[derive(Debug)]
pub struct Sensors<'a> {
    drive: &'a SimulatedDrive,
    noise: SensorNoiseLevels,
    latency_ms: Latencies,
    air: Air,
    believed_mass_kg: f32,
    /// True over assumed wheel radius.
    wheel_radius_factor: f64,
    rng: ChaCha8Rng,
}

impl<'a> Sensors<'a> {
    /// Creates the sensors of run `index`.
    #[must_use]
    pub fn new(scenario: &Scenario, index: usize, drive: &'a SimulatedDrive) -> Self {
        Self {
            drive,
            noise: scenario.noise,
            latency_ms: scenario.latency_ms,
            air: scenario.runs[index].air,
            believed_mass_kg: scenario.runs[index].vehicle.model.vehicle.mass_kg,
            wheel_radius_factor: scenario.planted.wheel_radius_factor,
            rng: stream(scenario.seed, index, Purpose::Sensors),
        }
    }

    /// Returns the value of a signal that is sent at a time of the drive.
    pub fn value(&mut self, signal: Signal, sent_s: f64) -> Value {
        let state = self.drive.at(sent_s - 1e-3 * self.age_ms(signal));
        let number = match signal {
            Signal::EngineTorqueMode => CRUISE_CONTROL_MODE,
            Signal::EngineTorqueFraction => 0.125 * (self.torque_eighths(&state) % 8) as f32,
            Signal::EngineTorque => (self.torque_eighths(&state) / 8) as f32,
            Signal::FrictionTorque => self.percent(state.friction_torque_nm) as f32,
            Signal::EngineSpeed => state.engine_rpm as f32,
            Signal::DrivelineEngaged => switch(state.engaged),
            Signal::ShiftInProcess => switch(state.shifting),
            Signal::ClutchSlip => state.clutch_slip_percent as f32,
            Signal::OutputShaftSpeed => {
                (self.drive.truck.output_shaft_rpm(state.speed_mps) * state.range_ratio) as f32
            }
            Signal::SelectedGear | Signal::CurrentGear if state.in_reverse => -1.0,
            Signal::SelectedGear => state.selected_gear as f32,
            Signal::CurrentGear => state.gear as f32,
            Signal::GearRatio => self.drive.truck.gear_ratio(state.gear) as f32,
            Signal::BrakeSwitch => switch(state.brake_pedal_percent > 0.0),
            Signal::BrakePedal => state.brake_pedal_percent as f32,
            Signal::ParkingBrake => switch(state.parked),
            Signal::RetarderTorque if state.retarder_n > 0.0 => {
                -self.drive.truck.retarder_percent(state.retarder_n) as f32
            }
            Signal::RetarderTorque => 0.0,
            Signal::Fan => state.fan_percent as f32,
            Signal::Mass => self.believed_mass_kg,
            Signal::AmbientTemperature => self.air.temperature_celsius as f32,
            Signal::AirPressure => self.air.pressure_pa as f32,
            Signal::YawRate => {
                // Course is positive to the right, yaw rate to the left.
                let turn = self.drive.road.curvature_per_m(state.distance_m) * state.speed_mps;
                (self.noise.yaw_rate_sigma_radps * normal(&mut self.rng) - turn) as f32
            }
            Signal::WheelSpeed | Signal::FrontAxleSpeed => {
                let noise = self.noise.speed_sigma_mps * normal(&mut self.rng);
                // The sensor counts pulses; the distance per pulse is assumed.
                let reported_mps = state.speed_mps / self.wheel_radius_factor;
                // Wheels at standstill give no pulses. Noise must not make the speed negative.
                if state.speed_mps > 0.0 {
                    (reported_mps + noise).max(0.0) as f32
                } else {
                    0.0
                }
            }
            _ => return Value::NotAvailable,
        };
        Value::Real(number)
    }

    fn age_ms(&self, signal: Signal) -> f64 {
        match signal {
            Signal::EngineTorqueMode
            | Signal::EngineTorqueFraction
            | Signal::EngineTorque
            | Signal::FrictionTorque
            | Signal::EngineSpeed => self.latency_ms.torque,
            Signal::WheelSpeed | Signal::FrontAxleSpeed => self.latency_ms.speed,
            Signal::DrivelineEngaged
            | Signal::ShiftInProcess
            | Signal::ClutchSlip
            | Signal::OutputShaftSpeed
            | Signal::SelectedGear
            | Signal::CurrentGear
            | Signal::GearRatio => self.latency_ms.gearbox,
            _ => self.latency_ms.chassis,
        }
    }

    fn percent(&self, torque_nm: f64) -> f64 {
        100.0 * torque_nm / self.drive.truck.reference_torque_nm
    }

    /// Returns the indicated torque, friction included, in eighths of a percent; never negative.
    /// SPN 513 holds the whole percents, SPN 4154 the remaining eighths.
    fn torque_eighths(&self, state: &DriveState) -> u32 {
        let indicated = self.percent(state.net_torque_nm + state.friction_torque_nm);
        (8.0 * indicated).round().clamp(0.0, 1000.0) as u32
    }
}

fn switch(on: bool) -> f32 {
    f32::from(u8::from(on))
}
