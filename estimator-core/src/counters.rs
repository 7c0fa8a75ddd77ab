//! What happened, counted by kind. Counters saturate.

/// Counts since the start. Those of frames, readings, steps and altitudes are added to without a
/// look at their end, which no drive comes near: steps end after ten million kilometres.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Counters {
    /// Frames given to the estimator.
    pub frames: u64,
    /// Frames that carried readings.
    pub frames_decoded: u64,
    /// Frames of no interest.
    pub frames_ignored: u64,
    /// Known frames that were too short or remote.
    pub frames_malformed: u32,
    /// Fast packets dropped for missing, repeated or swapped frames.
    pub fast_packets_broken: u32,
    /// Frames or readings older than the one before.
    pub time_backwards: u32,
    /// Frames or readings far ahead of the one before, and alone in that.
    pub times_ahead: u32,
    /// The listener's clock was set back, or began anew.
    pub clocks_set_back: u32,
    /// Long silences, or leaps of the listener's clock: nobody can tell them apart.
    pub silences: u32,
    /// Readings whose sender said "not available".
    pub not_available: u32,
    /// Readings whose sender said "error", or that are no number.
    pub errors: u32,
    /// Readings from another sender than the one in use.
    pub other_source: u32,
    /// Another sender took over a signal from a silent one.
    pub source_switches: u32,
    /// Times that a message came far faster than it had before: two may send it from one address.
    pub rates_exceeded: u32,
    /// Speeds that no vehicle changes to so fast.
    pub speed_leaps: u32,
    /// Speeds that stayed the same to the last digit while the engine's changed.
    pub frozen_speeds: u32,
    /// Speeds that moved the odometer.
    pub speeds_used: u64,
    /// Traction forces known: torque with a gear, or a force.
    pub tractions_used: u64,
    /// GNSS fixes without a usable altitude.
    pub poor_fixes: u32,
    /// GNSS fixes that repeated an altitude along a way on which no receiver would.
    pub frozen_fixes: u32,
    /// Stretches without speed.
    pub gaps: u32,
    /// Cells lost because `step` was not called often enough.
    pub samples_lost: u32,
    /// Finished cells overwritten because nobody fetched them.
    pub cells_lost: u32,
    /// Finished cells whose smoothing gave a number that is none.
    pub cells_unsound: u32,
    /// Filter steps.
    pub steps: u32,
    /// Steps with an invalid model (shift, brake, no traction).
    pub invalid_steps: u32,
    /// Altitudes used.
    pub altitudes_used: u32,
    /// Altitudes left out because they did not fit.
    pub altitudes_rejected: u32,
    /// Of these, single ones.
    pub altitude_outliers: u32,
    /// Cells at whose end the speed was another than the model allows; it was set anew.
    pub speed_steps: u32,
    /// Cells in which, without any brake signal, the vehicle slowed down as only brakes make it.
    pub brakes_guessed: u32,
    /// Stops after which what was learned of scale and bias was given up, wholly or in part.
    pub loads_reopened: u32,
    /// Times that the scale went too far from where it began for that to be believed.
    pub scales_reopened: u32,
    /// Stretches without an altitude.
    pub altitude_gaps: u32,
    /// Steps of the GNSS altitude error taken up.
    pub altitude_steps: u32,
    /// Stretches whose altitudes climbed unlike the road.
    pub altitude_drifts: u32,
    /// Of these, such as lasted too long for a drift and were believed.
    pub altitude_drifts_believed: u32,
    /// Altitude set anew.
    pub altitude_resets: u32,
    /// Steps that gave a number that is none; the filter was started anew.
    pub restarts: u32,
}
