//! Multi-packet messages of the simulated bus (SAE J1939-21, BAM): what engine and retarder say of
//! themselves every 5 s.
//!
//! They have the lowest priority of the bus. Each of their frames waits until the bus is free for
//! as long as it takes, so that no other frame is later because of them.

use super::scenario::Scenario;
use super::truck::RETARDER_NM;
use crate::source::can_frame::CanFrame;
use estimator_core::signal::encode;
use estimator_core::{Signal, Traction, Value};

/// Parameter groups: engine and retarder configuration.
const EC1: u32 = 65_251;
const RC: u32 = 65_249;
/// Time of the first session, and from one to the next, s.
const FIRST_S: f64 = 2.0;
const PERIOD_S: f64 = 5.0;
/// Time between two frames of a session, s. The standard allows 50 to 200 ms.
const PAUSE_S: f64 = 0.06;
/// Time by which the next sender begins later, s: their frames interleave.
const OFFSET_S: f64 = 0.02;
/// Longest payload.
const PAYLOAD: usize = 64;

/// The sessions of one sender, over and over.
#[derive(Debug)]
struct Session {
    frames: Vec<CanFrame>,
    /// Start of the session, s.
    start_s: f64,
    next: usize,
}

impl Session {
    fn due_s(&self) -> f64 {
        self.start_s + PAUSE_S * self.next as f64
    }
}

/// The sessions of all senders.
#[derive(Debug)]
pub(super) struct Broadcasts(Vec<Session>);

impl Broadcasts {
    /// Creates the sessions of run `index`: of the engine and the retarder at these addresses. The
    /// engine reports the reference torque that the vehicle file has.
    pub(super) fn new(scenario: &Scenario, index: usize, engine: u8, retarder: u8) -> Self {
        let vehicle = &scenario.runs[index].vehicle.model.vehicle;
        let value_of = |signal| match (signal, &vehicle.traction) {
            (Signal::EngineReferenceTorque, Traction::Powertrain(powertrain)) => {
                Value::Real(powertrain.reference_torque_nm)
            }
            (Signal::EngineInertia, Traction::Powertrain(powertrain)) => {
                Value::Real(powertrain.engine_inertia_kgm2)
            }
            (Signal::RetarderReferenceTorque, _) => Value::Real(RETARDER_NM as f32),
            _ => Value::NotAvailable,
        };
        let sessions = [(EC1, engine), (RC, retarder)].into_iter().zip(0_u8..);
        let session = sessions.map(|((pgn, source), order)| {
            let mut payload = [0; PAYLOAD];
            let length = encode(pgn, &mut payload, value_of).unwrap_or(0);
            Session {
                frames: CanFrame::broadcast(pgn, source, &payload[..length]).collect(),
                start_s: FIRST_S + OFFSET_S * f64::from(order),
                next: 0,
            }
        });
        Self(session.collect())
    }

    /// Returns the frame that is due first, if it can be sent from when the bus is free, in
    /// `duration_s`, and before the time `until_s`. Returns its time of transmission with it.
    pub(super) fn next(
        &mut self,
        free_s: f64,
        duration_s: f64,
        until_s: f64,
    ) -> Option<(f64, CanFrame)> {
        let first = self
            .0
            .iter_mut()
            .min_by(|a, b| a.due_s().total_cmp(&b.due_s()))?;
        let start_s = first.due_s().max(free_s);
        if start_s + duration_s > until_s {
            return None;
        }
        let frame = *first.frames.get(first.next)?;
        first.next += 1;
        if first.next == first.frames.len() {
            first.next = 0;
            first.start_s += PERIOD_S;
        }
        Some((start_s, frame))
    }
}
