//! The estimates with the effects that were found, beside those without.

use super::found::Found;
use super::tables::{NINE_IN_TEN, number, signed};
use super::trips::Kind;
use crate::numeric::statistics::{mean, median, quantile};
use crate::report::page::Table;

/// A group of trips, and which are in it.
type Group = (&'static str, fn(&Found) -> bool);

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

/// What is compared, with its place in [`Kind::ALL`].
const KINDS: [(usize, Kind); 3] = [(0, Kind::Smoothed), (1, Kind::Lagged), (2, Kind::Live)];

fn is_held_out(of: &Found) -> bool {
    HELD_OUT.contains(&of.trip.name.as_str())
}

/// One row a group and kind, over the long windows. Both slices have the same trips.
pub(super) fn table(before: &[Found], after: &[Found]) -> Table {
    let mut rows = Vec::new();
    for (group, is_in) in GROUPS {
        for (at, kind) in KINDS {
            let [before, after] = [before, after].map(|found| {
                let of = found.iter().filter(|of| is_in(of));
                Judgement::of(of, at)
            });
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

/// What is told of a group of trips.
struct Judgement {
    number: usize,
    rms_percent: Option<f64>,
    nine_in_ten_percent: Option<f64>,
    nees: Option<f64>,
    bias_percent: Option<f64>,
}

impl Judgement {
    /// Judges the estimates at this place of [`Kind::ALL`].
    fn of<'a>(found: impl Iterator<Item = &'a Found>, at: usize) -> Self {
        let (mut rms, mut nees, mut biases) = (Vec::new(), Vec::new(), Vec::new());
        for of in found {
            if let Some(differences) = of.differences[1][at] {
                rms.push(differences.rms_percent);
                nees.push(differences.nees);
                biases.push(of.trip.bias_percent);
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
