//! Effects that depend on the place on a closed lap: fitted on some laps, judged on others.

use super::laps::{LapError, rmse};
use nalgebra::{DMatrix, DVector};
use std::collections::BTreeMap;
use std::f64::consts::TAU;

/// What may explain errors by place.
pub(super) struct PlaceEffect {
    pub name: &'static str,
    shape: Shape,
}

enum Shape {
    /// The same everywhere.
    Constant,
    /// Harmonics of the lap, up to this one: a lap turns once around, so a steady wind is the first.
    Harmonics(u32),
    /// Any error by place: what effects by place can explain at most.
    AnyPlace,
}

pub(super) const PLACE_EFFECTS: [PlaceEffect; 4] = [
    PlaceEffect {
        name: "constant",
        shape: Shape::Constant,
    },
    PlaceEffect {
        name: "headwind: first harmonic",
        shape: Shape::Harmonics(1),
    },
    PlaceEffect {
        name: "first and second harmonic",
        shape: Shape::Harmonics(2),
    },
    PlaceEffect {
        name: "any error by place",
        shape: Shape::AnyPlace,
    },
];

/// What an effect explains.
pub(super) struct Explained {
    /// Amounts in words.
    pub amounts: String,
    /// Error that is left on the laps that were not fitted, %.
    pub judged_rmse: f64,
}

/// Fits an effect, and judges it. `None` where there is too little to fit.
pub(super) fn explained(
    effect: &PlaceEffect,
    length_m: f64,
    fitted: &[LapError],
    judged: &[LapError],
) -> Option<Explained> {
    let harmonics = match effect.shape {
        Shape::Constant => 0,
        Shape::Harmonics(count) => count,
        Shape::AnyPlace => return by_place(fitted, judged),
    };
    let basis = |error: &LapError| {
        let angle = TAU * error.place_m / length_m;
        let waves = (1..=harmonics).flat_map(move |harmonic| {
            let angle = f64::from(harmonic) * angle;
            [angle.cos(), angle.sin()]
        });
        std::iter::once(1.0).chain(waves)
    };
    let width = 1 + 2 * harmonics as usize;
    let rows = DMatrix::from_row_iterator(fitted.len(), width, fitted.iter().flat_map(basis));
    let errors = DVector::from_iterator(fitted.len(), fitted.iter().map(|of| of.error_percent));
    let amounts = (rows.transpose() * &rows)
        .cholesky()?
        .solve(&(rows.transpose() * errors));
    let predicted = |error: &LapError| basis(error).zip(amounts.iter()).map(|(b, a)| a * b).sum();
    let waves = (1..=harmonics as usize)
        .map(|wave| format!(", {:.3}", amounts[2 * wave - 1].hypot(amounts[2 * wave])));
    Some(Explained {
        amounts: format!("{:+.3}{}", amounts[0], waves.collect::<String>()),
        judged_rmse: rmse(&without(judged, predicted)),
    })
}

fn by_place(fitted: &[LapError], judged: &[LapError]) -> Option<Explained> {
    let mut sums: BTreeMap<u64, (f64, f64)> = BTreeMap::new();
    for error in fitted {
        let sum = sums.entry(error.place_m.to_bits()).or_default();
        *sum = (sum.0 + error.error_percent, sum.1 + 1.0);
    }
    let mean = |error: &LapError| {
        let (sum, count) = sums
            .get(&error.place_m.to_bits())
            .copied()
            .unwrap_or((0.0, 1.0));
        sum / count
    };
    (!fitted.is_empty()).then(|| Explained {
        amounts: String::new(),
        judged_rmse: rmse(&without(judged, mean)),
    })
}

fn without(errors: &[LapError], predicted: impl Fn(&LapError) -> f64) -> Vec<LapError> {
    let left = |error: &LapError| LapError {
        error_percent: error.error_percent - predicted(error),
        ..*error
    };
    errors.iter().map(left).collect()
}
