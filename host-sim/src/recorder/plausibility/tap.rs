//! The readings of frames, as the estimator takes them: one source for each signal.

use crate::source::can_frame::CanFrame;
use estimator_core::intake::{Admission, Sender, SourceArbiter};
use estimator_core::tuning::HoldTimes;
use estimator_core::{Decoder, Instant, Reading, Signal};

/// Decodes frames, and drops readings of signals that another source owns.
#[derive(Clone, Debug, Default)]
pub(super) struct Tap {
    decoder: Decoder,
    sources: SourceArbiter,
}

impl Tap {
    /// Leaves out a signal.
    pub(super) fn ignore(&mut self, signal: Signal) {
        self.sources.ignore(signal);
    }

    /// Leaves out a signal that frames do not give, but own messages.
    pub(super) fn reserve(&mut self, signal: Signal) {
        self.sources.reserve(signal);
    }

    /// Passes the admitted measurements of a frame to `take`.
    pub(super) fn readings(
        &mut self,
        now: Instant,
        frame: &CanFrame,
        tuning: &HoldTimes,
        mut take: impl FnMut(Reading),
    ) {
        let Self { decoder, sources } = self;
        decoder.decode(frame, |message, pgn, reading| {
            let sender = Sender::new(message, pgn.source);
            let is_available = reading.value.is_available();
            let admission = sources.admit(reading.signal, sender, now, is_available, tuning);
            let counts = !matches!(admission, Admission::Refused | Admission::Ignored);
            if counts && is_available {
                take(reading);
            }
        });
    }
}
