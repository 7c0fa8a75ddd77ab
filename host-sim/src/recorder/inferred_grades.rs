//! Live and lagged grades with inferred variances, cell by cell.

use estimator_core::inference::window::CellSlope;
use estimator_core::inference::{Numbers, Window};
use estimator_core::robust::VehicleCells;
use estimator_core::robust::vehicle_cells::EndedRest;
use estimator_core::sample::Sample;
use estimator_core::{Context, Scalar};
use std::collections::VecDeque;

/// Live and lagged slope of a cell.
pub type LiveAndLagged = (CellSlope, CellSlope);

/// The window behind the vehicle, and the live slopes of the cells that wait for their lag.
#[derive(Debug)]
pub struct InferredGrades<S> {
    numbers: Numbers,
    cells: VehicleCells,
    window: Box<Window<S>>,
    waiting: VecDeque<CellSlope>,
}

impl<S: Scalar> InferredGrades<S> {
    /// Starts before the first sample.
    pub fn new() -> Self {
        Self {
            numbers: Numbers::default(),
            cells: VehicleCells::default(),
            window: Box::new(Window::new(false)),
            waiting: VecDeque::new(),
        }
    }

    /// Takes a sample. `finished` gets the cells whose lag is over.
    pub fn push(
        &mut self,
        context: &Context,
        sample: &Sample,
        finished: impl FnMut(LiveAndLagged),
    ) {
        let Some(cell) = self.cells.next(&self.numbers, context, sample) else {
            return;
        };
        let rest = EndedRest::of(&self.numbers, sample);
        let cold = self.numbers.prior_cold_tyre * context.model.vehicle.rolling_resistance;
        let live = self
            .window
            .push(&self.numbers, &cell, rest.as_ref(), 100.0 * cold);
        self.waiting.push_back(live);
        if self.window.is_due() {
            self.update(false, finished);
        }
    }

    /// Ends the drive. `finished` gets the cells that are left.
    pub fn end(&mut self, finished: impl FnMut(LiveAndLagged)) {
        self.update(true, finished);
    }

    fn update(&mut self, ends: bool, mut finished: impl FnMut(LiveAndLagged)) {
        let waiting = &mut self.waiting;
        self.window.update(&self.numbers, ends, |behind, slope| {
            // After an update at the very end, the cells of that one are given once more.
            if behind < waiting.len()
                && let Some(live) = waiting.pop_front()
            {
                finished((live, slope));
            }
        });
    }
}
