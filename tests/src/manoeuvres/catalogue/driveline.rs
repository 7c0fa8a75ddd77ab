//! Driveline and torque: a wrong gear, a power take-off, a low range, slip, and how torque is
//! reported.

use super::maker::{Maker, ONSET_M};
use crate::manoeuvres::drives::{BenchTruck, Plan};
use crate::manoeuvres::parts::{END_M, add_edit, add_section};
use crate::manoeuvres::road::Profile;
use crate::manoeuvres::signals::Edit;
use crate::manoeuvres::truth::When;
use host_sim::simulator::manoeuvre_file::{Section, Stop};

/// Returns the plans of the driveline.
pub(super) fn driveline(truck: BenchTruck, seed: u64) -> Vec<Plan> {
    let make = Maker(truck, seed);
    let mut plans = Vec::new();
    for off in [-1, 1, -2] {
        for seconds in [60.0, 120.0, 300.0] {
            let name = format!("gear {off:+} told for {seconds} s");
            plans.push(make.plan(name, |plan| {
                plan.edits.push((When::Always, Edit::RatioUntold));
                add_edit(plan, When::Seconds(ONSET_M, seconds), Edit::GearOff(off));
            }));
        }
    }
    plans.push(make.section(
        "power take-off of 300 Nm",
        Section {
            pto_nm: 300.0,
            ..Section::new(ONSET_M, END_M)
        },
    ));
    for ratio in [2.0, 3.0, 4.0] {
        plans.push(make.plan(format!("low range {ratio} for 5 km"), |plan| {
            // The range is changed at a standstill.
            plan.stops.push(Stop::new(ONSET_M - 50.0, 15.0));
            plan.stops.push(Stop::new(ONSET_M + 5_000.0 - 20.0, 15.0));
            let section = Section {
                range_ratio: ratio,
                set_speed_mps: Some(22.2 / ratio),
                ..Section::new(ONSET_M, ONSET_M + 5_000.0)
            };
            add_section(plan, section);
        }));
    }
    plans.push(make.plan("wheel slip of 10 % on 1 km of 4 %", |plan| {
        plan.profiles.push(Profile {
            from_m: ONSET_M,
            corners: vec![(0.0, 4.0), (1_000.0, 4.0)],
        });
        let when = When::Way(ONSET_M, ONSET_M + 1_000.0);
        add_edit(plan, when, Edit::Slip(0.1));
    }));
    plans
}

/// Returns the plans of torque signals.
pub(super) fn torque(truck: BenchTruck, seed: u64) -> Vec<Plan> {
    let make = Maker(truck, seed);
    [
        ("torque every 2 s", Edit::TorqueEvery(2.0)),
        ("torque held for 2 s", Edit::TorqueHeld(2.0)),
        ("torque held for 5 s", Edit::TorqueHeld(5.0)),
        ("torque in steps of 5 %", Edit::TorqueSteps(5.0)),
        ("torque low-passed 1 s", Edit::TorqueLowPass(1.0)),
        ("torque 2 s late", Edit::TorqueLate(2.0)),
        (
            "torque wanders 5 %, 30 s",
            Edit::TorqueWander(0.05, 30.0, seed),
        ),
    ]
    .into_iter()
    .map(|(name, edit)| make.edit(name, When::Always, edit))
    .collect()
}
