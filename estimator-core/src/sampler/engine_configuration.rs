//! What the engine says of itself: its reference torque and its inertia (EC1).
//!
//! Torques are reported as parts of the controller's reference torque, whatever a vehicle file says.
//! So the bus goes before the file where they differ by more than rounding. The inertia is that of
//! the bare engine, without what turns with it; there the file holds unless it is far off. A value
//! counts when it came twice in a row: a damaged session must not change the model.

use super::accepted_ranges::{ENGINE_INERTIAS_KGM2, REFERENCE_TORQUES_NM};
use crate::context::Context;
use crate::counters::count;
use crate::maybe::Maybe;
use crate::signal::Signal;
use crate::vehicle::Traction;

/// Relative differences from the model that are none.
const TORQUE_TOLERANCE: f32 = 0.005;
const INERTIA_TOLERANCE: f32 = 0.2;
/// Cells after which the filter has learned something of its scale, at the earliest: 500 m.
const LEARNED_CELLS: u32 = 200;

/// The newest plausible values.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct EngineConfiguration {
    torque_nm: Maybe,
    inertia_kgm2: Maybe,
}

impl EngineConfiguration {
    /// Takes a reading, and changes the model if it is confirmed and the model differs. Returns whether
    /// what the filter has learned of its scale no longer holds.
    #[inline(never)] // Rare.
    pub(super) fn record(
        &mut self,
        context: &mut Context,
        signal: Signal,
        value: Option<f32>,
    ) -> bool {
        let Traction::Powertrain(powertrain) = &mut context.model.vehicle.traction else {
            return false;
        };
        let is_torque = signal == Signal::EngineReferenceTorque;
        let (newest, model, accepted, tolerance) = if is_torque {
            let model = &mut powertrain.reference_torque_nm;
            let accepted = REFERENCE_TORQUES_NM;
            (&mut self.torque_nm, model, accepted, TORQUE_TOLERANCE)
        } else {
            let model = &mut powertrain.engine_inertia_kgm2;
            let accepted = ENGINE_INERTIAS_KGM2;
            (&mut self.inertia_kgm2, model, accepted, INERTIA_TOLERANCE)
        };
        let Some(value) = value.filter(|value| accepted.contains(value)) else {
            return false;
        };
        let is_confirmed = newest.get() == Some(value);
        *newest = Maybe::some(value);
        if !is_confirmed || (value - *model).abs() <= tolerance * *model {
            return false;
        }
        *model = value;
        count(&mut context.counters.parameters_replaced);
        is_torque && context.counters.steps >= LEARNED_CELLS
    }
}
