//! The floor of the judgement: roads that were driven more than once.

use super::found::WINDOWS_M;
use super::interval::interval;
use super::repeats::Repeat;
use crate::numeric::statistics::median;
use crate::report::page::Table;

/// Returns the floor by pair of trips, and its median with an interval.
pub(super) fn table(repeats: &[Repeat], seed: u64) -> Table {
    let mut rows: Vec<Vec<String>> = repeats.iter().map(row).collect();
    let of = |value: fn(&Repeat) -> f64| -> Vec<f64> { repeats.iter().map(value).collect() };
    let summary = [
        interval(&of(|of| of.offset_percent.abs()), seed, median),
        interval(&of(|of| of.noise_percent[0]), seed, median),
        interval(&of(|of| of.noise_percent[1]), seed, median),
        interval(&of(|of| of.pitch_percent), seed, median),
    ];
    if !repeats.is_empty() {
        let kilometres: f64 = repeats.iter().map(|of| of.shared_m * 1e-3).sum();
        let mut last = vec!["median, from, to".to_owned(), String::new()];
        last.push(format!("{kilometres:.1}"));
        last.extend(summary.map(|of| {
            of.map_or("-".to_owned(), |of| {
                format!("{:.3}, {:.3}, {:.3}", of.value, of.low, of.high)
            })
        }));
        rows.push(last);
    }
    let [short_m, long_m] = WINDOWS_M;
    Table::new(
        "i3_floor",
        format!(
            "The judge against itself: the same road on two trips. Difference of both offsets; noise \
             of one judge over {short_m:.0} and {long_m:.0} m (differences without the offset, over \
             the root of two; other lanes and lines of driving are in it); and the difference for \
             each m/s² that one car accelerates more than the other, which is the pitch of the body. \
             Last, the medians over pairs with intervals of 95 %, of the offset without its sign."
        ),
        &[
            "trips",
            "season",
            "shared km",
            "offset %",
            "noise 100 m %",
            "noise 300 m %",
            "% per m/s²",
        ],
    )
    .with_rows(rows)
}

fn row(of: &Repeat) -> Vec<String> {
    let season = if of.is_winter { "winter" } else { "summer" };
    vec![
        format!("{} {}", of.trips[0], of.trips[1]),
        season.to_owned(),
        format!("{:.1}", of.shared_m * 1e-3),
        format!("{:+.3}", of.offset_percent),
        format!("{:.3}", of.noise_percent[0]),
        format!("{:.3}", of.noise_percent[1]),
        format!("{:+.3}", of.pitch_percent),
    ]
}
