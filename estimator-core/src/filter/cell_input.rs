//! What is known of one cell, in the form that the passes read again and again.

use crate::tuning::Numbers;

/// A cell: inputs, measurements and base variances. The inference multiplies the variances.
#[derive(Clone, Copy, Debug)]
pub struct CellInput {
    /// Time taken, s.
    pub duration_s: f32,
    /// Speed at its end, m/s.
    pub speed_mps: f32,
    /// Fraction of the kinetic energy that air resistance leaves, 1.
    pub keep_energy: f32,
    /// Work of all forces but weight and air resistance, m²/s².
    pub work: f32,
    /// Specific weight times length, m²/s² for 1 % of slope.
    pub gravity: f32,
    /// Net traction over weight, %: the slope that an error of the scale amounts to.
    pub net_traction_percent: f32,
    /// Its change at a launch or a stop, which no road has caused, %.
    pub traction_jump_percent: f32,
    /// Force of the retarder over weight, %. It is in the work.
    pub retarder_percent: f32,
    /// Its change since the last cell, %.
    pub retarder_step_percent: f32,
    /// Variance of the white noise of the force, as a slope, %². The force level multiplies it.
    pub force_variance: f32,
    /// Variance of the force that no level multiplies, as a slope, %².
    pub fixed_force_variance: f32,
    /// Stationary variance of the bias, %².
    pub bias_variance: f32,
    /// Variance that the scale gains at most, where the load may have changed before the cell; else 0.
    pub load_variance: f32,
    /// Variance that the bias gains by uncertain effects, %².
    pub effect_variance: f32,
    /// Stationary variance of the wind, %².
    pub wind_variance: f32,
    /// Speed as v²/2, m²/s².
    pub energy: Reading,
    /// Distance from where it was taken to the cell's end, m.
    pub energy_behind_m: f32,
    /// Distance since the reading before, m.
    pub since_speed_m: f32,
    /// What a tyre slip of one adds to that reading, m²/s².
    pub energy_per_slip: f32,
    /// GNSS altitude above the first one, m.
    pub altitude: Reading,
    /// Distance from where it was taken to the cell's end, m.
    pub altitude_behind_m: f32,
    /// Slope of the road that a sensor measures directly, %.
    pub slope: Reading,
    /// Sigma of the force of a torque that rested here, as a slope, %.
    pub rest_percent: f32,
    /// What holds in the cell.
    pub marks: Marks,
}

impl CellInput {
    /// Returns the slope that the force balance reads, with the kinetic energy before and behind, %.
    #[must_use]
    pub fn read_percent(&self, (before, after): (f32, f32)) -> f32 {
        (self.keep_energy * before + self.work - after) / (self.keep_energy * self.gravity)
    }

    /// Returns whether the retarder brakes.
    #[must_use]
    pub fn retards(&self, numbers: &Numbers) -> bool {
        self.retarder_percent > numbers.least_force_percent
    }
}

/// A measurement in a cell.
#[derive(Clone, Copy, Debug)]
pub struct Reading {
    /// The value; NaN where there is none.
    pub value: f32,
    /// Base variance of its noise.
    pub variance: f32,
}

impl Reading {
    /// No measurement.
    pub const NONE: Self = Self {
        value: f32::NAN,
        variance: 1.0,
    };

    /// Returns whether there is one.
    #[inline(always)]
    #[must_use]
    pub fn is_some(&self) -> bool {
        self.value.is_finite()
    }
}

/// What holds in a cell.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Marks {
    /// The force balance does not hold: a shift, a service brake, no known traction.
    pub invalid: bool,
    /// The slope that a sensor measures is the one that the force balance reads.
    pub slope_is_read: bool,
    /// The force is that of the accelerometer.
    pub by_accelerometer: bool,
    /// The engine drives nothing.
    pub overrun: bool,
    /// A rest of the torque begins in this cell.
    pub rest_begins: bool,
    /// A change of the load would be one that its report lacks.
    pub load_told: bool,
    /// The cell does not follow the last one.
    pub gap: bool,
    /// Another receiver gives the altitude from here on.
    pub receiver_switched: bool,
    /// The vehicle crawls: readings of the speed are coarse.
    pub crawling: bool,
}
