//! The ten experiments of the thesis (table 1).

use super::heading::Heading;
use super::thesis;
use crate::simulator::truck::Preset;
use crate::study::distance_drive::Belief;

/// Assumed torque of truck A, as a factor of the truth. Section 7.3 finds errors proportional to
/// the grade.
const TORQUE_A: f64 = 1.05;

/// One experiment, before the fit.
#[derive(Clone, Copy, Debug)]
pub struct Experiment {
    /// Direction of travel.
    pub heading: Heading,
    /// Number of the run in that direction, from 1.
    pub number: usize,
}

impl Experiment {
    /// Returns all ten experiments.
    #[must_use]
    pub fn all() -> Vec<Self> {
        Heading::BOTH
            .into_iter()
            .flat_map(|heading| (1..=5).map(move |number| Self { heading, number }))
            .collect()
    }

    /// Returns the truck (table 1).
    #[must_use]
    pub const fn preset(self) -> Preset {
        if self.number <= 3 {
            Preset::A
        } else {
            Preset::B
        }
    }

    /// Returns the false parameters of its truck.
    #[must_use]
    pub fn belief(self) -> Belief {
        let torque = match self.preset() {
            Preset::A => TORQUE_A,
            Preset::B => 1.0,
        };
        Belief {
            torque,
            ..Belief::TRUTH
        }
    }

    /// Returns µ, σ and RMSE of its pointwise grade in the thesis.
    #[must_use]
    pub const fn pointwise(self) -> [f64; 3] {
        thesis::pointwise(self.heading)[self.number - 1]
    }

    /// Returns whether the truck had stood overnight. The thesis names southbound 4. Southbound 1
    /// has the most positive mean of its truck. The mean then falls run by run, as cold tyres would
    /// explain.
    pub(super) const fn is_morning(self) -> bool {
        matches!(
            self,
            Self {
                heading: Heading::South,
                number: 1 | 4
            }
        )
    }

    /// Returns the large GPS errors: position and size, m. The thesis shows them at about 25 km in
    /// figures 6 (northbound 3) and 13 (southbound 4), and at 42 km in northbound 4, where the RMSE
    /// doubles. The last one is set to the largest error of its chain.
    pub(super) const fn gps_bumps(self) -> &'static [(f64, f64)] {
        match (self.heading, self.number) {
            (Heading::South, 4) | (Heading::North, 3) => &[(25_000.0, 6.0)],
            (Heading::North, 4) => &[(42_000.0, 15.0)],
            _ => &[],
        }
    }

    /// Returns its index in the streams of random numbers.
    pub(super) const fn index(self) -> usize {
        self.number
            + match self.heading {
                Heading::South => 0,
                Heading::North => 5,
            }
    }
}
