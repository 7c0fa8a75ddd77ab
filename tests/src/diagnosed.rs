//! Diagnoses of logs with a planted effect, case by case and as a confusion table.
//!
//! The diagnosis reads the logs and the vehicle file only. The truth is in a folder that it does
//! not get.

use crate::planted::{self, CATALOGUE, CLEAN, FAN, OUTSIDE, PlantedLogs};
use estimator_core::Tuning;
use host_sim::diagnose::drive::LoggedDrive;
use host_sim::diagnose::{Diagnosis, Request, diagnose};
use host_sim::error::{Error, Result};
use host_sim::files::truth;
use host_sim::files::vehicle::VehicleFile;
use host_sim::score::score_run;
use host_sim::source::read_options::ReadOptions;
use host_sim::terminal::table::text_table;
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::Path;

/// Both trucks of the bench.
pub const TRUCKS: [&str; 2] = ["A", "B"];
/// Ratio of the size of `wheel_radius`, in % of the radius, to the size of other effects, in %
/// grade: 1 % of the radius belongs to 0.1 % grade.
const RADIUS_SIZE: f64 = 10.0;

/// Pairs of effects of the same size. The two of a pair depend on different quantities.
pub const PAIRS: [&str; 6] = [
    "rolling_resistance+cornering",
    "driveline_loss+headwind",
    "mass+air_drag",
    "tyre_warmup+fan",
    "road_surface+torque_scale",
    "wheel_radius+rolling_resistance",
];

/// One set of logs.
#[derive(Clone, Debug, PartialEq)]
pub struct DiagnosisCase {
    /// An effect of the catalogue, one outside it, [`FAN`], [`CLEAN`], or two joined by a plus.
    pub effect: String,
    /// Size as in [`planted::logs`], %.
    pub size_percent: f64,
    /// "A" or "B".
    pub truck: &'static str,
    /// Seed of all random numbers.
    pub seed: u64,
}

/// A diagnosis compared with what was planted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Verdict {
    /// It names the effect or, for an effect outside the catalogue, what the rest depends on. For
    /// clean logs it adopts nothing.
    Named,
    /// It adopts another effect and reports that the data do not distinguish the two.
    InGroup,
    /// It adopts other effects only, or finds another dependence.
    Other,
    /// It finds nothing.
    Nothing,
}

/// A case and its diagnosis.
#[derive(Clone, Debug)]
pub struct CaseOutcome {
    /// The case.
    pub case: DiagnosisCase,
    /// Its diagnosis.
    pub diagnosis: Diagnosis,
    /// Grade errors of the filter on the runs held out: with the assumed vehicle, with the
    /// diagnosed vehicle, and with the assumed vehicle where nothing was planted.
    pub filtered: [GradeErrors; 3],
}

/// Root mean squares over all cells, %.
#[derive(Clone, Copy, Debug, Default)]
pub struct GradeErrors {
    /// Smoothed over the whole run.
    pub smoothed: f64,
    /// Estimated while driving.
    pub live: f64,
}

/// Returns the effects that have a row in the table: the catalogue, the fan, those outside the
/// catalogue, pairs, and none.
pub fn effects() -> impl Iterator<Item = &'static str> {
    CATALOGUE
        .into_iter()
        .chain([FAN])
        .chain(OUTSIDE)
        .chain(PAIRS)
        .chain([CLEAN])
}

/// Returns the cases of every effect in every size (% grade), on both trucks, with seeds 1 to
/// `seeds`. Clean logs have no size. A negative size is left out for an effect of which there cannot
/// be less than assumed.
///
/// # Errors
/// An effect is unknown.
pub fn cases(effects: &[String], sizes: &[f64], seeds: u64) -> Result<Vec<DiagnosisCase>> {
    let mut cases = Vec::new();
    for effect in effects {
        if !self::effects().any(|known| known == effect) {
            let known: Vec<&str> = self::effects().collect();
            let problem = format!("effect \"{effect}\": expected one of {}", known.join(", "));
            return Err(Error::content(Path::new("bench"), problem));
        }
        let sizes: Vec<f64> = match effect.as_str() {
            CLEAN => vec![0.0],
            "wheel_radius" => sizes.iter().map(|size| RADIUS_SIZE * size).collect(),
            _ => sizes.to_vec(),
        };
        let can_be_less = effect.split('+').all(planted::can_be_less);
        let sizes = sizes.into_iter().filter(|size| *size >= 0.0 || can_be_less);
        for (size_percent, truck, seed) in sizes.flat_map(|size| {
            TRUCKS
                .into_iter()
                .flat_map(move |truck| (1..=seeds).map(move |seed| (size, truck, seed)))
        }) {
            cases.push(DiagnosisCase {
                effect: effect.clone(),
                size_percent,
                truck,
                seed,
            });
        }
    }
    Ok(cases)
}

impl DiagnosisCase {
    /// Returns the effects planted, each with its size.
    fn planted(&self, size_percent: f64) -> Vec<(&str, f64)> {
        let of_pair = |effect| match effect {
            "wheel_radius" if self.effect.contains('+') => RADIUS_SIZE * size_percent,
            _ => size_percent,
        };
        let effects = self.effect.split('+');
        effects.map(|effect| (effect, of_pair(effect))).collect()
    }

    /// Simulates the logs and diagnoses them.
    ///
    /// # Errors
    /// Returns the errors of [`planted::logs`] and of the diagnosis.
    pub fn outcome(&self) -> Result<CaseOutcome> {
        let folder = tempfile::tempdir().map_err(Error::io(Path::new("temporary folder")))?;
        let logs = |name: &str, size_percent: f64| {
            let planted = self.planted(size_percent);
            planted::logs_of(&planted, self.truck, self.seed, &folder.path().join(name))
        };
        let without = logs("without", 0.0)?;
        let logs = logs("case", self.size_percent)?;
        let assumed = VehicleFile::read(&logs.vehicle)?;
        let diagnosis = diagnose(&Request {
            tuning: Tuning::default(),
            options: ReadOptions::default(),
            vehicle: assumed.clone(),
            logs: logs.fit.clone(),
            held_out: logs.held_out.clone(),
            reference: None,
            terrain: None,
            accelerometer: false,
        })?;
        let filtered = [
            GradeErrors::of(&logs, &assumed)?,
            GradeErrors::of(&logs, &diagnosis.vehicle)?,
            GradeErrors::of(&without, &assumed)?,
        ];
        Ok(CaseOutcome {
            case: self.clone(),
            diagnosis,
            filtered,
        })
    }
}

impl GradeErrors {
    /// Returns the errors on the runs held out, estimated with a vehicle.
    fn of(logs: &PlantedLogs, vehicle: &VehicleFile) -> Result<Self> {
        let (mut smoothed, mut live, mut cells) = (0.0, 0.0, 0.0);
        for (log, truth) in logs.held_out.iter().zip(&logs.truth.held_out) {
            let run = LoggedDrive::read(
                log,
                &vehicle.model,
                &Tuning::default(),
                &ReadOptions::default(),
            )?
            .run;
            let truth = truth::read(truth)?;
            let score = score_run("held out", &run.rows, &truth)
                .map_err(|problem| Error::content(log, problem.to_string()))?;
            for row in score.rows {
                let squares = row.cells as f64 * row.rmse_percent.powi(2);
                match row.estimate {
                    "smoothed" => {
                        smoothed += squares;
                        cells += row.cells as f64;
                    }
                    "live" => live += squares,
                    _ => {}
                }
            }
        }
        Ok(Self {
            smoothed: (smoothed / cells).sqrt(),
            live: (live / cells).sqrt(),
        })
    }
}

/// Returns the name in the catalogue of a planted effect.
fn catalogue_name(effect: &str) -> &str {
    if effect == FAN {
        "auxiliary_load"
    } else {
        effect
    }
}

/// Returns the diagnosis's words for the dependence of an effect outside the catalogue.
fn dependence(effect: &str) -> Option<&'static str> {
    match effect {
        "torque_hysteresis" => Some("torque (rising or falling)"),
        "side_resistance" => Some("place and direction"),
        "thermostat" => Some("time (a cycle)"),
        _ => None,
    }
}

impl CaseOutcome {
    /// Returns the verdict; of two planted effects, that on the worse found.
    #[must_use]
    pub fn verdict(&self) -> Verdict {
        let planted = self.case.planted(0.0).into_iter();
        let verdicts = planted.map(|(effect, _)| self.verdict_of(effect));
        verdicts.max().unwrap_or(Verdict::Nothing)
    }

    fn verdict_of(&self, effect: &str) -> Verdict {
        let (findings, unexplained) = (&self.diagnosis.findings, &self.diagnosis.unexplained);
        let wanted = catalogue_name(effect);
        let is_named = match dependence(effect) {
            Some(words) => unexplained.iter().any(|u| u.depends_on.starts_with(words)),
            None if effect == CLEAN => findings.is_empty(),
            None => findings.iter().any(|f| f.adopted.effect.name == wanted),
        };
        if is_named {
            Verdict::Named
        } else if findings.iter().any(|f| f.group.contains(&wanted)) {
            Verdict::InGroup
        } else if findings.is_empty() && unexplained.is_empty() {
            Verdict::Nothing
        } else {
            Verdict::Other
        }
    }

    /// Returns what it finds beyond what is planted: adopted effects by name, and dependences in
    /// brackets.
    fn besides(&self) -> impl Iterator<Item = String> {
        let planted = || self.case.planted(0.0).into_iter().map(|(effect, _)| effect);
        let is_wanted = move |name: &str| planted().any(|effect| catalogue_name(effect) == name);
        let is_planted =
            move |words: &str| planted().any(|effect| dependence(effect) == Some(words));
        let findings = self.diagnosis.findings.iter();
        let adopted = findings
            .map(|finding| finding.adopted.effect.name)
            .filter(move |&name| !is_wanted(name))
            .map(str::to_owned);
        let unexplained = self.diagnosis.unexplained.iter();
        let dependences = unexplained
            .map(|rest| rest.depends_on.split(", ").next().unwrap_or_default())
            .filter(move |&words| !is_planted(words))
            .map(|words| format!("[{words}]"));
        adopted.chain(dependences)
    }
}

/// Diagnoses all cases on all processors, prints the confusion table and returns the outcomes in
/// the order of the cases. Calls `done` after each case.
///
/// # Errors
/// Returns the first error of a case.
pub fn table(
    cases: &[DiagnosisCase],
    done: impl Fn(&CaseOutcome) + Sync,
) -> Result<Vec<CaseOutcome>> {
    let outcomes: Vec<CaseOutcome> = cases
        .par_iter()
        .map(|case| case.outcome().inspect(&done))
        .collect::<Result<_>>()?;
    println!("{}", confusion(&outcomes));
    Ok(outcomes)
}

/// Row of the table: effect and size.
type RowKey<'a> = (&'a str, String);

/// Returns the outcomes of each effect and size, in the order of their first occurrence.
fn rows(outcomes: &[CaseOutcome]) -> Vec<(RowKey<'_>, Vec<&CaseOutcome>)> {
    let mut rows: Vec<(RowKey, Vec<&CaseOutcome>)> = Vec::new();
    for outcome in outcomes {
        let case = &outcome.case;
        let key = (case.effect.as_str(), format!("{}", case.size_percent));
        match rows.iter_mut().find(|(known, _)| *known == key) {
            Some((_, own)) => own.push(outcome),
            None => rows.push((key, vec![outcome])),
        }
    }
    rows
}

/// Returns the confusion table, its totals in words, and the errors of the filter.
#[must_use]
pub fn confusion(outcomes: &[CaseOutcome]) -> String {
    let found: Vec<Vec<String>> = rows(outcomes)
        .iter()
        .map(|(key, own)| {
            let mut row = vec![key.0.to_owned(), key.1.clone()];
            row.extend(TRUCKS.iter().flat_map(|truck| {
                let of_truck = own.iter().filter(|o| o.case.truck == *truck);
                cells(&of_truck.copied().collect::<Vec<_>>())
            }));
            row.push(all_besides(own));
            row
        })
        .collect();
    let header = [
        "effect",
        "size %",
        "A: n/g/o/-",
        "before %",
        "after %",
        "B: n/g/o/-",
        "before %",
        "after %",
        "besides",
    ];
    format!(
        "n named, g in the group of another, o something else only, - nothing; RMSE of the bare \
         model on runs held out; besides: adopted, or [unexplained], beyond what is planted\n{}\n{}\n\
         RMSE of the filter's grade on runs held out, all trucks: as believed, as diagnosed, and \
         where nothing is planted\n{}\n",
        text_table(&header, &found, 1),
        in_words(outcomes),
        filtered(outcomes)
    )
}

/// Returns the table of the filter's errors for each effect and size.
fn filtered(outcomes: &[CaseOutcome]) -> String {
    let rows: Vec<Vec<String>> = rows(outcomes)
        .iter()
        .map(|(key, own)| {
            let rms = |of: &dyn Fn(&CaseOutcome) -> f64| {
                let squares: f64 = own.iter().map(|outcome| of(outcome).powi(2)).sum();
                (squares / own.len() as f64).sqrt()
            };
            let mut row = vec![key.0.to_owned(), key.1.clone()];
            for value in [|e: &GradeErrors| e.smoothed, |e: &GradeErrors| e.live] {
                let [before, after, without] =
                    [0, 1, 2].map(|which| rms(&|outcome| value(&outcome.filtered[which])));
                row.extend([before, after, without].map(|error| format!("{error:.4}")));
                row.push(format!("{:+.1}", 100.0 * (after / before - 1.0)));
            }
            row
        })
        .collect();
    let header = [
        "effect",
        "size %",
        "smoothed: before",
        "after",
        "without",
        "change %",
        "live: before",
        "after",
        "without",
        "change %",
    ];
    text_table(&header, &rows, 1).to_string()
}

/// Returns the counts of verdicts, and the errors before and after.
fn cells(outcomes: &[&CaseOutcome]) -> [String; 3] {
    let count = |verdict| outcomes.iter().filter(|o| o.verdict() == verdict).count();
    let rms = |rmse_percent: fn(&Diagnosis) -> f64| {
        let squares = outcomes.iter().map(|o| rmse_percent(&o.diagnosis).powi(2));
        format!(
            "{:.3}",
            (squares.sum::<f64>() / outcomes.len() as f64).sqrt()
        )
    };
    if outcomes.is_empty() {
        return Default::default();
    }
    [
        format!(
            "{}/{}/{}/{}",
            count(Verdict::Named),
            count(Verdict::InGroup),
            count(Verdict::Other),
            count(Verdict::Nothing)
        ),
        rms(|diagnosis| diagnosis.before.rmse_percent),
        rms(|diagnosis| diagnosis.after.rmse_percent),
    ]
}

fn all_besides(outcomes: &[&CaseOutcome]) -> String {
    let mut counts: BTreeMap<String, usize> = BTreeMap::new();
    for name in outcomes.iter().flat_map(|outcome| outcome.besides()) {
        *counts.entry(name).or_default() += 1;
    }
    let words: Vec<String> = counts
        .iter()
        .map(|(name, count)| format!("{name} {count}"))
        .collect();
    words.join(", ")
}

fn in_words(outcomes: &[CaseOutcome]) -> String {
    let mut words = String::new();
    let mut share = |what: &str, is_of: &dyn Fn(&DiagnosisCase) -> bool, verdicts: &[Verdict]| {
        let own: Vec<&CaseOutcome> = outcomes.iter().filter(|o| is_of(&o.case)).collect();
        let right = own.iter().filter(|o| verdicts.contains(&o.verdict()));
        if !own.is_empty() {
            let _ = writeln!(words, "{what}: {} of {}", right.count(), own.len());
        }
    };
    let is_pair = |case: &DiagnosisCase| case.effect.contains('+');
    let in_catalogue = |case: &DiagnosisCase| {
        case.effect != CLEAN && dependence(&case.effect).is_none() && !is_pair(case)
    };
    share(
        "of the catalogue, named or in the group",
        &in_catalogue,
        &[Verdict::Named, Verdict::InGroup],
    );
    share(
        "pairs, both named or in a group",
        &is_pair,
        &[Verdict::Named, Verdict::InGroup],
    );
    share(
        "outside the catalogue, unexplained with the right dependence",
        &|case| dependence(&case.effect).is_some(),
        &[Verdict::Named],
    );
    share(
        "clean, something adopted",
        &|case| case.effect == CLEAN,
        &[Verdict::Other],
    );
    words
}
