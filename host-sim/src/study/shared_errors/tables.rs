//! Tables and figures of the study.

use super::curve::{CampaignFigures, Curve, MapFigures, SIZES};
use super::drives::{RUNS, Shared, Without};
use crate::numeric::statistics::{error_of_mean, mean};
use crate::report::page::{Figure, Table};
use crate::report::plot::{Plot, Series, colour};

/// Means over campaigns of the maps of one number of runs.
struct OfSize {
    rmse_percent: f64,
    nees: f64,
    nees_error: f64,
    nees_range: (f64, f64),
}

fn of_size(figures: &[MapFigures]) -> OfSize {
    let squares: Vec<f64> = figures.iter().map(|map| map.rmse_percent.powi(2)).collect();
    let nees: Vec<f64> = figures.iter().map(|map| map.nees).collect();
    OfSize {
        rmse_percent: mean(&squares).sqrt(),
        nees: mean(&nees),
        nees_error: error_of_mean(&nees),
        nees_range: (
            nees.iter().copied().fold(f64::INFINITY, f64::min),
            nees.iter().copied().fold(0.0, f64::max),
        ),
    }
}

/// Means over campaigns.
struct Means {
    /// By the number of runs.
    sizes: Vec<OfSize>,
    /// Root of the mean square that all days have in common, %.
    common_percent: f64,
}

fn means(campaigns: &[CampaignFigures], curve: impl Fn(&CampaignFigures) -> Curve) -> Means {
    let curves: Vec<Curve> = campaigns.iter().map(curve).collect();
    let of_size = |size: usize| {
        let maps: Vec<MapFigures> = curves.iter().map(|curve| curve.maps[size]).collect();
        of_size(&maps)
    };
    let common: Vec<f64> = curves.iter().map(|curve| curve.common_square).collect();
    Means {
        sizes: (0..SIZES.len()).map(of_size).collect(),
        common_percent: mean(&common).max(0.0).sqrt(),
    }
}

pub(super) fn tables(campaigns: &[CampaignFigures]) -> Vec<Table> {
    vec![levels(campaigns), consistency(campaigns), floors(campaigns)]
}

fn levels(campaigns: &[CampaignFigures]) -> Table {
    let rows = Shared::ALL.into_iter().enumerate().map(|(number, shared)| {
        let means = means(campaigns, |of| of.shared[number]);
        let mut row = vec![shared.words().to_owned()];
        let sizes = means.sizes.iter();
        row.extend(sizes.map(|of| format!("{:.4}", of.rmse_percent)));
        row.push(format!("{:.4}", means.common_percent));
        row
    });
    let mut header = vec!["errors are".to_owned()];
    header.extend(SIZES.map(|size| match size {
        1 => "1 run %".to_owned(),
        _ => format!("{size} runs %"),
    }));
    header.push("all days %".to_owned());
    let header: Vec<&str> = header.iter().map(String::as_str).collect();
    Table::new(
        "shared_errors_rmse",
        "RMSE of the grade of maps (%, over all campaigns) by the number of runs, and the error that \
         all days have in common, which no further day of these trucks averages: the root of the \
         mean product of the errors of two maps, one of either half of the days.",
        &header,
    )
    .with_rows(rows)
}

fn consistency(campaigns: &[CampaignFigures]) -> Table {
    let rows = Shared::ALL
        .into_iter()
        .enumerate()
        .flat_map(|(number, shared)| {
            let means = means(campaigns, |of| of.shared[number]);
            let shown = [0, 2, SIZES.len() - 1];
            shown.map(|size| {
                let of = &means.sizes[size];
                vec![
                    shared.words().to_owned(),
                    SIZES[size].to_string(),
                    format!("{:.2} ± {:.2}", of.nees, of.nees_error),
                    format!("{:.2}", of.nees_range.0),
                    format!("{:.2}", of.nees_range.1),
                ]
            })
        });
    Table::new(
        "shared_errors_nees",
        "Normalised squared error of maps (NEES, 1 if the stated sigmas are consistent): mean over \
         campaigns with its standard error, and the least and the largest of a campaign.",
        &["errors are", "runs", "NEES", "least", "largest"],
    )
    .with_rows(rows)
}

fn floors(campaigns: &[CampaignFigures]) -> Table {
    let of_all = |number: usize| {
        let means = means(campaigns, |of| of.without[number]);
        let all = means.sizes[SIZES.len() - 1].rmse_percent;
        (means.sizes[0].rmse_percent, all, means.common_percent)
    };
    let (_, with_all, _) = of_all(0);
    let rows = Without::ALL
        .into_iter()
        .enumerate()
        .map(|(number, without)| {
            let (one, all, common) = of_all(number);
            vec![
                without.words().to_owned(),
                format!("{one:.4}"),
                format!("{all:.4}"),
                format!("{:+.0}", 100.0 * (all.powi(2) / with_all.powi(2) - 1.0)),
                format!("{common:.4}"),
            ]
        });
    let of_all_runs = format!("{RUNS} runs %");
    Table::new(
        "shared_errors_floor",
        format!(
            "Mixed errors, and the same drives without one of their causes: RMSE (%) of a run and of \
             {RUNS}, the change of the square of the latter, and the error that all days have in \
             common. What stays without all of them is what the estimator rounds: crests, shifts and \
             signals of different age. The parts do not add up: altitudes correct what parameters, \
             tyres and wind do."
        ),
        &[
            "without",
            "1 run %",
            &of_all_runs,
            "change of its square %",
            "all days %",
        ],
    )
    .with_rows(rows)
}

pub(super) fn figures(campaigns: &[CampaignFigures]) -> Vec<Figure> {
    let plot = |words: &str, value: fn(&OfSize) -> f64| {
        let mut plot = Plot::new("runs in the map", words);
        for (number, shared) in Shared::ALL.into_iter().enumerate() {
            let means = means(campaigns, |of| of.shared[number]);
            let points = SIZES.into_iter().zip(&means.sizes);
            let points = points.map(|(size, of)| (size as f64, value(of)));
            plot = plot.with(Series::line(shared.words(), colour::CYCLE[number], points));
        }
        plot
    };
    vec![
        Figure::new(
            "shared_errors_1",
            &plot("RMSE (% grade)", |of| of.rmse_percent),
            "RMSE of maps by the number of their runs, for errors that are each run's own or shared.",
        ),
        Figure::new(
            "shared_errors_2",
            &plot("NEES", |of| of.nees),
            "Mean normalised squared error of the same maps: above 1 the sigma of the map is too small.",
        ),
    ]
}
