//! A traction force that is late beside the motion.
//!
//! A force that is late or low-passed by τ lacks about τ times its rate of change. The difference
//! from its own low-pass of that time constant is as much; most of it is added. What is wrong with
//! that lasts as long as τ.

use super::climb_lag::{ClimbCell, ClimbLag};
use super::low_pass_bank::low_pass_gain;
use super::net_traction::{gained_mps2, net_traction_percent};
use super::state::State;
use super::state_index::StateIndex;
use crate::context::Context;
use crate::sample::Sample;
use crate::scalar::Scalar;
use crate::vehicle::GRAVITY;

/// Part of the difference that is added, and part of it by which that may be wrong, 1 sigma: a pure
/// delay and a low-pass of the same length differ by so much.
const ADDED: f32 = 0.8;
const WRONG: f32 = 0.7;

/// What the net traction lacks because it is late.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct LateTraction {
    /// To add, %.
    pub percent: f32,
    /// Sigma of white noise of a cell, %.
    pub noise_percent: f32,
}

impl LateTraction {
    /// Nothing.
    pub(super) const NONE: Self = Self {
        percent: 0.0,
        noise_percent: 0.0,
    };
}

/// How late the traction is, and its low-pass.
#[derive(Clone, Debug, Default)]
pub(super) struct TractionTiming {
    /// By how much the force is late beside the acceleration, s: as the last pass over the drive found,
    /// and the last cell.
    found_s: f32,
    late_s: f32,
    low_pass_percent: Option<f32>,
    climbs: ClimbLag,
}

impl TractionTiming {
    /// Returns the timing for a second pass over the same drive.
    pub(super) fn second_pass(&self) -> Self {
        Self {
            found_s: self.late_s,
            climbs: self.climbs.restarted(),
            ..Self::default()
        }
    }

    /// Advances over the cell of a sample.
    #[inline]
    pub(super) fn advance<S: Scalar>(
        &mut self,
        context: &Context,
        sample: &Sample,
        from: Option<&State<S>>,
    ) -> LateTraction {
        let or = |first_s: f32, other_s: f32| if first_s == 0.0 { other_s } else { first_s };
        self.late_s = or(sample.traction_late_s, self.found_s);
        let late_s = or(self.late_s, self.climbs.late_s());
        if late_s == 0.0 {
            return LateTraction::NONE;
        }
        self.lack(context, sample, from, late_s)
    }

    /// Notes that altitudes after here do not follow from those before.
    pub(super) fn interrupt(&mut self) {
        self.climbs.interrupt();
    }

    /// Compares climbs by the force and by altitudes over the cell of a sample, and up to an altitude
    /// at its end, m, if there is one.
    #[inline]
    pub(super) fn compare_climbs<S: Scalar>(
        &mut self,
        sample: &Sample,
        state: &State<S>,
        altitude_m: Option<f32>,
        memory: u16,
    ) {
        // Changes of the acceleration show a lag more sharply. Where they do, it is known.
        if sample.traction_late_s != 0.0 || !sample.end.condition.is_valid() {
            self.climbs.interrupt();
            return;
        }
        let traction = state.net_traction * (S::ONE + state.mean[StateIndex::Scale]);
        let speed = sample.end.speed_mps;
        self.climbs.advance(&ClimbCell {
            traction_climb_m: 0.01 * sample.length_m * traction.to_f32(),
            duration_s: sample.duration_s,
            speed_height_m: 0.5 * speed * speed / GRAVITY,
        });
        if let Some(altitude_m) = altitude_m {
            self.climbs.fix(altitude_m, memory);
        }
    }

    #[inline(never)] // Rare.
    fn lack<S: Scalar>(
        &mut self,
        context: &Context,
        sample: &Sample,
        from: Option<&State<S>>,
        late_s: f32,
    ) -> LateTraction {
        if !sample.end.condition.is_valid() {
            return LateTraction::NONE;
        }
        let percent = net_traction_percent(context, sample, gained_mps2(sample, from));
        let before = self.low_pass_percent.unwrap_or(percent);
        let gain = low_pass_gain(late_s, sample.duration_s);
        let low_pass = before + gain * (percent - before);
        self.low_pass_percent = Some(low_pass);
        let behind = percent - low_pass;
        let cells = 1.0 + late_s / Scalar::max(sample.duration_s, 1e-3);
        LateTraction {
            percent: ADDED * behind,
            noise_percent: WRONG * behind.abs() * Scalar::sqrt(cells),
        }
    }
}
