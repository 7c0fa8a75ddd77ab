//! What the reading of a log tells besides its frames.

use super::damage::Damage;
use super::interfaces::InterfaceCount;
use serde::Serialize;

/// What the reading of a whole log tells.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct LogReport {
    /// What was left out.
    pub damage: Damage,
    /// The interfaces; none in a signal table.
    pub interfaces: Vec<InterfaceCount>,
    /// Time of the first frame, if the log has absolute times, as `2026-11-22T10:00:00.000000Z`.
    /// ASC, TRC, BLF and `candump -t A` have the time of the logger's clock, whatever its time zone.
    pub start_utc: Option<String>,
    /// What was mended of the times of the log, in words.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub mended: Vec<String>,
    /// What else there is to tell of the log, in words.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub notes: Vec<String>,
    /// Columns of a signal table that are not ours.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub ignored_columns: Vec<String>,
    /// Own signals that no frame or record had, by column.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub unseen_signals: Vec<&'static str>,
    /// Whether the engine torque is that of diagnostic answers (service 01), as light vehicles have it.
    #[serde(skip)]
    pub has_diagnostic_torque: bool,
    /// The vehicle identification number (VIN); `None` if the bus does not send it.
    #[serde(skip)]
    pub vehicle_number: Option<String>,
}
