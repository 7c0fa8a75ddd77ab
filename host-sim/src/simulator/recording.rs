//! A simulated drive and its CAN data.

use super::bus::BusTraffic;
use super::drive::{self, SimulatedDrive};
use super::gnss::GnssReceiver;
use super::inertial::InertialSensors;
use super::scenario::Scenario;
use super::sensors::Sensors;
use crate::error::Result;
use crate::files::truth::TruthRow;
use crate::files::vehicle::VehicleFile;
use crate::source::can_frame::TimedFrame;
use estimator_core::VehicleParameters;

/// Time between two rows of the truth, s.
const TRUTH_STEP_S: f64 = 0.1;

/// A whole run in memory.
#[derive(Clone, Debug)]
pub struct SimulatedRun {
    /// The run's name in the scenario.
    pub name: String,
    /// The vehicle as the estimator assumes it.
    pub vehicle: VehicleFile,
    /// The true vehicle.
    pub true_parameters: VehicleParameters,
    /// The frames on the bus.
    pub frames: Vec<TimedFrame>,
    /// The true state, every 100 ms from the first frame on.
    pub truth: Vec<TruthRow>,
}

/// Simulates run `index` of the scenario in memory.
///
/// # Errors
/// Returns an error if the truck comes to a stop on its road.
///
/// # Panics
/// Panics if the scenario has no run `index`.
pub fn simulate(scenario: &Scenario, index: usize) -> Result<SimulatedRun> {
    let recording = Recording::new(scenario, index)?;
    let run = &scenario.runs[index];
    Ok(SimulatedRun {
        name: run.name.clone(),
        vehicle: run.vehicle.clone(),
        true_parameters: run.true_parameters.clone(),
        frames: recording.frames().collect(),
        truth: recording.truth(),
    })
}

/// A simulated drive whose CAN data can be generated.
#[derive(Debug)]
pub struct Recording<'a> {
    pub(super) scenario: &'a Scenario,
    pub(super) index: usize,
    pub(super) drive: SimulatedDrive,
}

impl<'a> Recording<'a> {
    /// Simulates run `index` of the scenario.
    ///
    /// # Errors
    /// Returns an error if the truck comes to a stop on its road.
    ///
    /// # Panics
    /// Panics if the scenario has no run `index`.
    pub fn new(scenario: &'a Scenario, index: usize) -> Result<Self> {
        let drive = drive::drive(scenario, index)?;
        Ok(Self {
            scenario,
            index,
            drive,
        })
    }

    /// Returns the drive, step by step.
    #[must_use]
    pub const fn drive(&self) -> &SimulatedDrive {
        &self.drive
    }

    /// Returns the CAN data, in order of time. Each call returns the same frames.
    pub fn frames(&self) -> impl Iterator<Item = TimedFrame> {
        let sensors = Sensors::new(self.scenario, self.index, &self.drive);
        let inertial = InertialSensors::new(self.scenario, self.index, &self.drive);
        let gnss = GnssReceiver::new(self.scenario, self.index, &self.drive);
        BusTraffic::new(
            self.scenario,
            self.index,
            sensors,
            inertial,
            gnss,
            self.drive.duration_s(),
        )
    }

    /// Returns the truth every 100 ms; time and distance count from the first frame.
    #[must_use]
    pub fn truth(&self) -> Vec<TruthRow> {
        let log_start_s = self.scenario.runs[self.index].start_time_s;
        let Some(first) = self.frames().next() else {
            return Vec::new();
        };
        let first_s = first.time.micros() as f64 * 1e-6 - log_start_s;
        let from_m = self.drive.at(first_s).driven_m();
        let rows = ((self.drive.duration_s() - first_s) / TRUTH_STEP_S) as usize + 1;
        (0..rows)
            .map(|row| {
                let time_s = row as f64 * TRUTH_STEP_S;
                let state = self.drive.at(first_s + time_s);
                let road = &self.drive.road;
                TruthRow {
                    time_s,
                    distance_m: state.driven_m() - from_m,
                    grade_percent: 100.0 * road.grade(state.distance_m),
                    altitude_m: road.altitude_m(state.distance_m),
                    shifting: u8::from(state.shifting),
                    braking: u8::from(state.braking()),
                }
            })
            .collect()
    }
}
