//! Counts of repeated work.

/// Number of calls, sum and largest of their counts.
#[derive(Clone, Copy, Debug, Default)]
pub struct CountTally {
    calls: u32,
    sum: u64,
    worst: u32,
}

impl CountTally {
    /// Adds a count.
    pub fn add(&mut self, count: u32) {
        self.calls += 1;
        self.sum += u64::from(count);
        self.worst = self.worst.max(count);
    }

    /// Adds to the sum without another call.
    pub fn add_to_last(&mut self, count: u32) {
        self.sum += u64::from(count);
    }

    /// Returns the number of calls.
    #[must_use]
    pub const fn calls(&self) -> u32 {
        self.calls
    }

    /// Returns the rounded mean; zero without calls.
    #[must_use]
    pub const fn mean(&self) -> u32 {
        let calls = self.calls as u64;
        match (self.sum + calls / 2).checked_div(calls) {
            Some(mean) => mean as u32,
            None => 0,
        }
    }

    /// Returns the largest count.
    #[must_use]
    pub const fn worst(&self) -> u32 {
        self.worst
    }
}
