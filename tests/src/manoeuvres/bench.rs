//! Drives through the estimator, two at a time, and their judgements.

use super::cells::compare;
use super::drives::{BenchTruck, Plan};
use super::judge::{Judgement, Reference};
use super::road::BenchRoad;
use crate::faults::outcome::estimated;
use host_sim::error::Result;
use rayon::prelude::*;
use std::collections::{BTreeMap, BTreeSet};

/// Name of the drive that others are compared with.
const REFERENCE: &str = "no fault";

/// A plan and what came of it.
#[derive(Clone, Debug)]
pub struct BenchRow {
    /// What happened.
    pub plan: Plan,
    /// The judgement, or why there is none.
    pub judgement: std::result::Result<Judgement, String>,
}

/// Drives all plans and judges them. Drives without a fault on the same stretches are made for
/// comparison.
#[must_use]
pub fn bench(road: &BenchRoad, plans: Vec<Plan>, done: impl Fn() + Sync) -> Vec<BenchRow> {
    let drives: BTreeSet<(BenchTruck, u64)> =
        plans.iter().map(|plan| (plan.truck, plan.seed)).collect();
    let references: BTreeMap<_, Reference> = drives
        .into_par_iter()
        .filter_map(|(truck, seed)| {
            let plan = Plan::new(REFERENCE, truck, seed);
            let judgement = judged(road, &plan, None).ok()?;
            Some(((truck, seed), judgement.reference()))
        })
        .collect();
    plans
        .into_par_iter()
        .map(|plan| {
            let reference = references.get(&(plan.truck, plan.seed));
            let judgement = judged(road, &plan, reference).map_err(|error| error.to_string());
            done();
            BenchRow { plan, judgement }
        })
        .collect()
}

fn judged(road: &BenchRoad, plan: &Plan, reference: Option<&Reference>) -> Result<Judgement> {
    let driven = plan.driven(&road.road)?;
    let run = estimated::<f32>(&driven.vehicle.model, driven.received(plan));
    let cells = compare(plan, &driven, &run.rows);
    Ok(Judgement::new(&cells, !plan.faults.is_empty(), reference))
}
