//! A drive of the indicator: what is on board, what happens, and what is wrong.

use crate::drive::{Moment, value_of};
use estimator_core::{Signal, Value};

/// What becomes of a reading; `None` if it does not come at all.
pub type Faults = fn(&Moment, Signal, f32) -> Option<Value>;

/// A drive.
#[derive(Clone, Copy)]
pub struct Scenario {
    pub name: &'static str,
    pub seed: u64,
    pub seconds: u32,
    pub by_force: bool,
    /// Whether all effects are adopted.
    pub effects: bool,
    /// Signals besides those that every vehicle has.
    pub more: &'static [Signal],
    /// Ticks of 100 ms from one fix to the next.
    pub fix_ticks: u32,
    /// True over assumed values.
    pub mass_factor: f32,
    pub rolling_factor: f32,
    pub headwind_mps: f32,
    pub gusts: f32,
    pub retarder: bool,
    pub begin_mps: f32,
    /// Where it stops, for how long, and what the load changes by there.
    pub stops_m: &'static [f32],
    pub stands_s: f32,
    pub load_factor: f32,
    /// How far it goes back after each stop.
    pub reverses_m: f32,
    /// Slope of the long descents.
    pub descents: f32,
    /// Ticks by which what the receiver says is late.
    pub late_ticks: usize,
    /// Time constants of low-pass filters of the receiver's altitude and of the wheel speed.
    pub altitude_smoothed_s: f32,
    pub speed_smoothed_s: f32,
    pub faults: Faults,
}

pub const PLAIN: Scenario = Scenario {
    name: "plain",
    seed: 1,
    seconds: 500,
    by_force: false,
    effects: false,
    more: &[],
    fix_ticks: 10,
    mass_factor: 1.0,
    rolling_factor: 1.0,
    headwind_mps: 0.0,
    gusts: 0.0,
    retarder: false,
    begin_mps: 20.0,
    stops_m: &[],
    stands_s: 30.0,
    load_factor: 1.0,
    reverses_m: 0.0,
    descents: 0.0,
    late_ticks: 0,
    altitude_smoothed_s: 0.0,
    speed_smoothed_s: 0.0,
    faults: |_, signal, value| Some(value_of(signal, value)),
};

/// Signals that only some vehicles have.
const OPTIONAL: &[Signal] = &[
    Signal::LongitudinalAcceleration,
    Signal::Pitch,
    Signal::VerticalSpeed,
    Signal::YawRate,
    Signal::Mass,
    Signal::Fan,
    Signal::NetEngineTorque,
    Signal::MotorTorque,
    Signal::MotorSpeed,
    Signal::ParasiticTorque,
    Signal::DrivelineEngaged,
    Signal::ClutchSlip,
    Signal::ClutchSwitch,
    Signal::GearRatio,
    Signal::OutputShaftSpeed,
    Signal::BrakeLight,
    Signal::FoundationBrake,
    Signal::BrakePedal,
    Signal::BrakePressure,
    Signal::ParkingBrake,
];

/// Signals of an engine that the torque of its shaft replaces, and of one that a motor replaces.
const OF_PERCENT: &[Signal] = &[Signal::EngineTorque, Signal::FrictionTorque];
const OF_AN_ENGINE: &[Signal] = &[
    Signal::EngineTorque,
    Signal::FrictionTorque,
    Signal::EngineSpeed,
    Signal::ShiftInProcess,
];

impl Scenario {
    /// Returns whether a signal is there.
    pub fn has(&self, signal: Signal) -> bool {
        let replaced =
            |by: Signal, what: &[Signal]| self.more.contains(&by) && what.contains(&signal);
        (!OPTIONAL.contains(&signal) || self.more.contains(&signal))
            && !replaced(Signal::NetEngineTorque, OF_PERCENT)
            && !replaced(Signal::MotorTorque, OF_AN_ENGINE)
    }
}
