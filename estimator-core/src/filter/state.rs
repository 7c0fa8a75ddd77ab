//! The states, and an estimate read from them.

use super::covariance::Covariance;
use crate::cell::{Estimate, Uncertain};
use crate::scalar::Scalar;

/// Number of states.
pub const STATES: usize = 8;

/// Kinetic energy per kilogram, v²/2, m²/s².
pub const ENERGY: usize = 0;
/// Altitude above [`State::origin_m`], m.
pub const ALTITUDE: usize = 1;
/// Slope that the vehicle model reads at its nominal scale: sine of the angle, %. The slope of
/// the road is this, less the bias and the wind, plus the scale's error times the load ([`State::load`]).
pub const SLOPE: usize = 2;
/// Change of [`SLOPE`] along the road, % per m.
pub const SLOPE_RATE: usize = 3;
/// Slope that the vehicle model reads too high for long, %: tyres, shape, wrong parameters.
pub const BIAS: usize = 4;
/// Slope that it reads too high for some kilometres, %: wind, and whatever else comes and goes.
pub const WIND: usize = 5;
/// True over modelled traction per kilogram, less one.
pub const SCALE: usize = 6;
/// Coloured error of the GNSS altitude, m.
pub const GNSS_ERROR: usize = 7;

/// Mean and covariance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct State<S> {
    /// The states in the order of the constants above.
    pub x: [S; STATES],
    /// Their covariance.
    pub p: Covariance<S>,
    /// Traction less air resistance over weight, %: the slope that an error of the scale amounts
    /// to.
    pub load: S,
    /// Altitude that the altitude state counts from, m: keeps it small in single precision.
    /// `None` before the first fix.
    pub origin_m: Option<f32>,
}

/// What can be read from the states.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// Slope of the road, sine in %.
    Slope,
    /// Altitude above [`State::origin_m`], m.
    Altitude,
    /// Slope that the vehicle model reads too high, all in all, %.
    Bias,
    /// True over modelled traction per kilogram, less one.
    Scale,
}

impl Quantity {
    /// h v, of the elements of a vector v.
    #[inline(always)]
    pub(super) fn of<S: Scalar>(self, load: S, v: impl Fn(usize) -> S) -> S {
        match self {
            Self::Slope => v(SLOPE) - v(BIAS) - v(WIND) + load * v(SCALE),
            Self::Altitude => v(ALTITUDE),
            Self::Bias => v(BIAS) + v(WIND),
            Self::Scale => v(SCALE),
        }
    }

    /// P h'.
    #[inline(always)] // Known where it is asked for, a quantity is a handful of elements.
    pub(super) fn cross<S: Scalar>(self, load: S, p: &Covariance<S>) -> [S; STATES] {
        let mut cross = [S::ZERO; STATES];
        for (k, element) in cross.iter_mut().enumerate() {
            *element = self.of(load, |i| p.get(i, k));
        }
        cross
    }
}

/// A quantity h x as it was known at one place: enough to correct it by what came later.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Look<S> {
    /// h x.
    pub mean: S,
    /// h P h'.
    pub variance: S,
    /// P h'.
    pub cross: [S; STATES],
}

impl<S: Scalar> State<S> {
    /// Standard deviation of state `i`.
    #[must_use]
    pub fn sigma(&self, i: usize) -> S {
        self.p.get(i, i).sqrt()
    }

    /// The estimate for the cell's end.
    #[must_use]
    pub fn estimate(&self) -> Estimate {
        let [bias, scale] = [Quantity::Bias, Quantity::Scale].map(|q| self.look(q).known());
        Estimate {
            grade_percent: self.look(Quantity::Slope).grade(),
            altitude_m: self.look(Quantity::Altitude).altitude(self.origin_m),
            speed_mps: (self.x[ENERGY] + self.x[ENERGY]).sqrt().to_f32(),
            bias_percent: bias,
            scale: Uncertain {
                value: 1.0 + scale.value,
                ..scale
            },
        }
    }

    /// How a quantity hangs on the states.
    #[inline(always)]
    #[must_use]
    pub fn look(&self, quantity: Quantity) -> Look<S> {
        let cross = quantity.cross(self.load, &self.p);
        Look {
            mean: quantity.of(self.load, |i| self.x[i]),
            variance: quantity.of(self.load, |i| cross[i]),
            cross,
        }
    }

    /// Whether every number is one.
    #[must_use]
    pub fn is_sound(&self) -> bool {
        S::are_finite(&self.x) && self.load.is_finite() && self.p.is_sound()
    }

    /// In another number.
    #[must_use]
    pub fn cast<T: Scalar>(&self) -> State<T> {
        State {
            x: self.x.map(|x| T::from_f64(x.to_f64())),
            p: self.p.cast(),
            load: T::from_f64(self.load.to_f64()),
            origin_m: self.origin_m,
        }
    }
}

impl<S: Scalar> Look<S> {
    /// Mean and standard deviation.
    #[must_use]
    pub fn known(&self) -> Uncertain {
        Uncertain {
            value: self.mean.to_f32(),
            sigma: self.variance.sqrt().to_f32(),
        }
    }

    /// A slope as a grade: 100 tan from the sine in %.
    #[must_use]
    pub fn grade(&self) -> Uncertain {
        let slope = self.known();
        // Roads end far below 30 %.
        let sine = (slope.value * 0.01).clamp(-0.5, 0.5);
        let cosine = Scalar::sqrt(1.0 - sine * sine);
        Uncertain {
            value: 100.0 * sine / cosine,
            sigma: slope.sigma / (cosine * cosine * cosine),
        }
    }

    /// An altitude that counts from an origin, if there is one.
    #[must_use]
    pub fn altitude(&self, origin_m: Option<f32>) -> Option<Uncertain> {
        origin_m.map(|origin_m| {
            let altitude = self.known();
            Uncertain {
                value: origin_m + altitude.value,
                ..altitude
            }
        })
    }
}
