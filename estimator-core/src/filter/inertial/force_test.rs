//! Whether force and accelerometer agree.
//!
//! A torque that sticks, or belongs to another gear, moves the model away from the accelerometer for
//! as long as it lasts. The test sums innovations over blocks of cells, and these over a cumulative
//! sum of either sign (E. S. Page, "Continuous inspection schemes", Biometrika 41:100, 1954).

use super::slow_errors::SlowErrors;
use super::unchanged_traction::UnchangedTraction;
use crate::sample::Sample;
use crate::scalar::Scalar;
use crate::tuning::Inertial;
use crate::vehicle::VehicleParameters;

/// Largest normalised square of a block that counts for its usual size.
const LARGEST_USUAL: f32 = 4.0;
/// Part of it by which that size follows: a memory of fifty blocks.
const USUAL_GAIN: f32 = 0.02;

/// An innovation of the accelerometer, m/s², with the variances of its white noise and of what is
/// expected.
#[derive(Clone, Copy, Debug)]
pub(super) struct Innovation {
    pub mps2: f32,
    pub white_variance: f32,
    pub expected_variance: f32,
}

/// What a cell shows.
#[derive(Clone, Copy, Debug)]
pub(super) enum Finding {
    /// Nothing new.
    Nothing,
    /// The force is wrong for some cells, by the last block's mean, m/s².
    Disagrees { cells: u32, error_mps2: f32 },
    /// The force is right again.
    AgreesAgain,
}

/// The test.
#[derive(Clone, Copy, Debug)]
pub(super) struct ForceTest {
    block: Block,
    /// Cumulative sums that look for a large and for a small error, and cells since both are zero.
    large: TwoSidedSum,
    small: TwoSidedSum,
    cells: u32,
    /// Sum of the innovations since then, m/s².
    innovations_mps2: f32,
    /// Sigma of the error of the force that the sums suggest, m/s².
    suspected_mps2: f32,
    /// Usual square of a block over its variance, at least one: the noise may have any colour.
    usual: f32,
    /// Errors when the sums were last zero.
    before: Option<SlowErrors>,
    traction: UnchangedTraction,
    disagrees: bool,
    /// Blocks in a row that agree, and their sum.
    agreed_blocks: u16,
    agreed_sum: f32,
}

/// Sums over the cells of a block.
#[derive(Clone, Copy, Debug, Default)]
struct Block {
    cells: u8,
    innovation_mps2: f32,
    white_variance: f32,
    expected_variance: f32,
}

impl Block {
    fn add(&mut self, innovation: Innovation) {
        self.cells = self.cells.saturating_add(1);
        self.innovation_mps2 += innovation.mps2;
        self.white_variance += innovation.white_variance;
        self.expected_variance += innovation.expected_variance;
    }

    /// Returns the sum over its standard deviation: white noise adds up by squares, the error of
    /// what is expected by itself.
    fn normalised(&self) -> f32 {
        let cells = f32::from(self.cells);
        let variance = self.white_variance + cells * self.expected_variance;
        self.innovation_mps2 / Scalar::sqrt(variance)
    }
}

/// A cumulative sum of either sign.
#[derive(Clone, Copy, Debug)]
struct TwoSidedSum {
    above: f32,
    below: f32,
}

impl TwoSidedSum {
    const ZERO: Self = Self {
        above: 0.0,
        below: 0.0,
    };

    /// Adds a block and returns the larger sum. `slack` is the part of each that is usual.
    fn add(&mut self, sigmas: f32, slack: f32) -> f32 {
        self.above = Scalar::max(0.0, self.above + sigmas - slack);
        self.below = Scalar::max(0.0, self.below - sigmas - slack);
        Scalar::max(self.above, self.below)
    }
}

impl ForceTest {
    pub(super) const fn new() -> Self {
        Self {
            block: Block {
                cells: 0,
                innovation_mps2: 0.0,
                white_variance: 0.0,
                expected_variance: 0.0,
            },
            large: TwoSidedSum::ZERO,
            small: TwoSidedSum::ZERO,
            cells: 0,
            innovations_mps2: 0.0,
            suspected_mps2: 0.0,
            usual: 1.0,
            before: None,
            traction: UnchangedTraction::new(),
            disagrees: false,
            agreed_blocks: 0,
            agreed_sum: 0.0,
        }
    }

    /// Returns whether the force is not believed.
    pub(super) const fn disagrees(&self) -> bool {
        self.disagrees
    }

    /// Returns the usual square of a block over its variance.
    pub(super) const fn usual(&self) -> f32 {
        self.usual
    }

    /// Returns the time for which the traction has been the same to the last digit, beyond what is
    /// usual, s.
    pub(super) fn unusual_s(&self) -> f32 {
        self.traction.unusual_s()
    }

    /// Returns the sigma of the error of the force that is suspected, m/s².
    pub(super) const fn suspected_mps2(&self) -> f32 {
        self.suspected_mps2
    }

    /// Drops the sums: what comes does not follow what was.
    pub(super) fn restart(&mut self) {
        *self = Self {
            usual: self.usual,
            traction: self.traction,
            ..Self::new()
        };
    }

    /// Notes the traction of a cell.
    pub(super) fn note_traction(&mut self, sample: &Sample, vehicle: &VehicleParameters) {
        self.traction
            .note(&sample.forces, vehicle, sample.duration_s, !self.disagrees);
    }

    /// Takes the innovation of a cell in which the model holds, and the errors before it. If the
    /// force is found to disagree, `errors` are those from before it did.
    pub(super) fn add(
        &mut self,
        innovation: Innovation,
        errors: &mut SlowErrors,
        tuning: &Inertial,
    ) -> Finding {
        self.block.add(innovation);
        if self.block.cells < tuning.block_cells {
            return Finding::Nothing;
        }
        let block = core::mem::take(&mut self.block);
        let sigmas = block.normalised() / Scalar::sqrt(self.usual);
        if self.disagrees {
            return self.wait_for_agreement(sigmas, tuning);
        }
        let followed = Scalar::min(sigmas * sigmas, LARGEST_USUAL) - 1.0;
        self.usual = Scalar::max(1.0, self.usual * (1.0 + USUAL_GAIN * followed));
        let large = self.large.add(sigmas, tuning.slack);
        let small = self.small.add(sigmas, tuning.small_slack);
        if large + small <= 0.0 {
            self.cells = 0;
            self.innovations_mps2 = 0.0;
            self.suspected_mps2 = 0.0;
            self.before = Some(*errors);
            return Finding::Nothing;
        }
        self.cells = self.cells.saturating_add(u32::from(block.cells));
        let part = self.limit_part(tuning);
        self.innovations_mps2 += block.innovation_mps2;
        let evidence = Scalar::max(large / tuning.sum, small / tuning.small_sum) / part;
        let mean_mps2 = self.innovations_mps2 / self.cells as f32;
        self.suspected_mps2 = tuning.suspicion * evidence * evidence * mean_mps2.abs();
        if large <= part * tuning.sum && small <= part * tuning.small_sum {
            return Finding::Nothing;
        }
        let cells = self.cells;
        if let Some(before) = self.before {
            *errors = before;
        }
        *self = Self {
            disagrees: true,
            traction: self.traction,
            usual: self.usual,
            ..Self::new()
        };
        Finding::Disagrees {
            cells,
            error_mps2: block.innovation_mps2 / f32::from(block.cells),
        }
    }

    /// Returns the part of the limits that counts: less while the traction is unchanged for longer
    /// than is usual.
    fn limit_part(&self, tuning: &Inertial) -> f32 {
        let left = 1.0 - self.traction.unusual_s() / tuning.unchanged_s;
        Scalar::max(tuning.unchanged_part, Scalar::min(1.0, left))
    }

    fn wait_for_agreement(&mut self, sigmas: f32, tuning: &Inertial) -> Finding {
        if sigmas.abs() > tuning.agreed_sigmas {
            self.agreed_blocks = 0;
            self.agreed_sum = 0.0;
            return Finding::Nothing;
        }
        self.agreed_blocks += 1;
        self.agreed_sum += sigmas;
        // A stuck torque may agree for a while.
        let is_unusual = self.traction.unusual_s() > 0.0;
        let enough = tuning.agreed_blocks * if is_unusual { 3 } else { 1 };
        if self.agreed_blocks < enough {
            return Finding::Nothing;
        }
        let mean = self.agreed_sum / Scalar::sqrt(f32::from(self.agreed_blocks));
        self.agreed_blocks = 0;
        self.agreed_sum = 0.0;
        if mean.abs() > tuning.agreed_sigmas {
            return Finding::Nothing;
        }
        self.disagrees = false;
        self.traction.take_for_usual();
        Finding::AgreesAgain
    }
}
