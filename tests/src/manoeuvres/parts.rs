//! Parts of plans: what happens, and when it is a fault.

use super::drives::{BenchTruck, Plan};
use super::signals::Edit;
use super::truth::When;
use host_sim::simulator::manoeuvre_file::{Section, Stop};

/// The end of every drive, m.
pub const END_M: f64 = 1e6;

/// Adds an edit of frames, which is the fault.
pub fn add_edit(plan: &mut Plan, when: When, edit: Edit) {
    plan.edits.push((when, edit));
    plan.faults.push(when);
}

/// Adds a section, which is the fault.
pub fn add_section(plan: &mut Plan, section: Section) {
    plan.faults.push(When::Way(section.from_m, section.to_m));
    plan.sections.push(section);
}

/// Adds a stop, which is the fault.
pub fn add_stop(plan: &mut Plan, stop: Stop) {
    plan.faults.push(When::Stop(plan.stops.len()));
    plan.stops.push(stop);
}

/// Adds a stop at which the load changes, and which no signal reports.
pub fn add_load_change(plan: &mut Plan, stop: Stop, mass_kg: f64) {
    add_stop(
        plan,
        Stop {
            mass_kg: Some(mass_kg),
            ..stop
        },
    );
    plan.edits.push((When::Always, Edit::MassUntold));
}

/// Returns the loaded and the empty mass of a truck, kg.
#[must_use]
pub const fn masses_kg(truck: BenchTruck) -> (f64, f64) {
    match truck {
        BenchTruck::A => (39_000.0, 15_000.0),
        BenchTruck::B => (24_000.0, 12_000.0),
    }
}

/// Returns the section of a whole drive with a retarder.
#[must_use]
pub const fn retarder() -> Section {
    Section {
        retarder: true,
        ..Section::new(0.0, END_M)
    }
}
