//! A filter of first order for readings at irregular times.

/// A filter of first order.
#[derive(Clone, Copy, Debug)]
pub struct LowPass {
    time_s: f64,
    last: Option<(f64, f64)>,
}

impl LowPass {
    /// Creates a filter with a time constant, s.
    #[must_use]
    pub const fn new(time_s: f64) -> Self {
        Self { time_s, last: None }
    }

    /// Returns the filtered value at a time, s.
    pub fn next(&mut self, at_s: f64, value: f64) -> f64 {
        let filtered = self.last.map_or(value, |(last_s, last)| {
            let part = 1.0 - (-(at_s - last_s).max(0.0) / self.time_s).exp();
            last + part * (value - last)
        });
        self.last = Some((at_s, filtered));
        filtered
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_low_pass_reaches_63_percent_after_its_time_constant() {
        let mut filter = LowPass::new(2.0);
        assert_eq!(filter.next(0.0, 0.0), 0.0);
        let after: f64 = (1..=20)
            .map(|n| filter.next(0.1 * f64::from(n), 1.0))
            .last()
            .unwrap();
        assert!((after - 0.632).abs() < 1e-3, "{after}");
    }
}
