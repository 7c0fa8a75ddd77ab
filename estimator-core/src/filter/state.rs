//! Mean and covariance of the states, and the estimate that follows from them.

use super::covariance::Covariance;
use super::gross_mass::ModelMass;
use super::quantity::{Quantity, QuantityEstimate};
use super::state_index::{StateIndex, StateVector};
use crate::cell::Estimate;
use crate::scalar::Scalar;

/// Mean and covariance of the states.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct State<S> {
    /// Mean, in the units of [`StateIndex`].
    pub mean: StateVector<S>,
    /// Covariance.
    pub covariance: Covariance<S>,
    /// Net traction: traction less air resistance, over weight, %. It is the slope that an error of
    /// the scale amounts to.
    pub net_traction: S,
    /// Altitude from which the altitude state counts, m. It keeps that state small in single
    /// precision. `None` before the first fix.
    pub origin_m: Option<f32>,
    /// Variance of the grade beyond what the covariance says, %²: forces and altitudes climb unlike
    /// each other, and nothing is certain yet.
    pub doubt_variance: f32,
}

impl<S: Scalar> State<S> {
    /// Returns the standard deviation of a state.
    #[must_use]
    pub fn sigma(&self, state: StateIndex) -> S {
        self.covariance.variance(state).sqrt()
    }

    /// Returns the estimate at the cell's end. `mass` is that of the model there.
    #[must_use]
    pub fn estimate(&self, mass: &ModelMass) -> Estimate {
        let energy = self.mean[StateIndex::KineticEnergy];
        let [bias, scale] =
            [Quantity::Bias, Quantity::Scale].map(|quantity| self.quantity(quantity).uncertain());
        let scale = scale.plus(1.0);
        Estimate {
            grade_percent: self
                .quantity(Quantity::Slope)
                .grade()
                .widened(self.doubt_variance),
            altitude_m: self.quantity(Quantity::Altitude).altitude(self.origin_m),
            speed_mps: (energy + energy).sqrt().to_f32(),
            bias_percent: bias,
            scale,
            mass_kg: mass.gross_kg(scale),
        }
    }

    /// Returns the estimate of a quantity, with its covariance with the states.
    #[inline(never)] // Long, and called from several places.
    #[must_use]
    pub fn quantity(&self, quantity: Quantity) -> QuantityEstimate<S> {
        let cross = quantity.cross(self.net_traction, &self.covariance);
        QuantityEstimate {
            mean: quantity.of(self.net_traction, |state| self.mean[state]),
            variance: quantity.of(self.net_traction, |state| cross[state]),
            cross,
        }
    }

    /// Returns the slope of the road by the forces, with the slow error of the model in it, %.
    #[inline]
    pub(super) fn slope_by_forces(&self) -> S {
        self.mean[StateIndex::Slope] + self.net_traction * self.mean[StateIndex::Scale]
    }

    /// Sets the net traction to zero, as at a standstill. The slope of the road stays as it is, also if
    /// the scale becomes another one there. Returns the net traction until then, %.
    pub(super) fn release_traction(&mut self) -> S {
        let net_traction = core::mem::replace(&mut self.net_traction, S::ZERO);
        let scale = self.mean[StateIndex::Scale];
        self.mean[StateIndex::Slope].add_product(net_traction, &scale);
        let covariance = &mut self.covariance;
        covariance.shear(StateIndex::Slope, StateIndex::Scale, net_traction);
        net_traction
    }

    /// Returns the slow error of the model, bias and wind, %, and its variance, %².
    pub(super) fn model_error(&self) -> (f32, f32) {
        let [bias, wind] = [StateIndex::Bias, StateIndex::Wind];
        let of = |i, j| self.covariance.get(i, j);
        let both = of(bias, wind);
        let variance = of(bias, bias) + both + both + of(wind, wind);
        let mean = self.mean[bias] + self.mean[wind];
        (mean.to_f32(), variance.to_f32())
    }

    /// Returns whether every number is finite and every variance not negative.
    #[must_use]
    pub fn is_sound(&self) -> bool {
        S::are_finite(&self.mean.0) && self.net_traction.is_finite() && self.covariance.is_sound()
    }

    /// Returns the state in another number type.
    #[must_use]
    pub fn cast<T: Scalar>(&self) -> State<T> {
        State {
            mean: StateVector(self.mean.0.map(|x| T::from_f64(x.to_f64()))),
            covariance: self.covariance.cast(),
            net_traction: T::from_f64(self.net_traction.to_f64()),
            origin_m: self.origin_m,
            doubt_variance: self.doubt_variance,
        }
    }
}
