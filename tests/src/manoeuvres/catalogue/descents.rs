//! Drives on other profiles: no fault, descents with brakes that are not reported, sharp crests.

use super::maker::{Maker, ONSET_M};
use crate::manoeuvres::drives::{BenchTruck, Plan};
use crate::manoeuvres::parts::{add_edit, retarder};
use crate::manoeuvres::road::Profile;
use crate::manoeuvres::signals::Edit;
use crate::manoeuvres::truth::When;
use host_sim::simulator::manoeuvre_file::Stop;

/// Returns the plans without a fault.
pub(super) fn without_fault(truck: BenchTruck, seed: u64) -> Vec<Plan> {
    let make = Maker(truck, seed);
    vec![
        make.plan("no fault", |_| {}),
        make.plan("no fault: mass not told", |plan| {
            plan.edits.push((When::Always, Edit::MassUntold));
        }),
        make.plan("no fault: stop of 60 s", |plan| {
            plan.stops.push(Stop::new(ONSET_M, 60.0));
        }),
        make.plan("no fault: retarder told, descent of 6 %", |plan| {
            plan.profiles.push(descent(6.0, 2_000.0));
            plan.sections.push(retarder());
        }),
    ]
}

/// Returns a descent at the onset: steepness in % and length in m.
fn descent(percent: f64, length_m: f64) -> Profile {
    Profile {
        from_m: ONSET_M,
        corners: vec![(0.0, -percent), (length_m, -percent)],
    }
}

/// Returns the plans with a fault.
pub(super) fn descents(truck: BenchTruck, seed: u64) -> Vec<Plan> {
    let make = Maker(truck, seed);
    let mut plans = Vec::new();
    for (percent, length_m) in [(5.0, 3_000.0), (6.0, 2_000.0), (8.0, 1_000.0)] {
        for with_retarder in [false, true] {
            let what = if with_retarder { "retarder" } else { "brakes" };
            let km = 1e-3 * length_m;
            let name = format!("{what} not told, {percent} % over {km} km");
            plans.push(make.plan(name, |plan| {
                plan.profiles.push(descent(percent, length_m));
                if with_retarder {
                    plan.sections.push(retarder());
                }
                plan.edits.push((When::Always, Edit::BrakesUntold));
                plan.faults.push(When::Way(ONSET_M, ONSET_M + length_m));
            }));
        }
    }
    for percent in [14.0, 17.0] {
        plans.push(
            make.plan(format!("crest of {percent} %, retarder told"), |plan| {
                let half = 0.5 * percent;
                plan.profiles.push(Profile {
                    from_m: ONSET_M,
                    corners: vec![(0.0, half), (300.0, half), (700.0, -half), (1_000.0, -half)],
                });
                plan.sections.push(retarder());
                plan.faults.push(When::Way(ONSET_M, ONSET_M + 1_000.0));
            }),
        );
    }
    plans.push(make.plan("anti-lock brakes at a stop", |plan| {
        plan.stops.push(Stop::new(ONSET_M, 30.0));
        add_edit(
            plan,
            When::Way(ONSET_M - 380.0, ONSET_M - 20.0),
            Edit::AntiLock,
        );
    }));
    plans
}
