//! From drives to what the vehicle model lacks: residual, effect, vehicle file, and the error before
//! and after on drives that were not used.
//!
//! * [`drive`]: a log as it is seen here, and where its cells lie on a common road;
//! * [`candidates`]: what is tried; [`evidence`]: what drives say about it; [`selection`]: what is
//!   adopted;
//! * [`radius`]: wheels, which show in speed and distance rather than in slope;
//! * [`judgement`]: the bare model against a reference, before and after;
//! * [`picture`]: what stays unexplained, drawn; [`report`]: report.json and the page.

pub mod candidates;
pub mod drive;
pub mod evidence;
pub mod judgement;
pub mod picture;
pub mod radius;
pub mod report;
pub mod selection;

use crate::error::{Error, Result};
use crate::map::MapRow;
use crate::report::page::Figure;
use crate::vehicle_file::VehicleFile;
use candidates::{Detail, Menu, Variable};
use drive::{CommonRoad, LoggedDrive};
use estimator_core::VehicleParameters;
use estimator_core::effect::{Adopted, Effect};
use evidence::{Evidence, WINDS_MPS, judging_tuning, stretches};
use judgement::{Judgement, judge};
use radius::Wheels;
use rayon::prelude::*;
use selection::{Case, Selection, Selector, Step};
use std::collections::BTreeSet;
use std::path::PathBuf;

/// Part of the error at which one effect does clearly better than another.
const CLEARLY: f64 = 0.9;

/// What is to be diagnosed.
#[derive(Clone, Debug)]
pub struct Request {
    /// The vehicle as it is believed.
    pub vehicle: VehicleFile,
    /// Logs to fit.
    pub logs: Vec<PathBuf>,
    /// Logs that are not used to fit. With none, and at least three to fit, the last of those.
    pub held_out: Vec<PathBuf>,
    /// Grade to judge by.
    pub reference: Option<Vec<MapRow>>,
}

/// An effect that was adopted.
#[derive(Clone, Debug)]
pub struct Finding {
    /// The effect, with amount, sigma and details.
    pub adopted: Adopted,
    /// Twice the logarithm of its Bayes factor.
    pub evidence: f64,
    /// Effects that the data cannot tell from it.
    pub group: Vec<&'static str>,
}

/// One candidate's case.
#[derive(Clone, Debug)]
pub struct CandidateCase {
    /// Name of the effect.
    pub name: &'static str,
    /// Estimate if it alone were adopted, and its sigma.
    pub amount: f64,
    pub sigma: f64,
    /// Unit of both.
    pub unit: &'static str,
    /// Twice the logarithm of the Bayes factor against nothing.
    pub evidence: f64,
    /// Judged with it alone.
    pub after: Judgement,
}

/// What is left that no effect explains.
#[derive(Clone, Debug)]
pub struct Unexplained {
    /// What it depends on.
    pub depends_on: String,
    /// Its size, % grade.
    pub rms_percent: f64,
    /// Twice the logarithm of the Bayes factor.
    pub evidence: f64,
    /// What it is drawn over.
    pub variable: Option<Variable>,
    /// The picture.
    pub figure: Option<Figure>,
}

/// All that was found.
#[derive(Clone, Debug)]
pub struct Diagnosis {
    /// Adopted, in the order of adoption.
    pub findings: Vec<Finding>,
    /// Every candidate alone, the best first.
    pub candidates: Vec<CandidateCase>,
    /// Clear dependences that no effect explains.
    pub unexplained: Vec<Unexplained>,
    /// The bare model on the drives held out, before and after.
    pub before: Judgement,
    pub after: Judgement,
    /// Whether these drives were used to fit as well, for want of others.
    pub judged_on_fitted: bool,
    /// What the vehicle file becomes.
    pub vehicle: VehicleFile,
}

/// Diagnoses.
///
/// # Errors
/// Logs that cannot be read, with file and line, or are given twice; an impossible vehicle.
pub fn diagnose(request: &Request) -> Result<Diagnosis> {
    let mut fit = request.logs.clone();
    let mut held_out = request.held_out.clone();
    if held_out.is_empty() && fit.len() >= 3 {
        held_out.extend(fit.pop());
    }
    let judged_on_fitted = held_out.is_empty();
    let mut seen = BTreeSet::new();
    if let Some(twice) = fit.iter().chain(&held_out).find(|path| !seen.insert(*path)) {
        return Err(Error::content(
            twice,
            "given twice; expected each drive once, to fit or held out".to_owned(),
        ));
    }
    let paths: Vec<PathBuf> = fit.iter().chain(&held_out).cloned().collect();
    let read = |vehicle: &VehicleParameters| -> Result<Vec<LoggedDrive>> {
        let read = |path: &PathBuf| LoggedDrive::read(path, vehicle);
        paths.par_iter().map(read).collect()
    };
    let mut vehicle = request.vehicle.clone();
    let mut findings = Vec::new();

    let mut drives = read(&vehicle.parameters)?;
    let wheels = Wheels::measured(&drives[..fit.len()]);
    if let Some(finding) = wheels.as_ref().and_then(Wheels::finding) {
        // The others are looked for with the right speeds and distances.
        let _ = vehicle.parameters.effects.adopt(finding.adopted);
        findings.push(finding);
        drives = read(&vehicle.parameters)?;
    }
    let with_wheels = vehicle.parameters.clone();
    let work = Work::new(&drives, fit.len(), &with_wheels);
    let (evidence, selection) = work.evidence();
    let judged = if judged_on_fitted {
        0..fit.len()
    } else {
        fit.len()..paths.len()
    };
    // The reference is estimated with what was found first, whatever is adopted in the end.
    let found = work.vehicle_with(&vehicle, &selection);
    let references = judgement::references(&read(&found.parameters)?, request.reference.as_deref());
    let judged_with = |vehicle: &VehicleParameters| -> Result<Judgement> {
        let read = |path: &PathBuf| LoggedDrive::read(path, vehicle);
        let drives: Vec<LoggedDrive> = paths[judged.clone()]
            .par_iter()
            .map(read)
            .collect::<Result<_>>()?;
        Ok(judge(&drives, vehicle, &references[judged.clone()]))
    };
    let before = judged_with(&request.vehicle.parameters)?;
    let alone = |case: &Case| -> Result<Option<CandidateCase>> {
        let Some(adopted) = work.adopted(case) else {
            return Ok(None);
        };
        let mut with = vehicle.parameters.clone();
        let possible = with.effects.adopt(adopted).is_ok() && with.check().is_ok();
        Ok(Some(CandidateCase {
            name: adopted.effect.name,
            amount: f64::from(adopted.amount),
            sigma: f64::from(adopted.amount_sigma),
            unit: adopted.effect.unit,
            evidence: case.evidence,
            after: if possible {
                judged_with(&with)?
            } else {
                before.clone()
            },
        }))
    };
    // Each with the case that it is of.
    let mut cases: Vec<(usize, CandidateCase)> = Vec::new();
    for case in &selection.alone {
        cases.extend(alone(case)?.map(|alone| (case.candidate, alone)));
    }
    let selection = match selection.steps.first().and_then(|step| lead(step, &cases)) {
        Some(first) => work.select(&evidence, Some(first)),
        None => selection,
    };
    let mut unexplained = Vec::new();
    for step in &selection.steps {
        match work.adopted(&step.adopted) {
            Some(adopted) => findings.push(Finding {
                adopted,
                evidence: step.adopted.evidence,
                group: work.names(&step.group),
            }),
            None => unexplained.push(work.unexplained(&step.adopted)),
        }
    }
    let vehicle = work.vehicle_with(&vehicle, &selection);
    let after = judged_with(&vehicle.parameters)?;
    if !unexplained.is_empty() {
        let drives = read(&vehicle.parameters)?;
        for (number, rest) in unexplained.iter_mut().enumerate() {
            let name = format!("unexplained_{}", number + 1);
            let road = work.road.as_ref();
            rest.figure = rest.variable.map(|variable| {
                let vehicle = &vehicle.parameters;
                picture::picture(&name, variable, &drives, vehicle, &references, road)
            });
        }
    }
    let mut candidates: Vec<CandidateCase> = cases.into_iter().map(|(_, case)| case).collect();
    if let Some(wheels) = &wheels {
        candidates.push(wheels.case(&before));
    }
    candidates.sort_by(|a, b| b.evidence.total_cmp(&a.evidence));
    Ok(Diagnosis {
        findings,
        candidates,
        unexplained,
        before,
        after,
        judged_on_fitted,
        vehicle,
    })
}

/// Which of a group that the evidence cannot tell apart does clearly best on the drives judged, if
/// it is not the one adopted.
fn lead(step: &Step, cases: &[(usize, CandidateCase)]) -> Option<usize> {
    let rmse = |candidate: usize| {
        let mut own = cases.iter().filter(|(of, _)| *of == candidate);
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

/// Drives with their menu.
struct Work<'a> {
    drives: &'a [LoggedDrive],
    fitted: usize,
    vehicle: &'a VehicleParameters,
    road: Option<CommonRoad>,
    menu: Menu,
}

impl<'a> Work<'a> {
    fn new(drives: &'a [LoggedDrive], fitted: usize, vehicle: &'a VehicleParameters) -> Self {
        let road = CommonRoad::of(&drives.iter().collect::<Vec<_>>());
        let numbers: Vec<usize> = (0..fitted).collect();
        let menu = Menu::new(road.as_ref().map(CommonRoad::length_m), &numbers);
        Self {
            drives,
            fitted,
            vehicle,
            road,
            menu,
        }
    }

    /// What the drives say, with the wind that makes them most likely, and what that asks for.
    fn evidence(&self) -> (Evidence, Selection) {
        let columns: Vec<Vec<evidence::Column>> = self
            .drives
            .par_iter()
            .enumerate()
            .map(|(number, drive)| {
                let places = self.road.as_ref().map(|road| road.places(drive));
                self.menu
                    .columns(self.vehicle, number, drive, places.as_deref())
            })
            .collect();
        let mut best: Option<(Evidence, Selection)> = None;
        // One after the other: the sums of a fleet's drives are large.
        for wind_mps in WINDS_MPS {
            let tuning = judging_tuning(wind_mps);
            let drives: Vec<_> = self.drives.iter().zip(&columns).enumerate().collect();
            let evidence: Evidence = drives
                .into_par_iter()
                .map(|(number, (drive, columns))| {
                    stretches(number, drive, self.vehicle, &tuning, columns)
                })
                .collect::<Vec<_>>()
                .into_iter()
                .flatten()
                .collect();
            let selection = self.select(&evidence, None);
            let is_better = |(_, best): &(_, Selection)| selection.surprise < best.surprise;
            if best.as_ref().is_none_or(is_better) {
                best = Some((evidence, selection));
            }
        }
        best.unwrap_or_default()
    }

    fn select(&self, evidence: &Evidence, first: Option<usize>) -> Selection {
        Selector::new(&self.menu, evidence, |drive| drive >= self.fitted).select(first)
    }

    /// The vehicle with all effects of a selection.
    fn vehicle_with(&self, vehicle: &VehicleFile, selection: &Selection) -> VehicleFile {
        let mut vehicle = vehicle.clone();
        for step in &selection.steps {
            if let Some(adopted) = self.adopted(&step.adopted) {
                let _ = vehicle.parameters.effects.adopt(adopted);
            }
        }
        vehicle
    }

    fn names(&self, group: &[Case]) -> Vec<&'static str> {
        let name = |case: &Case| self.menu.candidates[case.candidate].name;
        group.iter().map(name).collect()
    }

    /// The effect of a case, ready for a vehicle file; none for a plain dependence.
    fn adopted(&self, case: &Case) -> Option<Adopted> {
        let candidate = &self.menu.candidates[case.candidate];
        let effect: &'static Effect = candidate.effect?;
        let (amount, sigma) = (case.amounts[0] as f32, case.sigmas[0] as f32);
        let mut adopted = Adopted::new(effect, amount, sigma);
        match candidate.choices[case.choice].detail {
            Detail::None | Detail::Period(_) => {}
            Detail::Fan(with_fan) => {
                let _ = adopted.set("with_fan", with_fan);
            }
            Detail::Time(time_s) => {
                // How cold they are differs from drive to drive, and the next one is not known.
                let count = case.amounts.len() as f64;
                let mean = case.amounts.iter().sum::<f64>() / count;
                let between = case.amounts.iter().map(|a| (a - mean).powi(2)).sum::<f64>() / count;
                let own = case.sigmas.iter().map(|s| s * s).sum::<f64>() / count;
                adopted = Adopted::new(effect, mean.max(0.0) as f32, (between + own).sqrt() as f32);
                let _ = adopted.set("time_s", time_s);
            }
            Detail::Compass => {
                let (north, east) = (case.amounts[0], case.amounts[1]);
                let speed = north.hypot(east);
                let along = |n: f64, e: f64| (n * north + e * east) / speed.max(1e-9);
                let sigma = along(case.sigmas[0], 0.0).hypot(along(0.0, case.sigmas[1]));
                adopted = Adopted::new(effect, speed as f32, sigma as f32);
                let _ = adopted.set(
                    "from_deg",
                    east.atan2(north).to_degrees().rem_euclid(360.0) as f32,
                );
            }
            Detail::Stretch(from_m, to_m) => {
                if let Some(road) = &self.road {
                    let (latitude, longitude) = road.position_at(0.5 * (from_m + to_m));
                    let _ = adopted.set("latitude_deg", latitude as f32);
                    let _ = adopted.set("longitude_deg", longitude as f32);
                    let _ = adopted.set("length_m", (to_m - from_m) as f32);
                }
            }
        }
        Some(adopted)
    }

    fn unexplained(&self, case: &Case) -> Unexplained {
        let candidate = &self.menu.candidates[case.candidate];
        let size = case.amounts.iter().map(|a| a * a).sum::<f64>().sqrt();
        let (where_or_when, rms_percent) = match candidate.choices[case.choice].detail {
            Detail::Period(period_s) => (
                format!(", period {period_s:.0} s"),
                0.1 * size / 2f64.sqrt(),
            ),
            Detail::Stretch(from_m, to_m) => (
                format!(", km {:.1} to {:.1}", from_m * 1e-3, to_m * 1e-3),
                100.0 * size,
            ),
            _ => (
                String::new(),
                0.1 * size / (case.amounts.len() as f64).sqrt(),
            ),
        };
        Unexplained {
            depends_on: format!("{}{where_or_when}", candidate.name),
            rms_percent,
            evidence: case.evidence,
            variable: self.menu.variable(&candidate.choices[case.choice]),
            figure: None,
        }
    }
}
