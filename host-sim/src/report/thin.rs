//! Thins long series for drawing: the extremes of each group of points stay.

use super::plot::{Mark, Series};
use std::ops::Range;

/// Points of a series and, for a band, its lower edge at the same points.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Points {
    /// (x, y); y is not finite where the series has a gap.
    pub points: Vec<(f64, f64)>,
    /// Lower edge; empty if the series is no band.
    pub lower: Vec<f64>,
}

/// Returns the series with at most about `most` points. Of each group of neighbours the least and
/// the greatest stay; of a band, its widest extent. Gaps stay.
pub fn thinned(series: &Points, most: usize) -> Points {
    let all = series.points.len();
    if all <= most.max(2) {
        return series.clone();
    }
    let group = all.div_ceil((most / 2).max(1));
    let mut kept = Points::default();
    for range in runs(&series.points) {
        if !kept.points.is_empty() {
            let x = series.points[range.start].0;
            kept.push((x, f64::NAN), series.lower.first().map(|_| f64::NAN));
        }
        let mut start = range.start;
        while start < range.end {
            let end = (start + group).min(range.end);
            kept.take(series, start, end);
            start = end;
        }
    }
    kept
}

/// Returns the ranges of points between gaps.
pub fn runs(points: &[(f64, f64)]) -> Vec<Range<usize>> {
    let mut found: Vec<Range<usize>> = Vec::new();
    for (i, _) in points.iter().enumerate().filter(|(_, p)| p.1.is_finite()) {
        match found.last_mut() {
            Some(last) if last.end == i => last.end = i + 1,
            _ => found.push(i..i + 1),
        }
    }
    found
}

impl Points {
    /// Returns the points of a series.
    pub fn of(series: &Series) -> Self {
        Self {
            points: series.points.clone(),
            lower: match &series.mark {
                Mark::Band(lower) => lower.clone(),
                _ => Vec::new(),
            },
        }
    }

    fn push(&mut self, point: (f64, f64), lower: Option<f64>) {
        self.points.push(point);
        self.lower.extend(lower);
    }

    /// Adds the extremes of a group.
    fn take(&mut self, from: &Self, start: usize, end: usize) {
        let group = &from.points[start..end];
        let least = |a: &usize, b: &usize| group[*a].1.total_cmp(&group[*b].1);
        let (Some(low), Some(high)) = (
            (0..group.len()).min_by(least),
            (0..group.len()).max_by(least),
        ) else {
            return;
        };
        if from.lower.is_empty() {
            self.push(group[low.min(high)], None);
            if low != high {
                self.push(group[low.max(high)], None);
            }
            return;
        }
        let bottom = from.lower[start..end].iter().copied();
        let bottom = bottom.fold(f64::INFINITY, f64::min);
        self.push((group[0].0, group[high].1), Some(bottom));
        if group.len() > 1 {
            self.push((group[group.len() - 1].0, group[high].1), Some(bottom));
        }
    }
}
