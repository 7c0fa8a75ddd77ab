//! Regression of the difference of two speeds on acceleration and force: the delay and its variance.

use crate::scalar::Scalar;

/// Part of a new difference that counts in the means that are taken off: a memory of a minute. What
/// is slower, as the scale of the wheel speed, shows no delay.
const MEAN_GAIN: f32 = 1.0 / 240.0;
/// Most that a difference counts, m/s: beyond is an outlier.
const LARGEST_MPS: f32 = 1.0;
/// Largest correlation of the errors of two slots in a row.
const MOST_ALIKE: f32 = 0.9;

/// Delay and its variance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Lag {
    /// s
    pub lag_s: f32,
    /// s²
    pub variance_s2: f32,
}

/// What one slot shows.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pair {
    /// Speed over ground less that of the wheels, m/s.
    pub apart_mps: f32,
    /// Acceleration, m/s².
    pub acceleration: f32,
    /// Force, in a unit that makes it about one.
    pub force: f32,
}

/// Means, and sums of squares and products about them, which forget.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sums {
    mean: Pair,
    count: f32,
    aa: f32,
    af: f32,
    ff: f32,
    ad: f32,
    fd: f32,
    dd: f32,
    /// The last difference, and the sum of products of each with the one before.
    before: f32,
    successive: f32,
}

impl Sums {
    pub(super) const NONE: Self = Self {
        mean: Pair {
            apart_mps: 0.0,
            acceleration: 0.0,
            force: 0.0,
        },
        count: 0.0,
        aa: 0.0,
        af: 0.0,
        ff: 0.0,
        ad: 0.0,
        fd: 0.0,
        dd: 0.0,
        before: 0.0,
        successive: 0.0,
    };

    /// Takes a slot. `forget` is the part of what is known that it replaces.
    pub(super) fn add(&mut self, pair: &Pair, forget: f32) {
        if self.count == 0.0 {
            self.mean = *pair;
        }
        let a = pair.acceleration - self.mean.acceleration;
        let f = pair.force - self.mean.force;
        let d = (pair.apart_mps - self.mean.apart_mps).clamp(-LARGEST_MPS, LARGEST_MPS);
        self.mean.acceleration += MEAN_GAIN * a;
        self.mean.force += MEAN_GAIN * f;
        self.mean.apart_mps += MEAN_GAIN * d;
        let keep = 1.0 - forget;
        self.count = keep * self.count + 1.0;
        self.aa = keep * self.aa + a * a;
        self.af = keep * self.af + a * f;
        self.ff = keep * self.ff + f * f;
        self.ad = keep * self.ad + a * d;
        self.fd = keep * self.fd + f * d;
        self.dd = keep * self.dd + d * d;
        self.successive = keep * self.successive + d * self.before;
        self.before = d;
    }

    /// Changes the sums to those of a comparison at a delay that is longer by so much, s.
    pub(super) fn shift(&mut self, longer_s: f32) {
        self.dd += longer_s * (2.0 * self.ad + longer_s * self.aa);
        self.ad += longer_s * self.aa;
        self.fd += longer_s * self.af;
        self.mean.apart_mps += longer_s * self.mean.acceleration;
    }

    /// Returns the delay beyond that of the comparison; `None` if the accelerations show none.
    pub(super) fn lag(&self) -> Option<Lag> {
        // What of the acceleration and of the difference the force does not explain.
        let of_force = |product: f32| {
            if self.ff > 0.0 {
                product / self.ff
            } else {
                0.0
            }
        };
        let aa = self.aa - of_force(self.af * self.af);
        let ad = self.ad - of_force(self.af * self.fd);
        let dd = self.dd - of_force(self.fd * self.fd);
        if aa <= 1e-3 * self.aa || self.count < 10.0 {
            return None;
        }
        let left = Scalar::max(0.0, dd - ad * ad / aa) / self.count;
        // Errors of successive slots that are alike count as fewer.
        let alike = Scalar::min(self.successive / self.dd, MOST_ALIKE);
        let fewer = if alike > 0.0 {
            (1.0 + alike) / (1.0 - alike)
        } else {
            1.0
        };
        let found = Lag {
            lag_s: -ad / aa,
            variance_s2: fewer * left / aa,
        };
        (found.lag_s.is_finite() && found.variance_s2.is_finite()).then_some(found)
    }
}
