//! Events of an interface other than frames.

use serde::Serialize;
use socketcan::errors::ControllerProblems;
use socketcan::{CanErrorFrame, ErrorCause};

/// An event of a bus or its interface.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum BusEvent {
    /// The controller left the bus after too many errors.
    BusOff,
    /// The controller is back on the bus.
    Restarted,
    /// More than 127 errors: the controller no longer sends active error flags.
    ErrorPassive,
    /// More than 95 errors.
    ErrorWarning,
    /// Few errors again.
    ErrorActive,
    /// The controller's own buffer overflowed: frames were lost before the kernel received them.
    ControllerOverflow,
    /// A frame on the wire was wrong.
    WireError,
    /// No node acknowledged a frame.
    NotAcknowledged,
    /// Another report of the controller: lost arbitration, a late transmission, the transceiver.
    OtherReport,
    /// The interface was set down.
    InterfaceDown,
    /// The interface was removed.
    InterfaceGone,
    /// The interface is up again.
    InterfaceBack,
    /// The system clock was set. The time stamps of frames continue without the step.
    ClockSet,
}

impl BusEvent {
    /// Returns a short description.
    #[must_use]
    pub const fn words(self) -> &'static str {
        match self {
            Self::BusOff => "bus off",
            Self::Restarted => "restarted",
            Self::ErrorPassive => "error passive",
            Self::ErrorWarning => "error warning",
            Self::ErrorActive => "error active again",
            Self::ControllerOverflow => "controller overflow",
            Self::WireError => "wire errors",
            Self::NotAcknowledged => "not acknowledged",
            Self::OtherReport => "other reports",
            Self::InterfaceDown => "interface down",
            Self::InterfaceGone => "interface gone",
            Self::InterfaceBack => "interface back",
            Self::ClockSet => "clock set",
        }
    }

    /// Returns true if the state of the bus changed, which is worth a message; a single error is
    /// not.
    #[must_use]
    pub const fn is_change(self) -> bool {
        !matches!(
            self,
            Self::WireError | Self::NotAcknowledged | Self::OtherReport
        )
    }
}

/// Returns the events that an error frame reports, each once, in the order of their causes.
#[must_use]
pub fn of_error_frame(frame: &CanErrorFrame) -> Vec<BusEvent> {
    let mut events = Vec::new();
    for cause in (*frame).into_error().causes() {
        let event = match cause {
            ErrorCause::BusOff => BusEvent::BusOff,
            ErrorCause::Restarted => BusEvent::Restarted,
            ErrorCause::Controller(problems) => of_controller(*problems),
            ErrorCause::Protocol { .. } | ErrorCause::BusError => BusEvent::WireError,
            ErrorCause::NoAck => BusEvent::NotAcknowledged,
            // These come with a cause, and are not events themselves.
            ErrorCause::Counters { .. } => continue,
            _ => BusEvent::OtherReport,
        };
        if !events.contains(&event) {
            events.push(event);
        }
    }
    events
}

/// Returns the worst state of a controller.
fn of_controller(problems: ControllerProblems) -> BusEvent {
    let overflow = ControllerProblems::RX_OVERFLOW | ControllerProblems::TX_OVERFLOW;
    let passive = ControllerProblems::RX_PASSIVE | ControllerProblems::TX_PASSIVE;
    let warning = ControllerProblems::RX_WARNING | ControllerProblems::TX_WARNING;
    if problems.intersects(overflow) {
        BusEvent::ControllerOverflow
    } else if problems.intersects(passive) {
        BusEvent::ErrorPassive
    } else if problems.intersects(warning) {
        BusEvent::ErrorWarning
    } else if problems.contains(ControllerProblems::ACTIVE) {
        BusEvent::ErrorActive
    } else {
        BusEvent::OtherReport
    }
}
