//! Drives through the estimator, two at a time, and their judgements.

use super::cells::compare;
use super::drives::Plan;
use super::judge::{Judgement, Reference};
use super::road::BenchRoad;
use crate::faults::outcome::estimated;
use host_sim::error::Result;
use rayon::prelude::*;
use std::collections::BTreeMap;

/// A plan and what came of it.
#[derive(Clone, Debug)]
pub struct BenchRow {
    /// What happened.
    pub plan: Plan,
    /// The judgement, or why there is none.
    pub judgement: std::result::Result<Judgement, String>,
}

/// Drives all plans and judges them, each beside the same drive without what is at fault.
#[must_use]
pub fn bench(road: &BenchRoad, plans: Vec<Plan>, done: impl Fn() + Sync) -> Vec<BenchRow> {
    let references: BTreeMap<String, Plan> = plans
        .iter()
        .map(|plan| (key(&plan.faultless()), plan.faultless()))
        .collect();
    let references: BTreeMap<String, Reference> = references
        .into_par_iter()
        .filter_map(|(key, plan)| Some((key, judged(road, &plan, None).ok()?.reference())))
        .collect();
    plans
        .into_par_iter()
        .map(|plan| {
            let reference = references.get(&key(&plan.faultless()));
            let judgement = judged(road, &plan, reference).map_err(|error| error.to_string());
            done();
            BenchRow { plan, judgement }
        })
        .collect()
}

/// Returns what distinguishes a drive from others.
fn key(plan: &Plan) -> String {
    format!("{plan:?}")
}

fn judged(road: &BenchRoad, plan: &Plan, reference: Option<&Reference>) -> Result<Judgement> {
    let driven = plan.driven(&road.road)?;
    let run = estimated::<f32>(&driven.vehicle.model, driven.received(&plan.edits));
    let cells = compare(plan, &driven, &run.rows);
    Ok(Judgement::new(&cells, !plan.faults.is_empty(), reference))
}
