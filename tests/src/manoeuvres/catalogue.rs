//! The manoeuvres and faults by name.

mod descents;
mod driveline;
mod maker;
mod standing;
mod surroundings;

use super::drives::{BenchTruck, Plan};
use descents::{descents, without_fault};
use driveline::{driveline, torque};
use standing::standing;
use surroundings::{receiver, speed, surroundings};

/// Returns every manoeuvre for both trucks, those without a fault first.
#[must_use]
pub fn catalogue(seed: u64) -> Vec<Plan> {
    let of = |truck| {
        let mut makers = Vec::new();
        makers.extend(without_fault(truck, seed));
        makers.extend(standing(truck, seed));
        makers.extend(descents(truck, seed));
        makers.extend(driveline(truck, seed));
        makers.extend(torque(truck, seed));
        makers.extend(surroundings(truck, seed));
        makers.extend(speed(truck, seed));
        makers.extend(receiver(truck, seed));
        makers
    };
    let mut plans: Vec<Plan> = BenchTruck::ALL.into_iter().flat_map(of).collect();
    plans.sort_by_key(|plan| !plan.faults.is_empty());
    plans
}
