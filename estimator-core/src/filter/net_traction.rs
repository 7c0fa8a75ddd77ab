//! The net traction of a cell, and what the speed gains over it.

use super::state::State;
use super::state_index::StateIndex;
use crate::context::Context;
use crate::sample::Sample;
use crate::scalar::Scalar;

/// Returns what the speed gains over the cell of a sample, m/s².
pub(super) fn gained_mps2<S: Scalar>(sample: &Sample, from: Option<&State<S>>) -> f32 {
    let speed = sample.end.speed_mps;
    from.map_or(0.0, |state| {
        let before = state.mean[StateIndex::KineticEnergy].to_f32();
        (0.5 * speed * speed - before) / sample.length_m
    })
}

/// Returns the net traction over the cell of a sample over which the speed gains so much, as a slope, %.
/// What turns engine and wheels does not move the mass.
pub(super) fn net_traction_percent(context: &Context, sample: &Sample, gained_mps2: f32) -> f32 {
    let forces = &sample.forces;
    let drag_n = context.model.vehicle.drag_n(forces, sample.end.speed_mps);
    let turning_n = forces.rotating_kg * gained_mps2;
    100.0 * (forces.traction_n - drag_n - turning_n) / forces.weight_n()
}
