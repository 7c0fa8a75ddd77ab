//! A weighted histogram of ratios on a logarithmic scale, and its peaks.

use std::collections::BTreeMap;

/// Width of a bin in the logarithm: 0.2 %.
const BIN: f64 = 0.002;
/// Half width of a peak in the logarithm: noise of speeds, and of the wheels' slip.
const PEAK: f64 = 0.012;
/// Gears are at least this far apart in the logarithm.
const APART: f64 = 0.04;

/// A weighted histogram of positive ratios.
#[derive(Clone, Debug, Default)]
pub struct RatioHistogram {
    bins: BTreeMap<i32, Bin>,
    weight: f64,
}

#[derive(Clone, Copy, Debug, Default)]
struct Bin {
    weight: f64,
    sum: f64,
}

/// A peak of a histogram.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Peak {
    /// Its ratio.
    pub ratio: f64,
    /// Scatter of the ratios within it, relative.
    pub scatter: f64,
    /// Sum of the weights within it.
    pub weight: f64,
}

impl Peak {
    /// Returns whether both may be the same gear.
    #[must_use]
    pub fn is_near(&self, other: &Self) -> bool {
        (other.ratio / self.ratio).ln().abs() < APART
    }
}

impl RatioHistogram {
    /// Adds a ratio. Others than positive ones are left out.
    pub fn add(&mut self, ratio: f64, weight: f64) {
        let log = ratio.ln();
        if !log.is_finite() || !weight.is_finite() || weight <= 0.0 {
            return;
        }
        let bin = self.bins.entry((log / BIN).floor() as i32).or_default();
        bin.weight += weight;
        bin.sum += weight * log;
        self.weight += weight;
    }

    /// Adds all ratios of another histogram.
    pub fn merge(&mut self, other: &Self) {
        for (&at, bin) in &other.bins {
            let own = self.bins.entry(at).or_default();
            own.weight += bin.weight;
            own.sum += bin.sum;
        }
        self.weight += other.weight;
    }

    /// Returns the sum of all weights.
    #[must_use]
    pub const fn weight(&self) -> f64 {
        self.weight
    }

    /// Returns the highest peak; `None` for an empty histogram.
    #[must_use]
    pub fn highest(&self) -> Option<Peak> {
        let width = (PEAK / BIN) as i32;
        let (_, center) = self
            .bins
            .keys()
            .map(|&at| (self.within(at - width, at + width).0, at))
            .max_by(|a, b| a.0.total_cmp(&b.0))?;
        let (weight, sum) = self.within(center - width, center + width);
        let mean = sum / weight;
        let square: f64 = self
            .bins
            .range(center - width..=center + width)
            .map(|(_, bin)| bin.weight * (bin.sum / bin.weight - mean).powi(2))
            .sum();
        Some(Peak {
            ratio: mean.exp(),
            scatter: (square / weight).sqrt().max(BIN / 12f64.sqrt()),
            weight,
        })
    }

    /// Returns the peaks that have at least this weight, largest ratio first.
    #[must_use]
    pub fn peaks(&self, least_weight: f64) -> Vec<Peak> {
        let mut rest = self.clone();
        let mut found: Vec<Peak> = Vec::new();
        while let Some(peak) = rest.highest() {
            if peak.weight < least_weight {
                break;
            }
            // The flank of a peak is no peak of its own.
            if !found.iter().any(|other| other.is_near(&peak)) {
                found.push(peak);
            }
            let (center, width) = ((peak.ratio.ln() / BIN).floor() as i32, (PEAK / BIN) as i32);
            rest.bins.retain(|&at, _| (at - center).abs() > width + 1);
        }
        found.sort_by(|a, b| b.ratio.total_cmp(&a.ratio));
        found
    }

    fn within(&self, from: i32, to: i32) -> (f64, f64) {
        self.bins
            .range(from..=to)
            .fold((0.0, 0.0), |(weight, sum), (_, bin)| {
                (weight + bin.weight, sum + bin.sum)
            })
    }
}
