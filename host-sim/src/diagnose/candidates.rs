//! What is tried: the core's effects, each as a column of forces or as several to choose from; and
//! plain dependences on time, place and signals, for what no effect explains.

use super::drive::{LoggedDrive, RoadPlace};
use super::evidence::Column;
use estimator_core::effect::{Acts, CATALOGUE, Details, Effect};
use estimator_core::sampler::Sample;
use estimator_core::vehicle::GRAVITY;
use estimator_core::{Instant, VehicleParameters};

/// Times in which tyres warm up that are tried, s.
const WARMUP_TIMES_S: [f32; 4] = [600.0, 1_000.0, 1_700.0, 2_800.0];
/// Length of a piece of road, of which rough stretches are made, m.
const PIECE_M: f64 = 500.0;
/// Most pieces; longer roads have longer ones.
const MOST_PIECES: usize = 60;
/// Longest stretch, as a part of the road: what is everywhere is no stretch.
const LONGEST_STRETCH: f64 = 0.4;

/// One way in which an effect may be there.
#[derive(Clone, Debug)]
pub struct Choice {
    /// For each of its amounts, the columns that make its force together.
    pub amounts: Vec<Vec<usize>>,
    /// What tells it from other choices.
    pub detail: Detail,
}

/// What tells one choice from another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Detail {
    /// There is nothing to choose.
    None,
    /// Time in which tyres warm up, s.
    Time(f32),
    /// Whether the power goes with the fan: 1 or 0.
    Fan(f32),
    /// Wind from the north and from the east.
    Compass,
    /// A stretch of the common road, m.
    Stretch(f64, f64),
    /// Period of a cycle, s.
    Period(f64),
}

/// What a plain dependence is drawn over.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Variable {
    /// Distance along the common road, m, in one direction.
    Road(bool),
    /// The log's clock within a period, s.
    Phase(f64),
    /// A signal.
    Signal(Told),
    /// Whether traction rises (1) or falls (−1), with this play.
    Rises(f32),
}

/// Something to try, with its choices.
#[derive(Clone, Debug)]
pub struct Candidate {
    /// Name of the effect, or what the rest depends on.
    pub name: &'static str,
    /// The effect; none for a plain dependence.
    pub effect: Option<&'static Effect>,
    /// Usual size of an amount.
    pub typical: f64,
    /// At least one.
    pub choices: Vec<Choice>,
}

/// Columns of one kind of every drive are in the same place.
#[derive(Clone, Debug, Default)]
pub struct Menu {
    /// What is tried.
    pub candidates: Vec<Candidate>,
    columns: Vec<Kind>,
}

/// What a column is the force of.
#[derive(Clone, Copy, Debug)]
enum Kind {
    Effect(&'static Effect, Details),
    /// On one drive only.
    OnDrive(&'static Effect, Details, usize),
    /// The weight, on a piece of road, both ways or one.
    Piece(usize, f64, Option<bool>),
    /// A thousandth of the weight times a function of what a drive tells.
    Basis(Basis),
}

/// Plain functions, of about one in size.
#[derive(Clone, Copy, Debug)]
enum Basis {
    /// Cosine and sine of the clock in a period, s.
    Cosine(f64),
    Sine(f64),
    /// Whether a signal is in its lowest, second, … of [`BINS`] parts, less the mean of that.
    Bin(Told, usize),
    /// 1 where traction over weight (%) rises, −1 where it falls, with this play.
    Rises(f32),
}

/// A signal on which the rest may depend.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Told {
    /// m/s.
    Speed,
    /// Traction over weight, %.
    Traction,
    /// s.
    TimeInMotion,
    /// °C.
    Temperature,
}

/// Parts into which a signal's values are sorted.
const BINS: usize = 5;
/// Periods of cycles that are tried, s: from the shortest that a fix a second and the road's waves
/// leave, each a twentieth longer than the last.
const PERIODS_S: (f64, f64, f64) = (40.0, 900.0, 1.05);
/// Plays of a driveline's hysteresis that are tried, % of the weight.
const PLAYS_PERCENT: [f32; 3] = [0.1, 0.3, 1.0];
/// A tenth of a percent is the usual size of a plain dependence: its columns are in that unit.
const BASIS_UNIT: f32 = 1e-3;

impl Menu {
    /// For drives with these numbers to fit, over a road of this length if they share one.
    #[must_use]
    pub fn new(road_m: Option<f64>, drives: &[usize]) -> Self {
        let mut menu = Self::default();
        for effect in CATALOGUE {
            let choices = match (effect.name, effect.acts) {
                // Found from GNSS speed, not from forces.
                (_, Acts::WheelRadius) => continue,
                ("tyre_warmup", _) => WARMUP_TIMES_S
                    .iter()
                    .map(|&time_s| menu.on_each(effect, time_s, drives))
                    .collect(),
                ("auxiliary_load", _) => [0.0, 1.0]
                    .map(|with_fan| menu.choice(effect, &[Some(with_fan)], Detail::Fan(with_fan)))
                    .to_vec(),
                ("headwind", _) => {
                    let amounts = [0.0, 90.0]
                        .map(|from_deg| vec![menu.column(effect, &[Some(from_deg)])])
                        .to_vec();
                    vec![Choice {
                        amounts,
                        detail: Detail::Compass,
                    }]
                }
                ("road_surface", _) => match road_m {
                    Some(road_m) => menu.stretches(road_m, None),
                    None => continue,
                },
                _ => vec![menu.choice(effect, &[], Detail::None)],
            };
            menu.candidates.push(Candidate {
                name: effect.name,
                effect: Some(effect),
                typical: f64::from(effect.typical),
                choices,
            });
        }
        menu.plain_dependences(road_m);
        menu
    }

    fn plain_dependences(&mut self, road_m: Option<f64>) {
        let plain = |menu: &mut Self, name, typical, choices| {
            menu.candidates.push(Candidate {
                name,
                effect: None,
                typical,
                choices,
            });
        };
        if let Some(road_m) = road_m {
            let mut choices = self.stretches(road_m, Some(true));
            choices.extend(self.stretches(road_m, Some(false)));
            plain(self, "place and direction", f64::from(BASIS_UNIT), choices);
        }
        let (mut period_s, longest_s, step) = PERIODS_S;
        let mut choices = Vec::new();
        while period_s <= longest_s {
            let bases = [Basis::Cosine(period_s), Basis::Sine(period_s)];
            choices.push(self.basis(&bases, Detail::Period(period_s)));
            period_s *= step;
        }
        plain(self, "time (a cycle)", 1.0, choices);
        let choices = PLAYS_PERCENT.map(|play| self.basis(&[Basis::Rises(play)], Detail::None));
        plain(self, "torque (rising or falling)", 1.0, choices.to_vec());
        for (name, told) in [
            ("speed", Told::Speed),
            ("torque", Told::Traction),
            ("time in motion", Told::TimeInMotion),
            ("temperature", Told::Temperature),
        ] {
            // One less than there are: the mean is a resistance.
            let bases: Vec<Basis> = (1..BINS).map(|bin| Basis::Bin(told, bin)).collect();
            let choice = self.basis(&bases, Detail::None);
            plain(self, name, 1.0, vec![choice]);
        }
    }

    fn basis(&mut self, bases: &[Basis], detail: Detail) -> Choice {
        let first = self.columns.len();
        self.columns
            .extend(bases.iter().map(|&basis| Kind::Basis(basis)));
        Choice {
            amounts: (first..self.columns.len())
                .map(|column| vec![column])
                .collect(),
            detail,
        }
    }

    fn column(&mut self, effect: &'static Effect, given: &[Option<f32>]) -> usize {
        let mut details: Details = Default::default();
        for (i, detail) in effect.details.iter().enumerate() {
            let given = given.get(i).copied().flatten();
            details[i] = given.or(detail.default.get()).into();
        }
        self.columns.push(Kind::Effect(effect, details));
        self.columns.len() - 1
    }

    fn choice(&mut self, effect: &'static Effect, given: &[Option<f32>], detail: Detail) -> Choice {
        Choice {
            amounts: vec![vec![self.column(effect, given)]],
            detail,
        }
    }

    /// An amount for each drive: nobody tells how long the tyres had cooled before it.
    fn on_each(&mut self, effect: &'static Effect, time_s: f32, drives: &[usize]) -> Choice {
        let common = self.column(effect, &[Some(time_s)]);
        let Kind::Effect(effect, details) = self.columns[common] else {
            unreachable!("it was just made");
        };
        self.columns.pop();
        let amounts = drives
            .iter()
            .map(|&drive| {
                self.columns.push(Kind::OnDrive(effect, details, drive));
                vec![self.columns.len() - 1]
            })
            .collect();
        Choice {
            amounts,
            detail: Detail::Time(time_s),
        }
    }

    fn stretches(&mut self, road_m: f64, forward: Option<bool>) -> Vec<Choice> {
        let pieces = ((road_m / PIECE_M).ceil() as usize).clamp(1, MOST_PIECES);
        let piece_m = road_m / pieces as f64;
        let first = self.columns.len();
        self.columns
            .extend((0..pieces).map(|piece| Kind::Piece(piece, piece_m, forward)));
        let longest = (LONGEST_STRETCH * pieces as f64) as usize;
        let mut choices = Vec::new();
        for length in 1..=longest {
            for from in 0..=pieces - length {
                choices.push(Choice {
                    amounts: vec![(first + from..first + from + length).collect()],
                    detail: Detail::Stretch(
                        from as f64 * piece_m,
                        (from + length) as f64 * piece_m,
                    ),
                });
            }
        }
        choices
    }

    /// The forces of every column on a drive, N.
    #[must_use]
    pub fn columns(
        &self,
        vehicle: &VehicleParameters,
        number: usize,
        drive: &LoggedDrive,
        places: Option<&[Option<RoadPlace>]>,
    ) -> Vec<Column> {
        self.columns
            .iter()
            .map(|kind| match kind {
                Kind::OnDrive(_, _, other) if *other != number => vec![0.0; drive.samples.len()],
                Kind::Effect(effect, details) | Kind::OnDrive(effect, details, _) => drive
                    .samples
                    .iter()
                    .map(|sample| effect.derivative_n(vehicle, sample, details, 0.0))
                    .collect(),
                Kind::Piece(piece, piece_m, way) => drive
                    .samples
                    .iter()
                    .enumerate()
                    .map(|(k, sample)| {
                        let place = places.and_then(|places| places[k]);
                        let here = place.is_some_and(|p| {
                            (p.at_m / piece_m) as usize == *piece
                                && way.is_none_or(|forward| p.forward == forward)
                        });
                        let weight_n = sample.load.mass_kg * GRAVITY;
                        if here { weight_n } else { 0.0 }
                    })
                    .collect(),
                Kind::Basis(basis) => basis.column(drive),
            })
            .collect()
    }

    /// What a choice of a plain dependence is drawn over; none for effects.
    #[must_use]
    pub fn variable(&self, choice: &Choice) -> Option<Variable> {
        let column = *choice.amounts.first()?.first()?;
        match (self.columns[column], choice.detail) {
            (Kind::Piece(_, _, Some(forward)), _) => Some(Variable::Road(forward)),
            (Kind::Basis(_), Detail::Period(period_s)) => Some(Variable::Phase(period_s)),
            (Kind::Basis(Basis::Bin(told, _)), _) => Some(Variable::Signal(told)),
            (Kind::Basis(Basis::Rises(play)), _) => Some(Variable::Rises(play)),
            _ => None,
        }
    }

    /// Number of columns.
    #[must_use]
    pub fn width(&self) -> usize {
        self.columns.len()
    }
}

impl Basis {
    fn column(self, drive: &LoggedDrive) -> Column {
        let samples = &drive.samples;
        let unit_n = |sample: &Sample| BASIS_UNIT * sample.load.mass_kg * GRAVITY;
        let of_phase = |period_s: f64, wave: fn(f64) -> f64| {
            let phase =
                |sample: &Sample| wave(std::f64::consts::TAU * clock_s(sample) / period_s) as f32;
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
            Self::Bin(told, bin) => {
                let values: Vec<Option<f32>> = samples.iter().map(|s| told.value(s)).collect();
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
    /// With its unit, for an axis.
    #[must_use]
    pub fn label(self) -> String {
        match self {
            Self::Road(true) => "distance along the road (m), in its direction".to_owned(),
            Self::Road(false) => "distance along the road (m), against its direction".to_owned(),
            Self::Phase(period_s) => format!("clock within {period_s:.0} s (s)"),
            Self::Signal(Told::Speed) => "speed (m/s)".to_owned(),
            Self::Signal(Told::Traction) => "traction over weight (%)".to_owned(),
            Self::Signal(Told::TimeInMotion) => "time in motion (s)".to_owned(),
            Self::Signal(Told::Temperature) => "temperature (°C)".to_owned(),
            Self::Rises(_) => "traction falls (-1) or rises (1)".to_owned(),
        }
    }

    /// Its value in each cell of a drive.
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
                .map(|s| Some(clock_s(s).rem_euclid(period_s)))
                .collect(),
            Self::Signal(told) => samples
                .iter()
                .map(|s| {
                    let percent = if told == Told::Traction { 100.0 } else { 1.0 };
                    told.value(s).map(|value| percent * f64::from(value))
                })
                .collect(),
            Self::Rises(play) => rises(samples, play)
                .into_iter()
                .map(|rises| Some(f64::from(rises)))
                .collect(),
        }
    }
}

/// What the log's clock shows, s.
fn clock_s(sample: &Sample) -> f64 {
    1e-6 * sample.place.time.since(Instant::default()).micros() as f64
}

/// 1 where traction over weight rises, −1 where it falls, with a play in %.
fn rises(samples: &[Sample], play_percent: f32) -> Vec<f32> {
    let mut behind: Option<f32> = None;
    samples
        .iter()
        .map(|sample| {
            let percent = 100.0 * sample.load.traction_n / (sample.load.mass_kg * GRAVITY);
            let before = behind.unwrap_or(percent);
            let now = before.clamp(percent - play_percent, percent + play_percent);
            behind = Some(now);
            (percent - now) / play_percent
        })
        .collect()
}

impl Told {
    fn value(self, sample: &Sample) -> Option<f32> {
        match self {
            Self::Speed => Some(sample.place.speed_mps),
            Self::Traction => Some(sample.load.traction_n / (sample.load.mass_kg * GRAVITY)),
            Self::TimeInMotion => Some(sample.circumstances.driven_s),
            Self::Temperature => sample.circumstances.ambient_celsius.get(),
        }
    }
}

impl Choice {
    /// Whether it is a cycle, whose phase is each drive's own.
    #[must_use]
    pub const fn is_cycle(&self) -> bool {
        matches!(self.detail, Detail::Period(_))
    }
}
