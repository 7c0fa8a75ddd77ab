//! What frames say beyond the built-in messages: the user's own messages, and diagnostic answers.

use super::can_frame::TimedFrame;
use super::obd::ObdAnswers;
use super::own_signals::OwnSignals;
use super::vehicle_number::VehicleNumber;
use estimator_core::{Reading, Signal};
use std::sync::Arc;

/// Reader of own messages and diagnostic answers.
#[derive(Debug, Default)]
pub struct FrameReadings {
    own: Option<Arc<OwnSignals>>,
    /// Signals that no own message had so far.
    unseen: Vec<Signal>,
    obd: ObdAnswers,
    vehicle_number: VehicleNumber,
}

impl FrameReadings {
    /// Creates a reader.
    #[must_use]
    pub fn of(own: Option<&Arc<OwnSignals>>) -> Self {
        let signals: Vec<Signal> = own.iter().flat_map(|own| own.signals()).collect();
        Self {
            own: own.cloned(),
            obd: ObdAnswers::new(signals.iter().copied()),
            unseen: signals,
            vehicle_number: VehicleNumber::default(),
        }
    }

    /// Gives the readings of a frame to `sink`.
    pub fn decode(&mut self, timed: &TimedFrame, mut sink: impl FnMut(Reading)) {
        if let Some(own) = &self.own {
            own.decode(&timed.frame, |reading| {
                self.unseen.retain(|signal| *signal != reading.signal);
                sink(reading);
            });
        }
        self.obd.decode(timed, sink);
        self.vehicle_number.take(&timed.frame);
    }

    /// Returns the signals of own messages that no frame had so far.
    #[must_use]
    pub fn unseen(&self) -> &[Signal] {
        &self.unseen
    }

    /// Returns the vehicle identification number (VIN) that the bus or an answer sends.
    #[must_use]
    pub fn vehicle_number(&self) -> Option<&str> {
        self.vehicle_number.number().or(self.obd.vehicle_number())
    }

    /// Returns what was read of diagnostic answers.
    #[must_use]
    pub const fn obd(&self) -> &ObdAnswers {
        &self.obd
    }
}
