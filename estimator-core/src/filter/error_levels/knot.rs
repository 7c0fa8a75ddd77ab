//! Knots: some eighty metres of cells and their fixes as one step of the hypotheses.

/// What a cell adds to a knot.
#[derive(Clone, Copy, Debug)]
pub(in crate::filter) struct LevelCell {
    /// Length, m.
    pub length_m: f32,
    /// Duration, s.
    pub duration_s: f32,
    /// Climb by the forces, with the scale known so far, m.
    pub climb_m: f32,
}

/// Variances of the slow errors where a knot ends.
#[derive(Clone, Copy, Debug)]
pub(in crate::filter) struct SlowVariances {
    /// Variances of bias and wind as they are assumed, %².
    pub bias_variance: f32,
    pub wind_variance: f32,
    /// Variance of the bias as it is known, %².
    pub known_bias_variance: f32,
}

/// A knot that is being filled.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct OpenKnot {
    length_m: f32,
    duration_s: f32,
    climb_m: f32,
    /// Sums over fixes: altitude less the climb since the knot began, and variance.
    altitude_sum_m: f32,
    variance_sum: f32,
    fixes: f32,
}

/// A knot: the mean of its fixes, brought to its end by the climb of the forces.
#[derive(Clone, Copy, Debug)]
pub(super) struct Knot {
    pub length_m: f32,
    pub duration_s: f32,
    pub climb_m: f32,
    pub altitude_m: f32,
    pub variance: f32,
    pub bias_variance: f32,
    pub wind_variance: f32,
    pub known_bias_variance: f32,
}

impl OpenKnot {
    /// Takes a fix at the end of the newest cell.
    pub(super) fn fix(&mut self, altitude_m: f32, variance: f32) {
        self.altitude_sum_m += altitude_m - self.climb_m;
        self.variance_sum += variance;
        self.fixes += 1.0;
    }

    /// Adds a cell.
    pub(super) fn advance(&mut self, cell: &LevelCell) {
        self.length_m += cell.length_m;
        self.duration_s += cell.duration_s;
        self.climb_m += cell.climb_m;
    }

    /// Returns whether the knot is long enough and has a fix.
    pub(super) fn is_full(&self, least_m: f32) -> bool {
        !(self.length_m < least_m || self.fixes == 0.0)
    }

    /// Returns the knot, and begins a new one. The variances are those of the next cell.
    pub(super) fn close(&mut self, variances: &SlowVariances) -> Knot {
        let Self {
            length_m,
            duration_s,
            climb_m,
            altitude_sum_m,
            variance_sum,
            fixes,
        } = core::mem::take(self);
        Knot {
            length_m,
            duration_s,
            climb_m,
            altitude_m: altitude_sum_m / fixes + climb_m,
            variance: variance_sum / (fixes * fixes),
            bias_variance: variances.bias_variance,
            wind_variance: variances.wind_variance,
            known_bias_variance: variances.known_bias_variance,
        }
    }
}
