//! The tables of the study.

use super::found::{Found, WINDOWS_M};
use super::interval::{Interval, interval};
use super::own_errors::ends_percent;
use super::trips::Kind;
use crate::numeric::statistics::{mean, median, quantile};
use crate::report::page::Table;

/// The quantile over trips that the tables give: nine trips in ten stay below it.
pub(super) const NINE_IN_TEN: f64 = 0.9;

pub(super) fn number(value: Option<f64>, decimals: usize) -> String {
    value.map_or("-".to_owned(), |value| format!("{value:.decimals$}"))
}

pub(super) fn signed(value: Option<f64>, decimals: usize) -> String {
    value.map_or("-".to_owned(), |value| format!("{value:+.decimals$}"))
}

/// A group of trips, and which are in it.
pub(super) type Group = (&'static str, fn(&Found) -> bool);

const GROUPS: [Group; 4] = [
    ("summer", |of| !of.trip.is_winter()),
    ("summer, fast", |of| !of.trip.is_winter() && of.trip.is_fast),
    ("winter", |of| of.trip.is_winter()),
    ("all", |_| true),
];

/// One row a group, kind and window length: medians and means over trips, with intervals.
pub(super) fn groups(found: &[Found], seed: u64) -> Table {
    let mut rows = Vec::new();
    for (length, window_m) in WINDOWS_M.iter().enumerate() {
        for (group, is_in) in GROUPS {
            for (at, kind) in Kind::ALL.iter().enumerate() {
                let of: Vec<_> = found
                    .iter()
                    .filter(|of| is_in(of))
                    .filter_map(|of| of.differences[length][at])
                    .collect();
                let rms: Vec<f64> = of.iter().map(|of| of.rms_percent).collect();
                let offsets: Vec<f64> = of.iter().map(|of| of.offset_percent).collect();
                let nees: Vec<f64> = of.iter().map(|of| of.nees).collect();
                let tells_sigma = at < Kind::ESTIMATES.len() && !nees.is_empty();
                let mut row = vec![
                    format!("{window_m:.0}"),
                    group.to_owned(),
                    kind.word().to_owned(),
                    of.len().to_string(),
                ];
                row.extend(in_words(interval(&rms, seed, median), false));
                let tenth = (!rms.is_empty()).then(|| quantile(rms.clone(), NINE_IN_TEN));
                row.push(number(tenth, 3));
                row.extend(in_words(interval(&offsets, seed, mean), true));
                row.push(number(tells_sigma.then(|| median(&nees)), 2));
                rows.push(row);
            }
        }
    }
    Table::new(
        "i3_groups",
        "Against the accelerometer, over windows: root mean square of the differences without each \
         trip's offset, median over trips with its interval of 95 % (trips drawn with replacement), \
         what nine trips in ten stay below, the mean offset with its interval, and the median of \
         normalised squared errors by the variances of estimate and judge together.",
        &[
            "window m",
            "trips",
            "what",
            "number",
            "RMS %",
            "from",
            "to",
            "9 in 10 %",
            "mean %",
            "from",
            "to",
            "NEES",
        ],
    )
    .with_rows(rows)
}

fn in_words(interval: Option<Interval>, has_sign: bool) -> [String; 3] {
    let text = if has_sign { signed } else { number };
    let part = |of: fn(&Interval) -> f64| text(interval.as_ref().map(of), 3);
    [part(|of| of.value), part(|of| of.low), part(|of| of.high)]
}

/// One row a trip, over the long windows.
pub(super) fn trips(found: &[Found]) -> Table {
    let rows = found.iter().map(|of| {
        let differences = &of.differences[1];
        let mut row = vec![
            of.trip.name.clone(),
            number(of.trip.ambient_celsius, 1),
            format!("{:.1}", of.trip.length_m * 1e-3),
            if of.trip.is_fast { "yes" } else { "no" }.to_owned(),
        ];
        let rms = differences.iter().map(|of| of.map(|of| of.rms_percent));
        row.extend(rms.map(|rms| number(rms, 3)));
        row.extend([
            signed(differences[0].map(|of| of.offset_percent), 3),
            signed(differences[3].map(|of| of.offset_percent), 3),
            number(differences[0].map(|of| of.nees), 2),
            number(differences[2].map(|of| of.nees), 2),
            signed(Some(of.trip.published.bias_percent), 3),
        ]);
        row
    });
    Table::new(
        "i3_trips",
        format!(
            "Each trip over windows of {:.0} m: root mean square against the accelerometer without \
             the offset, the offset of the smoothed estimate and of the bare force model, NEES, \
             and the mean bias that the filter found.",
            WINDOWS_M[1]
        ),
        &[
            "trip",
            "ambient °C",
            "km",
            "fast",
            "smoothed %",
            "lagged %",
            "live %",
            "bare %",
            "elevation %",
            "smoothed offset %",
            "bare offset %",
            "NEES smoothed",
            "NEES live",
            "model bias %",
        ],
    )
    .with_rows(rows)
}

/// The judge's own errors, one row a trip.
pub(super) fn own(found: &[Found]) -> Table {
    let rows = found.iter().map(|of| {
        let own = &of.own;
        let noise = |window_m: f64| crate::inertial_judge::noise_percent(window_m);
        let ends = |at: usize| ends_percent(&of.windows[at], noise(WINDOWS_M[at]));
        vec![
            of.trip.name.clone(),
            signed(own.offset_percent, 3),
            number(own.drift_percent, 3),
            signed(own.pitch_percent, 2),
            signed(own.delay_s, 3),
            number(Some(ends(0)), 3),
            number(Some(ends(1)), 3),
            number(Some(100.0 * of.braking.part_of_road), 2),
            number(Some(100.0 * of.braking.part_of_windows), 1),
            number(of.braking.without.map(|of| of.rms_percent), 3),
        ]
    });
    Table::new(
        "i3_judge",
        "The judge's own errors: offset against the climb between the first and the last elevation; \
         its scatter over pieces of 2 km and more between elevations, which has their noise, too; \
         grade for each m/s² of motion (pitch of the body, scale of the sensor), which noise of \
         dv/dt draws towards minus; delay of the speed; the share of a window's sigma from its ends, \
         over 100 and 300 m. Then where friction brakes were on: part of the road and of the windows \
         of 300 m, and the smoothed estimate in the other windows.",
        &[
            "trip",
            "offset %",
            "scatter %",
            "% per m/s²",
            "delay s",
            "ends 100 m %",
            "ends 300 m %",
            "braked road %",
            "braked windows %",
            "smoothed, not braked %",
        ],
    )
    .with_rows(rows)
}
