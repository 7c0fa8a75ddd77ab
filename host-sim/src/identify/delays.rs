//! How late receiver and force of the vehicle are, where drives show it.

use super::estimate::{Estimate, Unknown, two_digits};
use crate::numeric::statistics;
use estimator_core::{Delay, Delays};

/// A delay that drives show.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FoundDelay {
    /// What is late.
    what: &'static str,
    /// What becomes of that.
    effect: &'static str,
    /// Delay behind the wheel speed, s.
    pub seconds: Estimate,
}

impl FoundDelay {
    /// Returns a sentence that tells it.
    #[must_use]
    pub fn sentence(&self) -> String {
        let Self {
            what,
            effect,
            seconds,
        } = self;
        format!(
            "{what} {:.2} ± {} s late: {effect}.",
            seconds.value,
            two_digits(seconds.sigma)
        )
    }
}

/// Returns the delays of the vehicle of these drives.
#[must_use]
pub fn found(drives: &[Delays]) -> Vec<FoundDelay> {
    const FOUND: &str = "an estimate finds it on each drive, and --kept keeps it";
    const ADDED: &str = "what it lacks is added, with a larger sigma";
    type Of = fn(&Delays) -> Delay;
    let kinds: [(&str, &str, Of); 3] = [
        ("The GNSS receiver is", FOUND, |delays| delays.receiver),
        ("The traction force or torque is", ADDED, |delays| {
            delays.traction
        }),
        (
            "GNSS altitudes, behind a low-pass of the receiver, are",
            FOUND,
            |delays| delays.altitude,
        ),
    ];
    let found = kinds.into_iter().filter_map(|(what, effect, delay)| {
        let seconds = mean(drives.iter().map(delay))?;
        Some(FoundDelay {
            what,
            effect,
            seconds,
        })
    });
    found.collect()
}

/// Returns what is not known of the receiver, if no drive shows its delay and one shows that it is
/// another one than assumed.
#[must_use]
pub fn unknown(drives: &[Delays]) -> Option<Unknown> {
    let is_wrong = drives.iter().any(|of| of.receiver == Delay::Invalid)
        && mean(drives.iter().map(|of| of.receiver)).is_none();
    is_wrong.then(|| Unknown {
        what: "how late the GNSS receiver is: by more than 5 s, or it changes".to_owned(),
        advice: "Record the receiver where its messages arrive.".to_owned(),
    })
}

/// Returns the mean of the estimated ones, with at least their scatter as sigma; `None` without any.
fn mean(delays: impl Iterator<Item = Delay>) -> Option<Estimate> {
    let estimated: Vec<(f64, f64)> = delays
        .filter_map(|delay| match delay {
            Delay::Estimated { delay_s, sigma_s } => Some((delay_s.into(), f64::from(sigma_s))),
            Delay::Unestimated | Delay::Invalid => None,
        })
        .collect();
    let weights: f64 = estimated.iter().map(|(_, sigma)| sigma.powi(-2)).sum();
    let weighted = estimated
        .iter()
        .map(|(delay_s, sigma)| delay_s / sigma.powi(2));
    let value = weighted.sum::<f64>() / weights;
    let squares: Vec<f64> = estimated
        .iter()
        .map(|(delay_s, _)| (delay_s - value).powi(2))
        .collect();
    let scatter = statistics::mean(&squares) / estimated.len() as f64;
    (weights > 0.0).then(|| Estimate::new(value, (1.0 / weights).max(scatter).sqrt()))
}
