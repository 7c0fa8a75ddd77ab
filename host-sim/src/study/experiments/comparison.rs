//! Our predictions against the thesis's numbers, and what the errors are made of.

use super::measure::{errors, mean};
use super::modified::{Estimated, Method};
use super::replica::{Campaign, Heading, Replica, Sources};
use crate::report::page::Table;
use crate::world::truck::Preset;
use rayon::prelude::*;

/// Beyond this, a difference is named and explained.
const QUARTER: f64 = 0.25;

/// One number, ours and the thesis's.
#[derive(Clone, Debug)]
pub struct Compared {
    /// What it is.
    pub what: String,
    /// Ours.
    pub ours: f64,
    /// The thesis's.
    pub thesis: f64,
}

/// The numbers that sum up tables 5-8.
#[derive(Clone, Debug)]
pub struct Summary(pub Vec<Compared>);

impl Summary {
    /// As a table.
    #[must_use]
    pub fn table(&self) -> Table {
        let header = ["what", "ours", "thesis", "ours over thesis"];
        let caption = "Predictions beside the thesis; errors in % grade, improvements in %.";
        Table::new("summary", caption, &header).with_rows(self.0.iter().map(|compared| {
            vec![
                compared.what.clone(),
                format!("{:.3}", compared.ours),
                format!("{:.3}", compared.thesis),
                format!("{:.2}", compared.ours / compared.thesis),
            ]
        }))
    }
}

/// Sums up both methods.
#[must_use]
pub fn summary(original: &[Estimated], modified: &[Estimated]) -> Summary {
    let mut all = Vec::new();
    for (preset, truck) in [(Preset::A, "A"), (Preset::B, "B")] {
        let of = |found: &[Estimated], value: &dyn Fn(&Estimated) -> f64| -> f64 {
            let members = found.iter().filter(|f| f.experiment.preset() == preset);
            mean(&members.map(value).collect::<Vec<f64>>())
        };
        let pairs = [(Method::Original, original), (Method::Modified, modified)];
        let mut means = Vec::new();
        for (method, found) in pairs {
            let ours = of(found, &|f| f.errors.rmse_valid);
            let thesis = of(found, &|f| method.of_thesis(f.experiment)[2]);
            means.push((ours, thesis));
            let what = format!(
                "mean RMSE(v) of the {} method, truck {truck}",
                method.word()
            );
            all.push(Compared { what, ours, thesis });
        }
        // The thesis's 46 % and -7 % are means over the runs' own improvements.
        let gains: Vec<(f64, f64)> = original
            .iter()
            .zip(modified)
            .filter(|(before, _)| before.experiment.preset() == preset)
            .map(|(before, after)| {
                let gain = |before: f64, after: f64| 100.0 * (1.0 - after / before);
                (
                    gain(before.errors.rmse_valid, after.errors.rmse_valid),
                    gain(
                        Method::Original.of_thesis(before.experiment)[2],
                        Method::Modified.of_thesis(before.experiment)[2],
                    ),
                )
            })
            .collect();
        all.push(Compared {
            what: format!("improvement by the modified method, truck {truck} (%)"),
            ours: mean(&gains.iter().map(|gain| gain.0).collect::<Vec<f64>>()),
            thesis: mean(&gains.iter().map(|gain| gain.1).collect::<Vec<f64>>()),
        });
    }
    for heading in Heading::BOTH {
        for runs in [3, 5] {
            for (method, found) in [(Method::Original, original), (Method::Modified, modified)] {
                let last = found
                    .iter()
                    .find(|f| (f.experiment.heading, f.experiment.number) == (heading, runs));
                all.extend(last.map(|found| Compared {
                    what: format!(
                        "RMSE(m) of {runs} {} runs, {}",
                        heading.word(),
                        method.word()
                    ),
                    ours: found.rmse_merged,
                    thesis: method.of_thesis(found.experiment)[4],
                }));
            }
        }
    }
    Summary(all)
}

/// Which numbers differ by more than a quarter, in words.
#[must_use]
pub fn differences(summary: &Summary) -> Vec<String> {
    let far: Vec<String> = summary
        .0
        .iter()
        .filter(|c| (c.ours - c.thesis).abs() > QUARTER * c.thesis.abs())
        .map(|c| format!("{}: {:.3} instead of {:.3}", c.what, c.ours, c.thesis))
        .collect();
    if far.is_empty() {
        return Vec::new();
    }
    vec![format!("More than a quarter off: {}.", far.join("; "))]
}

/// RMSE(v) that remains if one source of error at a time disturbs the runs, means over a truck.
#[must_use]
pub fn made_of(campaign: &Campaign, runs: &[Replica]) -> Table {
    let none = Sources::NONE;
    let rows = [
        ("nothing", none),
        (
            "speed noise",
            Sources {
                speed: true,
                ..none
            },
        ),
        ("GPS errors", Sources { gps: true, ..none }),
        ("wind", Sources { wind: true, ..none }),
        (
            "constant",
            Sources {
                constant: true,
                ..none
            },
        ),
        (
            "cold tyres",
            Sources {
                warm_up: true,
                ..none
            },
        ),
        (
            "torque",
            Sources {
                torque: true,
                ..none
            },
        ),
        ("everything", Sources::ALL),
    ];
    let header = [
        "disturbed by",
        "original A %",
        "modified A %",
        "original B %",
        "modified B %",
    ];
    let caption = "What the errors are made of: mean RMSE(v) with one source at a time.";
    Table::new("made_of", caption, &header).with_rows(
        rows.into_par_iter()
            .map(|(name, sources)| {
                let mut row = vec![name.to_owned()];
                for preset in [Preset::A, Preset::B] {
                    for method in Method::BOTH {
                        let each: Vec<f64> = runs
                            .iter()
                            .filter(|run| run.experiment.preset() == preset)
                            .map(|run| {
                                let alone = campaign.drive(run.experiment, run.fitted, sources);
                                errors(&alone, &method.estimate(&alone).grade_percent).rmse_valid
                            })
                            .collect();
                        row.push(format!("{:.3}", mean(&each)));
                    }
                }
                row
            })
            .collect::<Vec<_>>(),
    )
}
