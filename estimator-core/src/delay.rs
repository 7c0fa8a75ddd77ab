//! How late signals are, as a drive shows it.

/// The delay of a signal behind the wheel speed.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Delay {
    /// The drive shows no other one than assumed, which is in use.
    #[default]
    Unestimated,
    /// The drive, or one before, shows this one.
    Estimated {
        /// Delay, s. A signal that is ahead has a negative one.
        delay_s: f32,
        /// Its standard deviation, s.
        sigma_s: f32,
    },
    /// The assumed one is wrong, and no other one fits: it is longer than can be found, or changes.
    /// The assumed one is in use.
    Invalid,
}

/// The delays that an estimator looks for.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Delays {
    /// Of the GNSS receiver: age of a fix when it arrives. `gnss_latency_ms` is assumed.
    pub receiver: Delay,
    /// Of the traction force. None is assumed.
    pub traction: Delay,
    /// Of GNSS altitudes behind the fixes that they come with: the time constant of a low-pass in the
    /// receiver. None is assumed.
    pub altitude: Delay,
}

impl Delay {
    /// Returns the estimated delay, s; `None` unless there is one.
    #[must_use]
    pub const fn estimated_s(&self) -> Option<f32> {
        match self {
            Self::Estimated { delay_s, .. } => Some(*delay_s),
            Self::Unestimated | Self::Invalid => None,
        }
    }
}
