//! Figures of the maps of a campaign by the number of runs in them.

use super::drives::{RUNS, Shared, Without, is_of_first_days, order, session};
use crate::error::Result;
use crate::numeric::statistics::mean;
use crate::study::alignment::campaign::{Campaign, CampaignRun};

/// Numbers of runs in a map.
pub(super) const SIZES: [usize; 6] = [1, 2, 4, 8, 16, RUNS];

/// Figures of the drives of a campaign in one condition.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Curve {
    /// Maps of [`SIZES`] runs.
    pub(super) maps: [MapFigures; SIZES.len()],
    /// Mean product of the errors of two maps, of either half of the days, %². Errors that a day has
    /// for itself do not count in the mean.
    pub(super) common_square: f64,
}

/// Figures of one map.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct MapFigures {
    pub(super) rmse_percent: f64,
    pub(super) nees: f64,
}

/// Curves of one campaign.
#[derive(Clone, Copy, Debug)]
pub(super) struct CampaignFigures {
    pub(super) shared: [Curve; Shared::ALL.len()],
    pub(super) without: [Curve; Without::ALL.len()],
}

/// Returns the figures of the maps of these runs.
///
/// # Errors
/// Returns an error if a map has no cell far enough from its ends.
pub(super) fn curve_of(campaign: &Campaign, runs: &[CampaignRun]) -> Result<Curve> {
    let order: Vec<usize> = order().collect();
    let map = |indices: &[usize]| {
        let sessions: Vec<(String, &CampaignRun)> = indices
            .iter()
            .map(|&index| (session(index), &runs[index]))
            .collect();
        let named: Vec<_> = sessions
            .iter()
            .map(|(session, run)| (Some(session.as_str()), *run))
            .collect();
        campaign.map_of_sessions(&named)
    };
    let mut curve = Curve::default();
    for (figures, size) in curve.maps.iter_mut().zip(SIZES) {
        let score = campaign.score(&map(&order[..size]))?;
        *figures = MapFigures {
            rmse_percent: score.rmse_percent,
            nees: score.nees,
        };
    }
    let (first, second): (Vec<usize>, Vec<usize>) =
        (0..RUNS).partition(|&index| is_of_first_days(index));
    let of_first = campaign.errors_percent(&map(&first));
    let of_second = campaign.errors_percent(&map(&second));
    let products = of_first
        .iter()
        .filter_map(|(cell, error)| Some(error * of_second.get(cell)?));
    curve.common_square = mean(&products.collect::<Vec<_>>());
    Ok(curve)
}
