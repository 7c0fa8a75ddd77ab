//! From what difference on a map does not count.

/// From what difference on a map does not count, and below which it counts again.
#[derive(Clone, Copy, Debug)]
pub(super) struct MapLimits {
    /// The error of grade by a shift along the road that makes a map useless, in standard deviations of
    /// the lagged grade; and the shift itself, in its own.
    pub(super) displaced_harm: f32,
    pub(super) displaced_sigmas: f32,
    /// The error of grade by a shift that does no harm.
    pub(super) aligned_harm: f32,
    /// Mean normalised squared differences from the estimate.
    pub(super) left_out: f32,
    pub(super) counts_again: f32,
}

impl MapLimits {
    /// Those of a map from outside. The differences are 2.4 standard deviations over the whole distance,
    /// and 1.4.
    pub(super) const MAP: Self = Self {
        displaced_harm: 0.7,
        displaced_sigmas: 3.0,
        aligned_harm: 0.4,
        left_out: 6.0,
        counts_again: 2.0,
    };
    /// Those of the vehicle's own memory. The same receiver made it, so it is rarely shifted. It is of
    /// few drives, so that its errors are larger where those of the live grade are. A road that was
    /// rebuilt by 1 % differs by 60.
    pub(super) const MEMORY: Self = Self {
        displaced_harm: 1.2,
        displaced_sigmas: 4.0,
        aligned_harm: 0.6,
        left_out: 10.0,
        counts_again: 3.0,
    };
}
