//! The whole diagnosis, from logs to result.

use super::drive::LoggedDrive;
use super::findings::{CandidateCase, Diagnosis, Finding, Request};
use super::judgement::{self, Judgement, ReferenceGrades, judge};
use super::picture;
use super::radius::Wheels;
use super::rivals::SelectionStep;
use super::search::EffectSearch;
use super::signal_judgement::SignalJudgement;
use super::terrain_reference::references_by_terrain;
use crate::error::{Error, Result, on_one_line};
use crate::files::run::{RunCell, RunIdentity};
use crate::map::read_map;
use crate::source::read_options::ReadOptions;
use crate::source::terrain::Terrain;
use estimator_core::{AdoptedEffect, Model, Signal, Tuning};
use rayon::prelude::*;
use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;
use std::path::PathBuf;

/// An effect is clearly better than another if its error is below this fraction of the other's.
const CLEARLY: f64 = 0.9;

/// Runs a diagnosis.
///
/// # Errors
/// Returns an error, with file and line, if a log cannot be read or is given twice; if the vehicle
/// is impossible; or if the reference cannot be read or is of another road.
pub fn diagnose(request: &Request) -> Result<Diagnosis> {
    let logs = RequestLogs::of(request)?;
    let mut vehicle = request.vehicle.clone();
    let mut findings = Vec::new();
    let mut drives = logs.read(&vehicle.model)?;
    logs.check_copies(&drives)?;
    logs.check_accelerometer(&drives)?;
    let reports = drives.iter().map(|drive| drive.log.clone());
    let reports = logs.paths.iter().cloned().zip(reports).collect();
    let wheels = Wheels::measured(&drives[..logs.fitted]);
    if let Some(finding) = wheels.as_ref().and_then(Wheels::finding) {
        // The search for other effects uses the corrected speeds and distances.
        let _ = vehicle.model.effects.adopt(finding.adopted);
        findings.push(finding);
        drives = logs.read(&vehicle.model)?;
    }
    let with_wheels = vehicle.model.clone();
    let search = EffectSearch::new(&drives, logs.fitted, &with_wheels, &request.tuning);
    let (evidence, selection) = search.evidence();
    // The reference is estimated with the first selection, whatever is adopted in the end.
    let found = search.vehicle_with(&vehicle, &selection).model;
    let judge = Judge {
        references: references(&logs.read(&found)?, request.reference.as_ref())?,
        logs: &logs,
    };
    let before = judge.judge(&request.vehicle.model)?;
    let beside = Beside::new(request, &logs);
    // Each case with the index of its candidate.
    let mut cases: Vec<(Option<usize>, CandidateCase)> = Vec::new();
    for case in &selection.alone {
        if let Some(adopted) = search.adopted(case) {
            let alone = judge.alone(&with_wheels, adopted, case.evidence)?;
            cases.push((Some(case.candidate), alone));
        }
    }
    if let Some(wheels) = &wheels {
        let (bare, adopted) = (&request.vehicle.model, wheels.adopted());
        cases.push((None, judge.alone(bare, adopted, wheels.evidence())?));
    }
    let selection = match selection.steps.first().and_then(|step| lead(step, &cases)) {
        Some(first) => search.select(&evidence, Some(first)),
        None => selection,
    };
    let mut unexplained = Vec::new();
    for step in &selection.steps {
        match search.adopted(&step.adopted) {
            Some(adopted) => findings.push(Finding {
                adopted,
                evidence: step.adopted.evidence,
                group: search.names(step),
                pairs: search.pairs(step),
                fitted: search.amounts(&step.adopted),
            }),
            None => unexplained.push(search.unexplained(&step.adopted)),
        }
    }
    let vehicle = search.vehicle_with(&vehicle, &selection);
    let after = judge.judge(&vehicle.model)?;
    let models = [&request.vehicle.model, &vehicle.model];
    if !unexplained.is_empty() {
        let drives = logs.read(&vehicle.model)?;
        for (number, rest) in unexplained.iter_mut().enumerate() {
            let name = format!("unexplained_{}", number + 1);
            let (model, road) = (&vehicle.model, search.road.as_ref());
            rest.figure = rest.variable.map(|variable| {
                picture::picture(&name, variable, &drives, model, &judge.references, road)
            });
        }
    }
    let mut candidates: Vec<CandidateCase> = cases.into_iter().map(|(_, case)| case).collect();
    candidates.sort_by(|a, b| b.evidence.total_cmp(&a.evidence));
    Ok(Diagnosis {
        findings,
        candidates,
        unexplained,
        before,
        after,
        terrain: beside.terrain(models)?,
        accelerometer: beside.accelerometer(models)?,
        judged: logs.paths[logs.judged.clone()].to_vec(),
        judged_on_fitted: logs.judged.start == 0,
        vehicle,
        logs: reports,
    })
}

/// The logs of a request. Those to fit are first.
struct RequestLogs {
    paths: Vec<PathBuf>,
    fitted: usize,
    /// Indices of the logs on which before and after are judged.
    judged: Range<usize>,
    tuning: Tuning,
    options: ReadOptions,
    accelerometer: bool,
}

impl RequestLogs {
    fn of(request: &Request) -> Result<Self> {
        let mut paths = request.logs.clone();
        let held_out = match request.held_out.len() {
            0 => usize::from(paths.len() >= 3),
            given => given,
        };
        paths.extend_from_slice(&request.held_out);
        let mut seen = BTreeSet::new();
        if let Some(twice) = paths.iter().find(|path| !seen.insert(*path)) {
            return Err(Error::content(
                twice,
                "given twice; expected each drive once, to fit or held out".to_owned(),
            ));
        }
        let fitted = paths.len() - held_out;
        let judged = if held_out > 0 { fitted } else { 0 }..paths.len();
        Ok(Self {
            paths,
            fitted,
            judged,
            tuning: request.tuning.clone(),
            options: request.options.clone(),
            accelerometer: request.accelerometer,
        })
    }

    /// Returns an error if two logs have the same drive: a copy that is held out would confirm what
    /// was fitted to it. Cells are compared, so another name, format or compression does not matter.
    fn check_copies(&self, drives: &[LoggedDrive]) -> Result<()> {
        let mut seen = BTreeMap::new();
        for (path, drive) in self.paths.iter().zip(drives) {
            let identity = RunIdentity::of(drive.run.rows.iter().map(RunCell::from));
            if let Some(first) = seen.insert(identity, path) {
                let first = on_one_line(first);
                let problem = format!(
                    "the same drive as {first}; expected each drive once, to fit or held out"
                );
                return Err(Error::content(path, problem));
            }
        }
        Ok(())
    }

    /// Returns an error if the accelerometer is asked for and no drive has one.
    fn check_accelerometer(&self, drives: &[LoggedDrive]) -> Result<()> {
        let has_one = |drive: &LoggedDrive| drive.accelerometer.is_some();
        if !self.accelerometer || drives[..self.fitted].iter().any(has_one) {
            return Ok(());
        }
        let problem = format!(
            "no {} in it, nor in other drives to fit; expected a log of an accelerometer",
            Signal::LongitudinalAcceleration.column()
        );
        Err(Error::content(&self.paths[0], problem))
    }

    fn read(&self, model: &Model) -> Result<Vec<LoggedDrive>> {
        self.read_each(&self.paths, model)
    }

    fn read_judged(&self, model: &Model) -> Result<Vec<LoggedDrive>> {
        self.read_each(&self.paths[self.judged.clone()], model)
    }

    fn read_each(&self, paths: &[PathBuf], model: &Model) -> Result<Vec<LoggedDrive>> {
        let read = |path: &PathBuf| {
            let (tuning, options) = (&self.tuning, &self.options);
            if self.accelerometer {
                LoggedDrive::read_with_accelerometer(path, model, tuning, options)
            } else {
                LoggedDrive::read(path, model, tuning, options)
            }
        };
        paths.par_iter().map(read).collect()
    }
}

/// The references and the drives on which vehicles are judged.
struct Judge<'a> {
    logs: &'a RequestLogs,
    /// References of all drives.
    references: Vec<ReferenceGrades>,
}

impl Judge<'_> {
    fn judge(&self, model: &Model) -> Result<Judgement> {
        let drives = self.logs.read_judged(model)?;
        let references = &self.references[self.logs.judged.clone()];
        Ok(judge(&drives, model, references))
    }

    /// Returns the case of one effect added to a vehicle. The vehicle is judged without the effect
    /// if it cannot have it.
    fn alone(&self, model: &Model, adopted: AdoptedEffect, evidence: f64) -> Result<CandidateCase> {
        let mut with = model.clone();
        let possible = with.effects.adopt(adopted).is_ok() && with.check().is_ok();
        Ok(CandidateCase {
            name: adopted.effect.name,
            amount: f64::from(adopted.amount),
            sigma: f64::from(adopted.amount_sigma),
            unit: adopted.effect.unit,
            evidence,
            after: self.judge(if possible { &with } else { model })?,
        })
    }
}

/// Judges beside the reference, where asked for.
struct Beside<'a> {
    request: &'a Request,
    logs: &'a RequestLogs,
}

impl<'a> Beside<'a> {
    const fn new(request: &'a Request, logs: &'a RequestLogs) -> Self {
        Self { request, logs }
    }

    fn terrain(&self, [before, after]: [&Model; 2]) -> Result<Option<[Judgement; 2]>> {
        let Some(folder) = &self.request.terrain else {
            return Ok(None);
        };
        let mut terrain = Terrain::new(folder);
        let mut against = |model| {
            let drives = self.logs.read_judged(model)?;
            let references = references_by_terrain(&drives, &mut terrain)?;
            Ok(judge(&drives, model, &references))
        };
        Ok(Some([against(before)?, against(after)?]))
    }

    fn accelerometer(&self, [before, after]: [&Model; 2]) -> Result<Option<[SignalJudgement; 2]>> {
        if !self.request.accelerometer {
            return Ok(None);
        }
        let against = |model| Ok(SignalJudgement::of(&self.logs.read_judged(model)?, model));
        Ok(Some([against(before)?, against(after)?]))
    }
}

/// Returns the reference of each drive, from a map if one is given.
fn references(drives: &[LoggedDrive], map: Option<&PathBuf>) -> Result<Vec<ReferenceGrades>> {
    let Some(path) = map else {
        return Ok(judgement::references(drives));
    };
    judgement::references_by_map(drives, &read_map(path)?).ok_or_else(|| {
        let problem = "no drive is on this road; expected a map of the road that was driven";
        Error::content(path, problem.to_owned())
    })
}

/// Returns the candidate with a clearly smaller error on the judged drives, among those that the
/// evidence cannot separate; `None` if it is the adopted one.
fn lead(step: &SelectionStep, cases: &[(Option<usize>, CandidateCase)]) -> Option<usize> {
    let rmse = |candidate: usize| {
        let mut own = cases.iter().filter(|(of, _)| *of == Some(candidate));
        own.next().map(|(_, case)| case.after.rmse_percent)
    };
    let adopted = rmse(step.adopted.candidate)?;
    step.group
        .iter()
        .filter_map(|case| Some((case.candidate, rmse(case.candidate)?)))
        .filter(|(_, rmse)| *rmse < CLEARLY * adopted)
        .min_by(|a, b| a.1.total_cmp(&b.1))
        .map(|(candidate, _)| candidate)
}
