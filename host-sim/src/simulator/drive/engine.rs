//! The engine in a step: its speed and torque along the path of the torque.

use super::Journey;
use super::state::STEP_S;
use crate::simulator::driver::TorqueRequest;
use crate::simulator::gearbox::Flow;
use crate::simulator::truck::IDLE_RPM;

/// Rate of change of torque, full load to none or back, 1/s: by the driver, and by the gearbox.
const TORQUE_RATE_PER_S: (f64, f64) = (1.5, 8.0);

impl Journey<'_> {
    /// Sets engine speed and torque. Returns the gear that couples engine and wheels (0 if none)
    /// and the slip of the clutch in %.
    pub(super) fn run_engine(&mut self, flow: Flow, halting: bool) -> (usize, f64) {
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
                let wish = if halting {
                    TorqueRequest {
                        net_nm: lowest_nm,
                        at_full_load: false,
                    }
                } else {
                    self.cruise
                        .request(self.speed_mps, per_kg, limits_nm, STEP_S)
                };
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
