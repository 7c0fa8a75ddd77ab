//! Wind, surface, speed signals and the GNSS receiver.

use super::maker::{Maker, ONSET_M};
use crate::manoeuvres::drives::{BenchTruck, Plan};
use crate::manoeuvres::parts::END_M;
use crate::manoeuvres::signals::Edit;
use crate::manoeuvres::truth::When;
use host_sim::simulator::manoeuvre_file::Section;

/// Returns the plans of wind and surface.
pub(super) fn surroundings(truck: BenchTruck, seed: u64) -> Vec<Plan> {
    let make = Maker(truck, seed);
    let mut plans = Vec::new();
    for (name, wind) in [
        ("gusts 2 m/s in 8 m/s", (8.0, 2.0, 60.0)),
        ("gusts 2 m/s over 10 s in 8 m/s", (8.0, 2.0, 10.0)),
        ("gusts 1 m/s over 30 s in 5 m/s", (5.0, 1.0, 30.0)),
    ] {
        plans.push(make.plan(name, |plan| {
            plan.wind = wind;
            plan.faults.push(When::Always);
        }));
    }
    for rolling_factor in [2.0, 3.0] {
        plans.push(make.section(
            format!("rolling resistance x{rolling_factor} from 15 km"),
            Section {
                rolling_factor,
                ..Section::new(ONSET_M, END_M)
            },
        ));
    }
    for headwind_mps in [8.0, -8.0] {
        plans.push(make.section(
            format!("headwind {headwind_mps:+} m/s from 15 km"),
            Section {
                headwind_mps,
                ..Section::new(ONSET_M, END_M)
            },
        ));
    }
    plans
}

/// Returns the plans of speed signals.
pub(super) fn speed(truck: BenchTruck, seed: u64) -> Vec<Plan> {
    let make = Maker(truck, seed);
    vec![
        make.edit("speed x1.10", When::Always, Edit::SpeedFactor(1.1)),
        make.edit("speed x0.90", When::Always, Edit::SpeedFactor(0.9)),
        make.edit(
            "speed x1.10 for 5 km",
            When::Way(ONSET_M, ONSET_M + 5_000.0),
            Edit::SpeedFactor(1.1),
        ),
        make.edit(
            "speed in steps of 1 km/h",
            When::Always,
            Edit::SpeedSteps(1.0 / 3.6),
        ),
        make.edit(
            "speed low-passed 1 s",
            When::Always,
            Edit::SpeedLowPass(1.0),
        ),
    ]
}

/// Returns the plans of the receiver.
pub(super) fn receiver(truck: BenchTruck, seed: u64) -> Vec<Plan> {
    let make = Maker(truck, seed);
    let mut plans = Vec::new();
    for time_s in [10.0, 30.0] {
        plans.push(make.edit(
            format!("altitude low-passed {time_s} s"),
            When::Always,
            Edit::AltitudeLowPass(time_s),
        ));
    }
    for m_per_km in [2.0, -2.0] {
        plans.push(
            make.plan(format!("altitude drifts {m_per_km:+} m/km"), |plan| {
                plan.ramps.push((0.0, 50_000.0, 50.0 * m_per_km));
                plan.faults.push(When::Always);
            }),
        );
    }
    for late_s in [1.0, 2.0, 5.0] {
        plans.push(
            make.plan(format!("GNSS {late_s} s late, by place"), |plan| {
                plan.gnss_late_s = Some(late_s);
                plan.by_place = true;
                plan.faults.push(When::Always);
            }),
        );
    }
    plans.push(make.plan("tunnel of 3 km", |plan| {
        plan.outages.push((ONSET_M, ONSET_M + 3_000.0));
        plan.faults.push(When::Way(ONSET_M, ONSET_M + 3_000.0));
    }));
    plans.push(make.plan("multipath steps of 5-15 m", |plan| {
        for (index, metres) in [5.0, -8.0, 15.0, -12.0, 10.0, -5.0].into_iter().enumerate() {
            let from_m = ONSET_M + 600.0 * index as f64;
            plan.steps.push((from_m, from_m + 250.0, metres));
        }
        plan.faults.push(When::Way(ONSET_M, ONSET_M + 3_250.0));
    }));
    plans
}
