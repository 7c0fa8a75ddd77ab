//! What happens at a stop: reversing, another load, a ferry, a lifted axle.

use super::maker::{Maker, ONSET_M};
use crate::manoeuvres::drives::{BenchTruck, Plan};
use crate::manoeuvres::parts::{END_M, add_load_change, add_section, add_stop, masses_kg};
use crate::manoeuvres::signals::Edit;
use crate::manoeuvres::truth::When;
use host_sim::simulator::manoeuvre_file::{Section, Stop};

/// Returns the plans.
pub(super) fn standing(truck: BenchTruck, seed: u64) -> Vec<Plan> {
    let make = Maker(truck, seed);
    let (loaded_kg, empty_kg) = masses_kg(truck);
    let mut plans = Vec::new();
    for reverse_m in [50.0, 60.0] {
        plans.push(
            make.plan(format!("reverses {reverse_m} m to a dock"), |plan| {
                let stop = Stop {
                    reverse_m,
                    ..Stop::new(ONSET_M, 120.0)
                };
                add_stop(plan, stop);
            }),
        );
    }
    plans.push(make.plan("reverses 60 m, gear not told", |plan| {
        let stop = Stop {
            reverse_m: 60.0,
            ..Stop::new(ONSET_M, 120.0)
        };
        add_stop(plan, stop);
        plan.edits.push((When::Always, Edit::ReverseUntold));
    }));
    for (from_kg, to_kg) in [(loaded_kg, empty_kg), (empty_kg, loaded_kg)] {
        for seconds in [20.0, 60.0, 300.0] {
            let name = format!(
                "{:.0} to {:.0} t, stop of {seconds} s",
                1e-3 * from_kg,
                1e-3 * to_kg
            );
            plans.push(make.plan(name, |plan| {
                plan.mass_kg = Some(from_kg);
                add_load_change(plan, Stop::new(ONSET_M, seconds), to_kg);
            }));
        }
    }
    let coupled_kg = empty_kg + 17_000.0;
    plans.push(make.plan("trailer coupled, 60 s", |plan| {
        plan.mass_kg = Some(empty_kg);
        add_load_change(plan, Stop::new(ONSET_M, 60.0), coupled_kg);
    }));
    plans.push(make.plan("trailer coupled, 600 s, ignition off", |plan| {
        plan.mass_kg = Some(empty_kg);
        add_load_change(plan, Stop::new(ONSET_M, 600.0), coupled_kg);
        plan.edits.push((When::Stop(0), Edit::Silence));
    }));
    plans.push(make.plan("trailer dropped, 600 s, ignition off", |plan| {
        plan.mass_kg = Some(coupled_kg);
        add_load_change(plan, Stop::new(ONSET_M, 600.0), empty_kg);
        plan.edits.push((When::Stop(0), Edit::Silence));
    }));
    plans.push(make.plan("ferry of 4 km in 900 s", |plan| {
        let stop = Stop {
            carried_m: 4_000.0,
            ..Stop::new(ONSET_M, 900.0)
        };
        add_stop(plan, stop);
    }));
    plans.push(make.plan("ferry of 4 km in 900 s, ignition off", |plan| {
        let stop = Stop {
            carried_m: 4_000.0,
            ..Stop::new(ONSET_M, 900.0)
        };
        add_stop(plan, stop);
        plan.edits.push((When::Stop(0), Edit::Silence));
    }));
    plans.push(make.plan("lift axle raised at a stop", |plan| {
        plan.stops.push(Stop::new(ONSET_M, 30.0));
        let section = Section {
            rolling_factor: 0.9,
            ..Section::new(ONSET_M, END_M)
        };
        add_section(plan, section);
    }));
    plans
}
