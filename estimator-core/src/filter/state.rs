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

impl<S: Scalar> State<S> {
    /// Standard deviation of state `i`.
    #[must_use]
    pub fn sigma(&self, i: usize) -> S {
        self.p.get(i, i).sqrt()
    }

    /// The estimate for the cell's end.
    #[must_use]
    pub fn estimate(&self) -> Estimate {
        estimate(&self.x, self.load, self.origin_m, |h| {
            dot(h, &self.p.times(h))
        })
    }

    /// Whether every number is one.
    #[must_use]
    pub fn is_sound(&self) -> bool {
        self.x.iter().all(|x| x.is_finite()) && self.p.is_sound()
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

/// a b'.
#[inline(always)]
pub(super) fn dot<S: Scalar>(a: &[S; STATES], b: &[S; STATES]) -> S {
    let mut sum = S::ZERO;
    for (a, b) in a.iter().zip(b) {
        sum += *a * *b;
    }
    sum
}

/// Reads an estimate from a mean; `variance` tells the variance of h x for a row h.
pub(super) fn estimate<S: Scalar>(
    x: &[S; STATES],
    load: S,
    origin_m: Option<f32>,
    variance: impl Fn(&[S; STATES]) -> S,
) -> Estimate {
    let read = |row: &[(usize, S)]| {
        let mut h = [S::ZERO; STATES];
        for (state, factor) in row {
            h[*state] = *factor;
        }
        Uncertain {
            value: dot(&h, x).to_f32(),
            sigma: variance(&h).sqrt().to_f32(),
        }
    };
    let slope = read(&[
        (SLOPE, S::ONE),
        (BIAS, -S::ONE),
        (WIND, -S::ONE),
        (SCALE, load),
    ]);
    // tan from sin; roads end far below 30 %.
    let sine = (slope.value * 0.01).clamp(-0.5, 0.5);
    let cosine = libm::sqrtf(1.0 - sine * sine);
    let scale = read(&[(SCALE, S::ONE)]);
    Estimate {
        grade_percent: Uncertain {
            value: 100.0 * sine / cosine,
            sigma: slope.sigma / (cosine * cosine * cosine),
        },
        altitude_m: origin_m.map(|origin_m| {
            let altitude = read(&[(ALTITUDE, S::ONE)]);
            Uncertain {
                value: origin_m + altitude.value,
                sigma: altitude.sigma,
            }
        }),
        speed_mps: (x[ENERGY] + x[ENERGY]).sqrt().to_f32(),
        bias_percent: read(&[(BIAS, S::ONE), (WIND, S::ONE)]),
        scale: Uncertain {
            value: 1.0 + scale.value,
            sigma: scale.sigma,
        },
    }
}
