//! The driver: PI cruise control (thesis 4), and the service brake if that is not sufficient.

/// Set speed of the thesis: 80 km/h.
pub const SET_SPEED_MPS: f64 = 80.0 / 3.6;
/// Speed above which the brakes are used (thesis 4.3): 89 km/h.
pub const BRAKE_ON_MPS: f64 = 89.0 / 3.6;
/// Speed at which the driver releases the brake.
pub const BRAKE_OFF_MPS: f64 = 85.0 / 3.6;
/// Pedal position while braking, %.
const PEDAL_PERCENT: f64 = 20.0;
/// Deceleration that a fully applied service brake gives at that pedal, m/s².
const BRAKE_DECELERATION: f64 = 0.8;
/// Time in which air pressure builds up or vanishes, s.
const BRAKE_LAG_S: f64 = 0.25;
/// Deceleration below which a brake no longer counts as used, m/s².
const BRAKE_RELEASED: f64 = 0.005;

/// Gains of the cruise control: acceleration per m/s of speed error, 1/s, and per metre of its
/// integral, 1/s². Overdamped, so that a change of grade does not cause oscillation.
const PROPORTIONAL_PER_S: f64 = 0.4;
const INTEGRAL_PER_S2: f64 = 0.02;

/// Cruise control. Its integral is a specific force, m/s².
#[derive(Clone, Copy, Debug, Default)]
pub struct CruiseControl {
    integral_mps2: f64,
    /// Another set speed than [`SET_SPEED_MPS`], m/s.
    other_set_speed_mps: Option<f64>,
}

/// The torque request of the cruise control.
#[derive(Clone, Copy, Debug)]
pub struct TorqueRequest {
    /// Net torque within the engine's limits, Nm.
    pub net_nm: f64,
    /// True if the request is limited by the engine.
    pub at_full_load: bool,
}

impl CruiseControl {
    /// Creates a cruise control in balance at this specific force, m/s².
    #[must_use]
    pub const fn balanced_at(integral_mps2: f64) -> Self {
        Self {
            integral_mps2,
            other_set_speed_mps: None,
        }
    }

    /// Sets the speed to keep, m/s.
    pub const fn set_speed(&mut self, set_speed_mps: f64) {
        self.other_set_speed_mps = Some(set_speed_mps);
    }

    /// Returns the torque for the next `step_s`. `force_per_kg_nm` is the specific force of one
    /// newton metre, `limits_nm` the range of the engine. The integrator is frozen while the engine
    /// is at a limit and the error would increase it further.
    pub fn request(
        &mut self,
        speed_mps: f64,
        force_per_kg_nm: f64,
        limits_nm: (f64, f64),
        step_s: f64,
    ) -> TorqueRequest {
        let error_mps = self.other_set_speed_mps.unwrap_or(SET_SPEED_MPS) - speed_mps;
        let wanted = (PROPORTIONAL_PER_S * error_mps + self.integral_mps2) / force_per_kg_nm;
        let net_nm = wanted.clamp(limits_nm.0, limits_nm.1);
        if (wanted - net_nm) * error_mps <= 0.0 {
            self.integral_mps2 += INTEGRAL_PER_S2 * error_mps * step_s;
        }
        TorqueRequest {
            net_nm,
            at_full_load: wanted > limits_nm.1,
        }
    }
}

/// The service brake and its pedal.
#[derive(Clone, Copy, Debug, Default)]
pub struct Brake {
    pressed: bool,
    deceleration_mps2: f64,
}

impl Brake {
    /// Advances pedal and air pressure by `step_s`; returns the specific braking force, m/s².
    pub fn step(&mut self, speed_mps: f64, hold: bool, step_s: f64) -> f64 {
        self.step_about(SET_SPEED_MPS, speed_mps, hold, step_s)
    }

    /// Does the same as [`step`](Self::step) at another set speed, m/s.
    pub fn step_about(
        &mut self,
        set_speed_mps: f64,
        speed_mps: f64,
        hold: bool,
        step_s: f64,
    ) -> f64 {
        let lower_mps = SET_SPEED_MPS - set_speed_mps;
        let limit_mps = if self.pressed {
            BRAKE_OFF_MPS
        } else {
            BRAKE_ON_MPS
        };
        self.pressed = hold || speed_mps > limit_mps - lower_mps;
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

    /// Returns the pedal position, %.
    #[must_use]
    pub fn pedal_percent(&self) -> f64 {
        if self.pressed { PEDAL_PERCENT } else { 0.0 }
    }
}

/// Specific force of the retarder for a speed above its limit, 1/s, and the largest one, m/s².
const RETARDER: (f64, f64) = (0.5, 1.0);
/// Speed above the set speed from which the retarder brakes, m/s.
const RETARDER_ON_MPS: f64 = 0.5;
/// Time in which the retarder follows its request, s.
const RETARDER_LAG_S: f64 = 0.4;
/// Deceleration below which the retarder is off, m/s².
const RETARDER_OFF: f64 = 1e-3;

/// The retarder, which keeps a speed downhill.
#[derive(Clone, Copy, Debug, Default)]
pub struct Retarder {
    deceleration_mps2: f64,
}

impl Retarder {
    /// Advances by `step_s`; returns the specific braking force, m/s².
    pub fn step(&mut self, is_used: bool, excess_mps: f64, step_s: f64) -> f64 {
        let wanted = if is_used {
            (RETARDER.0 * (excess_mps - RETARDER_ON_MPS)).clamp(0.0, RETARDER.1)
        } else {
            0.0
        };
        self.deceleration_mps2 += (wanted - self.deceleration_mps2) * step_s / RETARDER_LAG_S;
        if wanted == 0.0 && self.deceleration_mps2 < RETARDER_OFF {
            self.deceleration_mps2 = 0.0;
        }
        self.deceleration_mps2
    }
}
