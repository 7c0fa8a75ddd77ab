//! What may change of the errors.
//!
//! An error may grow by 3 %. A NEES must lie within 0.3 to 2.5. Where the committed one lies
//! outside, the range ends there: it may come nearer, and must not go farther out.

use super::estimate::Estimate;
use super::table::AccuracyRow;
use std::ops::RangeInclusive;

/// Command that commits the errors.
pub const WRITE: &str = "cargo run -p cross-tests --example accuracy -- --write";

/// Largest accepted change of an error, %.
const SLACK_PERCENT: f64 = 3.0;
/// Range of an honest NEES.
const NEES: RangeInclusive<f64> = 0.3..=2.5;

/// What changed, one line each.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Comparison {
    /// What is worse than allowed.
    pub worse: Vec<String>,
    /// Errors that are smaller by more than the slack.
    pub better: Vec<String>,
}

/// Compares rows with the committed ones of the same names.
#[must_use]
pub fn compare(rows: &[AccuracyRow], committed: &[AccuracyRow]) -> Comparison {
    let mut found = Comparison::default();
    for row in rows {
        match committed.iter().find(|before| before.is_of_same(row)) {
            Some(before) => found.add(row, before),
            None => found.worse.push(format!("{}: not committed", row.drive)),
        }
    }
    found
}

impl Comparison {
    fn add(&mut self, row: &AccuracyRow, before: &AccuracyRow) {
        for estimate in Estimate::ALL {
            self.add_error(row, before, estimate);
            self.add_nees(row, before, estimate);
        }
    }

    fn add_error(&mut self, row: &AccuracyRow, before: &AccuracyRow, estimate: Estimate) {
        let (now, committed) = (row.error_percent(estimate), before.error_percent(estimate));
        let most = committed * (1.0 + SLACK_PERCENT / 100.0);
        let line = format!(
            "{}, {}: error {now:.4} %, committed {committed:.4} %",
            row.drive,
            estimate.word()
        );
        if now.is_nan() || now > most {
            self.worse
                .push(format!("{line}, at most {most:.4} % allowed"));
        } else if now < committed * (1.0 - SLACK_PERCENT / 100.0) {
            self.better.push(format!("{line}: better"));
        }
    }

    fn add_nees(&mut self, row: &AccuracyRow, before: &AccuracyRow, estimate: Estimate) {
        let (now, committed) = (row.nees(estimate), before.nees(estimate));
        let (least, most) = (NEES.start().min(committed), NEES.end().max(committed));
        if !(least..=most).contains(&now) {
            self.worse.push(format!(
                "{}, {}: NEES {now:.2}, committed {committed:.2}, {least:.2} to {most:.2} allowed",
                row.drive,
                estimate.word()
            ));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::errors::Errors;
    use super::*;

    fn row(smoothed_percent: f64, smoothed_nees: f64) -> AccuracyRow {
        let errors = Errors {
            rmse_percent: [smoothed_percent, 0.2, 0.3],
            nees: [smoothed_nees, 1.0, 1.0],
        };
        AccuracyRow::new("hills", &errors)
    }

    /// Compares a smoothed error and NEES with committed ones.
    fn compared(now: (f64, f64), committed: (f64, f64)) -> Comparison {
        let [now, committed] = [now, committed].map(|(e, nees)| row(e, nees));
        compare(&[now], &[committed])
    }

    #[test]
    fn an_error_may_grow_by_the_slack_and_no_more() {
        let same = Comparison::default();
        assert_eq!(compared((0.1, 1.0), (0.1, 1.0)), same);
        assert_eq!(compared((0.1029, 1.0), (0.1, 1.0)), same);
        assert_eq!(compared((0.0971, 1.0), (0.1, 1.0)), same);
        let expected =
            "hills, smoothed: error 0.1031 %, committed 0.1000 %, at most 0.1030 % allowed";
        assert_eq!(compared((0.1031, 1.0), (0.1, 1.0)).worse, [expected]);
        assert_eq!(compared((f64::NAN, 1.0), (0.1, 1.0)).worse.len(), 1);
        let expected = "hills, smoothed: error 0.0969 %, committed 0.1000 %: better";
        assert_eq!(compared((0.0969, 1.0), (0.1, 1.0)).better, [expected]);
    }

    #[test]
    fn a_nees_stays_in_its_range_or_gets_no_farther_out() {
        let worse = |now, committed| compared((0.1, now), (0.1, committed)).worse;
        for (now, committed) in [
            (0.3, 1.0),
            (2.5, 1.0),
            (0.15, 0.15),
            (0.2, 0.15),
            (4.0, 4.1),
        ] {
            assert!(worse(now, committed).is_empty(), "{now} of {committed}");
        }
        for (now, committed) in [
            (0.29, 1.0),
            (2.51, 1.0),
            (0.14, 0.15),
            (4.2, 4.1),
            (2.6, 0.15),
        ] {
            assert_eq!(worse(now, committed).len(), 1, "{now} of {committed}");
        }
        let expected = "hills, smoothed: NEES 0.14, committed 0.15, 0.15 to 2.50 allowed";
        assert_eq!(worse(0.14, 0.15), [expected]);
        assert_eq!(worse(f64::NAN, 1.0).len(), 1);
    }

    #[test]
    fn what_is_not_committed_is_reported() {
        let found = compare(&[row(0.1, 1.0)], &[]);
        assert_eq!(found.worse, ["hills: not committed"]);
    }
}
