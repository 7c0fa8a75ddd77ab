//! Every fault on every truck, and the table of what came of it.

use super::catalogue::Fault;
use super::drive::drive;
use super::outcome::{Phases, Times, Truth, estimated, is_sound};
use estimator_core::Counters;
use host_sim::error::Result;
use host_sim::world::SimulatedRun;

/// A drive that faults happen to.
#[derive(Debug)]
pub struct Subject {
    run: SimulatedRun,
    truth: Truth,
}

/// What came of a fault.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// Its errors.
    pub phases: Phases,
    /// What was counted.
    pub counters: Counters,
    /// Whether all numbers are some.
    pub is_sound: bool,
    /// Way of the last cell, m.
    pub way_m: f64,
    /// Cells handed out.
    pub cells: usize,
}

impl Subject {
    /// A drive.
    ///
    /// # Errors
    /// As [`drive`].
    pub fn new(truck: &str, seed: u64) -> Result<Self> {
        let run = drive(truck, seed)?;
        let truth = Truth::new(&run);
        Ok(Self { run, truth })
    }

    /// The drive with a fault, judged at the fault's times or at those given.
    #[must_use]
    pub fn with(&self, fault: &Fault) -> Outcome {
        let run = estimated::<f32>(&self.run.vehicle.parameters, fault.heard(&self.run.frames));
        let times = Times {
            window_s: fault.window_s,
            ahead_s: fault.ahead_s,
        };
        Outcome {
            phases: self.truth.phases(&run.rows, &times),
            counters: run.counters,
            is_sound: is_sound(&run.rows),
            way_m: run.rows.last().map_or(0.0, |row| row.distance_m),
            cells: run.rows.len(),
        }
    }
    /// The drive without a fault, judged at its times.
    #[must_use]
    pub fn phases_of(&self, rows: &[host_sim::run_file::RunRow], fault: &Fault) -> Phases {
        self.truth.phases(
            rows,
            &Times {
                window_s: fault.window_s,
                ahead_s: 0.0,
            },
        )
    }
    pub fn clean(&self) -> host_sim::recorder::Run {
        estimated::<f32>(
            &self.run.vehicle.parameters,
            Box::new(self.run.frames.iter().copied()),
        )
    }
}
