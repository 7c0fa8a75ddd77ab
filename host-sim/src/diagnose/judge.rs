//! Before and after: a vehicle's model on the drives that are judged, against all that was asked for.

use super::drive::LoggedDrive;
use super::findings::{CandidateCase, Request};
use super::judgement::{self, Judgement, ReferenceGrades, judge};
use super::request_logs::RequestLogs;
use super::signal_judgement::SignalJudgement;
use super::terrain_reference::references_by_terrain;
use crate::error::{Error, Result};
use crate::map::read_map;
use crate::source::terrain::Terrain;
use estimator_core::{AdoptedEffect, Model};
use std::path::PathBuf;

/// A model against everything that was asked for.
pub(super) struct Judgements {
    /// Against the reference.
    pub(super) reference: Judgement,
    /// Against a terrain model.
    pub(super) terrain: Option<Judgement>,
    /// Against the accelerometers of the drives.
    pub(super) accelerometer: Option<SignalJudgement>,
}

/// What models are judged by.
pub(super) struct Judge<'a> {
    logs: &'a RequestLogs,
    /// References of all drives.
    references: Vec<ReferenceGrades>,
    terrain: Option<Terrain>,
    accelerometer: bool,
}

impl<'a> Judge<'a> {
    /// Takes the references from the request's map, or from these drives.
    ///
    /// # Errors
    /// Returns an error if the map cannot be read or is of another road.
    pub(super) fn new(
        request: &Request,
        logs: &'a RequestLogs,
        drives: &[LoggedDrive],
    ) -> Result<Self> {
        Ok(Self {
            logs,
            references: references(drives, request.reference.as_ref())?,
            terrain: request.terrain.as_deref().map(Terrain::new),
            accelerometer: request.accelerometer,
        })
    }

    /// Returns the references of all drives.
    pub(super) fn references(&self) -> &[ReferenceGrades] {
        &self.references
    }

    /// Judges a model by everything.
    ///
    /// # Errors
    /// Returns an error if a log or the terrain cannot be read.
    pub(super) fn judge(&mut self, model: &Model) -> Result<Judgements> {
        let drives = self.logs.read_judged(model)?;
        let by_terrain = self.terrain.as_mut().map(|terrain| {
            let references = references_by_terrain(&drives, terrain)?;
            Ok(judge(&drives, model, &references))
        });
        let is_sensed = self.accelerometer;
        Ok(Judgements {
            reference: self.against_reference(&drives, model),
            terrain: by_terrain.transpose()?,
            accelerometer: is_sensed.then(|| SignalJudgement::of(&drives, model)),
        })
    }

    /// Judges one effect that is added to a model, by the reference. The model is judged without the
    /// effect if it cannot have it.
    ///
    /// # Errors
    /// Returns an error if a log cannot be read.
    pub(super) fn alone(
        &self,
        model: &Model,
        adopted: AdoptedEffect,
        evidence: f64,
    ) -> Result<CandidateCase> {
        let mut with = model.clone();
        let possible = with.effects.adopt(adopted).is_ok() && with.check().is_ok();
        let judged = if possible { &with } else { model };
        let drives = self.logs.read_judged(judged)?;
        Ok(CandidateCase {
            name: adopted.effect.name,
            amount: f64::from(adopted.amount),
            sigma: f64::from(adopted.amount_sigma),
            unit: adopted.effect.unit,
            evidence,
            after: self.against_reference(&drives, judged),
        })
    }

    fn against_reference(&self, drives: &[LoggedDrive], model: &Model) -> Judgement {
        judge(drives, model, &self.references[self.logs.judged.clone()])
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
