//! Plain dependences on time, place and signals, for a residual that no effect explains.

use super::collector::seconds;
use super::drive::{LoggedDrive, RoadPlace};
use super::evidence::ForceColumn;
use estimator_core::sample::Sample;
use estimator_core::vehicle::GRAVITY;

/// Number of bins of a signal's values.
pub(super) const BINS: usize = 5;
/// Unit of the columns of a plain dependence: a tenth of a percent of the weight, its usual size.
pub(super) const BASIS_UNIT: f32 = 1e-3;

/// The x variable of a plain dependence's plot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Variable {
    /// Distance along the common road, m; whether in its direction.
    Road(bool),
    /// The log's clock within a period, s.
    Phase(f64),
    /// A signal.
    Signal(Covariate),
    /// Whether traction rises (1) or falls (−1), with this hysteresis.
    Rises(f32),
}

/// Basis functions, of magnitude about one.
#[derive(Clone, Copy, Debug)]
pub(super) enum BasisFunction {
    /// Cosine and sine of the clock in a period, s.
    Cosine(f64),
    Sine(f64),
    /// Whether a signal is in its lowest, second, … of [`BINS`] bins, less the mean of that.
    Bin(Covariate, usize),
    /// 1 where traction over weight (%) rises, −1 where it falls, with this hysteresis.
    Rises(f32),
}

/// A signal on which the residual may depend.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Covariate {
    /// Speed, m/s.
    Speed,
    /// Traction over weight, %.
    Traction,
    /// Time in motion, s.
    TimeInMotion,
    /// Air temperature, °C.
    Temperature,
}

impl BasisFunction {
    pub(super) fn column(self, drive: &LoggedDrive) -> ForceColumn {
        let samples = &drive.samples;
        let unit_n = |sample: &Sample| BASIS_UNIT * sample.forces.mass_kg * GRAVITY;
        let of_phase = |period_s: f64, wave: fn(f64) -> f64| {
            let phase = |sample: &Sample| {
                wave(std::f64::consts::TAU * seconds(sample.end.time) / period_s) as f32
            };
            samples.iter().map(|s| unit_n(s) * phase(s)).collect()
        };
        match self {
            Self::Cosine(period_s) => of_phase(period_s, f64::cos),
            Self::Sine(period_s) => of_phase(period_s, f64::sin),
            Self::Rises(play_percent) => rises(samples, play_percent)
                .iter()
                .zip(samples)
                .map(|(rises, sample)| -unit_n(sample) * rises)
                .collect(),
            Self::Bin(covariate, bin) => {
                let values: Vec<Option<f32>> = samples.iter().map(|s| covariate.value(s)).collect();
                let mut sorted: Vec<f32> = values.iter().copied().flatten().collect();
                sorted.sort_by(f32::total_cmp);
                let edge = |part: usize| {
                    let index = (part * sorted.len() / BINS).min(sorted.len().saturating_sub(1));
                    sorted.get(index).copied().unwrap_or(0.0)
                };
                let (low, high) = (edge(bin), edge(bin + 1));
                let last = bin + 1 == BINS;
                let is_in = |value: &Option<f32>| {
                    value.is_some_and(|v| v >= low && (last || v < high)) && high > low
                };
                let share =
                    values.iter().filter(|v| is_in(v)).count() as f32 / values.len().max(1) as f32;
                let member = |value: &Option<f32>| if is_in(value) { 1.0 - share } else { -share };
                let pairs = samples.iter().zip(&values);
                pairs.map(|(s, value)| unit_n(s) * member(value)).collect()
            }
        }
    }
}

impl Variable {
    /// Returns the label of an axis, with the unit.
    #[must_use]
    pub fn label(self) -> String {
        match self {
            Self::Road(true) => "distance along the road (m), in its direction".to_owned(),
            Self::Road(false) => "distance along the road (m), against its direction".to_owned(),
            Self::Phase(period_s) => format!("clock within {period_s:.0} s (s)"),
            Self::Signal(Covariate::Speed) => "speed (m/s)".to_owned(),
            Self::Signal(Covariate::Traction) => "traction over weight (%)".to_owned(),
            Self::Signal(Covariate::TimeInMotion) => "time in motion (s)".to_owned(),
            Self::Signal(Covariate::Temperature) => "temperature (°C)".to_owned(),
            Self::Rises(_) => "traction falls (-1) or rises (1)".to_owned(),
        }
    }

    /// Returns its value in each cell of a drive.
    #[must_use]
    pub fn values(
        self,
        drive: &LoggedDrive,
        places: Option<&[Option<RoadPlace>]>,
    ) -> Vec<Option<f64>> {
        let samples = &drive.samples;
        match self {
            Self::Road(forward) => (0..samples.len())
                .map(|k| {
                    let place = places?[k]?;
                    (place.forward == forward).then_some(place.at_m)
                })
                .collect(),
            Self::Phase(period_s) => samples
                .iter()
                .map(|s| Some(seconds(s.end.time).rem_euclid(period_s)))
                .collect(),
            Self::Signal(covariate) => samples
                .iter()
                .map(|s| {
                    let percent = if covariate == Covariate::Traction {
                        100.0
                    } else {
                        1.0
                    };
                    covariate.value(s).map(|value| percent * f64::from(value))
                })
                .collect(),
            Self::Rises(play) => rises(samples, play)
                .into_iter()
                .map(|rises| Some(f64::from(rises)))
                .collect(),
        }
    }
}

/// Returns 1 where traction over weight rises, −1 where it falls, with a hysteresis in %.
fn rises(samples: &[Sample], play_percent: f32) -> Vec<f32> {
    let mut behind: Option<f32> = None;
    samples
        .iter()
        .map(|sample| {
            let percent = 100.0 * sample.forces.traction_n / (sample.forces.mass_kg * GRAVITY);
            let before = behind.unwrap_or(percent);
            let now = before.clamp(percent - play_percent, percent + play_percent);
            behind = Some(now);
            (percent - now) / play_percent
        })
        .collect()
}

impl Covariate {
    fn value(self, sample: &Sample) -> Option<f32> {
        match self {
            Self::Speed => Some(sample.end.speed_mps),
            Self::Traction => Some(sample.forces.traction_n / (sample.forces.mass_kg * GRAVITY)),
            Self::TimeInMotion => Some(sample.effect_inputs.driven_s),
            Self::Temperature => sample.effect_inputs.ambient_celsius.get(),
        }
    }
}
