//! The whole diagnosis, from logs to result.

use super::findings::{CandidateCase, Diagnosis, Finding, Request};
use super::judge::Judge;
use super::picture;
use super::radius::Wheels;
use super::request_logs::RequestLogs;
use super::rivals::SelectionStep;
use super::search::EffectSearch;
use crate::error::Result;

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
    let mut judge = Judge::new(request, &logs, &logs.read(&found)?)?;
    let before = judge.judge(&request.vehicle.model)?;
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
    if !unexplained.is_empty() {
        let drives = logs.read(&vehicle.model)?;
        for (number, rest) in unexplained.iter_mut().enumerate() {
            let name = format!("unexplained_{}", number + 1);
            let (model, road) = (&vehicle.model, search.road.as_ref());
            rest.figure = rest.variable.map(|variable| {
                picture::picture(&name, variable, &drives, model, judge.references(), road)
            });
        }
    }
    let mut candidates: Vec<CandidateCase> = cases.into_iter().map(|(_, case)| case).collect();
    candidates.sort_by(|a, b| b.evidence.total_cmp(&a.evidence));
    Ok(Diagnosis {
        findings,
        candidates,
        unexplained,
        before: before.reference,
        after: after.reference,
        terrain: before.terrain.zip(after.terrain).map(<[_; 2]>::from),
        accelerometer: before
            .accelerometer
            .zip(after.accelerometer)
            .map(<[_; 2]>::from),
        judged: logs.paths[logs.judged.clone()].to_vec(),
        judged_on_fitted: logs.judged.start == 0,
        vehicle,
        logs: reports,
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
