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

/// Evidence below which an estimated delay is no other than the assumed one.
const TOO_LITTLE: f32 = 1.0;

/// The delay that fits the drive best.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BestFit {
    pub delay_s: f32,
    pub sigma_s: f32,
    /// Whether it is one: the best lies within what is compared, and fits.
    pub is_clear: bool,
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

    /// Returns what is known of the delay with the best fit of more of the drive. The evidence is that
    /// of another delay than assumed, and that against the one that was estimated; both are logarithms
    /// of ratios of likelihoods, and `enough` is what a decision takes.
    pub(crate) fn decided(
        self,
        best: BestFit,
        evidence: f32,
        evidence_against: f32,
        enough: f32,
    ) -> Self {
        let BestFit {
            mut delay_s,
            sigma_s,
            is_clear,
        } = best;
        let mut needed = enough;
        if let Self::Estimated {
            delay_s: held_s,
            sigma_s: held_sigma_s,
        } = self
        {
            // A drive that knows less than an earlier one follows it unless it contradicts.
            if sigma_s > held_sigma_s && evidence_against < enough {
                return self;
            }
            needed = TOO_LITTLE;
            // Smaller changes are noise, and each one moves what is late.
            if (delay_s - held_s).abs() < 0.5 * sigma_s {
                delay_s = held_s;
            }
        }
        if evidence < needed {
            Self::Unestimated
        } else if is_clear {
            Self::Estimated { delay_s, sigma_s }
        } else {
            Self::Invalid
        }
    }
}
