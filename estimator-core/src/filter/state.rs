//! Mean and covariance of the states, and their step over a cell.

use super::cell_input::CellInput;
use super::covariance::{Covariance, StateVector};
use super::dynamics::Dynamics;
use super::measurement::Update;
use super::noise::{CellNoise, Noise};
use super::state_index::STATES;
use super::state_index::StateIndex::{
    self, Altitude, Bias, DoubtfulForce, KineticEnergy, Retarder, Scale, Slope, Wind,
};
use crate::cell::Uncertain;
use crate::scalar::Scalar;

/// Mean and covariance of the states, and the forces that weigh two of them.
#[derive(Clone, Copy, Debug)]
pub struct State<S> {
    /// Mean.
    pub mean: StateVector<S>,
    /// Covariance.
    pub covariance: Covariance<S>,
    /// Net traction of the last cell, %.
    pub net_traction: S,
    /// Force of the retarder in the last cell, %.
    pub retarder: S,
}

/// Mean and variance of a quantity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moments<S> {
    /// Mean.
    pub mean: S,
    /// Variance.
    pub variance: S,
}

impl<S: Scalar> Moments<S> {
    /// Returns them in single precision.
    #[must_use]
    pub fn to_single(self) -> Moments<f32> {
        Moments {
            mean: self.mean.to_f32(),
            variance: self.variance.to_f32(),
        }
    }
}

impl Moments<f32> {
    /// Nothing.
    pub const NONE: Self = Self {
        mean: 0.0,
        variance: 0.0,
    };

    /// Returns mean and standard deviation.
    #[must_use]
    pub fn uncertain(&self) -> Uncertain {
        Uncertain {
            value: self.mean,
            sigma: Scalar::sqrt(Scalar::max(0.0, self.variance)),
        }
    }

    /// Returns the moments with a variance in addition.
    #[must_use]
    pub const fn widened(self, variance: f32) -> Self {
        Self {
            mean: self.mean,
            variance: self.variance + variance,
        }
    }

    /// Returns the grade of a slope, %: 100 tan of the angle from the sine in %.
    #[must_use]
    pub fn grade(&self) -> Uncertain {
        // No road is steeper than 50 %.
        let sine = Scalar::min(0.5, Scalar::max(-0.5, self.mean * 0.01));
        let cosine = Scalar::sqrt(1.0 - sine * sine);
        Uncertain {
            value: 100.0 * sine / cosine,
            sigma: Scalar::sqrt(self.variance) / (cosine * cosine * cosine),
        }
    }
}

/// What a step leaves for the backward pass.
#[derive(Clone, Copy, Debug)]
pub struct Record<S> {
    /// State after the step.
    pub state: State<S>,
    /// Net traction before the step, %.
    pub net_traction_before: S,
    /// Update with the speed.
    pub speed: Option<Update<S>>,
    /// Whether the speed stepped by more than any force can make it: the sensor did.
    pub speed_steps: bool,
    /// Update with the altitude.
    pub altitude: Option<Update<S>>,
    /// Update with a slope that was measured directly.
    pub slope: Option<Update<S>>,
}

/// What is linear in the states.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// Slope of the road, sine in %.
    RoadSlope,
    /// Slope that the force balance reads, sine in %.
    ReadSlope,
    /// Altitude above the origin, m.
    Altitude,
    /// Bias and wind, %.
    ModelError,
    /// Scale error, 1.
    Scale,
    /// Doubtful force, %.
    DoubtfulForce,
    /// v²/2, m²/s².
    KineticEnergy,
}

impl<S: Scalar> State<S> {
    /// Nothing known, and nothing moving: the place of a state.
    pub const ZERO: Self = Self {
        mean: [S::ZERO; STATES],
        covariance: Covariance::ZERO,
        net_traction: S::ZERO,
        retarder: S::ZERO,
    };

    /// Returns h v of a quantity h for the elements of v.
    #[inline(always)]
    fn of(&self, quantity: Quantity, v: impl Fn(StateIndex) -> S) -> S {
        match quantity {
            Quantity::RoadSlope => {
                v(Slope) - v(Bias) - v(Wind) - v(DoubtfulForce) + self.net_traction * v(Scale)
                    - self.retarder * v(Retarder)
            }
            Quantity::ReadSlope => v(Slope),
            Quantity::Altitude => v(Altitude),
            Quantity::ModelError => v(Bias) + v(Wind),
            Quantity::Scale => v(Scale),
            Quantity::DoubtfulForce => v(DoubtfulForce),
            Quantity::KineticEnergy => v(KineticEnergy),
        }
    }

    /// Returns the mean of a quantity.
    #[inline(always)]
    pub(super) fn mean_of(&self, quantity: Quantity) -> S {
        self.of(quantity, |i| self.mean[i as usize])
    }

    /// Returns mean and variance of a quantity, and its covariance with the states, P h'.
    #[inline]
    #[must_use]
    pub fn quantity(&self, quantity: Quantity) -> (Moments<S>, StateVector<S>) {
        let cross =
            StateIndex::ALL.map(|index| self.of(quantity, |i| self.covariance.get(i, index)));
        let moments = Moments {
            mean: self.mean_of(quantity),
            variance: self.of(quantity, |i| cross[i as usize]),
        };
        (moments, cross)
    }

    /// Returns whether every number is finite and every variance not negative.
    #[must_use]
    pub fn is_sound(&self) -> bool {
        S::are_finite(&self.mean) && self.covariance.is_sound()
    }

    /// Moves over a cell that follows the last one, and leaves its record.
    #[inline]
    pub fn step(
        &mut self,
        cell: &CellInput,
        dynamics: &Dynamics<S>,
        noise: &CellNoise<S>,
        gate: Option<S>,
        record: &mut Record<S>,
    ) {
        record.net_traction_before = self.net_traction;
        if noise.load > S::ZERO {
            self.open_load(noise.load);
        }
        let energy_before = self.mean[KineticEnergy as usize];
        dynamics.forward(&mut self.mean, &mut self.covariance);
        self.net_traction = dynamics.net_traction;
        self.retarder = dynamics.retarder;
        let energy = &mut self.mean[KineticEnergy as usize];
        *energy = (*energy + S::from_f32(cell.work)).max(S::ZERO);
        self.observe(cell, noise, energy_before, gate, record);
    }

    /// Adds the noise of a cell whose end is predicted, and updates with speed and altitude. An
    /// altitude whose squared innovation exceeds `gate` times its variance is left out.
    #[inline(never)] // One copy: flash is small.
    pub(super) fn observe(
        &mut self,
        cell: &CellInput,
        noise: &CellNoise<S>,
        energy_before: S,
        gate: Option<S>,
        record: &mut Record<S>,
    ) {
        for (direction, q) in Noise::ALL.into_iter().zip(noise.of) {
            direction.add_to(&mut self.covariance, q);
        }
        (record.speed, record.speed_steps) = if cell.energy.is_some() {
            let (update, steps) = self.update_speed(cell, energy_before, noise.speed);
            (Some(update), steps)
        } else {
            (None, false)
        };
        record.altitude = if cell.altitude.is_some() {
            Some(self.update_altitude(cell, noise.altitude, gate))
        } else {
            None
        };
        record.slope = if cell.slope.is_some() {
            Some(self.update_slope(cell, noise.slope, gate))
        } else {
            None
        };
        record.state = *self;
    }

    /// Widens the scale at a standstill, where the load may change. The slope of the road stays.
    fn open_load(&mut self, variance: S) {
        let l = self.net_traction;
        let p = &mut self.covariance;
        p.add(Scale, Scale, variance);
        p.add(Scale, Slope, -(variance * l));
        p.add(Slope, Slope, variance * l * l);
    }
}

impl<S: Scalar> Record<S> {
    /// The place of a record.
    pub const EMPTY: Self = Self {
        state: State::ZERO,
        net_traction_before: S::ZERO,
        speed: None,
        speed_steps: false,
        altitude: None,
        slope: None,
    };
}
