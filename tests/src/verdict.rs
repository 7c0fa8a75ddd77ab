//! What becomes of a drive with a fault or a manoeuvre.

use std::fmt::{Display, Formatter, Result};

/// A verdict; the worse it is, the larger.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Verdict {
    /// The cells are the same.
    NoEffect,
    /// The errors are within what the sigmas say.
    Withstood,
    /// Those of unmarked cells are; those of marked cells are not.
    Marked,
    /// Neither.
    NotWithstood,
}

impl Display for Verdict {
    fn fmt(&self, formatter: &mut Formatter<'_>) -> Result {
        formatter.write_str(match self {
            Self::NoEffect => "no effect",
            Self::Withstood => "withstood",
            Self::Marked => "marked",
            Self::NotWithstood => "**not withstood**",
        })
    }
}

/// Returns how many drives have each verdict, in words.
#[must_use]
pub fn counts(verdicts: &[Verdict]) -> String {
    let count = |verdict| verdicts.iter().filter(|other| **other == verdict).count();
    let untouched = match count(Verdict::NoEffect) {
        0 => String::new(),
        count => format!(" ({count} of them without any effect)"),
    };
    format!(
        "{} withstood{untouched}, {} marked, {} not withstood",
        count(Verdict::Withstood) + count(Verdict::NoEffect),
        count(Verdict::Marked),
        count(Verdict::NotWithstood)
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn verdicts_are_counted() {
        let verdicts = [
            Verdict::NoEffect,
            Verdict::Withstood,
            Verdict::Marked,
            Verdict::NotWithstood,
            Verdict::NotWithstood,
        ];
        assert_eq!(
            counts(&verdicts),
            "2 withstood (1 of them without any effect), 1 marked, 2 not withstood"
        );
        assert_eq!(
            counts(&verdicts[1..]),
            "1 withstood, 1 marked, 2 not withstood"
        );
    }
}
