//! The estimates with the effects that were found, beside those without.

use super::comparison::Differences;
use super::found::Found;
use super::tables::{Group, NINE_IN_TEN, number, signed};
use super::trips::Kind;
use crate::numeric::statistics::{mean, median, quantile};
use crate::report::page::Table;

const GROUPS: [Group; 5] = [
    ("summer", |of| !of.trip.is_winter()),
    ("winter", |of| of.trip.is_winter()),
    ("all", |_| true),
    ("summer, held out", |of| {
        is_held_out(of) && !of.trip.is_winter()
    }),
    ("winter, held out", |of| {
        is_held_out(of) && of.trip.is_winter()
    }),
];

/// The trips on which the effects were judged, and not fitted.
const HELD_OUT: [&str; 8] = [
    "TripA02", "TripA04", "TripA07", "TripA12", "TripA19", "TripB05", "TripB19", "TripB25",
];

fn is_held_out(of: &Found) -> bool {
    HELD_OUT.contains(&of.trip.name.as_str())
}

/// One row a group and kind, over the long windows.
pub(super) fn table(found: &[Found]) -> Table {
    let mut rows = Vec::new();
    for (group, is_in) in GROUPS {
        for (at, kind) in Kind::ESTIMATES.iter().enumerate() {
            let of = || found.iter().filter(|of| is_in(of));
            let before = of().map(|of| (of.differences[1][at], of.trip.published.bias_percent));
            let after = of().map(|of| (of.with_effects[at], of.trip.with_effects.bias_percent));
            let (before, after) = (Judgement::of(before), Judgement::of(after));
            rows.push(vec![
                group.to_owned(),
                kind.word().to_owned(),
                after.number.to_string(),
                number(before.rms_percent, 3),
                number(after.rms_percent, 3),
                number(before.nine_in_ten_percent, 3),
                number(after.nine_in_ten_percent, 3),
                number(before.nees, 2),
                number(after.nees, 2),
                signed(before.bias_percent, 3),
                signed(after.bias_percent, 3),
            ]);
        }
    }
    Table::new(
        "i3_effects",
        "With published parameters (before), and with the effects that `diagnose` found on 17 of the \
         trips, as host-sim/vehicles/i3.toml has them (after), over windows of 300 m: median of the \
         root mean square differences, what nine trips in ten stay below, median of the normalised \
         squared errors, and mean over trips of the bias that the smoothed filter found.",
        &[
            "trips",
            "what",
            "number",
            "RMS %, before",
            "after",
            "9 in 10 %, before",
            "after",
            "NEES, before",
            "after",
            "bias %, before",
            "after",
        ],
    )
    .with_rows(rows)
}

/// Statistics over a group of trips.
struct Judgement {
    number: usize,
    rms_percent: Option<f64>,
    nine_in_ten_percent: Option<f64>,
    nees: Option<f64>,
    bias_percent: Option<f64>,
}

impl Judgement {
    /// Computes them from differences and bias, %, of each trip.
    fn of(trips: impl Iterator<Item = (Option<Differences>, f64)>) -> Self {
        let (mut rms, mut nees, mut biases) = (Vec::new(), Vec::new(), Vec::new());
        for (differences, bias_percent) in trips {
            if let Some(differences) = differences {
                rms.push(differences.rms_percent);
                nees.push(differences.nees);
                biases.push(bias_percent);
            }
        }
        let some = |value: fn(&[f64]) -> f64, of: &[f64]| (!of.is_empty()).then(|| value(of));
        Self {
            number: rms.len(),
            rms_percent: some(median, &rms),
            nine_in_ten_percent: some(|rms| quantile(rms.iter().copied(), NINE_IN_TEN), &rms),
            nees: some(median, &nees),
            bias_percent: some(mean, &biases),
        }
    }
}
