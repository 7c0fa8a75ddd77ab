//! Counts of what happened, by kind.

/// Counts since the start. They saturate, except those of frames, readings, steps and altitudes,
/// whose largest value no drive reaches: steps last for ten million kilometres.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Counters {
    /// Frames given to the estimator.
    pub frames: u64,
    /// Frames that carried readings.
    pub frames_decoded: u64,
    /// Frames of messages that the decoder does not read.
    pub frames_ignored: u64,
    /// Frames of known messages that are too short, or remote, or announce an impossible session.
    pub frames_malformed: u32,
    /// Fast packets dropped because of missing, repeated or swapped frames.
    pub fast_packets_broken: u32,
    /// Transport sessions dropped because of missing, swapped or late packets.
    pub sessions_broken: u32,
    /// Inputs older than the one before.
    pub time_backwards: u32,
    /// Single inputs far ahead of the one before.
    pub times_ahead: u32,
    /// Times that the receiver's clock was set back, or restarted.
    pub clocks_set_back: u32,
    /// Long silences, or jumps of the receiver's clock: they look the same.
    pub silences: u32,
    /// Readings with the code "not available".
    pub not_available: u32,
    /// Readings with the code "error", and non-finite readings.
    pub errors: u32,
    /// Parameters of the vehicle that the bus contradicted: its values are used.
    pub parameters_replaced: u32,
    /// Readings from another source than the one in use.
    pub other_source: u32,
    /// Times that another source took over a signal from a silent one.
    pub source_switches: u32,
    /// Times that a message came far faster than before: two may send it from one address.
    pub rates_exceeded: u32,
    /// Speeds that no vehicle can have reached from the one before, or that two senders seem to send.
    pub speed_leaps: u32,
    /// Speeds that stayed the same to the last digit while the engine speed changed.
    pub frozen_speeds: u32,
    /// Speeds that moved the odometer.
    pub speeds_used: u64,
    /// Readings that gave a traction force: torque with a gear, or a force.
    pub tractions_used: u64,
    /// GNSS fixes without a usable altitude.
    pub poor_fixes: u32,
    /// GNSS fixes that repeated an altitude over a distance on which no receiver does.
    pub frozen_fixes: u32,
    /// Times that the vehicle began to reverse.
    pub reversals: u32,
    /// Gaps without speed.
    pub gaps: u32,
    /// Samples lost because `step` was not called often enough.
    pub samples_lost: u32,
    /// Finished cells overwritten because they were not fetched.
    pub cells_lost: u32,
    /// Finished cells with a non-finite lagged grade.
    pub cells_unsound: u32,
    /// Finished cells in which signals disagree: the lagged sigma may be too small.
    pub cells_suspect: u32,
    /// Filter steps.
    pub steps: u32,
    /// Steps with an invalid model (shift, brake, no traction).
    pub invalid_steps: u32,
    /// Altitudes used.
    pub altitudes_used: u32,
    /// Altitudes that the live filter left out: it gates them, the lagged estimate weighs them.
    pub altitudes_rejected: u32,
    /// Slopes that were measured directly, and used live.
    pub slopes_used: u32,
    /// Such slopes that the live filter left out.
    pub slopes_rejected: u32,
    /// Speeds that differ from the prediction by more than the model allows; the speed was reset.
    pub speed_steps: u32,
    /// Stops after which the load may be another one.
    pub loads_reopened: u32,
    /// Steps with a result that is no number; the filter was restarted.
    pub restarts: u32,
}

/// Adds one to a counter, which stays at its largest value.
#[inline(never)] // Rare, each in many places.
pub(crate) fn count(counter: &mut u32) {
    *counter = counter.saturating_add(1);
}

/// Adds a number to a counter, which stays at its largest value.
#[inline]
pub(crate) fn count_by(counter: &mut u32, number: usize) {
    *counter = counter.saturating_add(number as u32);
}
