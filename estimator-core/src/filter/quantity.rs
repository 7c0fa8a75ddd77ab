//! Quantities that are linear in the states, and their estimates.

use super::covariance::Covariance;
use super::state_index::{StateIndex, StateVector};
use crate::cell::Uncertain;
use crate::scalar::Scalar;

/// A quantity h x of the states x.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// Slope of the road: s − b − w + κ times net traction, sine in %.
    Slope,
    /// Altitude above the origin, m.
    Altitude,
    /// Bias of the vehicle model: b + w, %.
    Bias,
    /// Scale error κ, 1.
    Scale,
}

impl Quantity {
    /// Returns h v for the elements of a vector v.
    #[inline(always)]
    pub(crate) fn of<S: Scalar>(self, net_traction: S, v: impl Fn(StateIndex) -> S) -> S {
        match self {
            Self::Slope => {
                v(StateIndex::Slope) - v(StateIndex::Bias) - v(StateIndex::Wind)
                    + net_traction * v(StateIndex::Scale)
            }
            Self::Altitude => v(StateIndex::Altitude),
            Self::Bias => v(StateIndex::Bias) + v(StateIndex::Wind),
            Self::Scale => v(StateIndex::Scale),
        }
    }

    /// Returns P h'.
    #[inline(always)] // With a known quantity it is a handful of elements.
    pub(crate) fn cross<S: Scalar>(self, net_traction: S, p: &Covariance<S>) -> StateVector<S> {
        let mut cross = StateVector::ZERO;
        for (k, element) in cross.0.iter_mut().enumerate() {
            *element = self.of(net_traction, |i| p.element(i as usize, k));
        }
        cross
    }
}

/// The estimate of a quantity h x at one cell. It is enough for a smoother to correct it later.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct QuantityEstimate<S> {
    /// Mean h x.
    pub mean: S,
    /// Variance h P h'.
    pub variance: S,
    /// Covariance with the states, P h'.
    pub cross: StateVector<S>,
}

impl<S: Scalar> QuantityEstimate<S> {
    /// Returns mean and standard deviation.
    #[must_use]
    pub fn uncertain(&self) -> Uncertain {
        Uncertain {
            value: self.mean.to_f32(),
            sigma: self.variance.sqrt().to_f32(),
        }
    }

    /// Returns the grade of a slope, %: 100 tan of the angle from the sine in %.
    #[inline(never)] // Called from several places.
    #[must_use]
    pub fn grade(&self) -> Uncertain {
        let slope = self.uncertain();
        // No road is steeper than 50 %.
        let sine = (slope.value * 0.01).clamp(-0.5, 0.5);
        let cosine = Scalar::sqrt(1.0 - sine * sine);
        Uncertain {
            value: 100.0 * sine / cosine,
            sigma: slope.sigma / (cosine * cosine * cosine),
        }
    }

    /// Returns an altitude that counts from an origin, m; `None` without an origin.
    #[must_use]
    pub fn altitude(&self, origin_m: Option<f32>) -> Option<Uncertain> {
        origin_m.map(|origin_m| {
            let altitude = self.uncertain();
            Uncertain {
                value: origin_m + altitude.value,
                ..altitude
            }
        })
    }
}
