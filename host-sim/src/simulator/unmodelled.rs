//! The true error of the assumed vehicle model, the target of the diagnosis.

use super::drive::{DriveState, STEP_S};
use super::recording::Recording;
use super::truck::{GRAVITY, Truck};
use crate::numeric::slope::sine;

/// One step of a drive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Unmodelled {
    /// Length of the step, m.
    pub length_m: f64,
    /// Grade in % of the assumed force balance (thesis eq. 9, still air, warm tyres) from signals
    /// without noise or delay, minus the true grade. It is positive where a force that the vehicle
    /// file lacks acts against the motion. The service brake is taken as known.
    pub percent: f64,
    /// True if a gear is engaged, without shift or brake.
    pub valid: bool,
}

impl Recording<'_> {
    /// Returns the error of the assumed vehicle model, step by step.
    ///
    /// # Panics
    /// Never: the assumed vehicle has the engine and gearbox of the true one.
    pub fn unmodelled(&self) -> impl Iterator<Item = Unmodelled> {
        let run = &self.scenario.runs[self.index];
        let assumed = Truck::new(&run.vehicle.model.vehicle).expect("it has the true one's engine");
        let radius_factor = self.scenario.planted.wheel_radius_factor;
        let air_density = run.air.density();
        let torque_factor = assumed.reference_torque_nm / self.drive.truck.reference_torque_nm;
        self.drive.states.iter().map(move |state| {
            let length_m = STEP_S * state.speed_mps;
            let per_torque = torque_factor * assumed_per_torque(&assumed, state);
            let closed_gear = if state.engaged { state.gear } else { 0 };
            let inertia_n =
                assumed.accelerated_kg(closed_gear) * state.acceleration_mps2 / radius_factor;
            let force_n = per_torque * state.net_torque_nm
                - assumed.resistance_n(state.speed_mps / radius_factor, air_density)
                - state.brake_n
                - state.retarder_n
                - inertia_n;
            let true_grade = self.drive.road.grade(state.distance_m + 0.5 * length_m);
            let read = force_n / (assumed.mass_kg * GRAVITY);
            Unmodelled {
                length_m,
                percent: 100.0 * (read - sine(true_grade)),
                valid: state.engaged && !state.shifting && !state.braking(),
            }
        })
    }
}

/// Returns the force per newton metre of net torque, N/Nm; zero if the driveline is open.
fn assumed_per_torque(assumed: &Truck, state: &DriveState) -> f64 {
    if state.traction_n == 0.0 {
        0.0
    } else {
        assumed.force_per_torque(state.gear)
    }
}
