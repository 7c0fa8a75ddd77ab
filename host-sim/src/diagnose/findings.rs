//! Request and result of a diagnosis.

use super::dependence::Variable;
use super::judgement::Judgement;
use crate::files::vehicle::VehicleFile;
use crate::report::page::Figure;
use estimator_core::{AdoptedEffect, Tuning};
use std::path::PathBuf;

/// What is to be diagnosed.
#[derive(Clone, Debug)]
pub struct Request {
    /// The vehicle as it is believed.
    pub vehicle: VehicleFile,
    /// Logs to fit.
    pub logs: Vec<PathBuf>,
    /// Logs that are not used to fit. With none, and at least three to fit, the last of those.
    pub held_out: Vec<PathBuf>,
    /// Map to judge by.
    pub reference: Option<PathBuf>,
    /// Tuning of the estimator that reads the drives.
    pub tuning: Tuning,
}

/// An effect that was adopted.
#[derive(Clone, Debug)]
pub struct Finding {
    /// The effect, with amount, sigma and details.
    pub adopted: AdoptedEffect,
    /// Twice the logarithm of its Bayes factor.
    pub evidence: f64,
    /// Effects that the data cannot separate from it.
    pub group: Vec<&'static str>,
}

/// One candidate's case.
#[derive(Clone, Debug)]
pub struct CandidateCase {
    /// Name of the effect.
    pub name: &'static str,
    /// Estimate if it alone were adopted, and its sigma.
    pub amount: f64,
    /// Standard deviation of the estimate.
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
    /// Adopted effects, in the order of adoption.
    pub findings: Vec<Finding>,
    /// Every candidate alone, the best first.
    pub candidates: Vec<CandidateCase>,
    /// Clear dependences that no effect explains.
    pub unexplained: Vec<Unexplained>,
    /// The bare model on the drives held out, before and after.
    pub before: Judgement,
    /// The bare model on the same drives, after.
    pub after: Judgement,
    /// Whether these drives were used to fit as well, for want of others.
    pub judged_on_fitted: bool,
    /// What the vehicle file becomes.
    pub vehicle: VehicleFile,
}
