//! Request and result of a diagnosis.

use super::dependence::Variable;
use super::judgement::Judgement;
use super::signal_judgement::SignalJudgement;
use crate::files::vehicle::VehicleFile;
use crate::report::page::Figure;
use crate::source::log_report::LogReport;
use crate::source::read_options::ReadOptions;
use estimator_core::{AdoptedEffect, Tuning};
use nalgebra::DMatrix;
use std::path::PathBuf;

/// Request for a diagnosis.
#[derive(Clone, Debug)]
pub struct Request {
    /// The vehicle with its assumed parameters.
    pub vehicle: VehicleFile,
    /// Logs to fit.
    pub logs: Vec<PathBuf>,
    /// Logs that are not fitted. If none is given, and at least three are to fit, the last of
    /// those.
    pub held_out: Vec<PathBuf>,
    /// Map as reference.
    pub reference: Option<PathBuf>,
    /// Folder of SRTM tiles, as another reference for before and after.
    pub terrain: Option<PathBuf>,
    /// Whether the longitudinal accelerometer is evidence beside the altitudes, and a judge. The
    /// estimates do not see it then.
    pub accelerometer: bool,
    /// Tuning of the estimator that reads the drives.
    pub tuning: Tuning,
    /// How to read the logs.
    pub options: ReadOptions,
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
    /// Pairs of effects that together the data cannot separate from it.
    pub pairs: Vec<[&'static str; 2]>,
    /// The amounts that were fitted, if the vehicle file has them only summed up.
    pub fitted: Option<FittedAmounts>,
}

/// Amounts that were fitted together: parts of a direction, or those of drives.
#[derive(Clone, Debug)]
pub struct FittedAmounts {
    /// What each belongs to.
    pub names: Vec<String>,
    /// The amounts, in the effect's unit.
    pub amounts: Vec<f64>,
    /// Their covariance.
    pub covariance: DMatrix<f64>,
}

/// Result for one candidate.
#[derive(Clone, Debug)]
pub struct CandidateCase {
    /// Name of the effect.
    pub name: &'static str,
    /// Estimate with it alone adopted.
    pub amount: f64,
    /// Standard deviation of the estimate.
    pub sigma: f64,
    /// Unit of both.
    pub unit: &'static str,
    /// Twice the logarithm of the Bayes factor against no effect.
    pub evidence: f64,
    /// Judgement with it alone adopted.
    pub after: Judgement,
}

/// A clear dependence that no effect explains.
#[derive(Clone, Debug)]
pub struct Unexplained {
    /// The variable that it depends on.
    pub depends_on: String,
    /// Its size, % grade.
    pub rms_percent: f64,
    /// Twice the logarithm of the Bayes factor.
    pub evidence: f64,
    /// The x variable of its plot.
    pub variable: Option<Variable>,
    /// The plot.
    pub figure: Option<Figure>,
}

/// Result of a diagnosis.
#[derive(Clone, Debug)]
pub struct Diagnosis {
    /// Adopted effects, in the order of adoption.
    pub findings: Vec<Finding>,
    /// Every candidate alone, the best first.
    pub candidates: Vec<CandidateCase>,
    /// Clear dependences that no effect explains.
    pub unexplained: Vec<Unexplained>,
    /// The bare model on the drives held out, before.
    pub before: Judgement,
    /// The bare model on the same drives, after.
    pub after: Judgement,
    /// The bare model against terrain, before and after, if that was asked for.
    pub terrain: Option<[Judgement; 2]>,
    /// Model and estimates against the accelerometer, before and after, if that was asked for.
    pub accelerometer: Option<[SignalJudgement; 2]>,
    /// Names of the logs that were judged.
    pub judged: Vec<PathBuf>,
    /// Whether these drives were also fitted, because no others exist.
    pub judged_on_fitted: bool,
    /// The vehicle file with the adopted effects.
    pub vehicle: VehicleFile,
    /// What the reading of each log told.
    pub logs: Vec<(PathBuf, LogReport)>,
}
