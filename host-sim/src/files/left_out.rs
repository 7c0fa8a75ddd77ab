//! Objects of a file that are left out, each by itself, while the rest is read.

/// Number of problems that are kept for messages.
const FIRST: usize = 5;

/// What was left out of a file.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct LeftOut {
    count: u64,
    first: Vec<String>,
}

impl LeftOut {
    /// Adds an object, with what is wrong with it.
    pub fn add(&mut self, problem: impl Into<String>) {
        self.count += 1;
        if self.first.len() < FIRST {
            self.first.push(problem.into());
        }
    }

    /// Adds those of another part of the file.
    pub fn extend(&mut self, other: Self) {
        self.count += other.count;
        let room = FIRST - self.first.len();
        self.first.extend(other.first.into_iter().take(room));
    }

    /// Returns how many there are.
    #[must_use]
    pub const fn count(&self) -> u64 {
        self.count
    }

    /// Returns the first problems.
    #[must_use]
    pub fn first(&self) -> &[String] {
        &self.first
    }
}
