//! The driver: PI cruise control (thesis 4), and a foot on the brake when that is not enough.

/// Set speed of the thesis: 80 km/h.
pub const SET_SPEED_MPS: f64 = 80.0 / 3.6;
/// Speed above which the brakes are used (thesis 4.3): 89 km/h.
pub const BRAKE_ON_MPS: f64 = 89.0 / 3.6;
/// Speed at which the foot leaves the brake again.
pub const BRAKE_OFF_MPS: f64 = 85.0 / 3.6;
/// Pedal position while braking, %.
const PEDAL_PERCENT: f64 = 20.0;
/// Deceleration that a fully applied service brake gives at that pedal, m/s².
const BRAKE_DECELERATION: f64 = 0.8;
/// Time in which air pressure builds up or vanishes, s.
const BRAKE_LAG_S: f64 = 0.25;
/// Deceleration below which a brake no longer counts as used, m/s².
const BRAKE_RELEASED: f64 = 0.005;

/// Acceleration asked for per m/s of speed error, 1/s, and per metre of its integral, 1/s².
/// Damped above critical, so that a change of grade does not make the truck hunt.
const PROPORTIONAL_PER_S: f64 = 0.4;
const INTEGRAL_PER_S2: f64 = 0.02;

/// Cruise control. Its integral is a specific force, m/s².
#[derive(Clone, Copy, Debug, Default)]
pub struct CruiseControl {
    integral_mps2: f64,
}

/// What cruise control asks of the engine.
#[derive(Clone, Copy, Debug)]
pub struct TorqueWish {
    /// Net torque within the engine's limits, Nm.
    pub net_nm: f64,
    /// More was wanted than the engine has.
    pub at_full_load: bool,
}

impl CruiseControl {
    /// Already balanced at this specific force, m/s².
    #[must_use]
    pub const fn balanced_at(integral_mps2: f64) -> Self {
        Self { integral_mps2 }
    }

    /// The torque for the next `step_s`: `force_per_kg_nm` is the specific force of one newton
    /// metre, `limits_nm` what the engine can give. The integral stands still while the engine
    /// is at a limit and the error would push it further.
    pub fn wish(
        &mut self,
        speed_mps: f64,
        force_per_kg_nm: f64,
        limits_nm: (f64, f64),
        step_s: f64,
    ) -> TorqueWish {
        let error_mps = SET_SPEED_MPS - speed_mps;
        let wanted = (PROPORTIONAL_PER_S * error_mps + self.integral_mps2) / force_per_kg_nm;
        let net_nm = wanted.clamp(limits_nm.0, limits_nm.1);
        if (wanted - net_nm) * error_mps <= 0.0 {
            self.integral_mps2 += INTEGRAL_PER_S2 * error_mps * step_s;
        }
        TorqueWish {
            net_nm,
            at_full_load: wanted > limits_nm.1,
        }
    }
}

/// The service brake and the foot on it.
#[derive(Clone, Copy, Debug, Default)]
pub struct Brake {
    pressed: bool,
    deceleration_mps2: f64,
}

impl Brake {
    /// Moves foot and air pressure on by `step_s`; returns the specific braking force, m/s².
    pub fn step(&mut self, speed_mps: f64, hold: bool, step_s: f64) -> f64 {
        self.pressed = hold
            || speed_mps
                > if self.pressed {
                    BRAKE_OFF_MPS
                } else {
                    BRAKE_ON_MPS
                };
        let target = if self.pressed {
            BRAKE_DECELERATION
        } else {
            0.0
        };
        self.deceleration_mps2 += (target - self.deceleration_mps2) * step_s / BRAKE_LAG_S;
        if !self.pressed && self.deceleration_mps2 < BRAKE_RELEASED {
            self.deceleration_mps2 = 0.0;
        }
        self.deceleration_mps2
    }

    /// Pedal position, %.
    #[must_use]
    pub fn pedal_percent(&self) -> f64 {
        if self.pressed { PEDAL_PERCENT } else { 0.0 }
    }
}
