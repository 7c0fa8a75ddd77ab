//! The error along the way: that of the place, and that of the odometer's scale.

/// Standard deviation of a position along the way, m. Its errors last for hundreds of metres, so a
/// position every ten metres counts a tenth.
const POSITION_SIGMA_M: f32 = 3.0;
/// Positions that count as one.
const CORRELATED: f32 = 20.0;
/// Part of a position's error that lasts: the delay of the receiver, and the map's own. It is in
/// each position alike, m.
const COMMON_SIGMA_M: f32 = 1.5;
/// Standard deviation of the odometer's scale at the start, 1.
const SCALE_SIGMA: f32 = 0.015;
/// Its change over a kilometre, 1.
const SCALE_CHANGE: f32 = 0.0005;
/// Standard deviation of the way over a metre of road: lanes, bends, slip, m.
const WANDER_SIGMA_M: f32 = 0.05;

/// Covariance of place and scale, and the scale. All hypotheses share them: they get the same
/// positions.
#[derive(Clone, Copy, Debug)]
pub(super) struct Along {
    /// True distance over driven distance, less one.
    pub(super) scale: f32,
    place_m2: f32,
    place_scale_m: f32,
    scale_1: f32,
}

/// The part of a deviation that goes to the place, and that to the scale, 1/m.
#[derive(Clone, Copy, Debug)]
pub(super) struct Gain {
    pub(super) place: f32,
    scale: f32,
}

impl Along {
    pub(super) fn new() -> Self {
        Self {
            scale: 0.0,
            place_m2: POSITION_SIGMA_M * POSITION_SIGMA_M,
            place_scale_m: 0.0,
            scale_1: SCALE_SIGMA * SCALE_SIGMA,
        }
    }

    /// Begins at a new place. The scale stays known.
    pub(super) fn restart(&mut self) {
        self.place_m2 = POSITION_SIGMA_M * POSITION_SIGMA_M;
        self.place_scale_m = 0.0;
    }

    /// Moves on by a distance.
    pub(super) fn advance(&mut self, metres: f32) {
        self.place_m2 += metres * (2.0 * self.place_scale_m + metres * self.scale_1)
            + metres * WANDER_SIGMA_M * WANDER_SIGMA_M;
        self.place_scale_m += metres * self.scale_1;
        self.scale_1 += metres * 1e-3 * SCALE_CHANGE * SCALE_CHANGE;
    }

    /// Takes a position.
    pub(super) fn update(&mut self) -> Gain {
        let noise = CORRELATED * POSITION_SIGMA_M * POSITION_SIGMA_M;
        let per_variance = 1.0 / (self.place_m2 + noise);
        let gain = Gain {
            place: self.place_m2 * per_variance,
            scale: self.place_scale_m * per_variance,
        };
        self.scale_1 -= gain.scale * self.place_scale_m;
        self.place_scale_m *= 1.0 - gain.place;
        self.place_m2 *= 1.0 - gain.place;
        gain
    }

    /// Learns the scale from how far the position of the best hypothesis is ahead, m.
    pub(super) fn learn(&mut self, gain: Gain, ahead_m: f32) {
        self.scale = (self.scale + gain.scale * ahead_m).clamp(-0.1, 0.1);
    }

    /// Returns the standard deviation of the place along the way, m.
    pub(super) fn sigma_m(&self) -> f32 {
        libm::sqrtf(self.place_m2 + COMMON_SIGMA_M * COMMON_SIGMA_M)
    }
}
