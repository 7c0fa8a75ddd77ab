//! The states, and an estimate read from them.

use super::covariance::Covariance;
use crate::cell::{Estimate, Uncertain};
use crate::scalar::Scalar;

/// Number of states.
pub const STATES: usize = 7;

/// Kinetic energy per kilogram, v²/2, m²/s².
pub const ENERGY: usize = 0;
/// Altitude above [`State::origin_m`], m.
pub const ALTITUDE: usize = 1;
/// Sine of the slope angle, %.
pub const SLOPE: usize = 2;
/// Change of the slope along the road, % per m.
pub const SLOPE_RATE: usize = 3;
/// Slope that the vehicle model reads too high, %.
pub const BIAS: usize = 4;
/// True over modelled traction per kilogram, less one.
pub const SCALE: usize = 5;
/// Coloured error of the GNSS altitude, m.
pub const GNSS_ERROR: usize = 6;

/// Mean and covariance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct State<S> {
    /// The states in the order of the constants above.
    pub x: [S; STATES],
    /// Their covariance.
    pub p: Covariance<S>,
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
        estimate(&self.x, |i| self.p.get(i, i), self.origin_m)
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
            origin_m: self.origin_m,
        }
    }
}

/// Reads an estimate from a state and its variances.
pub(super) fn estimate<S: Scalar>(
    x: &[S; STATES],
    variance: impl Fn(usize) -> S,
    origin_m: Option<f32>,
) -> Estimate {
    let uncertain = |i: usize| Uncertain {
        value: x[i].to_f32(),
        sigma: variance(i).sqrt().to_f32(),
    };
    let slope = uncertain(SLOPE);
    // tan from sin; roads end far below 30 %.
    let sine = (slope.value * 0.01).clamp(-0.5, 0.5);
    let cosine = libm::sqrtf(1.0 - sine * sine);
    let scale = uncertain(SCALE);
    Estimate {
        grade_percent: Uncertain {
            value: 100.0 * sine / cosine,
            sigma: slope.sigma / (cosine * cosine * cosine),
        },
        altitude_m: origin_m.map(|origin_m| {
            let altitude = uncertain(ALTITUDE);
            Uncertain {
                value: origin_m + altitude.value,
                sigma: altitude.sigma,
            }
        }),
        speed_mps: (x[ENERGY] + x[ENERGY]).sqrt().to_f32(),
        bias_percent: uncertain(BIAS),
        scale: Uncertain {
            value: 1.0 + scale.value,
            sigma: scale.sigma,
        },
    }
}
