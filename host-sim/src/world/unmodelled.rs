//! What the believed vehicle does not explain: the truth that a diagnosis is after.

use super::Recording;
use super::drive::{DriveState, STEP_S};
use super::road::sine;
use super::truck::{GRAVITY, Truck};

impl Recording<'_> {
    /// Way in m and, on it, the grade in % that the believed force balance (thesis eq. 9, still
    /// air, warm tyres) reads from signals without noise or delay, less the true grade: positive
    /// where something holds the truck back that the vehicle file does not know. One a step; the
    /// service brake is taken as known.
    ///
    /// # Panics
    /// Never: the believed vehicle has the engine and gearbox of the true one.
    pub fn unmodelled_percent(&self) -> impl Iterator<Item = (f64, f64)> {
        let run = &self.scenario.runs[self.index];
        let believed = Truck::new(&run.vehicle.parameters).expect("it has the true one's engine");
        let radius_factor = self.scenario.planted.wheel_radius_factor;
        let air_density = self.scenario.air_density();
        let torque_factor = believed.reference_torque_nm / self.drive.truck.reference_torque_nm;
        self.drive.states.iter().map(move |state| {
            let way_m = STEP_S * state.speed_mps;
            let speed_mps = state.speed_mps / radius_factor;
            let force_n =
                torque_factor * believed_per_torque(&believed, state) * state.net_torque_nm
                    - believed.resistance_n(speed_mps, air_density)
                    - state.brake_n
                    - believed.accelerated_kg(if state.engaged { state.gear } else { 0 })
                        * state.acceleration_mps2
                        / radius_factor;
            let true_grade = self.drive.road.grade(state.distance_m + 0.5 * way_m);
            let read = force_n / (believed.mass_kg * GRAVITY);
            (way_m, 100.0 * (read - sine(true_grade)))
        })
    }

    /// The same as one number: its RMS over the way driven, %.
    #[must_use]
    pub fn unmodelled_rms_percent(&self) -> f64 {
        let (squares, way_m) = self
            .unmodelled_percent()
            .fold((0.0, 0.0), |sum, (way_m, percent)| {
                (sum.0 + way_m * percent * percent, sum.1 + way_m)
            });
        (squares / f64::max(way_m, f64::MIN_POSITIVE)).sqrt()
    }
}

/// Force for a newton metre of net torque as far as the driveline passes it, N/Nm.
fn believed_per_torque(believed: &Truck, state: &DriveState) -> f64 {
    if state.traction_n == 0.0 {
        0.0
    } else {
        believed.force_per_torque(state.gear)
    }
}
