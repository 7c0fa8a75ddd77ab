//! Thins long series for drawing: the extremes of each group of points stay.

use super::plot::{Mark, Series};
use std::ops::Range;

/// Points of a series and, for a band, its lower edge at the same points.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Points {
    /// (x, y); y is not finite where the series has a gap.
    pub points: Vec<(f64, f64)>,
    /// Lower edge; empty if the series is no band.
    pub lower: Vec<f64>,
}

/// Returns the series with at most about `most` points. Of each group of neighbours the least and
/// the greatest stay; of a band, its widest extent. Gaps stay.
pub(super) fn thinned(series: &Points, most: usize) -> Points {
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
pub(super) fn runs(points: &[(f64, f64)]) -> Vec<Range<usize>> {
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
    pub(super) fn of(series: &Series) -> Self {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn extremes_and_gaps_stay() {
        let wave = |i: usize| if i == 500 { 9.0 } else { (i % 7) as f64 };
        let mut points: Vec<(f64, f64)> = (0..1000).map(|i| (i as f64, wave(i))).collect();
        points[300].1 = f64::NAN;
        let lower: Vec<f64> = points.iter().map(|p| p.1 - 1.0).collect();
        let line = thinned(
            &Points {
                points: points.clone(),
                lower: Vec::new(),
            },
            100,
        );
        assert!(line.points.len() <= 110, "{}", line.points.len());
        assert!(line.points.contains(&(500.0, 9.0)));
        assert_eq!(runs(&line.points).len(), 2);
        assert!(line.points.windows(2).all(|pair| pair[0].0 <= pair[1].0));
        let band = thinned(&Points { points, lower }, 100);
        assert_eq!(band.points.len(), band.lower.len());
        assert!(band.lower.contains(&-1.0) && band.points.iter().any(|p| p.1 == 9.0));
    }

    #[test]
    fn short_series_stay_as_they_are() {
        let series = Points {
            points: vec![(0.0, 1.0), (1.0, f64::NAN)],
            lower: Vec::new(),
        };
        let same = thinned(&series, 2);
        assert_eq!(same.points[0], (0.0, 1.0));
        assert!(same.points[1].1.is_nan());
    }
}
