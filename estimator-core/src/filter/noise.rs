//! The directions in which noise enters, and the variances of a cell.

use super::covariance::{Covariance, StateVector};
use super::state_index::StateIndex::{
    self, Bias, DoubtfulForce, FastGnssError, KineticEnergy, Scale, Slope, SlopeRate,
    SlowGnssError, Wind,
};
use crate::scalar::Scalar;

/// A noise: a scalar of variance q along a direction d, so that P grows by q d d'. An error of the
/// force moves the slope that is read, not the road: bias, wind and doubtful force move with it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Noise {
    /// White noise of the force: e.
    Force,
    /// Change of the slope rate: r.
    Road,
    /// Change of the bias: b + s.
    Bias,
    /// Change of the wind: w + s.
    Wind,
    /// Change of the scale: κ.
    Scale,
    /// Change of the slow GNSS error: g₁.
    SlowGnss,
    /// Change of the fast GNSS error: g₂.
    FastGnss,
    /// Change of the doubtful force: u + s.
    Doubt,
    /// Kink of the road: s.
    Kink,
}

/// Number of noises.
pub const NOISES: usize = 9;

impl Noise {
    /// Every noise.
    pub const ALL: [Self; NOISES] = [
        Self::Force,
        Self::Road,
        Self::Bias,
        Self::Wind,
        Self::Scale,
        Self::SlowGnss,
        Self::FastGnss,
        Self::Doubt,
        Self::Kink,
    ];

    /// Returns the state that moves, and whether the slope moves with it.
    #[inline(always)]
    const fn direction(self) -> (StateIndex, bool) {
        match self {
            Self::Force => (KineticEnergy, false),
            Self::Road => (SlopeRate, false),
            Self::Bias => (Bias, true),
            Self::Wind => (Wind, true),
            Self::Scale => (Scale, false),
            Self::SlowGnss => (SlowGnssError, false),
            Self::FastGnss => (FastGnssError, false),
            Self::Doubt => (DoubtfulForce, true),
            Self::Kink => (Slope, false),
        }
    }

    /// Adds q d d' to a covariance.
    #[inline(always)]
    pub fn add_to<S: Scalar>(self, p: &mut Covariance<S>, q: S) {
        let (i, with_slope) = self.direction();
        p.add(i, i, q);
        if with_slope {
            p.add(i, Slope, q);
            p.add(Slope, Slope, q);
        }
    }

    /// Returns the score of the noise: d'r and d'N d.
    #[inline(always)]
    #[must_use]
    pub fn score<S: Scalar>(self, r: &StateVector<S>, n: &Covariance<S>) -> Score<S> {
        let (i, with_slope) = self.direction();
        let mut score = Score {
            sum: r[i as usize],
            information: n.get(i, i),
        };
        if with_slope {
            let both = n.get(i, Slope);
            score.sum += r[Slope as usize];
            score.information += both + both + n.get(Slope, Slope);
        }
        score
    }
}

/// What the backward pass says of a noise: ρ = d'r and n = d'N d. A noise of variance q had the mean
/// q ρ and the variance q − q² n.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Score<S> {
    /// ρ.
    pub sum: S,
    /// n.
    pub information: S,
}

/// Variances and input of a cell, as one pass uses them.
#[derive(Clone, Copy, Debug)]
pub struct CellNoise<S> {
    /// Of each noise, in the order of [`Noise::ALL`].
    pub of: [S; NOISES],
    /// Of the load at a stop before the cell, along κ − ℓ s with the net traction ℓ of the cell
    /// before.
    pub load: S,
    /// Of the speed reading.
    pub speed: S,
    /// Of the altitude.
    pub altitude: S,
    /// Of a slope that was measured directly.
    pub slope: S,
}
