//! How maps of the three methods improve with the number of runs.

use crate::numeric::statistics::mean;
use crate::report::page::{Figure, Table};
use crate::report::plot::{Plot, Series, colour};
use crate::study::convergence::Conditions;
use crate::study::convergence::curve::PowerLaw;
use crate::study::experiments::measure::rmse;
use crate::study::experiments::method::ThesisMethod;
use rayon::prelude::*;

/// Number of maps, and of runs in each. The thesis's 800 runs are those of its study.
const SETS: usize = 10;
const RUNS: usize = 10;
/// Numbers of runs in the table.
const SHOWN: [usize; 4] = [1, 3, 5, 10];

/// RMSE of maps after each run, mean over sets, % grade.
pub(super) struct Converged {
    curves: [Vec<f64>; 3],
}

/// Drives the runs of all sets over a road of these grades (%, every 2.5 m), each with false
/// parameters of its own, and fuses them by 1/P.
pub(super) fn converge(grade_percent: &[f64], seed: u64) -> Converged {
    let conditions = Conditions::calibrated(grade_percent.to_vec(), seed);
    let sets: Vec<[Vec<f64>; 3]> = (0..SETS)
        .into_par_iter()
        .map(|set| of_set(&conditions, set * RUNS))
        .collect();
    let curve = |method: usize| {
        let after = |n: usize| mean(&sets.iter().map(|set| set[method][n]).collect::<Vec<_>>());
        (0..RUNS).map(after).collect()
    };
    Converged {
        curves: [0, 1, 2].map(curve),
    }
}

fn of_set(conditions: &Conditions, first: usize) -> [Vec<f64>; 3] {
    let truth = &conditions.grade_percent;
    let mut sums = [0, 1, 2].map(|_: usize| vec![(0.0, 0.0); truth.len()]);
    let mut curves = [0, 1, 2].map(|_: usize| Vec::with_capacity(RUNS));
    for index in first..first + RUNS {
        let drive = conditions.disturbed_drive(index).drive;
        for (number, method) in ThesisMethod::ALL.into_iter().enumerate() {
            let profile = method.estimate_drive(&drive);
            for (k, (sum, weights)) in sums[number].iter_mut().enumerate() {
                let weight = profile.sigma_percent[k].powi(-2);
                *sum += weight * profile.grade_percent[k];
                *weights += weight;
            }
            let map: Vec<f64> = sums[number].iter().map(|(s, w)| s / w).collect();
            curves[number].push(rmse(truth, &map));
        }
    }
    curves
}

impl Converged {
    fn laws(&self) -> [PowerLaw; 3] {
        [0, 1, 2].map(|method: usize| PowerLaw::fit(&self.curves[method]))
    }

    /// Returns the result in words.
    pub(super) fn words(&self) -> String {
        let [original, modified, ours] =
            [0, 1, 2].map(|method: usize| self.curves[method][RUNS - 1]);
        format!(
            "Convergence: {SETS} maps of {RUNS} runs of vehicle A, parameters of each run wrong by factors \
             from N(1, 0.2) as in the thesis. Maps of {RUNS} runs have an RMSE of {original:.3} % by the \
             original method, {modified:.3} % by the modified one and {ours:.3} % by ours."
        )
    }

    /// Returns the RMSE after some numbers of runs, and the exponents.
    pub(super) fn table(&self) -> Table {
        let mut header = vec!["method".to_owned()];
        header.extend(SHOWN.map(|runs| format!("{runs} runs %")));
        header.push("exponent".to_owned());
        let header: Vec<&str> = header.iter().map(String::as_str).collect();
        let rows = ThesisMethod::ALL
            .into_iter()
            .zip(&self.curves)
            .zip(self.laws());
        let rows = rows.map(|((method, curve), law)| {
            let mut row = vec![method.phrase().to_owned()];
            row.extend(SHOWN.map(|runs| format!("{:.4}", curve[runs - 1])));
            row.push(format!("{:.2}", -law.exponent));
            row
        });
        let caption = format!(
            "RMSE of maps against the number of runs, mean of {SETS} maps, and the exponent fitted to it; \
             independent errors have -0.5."
        );
        Table::new("e4_convergence", caption, &header).with_rows(rows)
    }

    /// Returns the curves.
    pub(super) fn figure(&self) -> Figure {
        let mut plot = Plot::new("runs in the map", "RMSE (% grade)");
        let colours = [colour::GREY, colour::ORANGE, colour::BLUE];
        for ((method, curve), colour) in
            ThesisMethod::ALL.into_iter().zip(&self.curves).zip(colours)
        {
            let points = (1..).map(f64::from).zip(curve.iter().copied());
            plot = plot.with(Series::line(method.phrase(), colour, points));
        }
        let caption = "RMSE of maps after each run on the E4, mean over the sets.";
        Figure::new("e4_convergence_10", &plot, caption)
    }
}
