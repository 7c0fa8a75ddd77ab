//! Quantiles of positive numbers of any magnitude, in fixed memory.

/// Bins for a factor of e.
const BINS_PER_E: f64 = 64.0;
/// Natural logarithm of the largest number that has a bin of its own; its negative is the smallest.
const LARGEST_LN: f64 = 16.0;
/// Number of bins.
const BINS: usize = (2.0 * LARGEST_LN * BINS_PER_E) as usize;

/// Counts of positive numbers in bins 1.6 % wide. Smaller and larger numbers go into the first and
/// the last bin.
#[derive(Clone, Debug, Default)]
pub(super) struct Distribution {
    /// Empty before the first number.
    bins: Vec<u32>,
    count: u32,
}

impl Distribution {
    /// Takes a number. One that is not above zero is the smallest.
    pub(super) fn add(&mut self, number: f64) {
        if self.bins.is_empty() {
            self.bins = vec![0; BINS];
        }
        // The cast of a number that is too small, and of NaN, gives 0.
        let bin = ((number.ln() + LARGEST_LN) * BINS_PER_E) as usize;
        let bin = &mut self.bins[bin.min(BINS - 1)];
        *bin = bin.saturating_add(1);
        self.count = self.count.saturating_add(1);
    }

    /// Returns the number that this part of the numbers does not exceed; `None` without numbers.
    pub(super) fn quantile(&self, part: f64) -> Option<f64> {
        let wanted = (part * f64::from(self.count)).ceil().max(1.0) as u64;
        let mut passed = 0_u64;
        for (bin, count) in self.bins.iter().enumerate() {
            passed += u64::from(*count);
            if passed >= wanted {
                return Some((((bin as f64) + 0.5) / BINS_PER_E - LARGEST_LN).exp());
            }
        }
        None
    }

    /// Returns the median if there are at least so many numbers.
    pub(super) fn median_of(&self, least: u32) -> Option<f64> {
        self.quantile(0.5).filter(|_| self.count >= least)
    }

    /// Returns the logarithm of the ratio of the upper to the lower quartile.
    pub(super) fn spread(&self) -> Option<f64> {
        Some((self.quantile(0.75)? / self.quantile(0.25)?).ln())
    }
}
