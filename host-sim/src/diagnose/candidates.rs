//! Candidates of the search: the core's effects, each with one or several choices; and plain
//! dependences on time, place and signals, for a residual that no effect explains.

use super::column_kind::ColumnKind;
use super::dependence::{BASIS_UNIT, BINS, BasisFunction, Covariate, Variable};
use super::drive::{LoggedDrive, RoadPlace};
use super::evidence::ForceColumn;
use estimator_core::VehicleParameters;
use estimator_core::effect::{CATALOGUE, Effect, ParameterValues, Varies, search_of};

/// Length of a piece of road, m. Road sections are made of pieces.
const PIECE_M: f64 = 500.0;
/// Largest number of pieces. Longer roads have longer pieces.
const MOST_PIECES: usize = 60;
/// Longest section, as a fraction of the road: an effect everywhere is not a section.
const LONGEST_STRETCH: f64 = 0.4;

/// One choice of a candidate.
#[derive(Clone, Debug)]
pub struct Choice {
    /// For each of its amounts, the columns whose sum is its force.
    pub amounts: Vec<Vec<usize>>,
    /// Columns of drives held out, of which each has an amount of its own.
    pub held_out: Vec<usize>,
    /// The parameter in which it differs from other choices.
    pub detail: Detail,
}

/// The parameter in which choices differ.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Detail {
    /// The candidate has one choice.
    None,
    /// A value of the parameter with this key.
    Value(&'static str, f32),
    /// The same, with a separate amount for each drive.
    EachDrive(&'static str, f32),
    /// The same, with one amount for some of the drives. The others have none.
    SomeDrives {
        /// Key of the parameter.
        key: &'static str,
        /// Its value.
        value: f32,
        /// Number of drives that have the amount.
        with: usize,
        /// Number of drives.
        of: usize,
    },
    /// Amounts towards north and east. The parameter with this key is the direction.
    Direction(&'static str),
    /// A section of the common road, m.
    RoadSection(f64, f64),
    /// Period of a cycle, s.
    Period(f64),
}

/// A candidate with its choices.
#[derive(Clone, Debug)]
pub struct Candidate {
    /// Name of the effect, or of the variable of a plain dependence.
    pub name: &'static str,
    /// The effect; `None` for a plain dependence.
    pub effect: Option<&'static Effect>,
    /// Usual size of an amount.
    pub typical: f64,
    /// At least one choice.
    pub choices: Vec<Choice>,
}

/// The candidates. A column has the same index on every drive.
#[derive(Clone, Debug, Default)]
pub struct Menu {
    /// The candidates.
    pub candidates: Vec<Candidate>,
    /// Columns of the errors of a sensor that is part of the evidence, each with its standard
    /// deviation. They are unknowns beside all candidates.
    pub sensor_errors: Vec<(usize, f64)>,
    columns: Vec<ColumnKind>,
}

/// What the drives are like, which decides what can be found on them.
#[derive(Clone, Copy, Debug)]
pub struct DriveFacts {
    /// Number of drives to fit, which are first.
    pub fitted: usize,
    /// Number of all drives, with those held out.
    pub of: usize,
    /// Length of their common road, m, if they have one.
    pub road_m: Option<f64>,
    /// Range of their air temperatures, K.
    pub temperatures_k: f32,
    /// How long half of them last at least, s.
    pub duration_s: f64,
}

/// Tried periods of cycles, s: shortest, longest, and the ratio of one to the one before. The
/// shortest period is limited by one fix a second and by the waves of the road.
const PERIODS_S: (f64, f64, f64) = (40.0, 900.0, 1.05);
/// A cycle repeats at least so often on a drive: a longer one is a drift.
const FEWEST_PERIODS: f64 = 3.0;
/// Tried widths of a driveline's hysteresis, % of the weight.
const PLAYS_PERCENT: [f32; 3] = [0.1, 0.3, 1.0];

impl Menu {
    /// Creates the candidates for these drives.
    #[must_use]
    pub fn new(drives: &DriveFacts) -> Self {
        let mut menu = Self::default();
        for effect in CATALOGUE {
            let choices = match search_of(effect).map_or(Varies::Amount, |search| search.varies) {
                Varies::GnssSpeed => continue,
                Varies::AmountOverTemperatures { smallest_range_k }
                    if drives.temperatures_k < smallest_range_k =>
                {
                    continue;
                }
                Varies::Amount | Varies::AmountOverTemperatures { .. } => {
                    vec![menu.choice(effect, &[], Detail::None)]
                }
                Varies::AmountForEachValue { key, values } => values
                    .iter()
                    .map(|&value| menu.choice(effect, &[Some(value)], Detail::Value(key, value)))
                    .collect(),
                Varies::AmountForEachDrive { key, values } => values
                    .iter()
                    .map(|&value| menu.on_each(effect, (key, value), drives))
                    .collect(),
                Varies::NorthAndEast { key } => {
                    let amounts = [0.0, 90.0]
                        .map(|direction_deg| vec![menu.column(effect, &[Some(direction_deg)])])
                        .to_vec();
                    vec![Choice {
                        amounts,
                        held_out: Vec::new(),
                        detail: Detail::Direction(key),
                    }]
                }
                Varies::RoadSection { .. } => match drives.road_m {
                    Some(road_m) => menu.road_sections(road_m, None),
                    None => continue,
                },
            };
            menu.candidates.push(Candidate {
                name: effect.name,
                effect: Some(effect),
                typical: f64::from(effect.typical),
                choices,
            });
        }
        menu.plain_dependences(drives);
        menu
    }

    /// Adds unknown errors of a sensor with these standard deviations; returns their columns.
    pub fn add_sensor_errors<const N: usize>(&mut self, sigmas: [f64; N]) -> [usize; N] {
        sigmas.map(|sigma| {
            self.columns.push(ColumnKind::SensorError);
            let column = self.columns.len() - 1;
            self.sensor_errors.push((column, sigma));
            column
        })
    }

    fn plain_dependences(&mut self, drives: &DriveFacts) {
        let plain = |menu: &mut Self, name, typical, choices| {
            menu.candidates.push(Candidate {
                name,
                effect: None,
                typical,
                choices,
            });
        };
        if let Some(road_m) = drives.road_m {
            let mut choices = self.road_sections(road_m, Some(true));
            choices.extend(self.road_sections(road_m, Some(false)));
            plain(self, "place and direction", f64::from(BASIS_UNIT), choices);
        }
        let (mut period_s, longest_s, step) = PERIODS_S;
        let longest_s = longest_s
            .min(drives.duration_s / FEWEST_PERIODS)
            .max(period_s);
        let mut choices = Vec::new();
        while period_s <= longest_s {
            let bases = [
                BasisFunction::Cosine(period_s),
                BasisFunction::Sine(period_s),
            ];
            choices.push(self.basis(&bases, Detail::Period(period_s)));
            period_s *= step;
        }
        plain(self, "time (a cycle)", 1.0, choices);
        let choices =
            PLAYS_PERCENT.map(|play| self.basis(&[BasisFunction::Rises(play)], Detail::None));
        plain(self, "torque (rising or falling)", 1.0, choices.to_vec());
        for (name, covariate) in [
            ("speed", Covariate::Speed),
            ("torque", Covariate::Traction),
            ("time in motion", Covariate::TimeInMotion),
            ("temperature", Covariate::Temperature),
        ] {
            // One less than the number of bins: their mean is a resistance.
            let bases: Vec<BasisFunction> = (1..BINS)
                .map(|bin| BasisFunction::Bin(covariate, bin))
                .collect();
            let choice = self.basis(&bases, Detail::None);
            plain(self, name, 1.0, vec![choice]);
        }
    }

    fn basis(&mut self, bases: &[BasisFunction], detail: Detail) -> Choice {
        let first = self.columns.len();
        self.columns
            .extend(bases.iter().map(|&basis| ColumnKind::Basis(basis)));
        Choice {
            amounts: (first..self.columns.len())
                .map(|column| vec![column])
                .collect(),
            held_out: Vec::new(),
            detail,
        }
    }

    fn column(&mut self, effect: &'static Effect, given: &[Option<f32>]) -> usize {
        let mut details: ParameterValues = Default::default();
        for (i, detail) in effect.parameters.iter().enumerate() {
            let given = given.get(i).copied().flatten();
            details[i] = given.or(detail.default.get()).into();
        }
        self.columns.push(ColumnKind::Effect(effect, details));
        self.columns.len() - 1
    }

    fn choice(&mut self, effect: &'static Effect, given: &[Option<f32>], detail: Detail) -> Choice {
        Choice {
            amounts: vec![vec![self.column(effect, given)]],
            held_out: Vec::new(),
            detail,
        }
    }

    /// Returns a choice with an amount for each drive. The time for which the tyres had cooled
    /// before a drive is unknown.
    fn on_each(
        &mut self,
        effect: &'static Effect,
        (key, value): (&'static str, f32),
        drives: &DriveFacts,
    ) -> Choice {
        let common = self.column(effect, &[Some(value)]);
        let ColumnKind::Effect(effect, details) = self.columns[common] else {
            unreachable!("it was just made");
        };
        self.columns.pop();
        let first = self.columns.len();
        let each = (0..drives.of).map(|drive| ColumnKind::OnDrive(effect, details, drive));
        self.columns.extend(each);
        Choice {
            amounts: (first..first + drives.fitted)
                .map(|column| vec![column])
                .collect(),
            held_out: (first + drives.fitted..self.columns.len()).collect(),
            detail: Detail::EachDrive(key, value),
        }
    }

    fn road_sections(&mut self, road_m: f64, forward: Option<bool>) -> Vec<Choice> {
        let pieces = ((road_m / PIECE_M).ceil() as usize).clamp(1, MOST_PIECES);
        let piece_m = road_m / pieces as f64;
        let first = self.columns.len();
        self.columns
            .extend((0..pieces).map(|piece| ColumnKind::Piece(piece, piece_m, forward)));
        let longest = (LONGEST_STRETCH * pieces as f64) as usize;
        let mut choices = Vec::new();
        for length in 1..=longest {
            for from in 0..=pieces - length {
                choices.push(Choice {
                    amounts: vec![(first + from..first + from + length).collect()],
                    held_out: Vec::new(),
                    detail: Detail::RoadSection(
                        from as f64 * piece_m,
                        (from + length) as f64 * piece_m,
                    ),
                });
            }
        }
        choices
    }

    /// Returns the forces of every column on a drive, N.
    #[must_use]
    pub fn columns(
        &self,
        vehicle: &VehicleParameters,
        number: usize,
        drive: &LoggedDrive,
        places: Option<&[Option<RoadPlace>]>,
    ) -> Vec<ForceColumn> {
        let force = |kind: &ColumnKind| kind.force(vehicle, number, drive, places);
        self.columns.iter().map(force).collect()
    }

    /// Returns the x variable of a plain dependence's plot; `None` for effects.
    #[must_use]
    pub fn variable(&self, choice: &Choice) -> Option<Variable> {
        let column = *choice.amounts.first()?.first()?;
        match (self.columns[column], choice.detail) {
            (ColumnKind::Piece(_, _, Some(forward)), _) => Some(Variable::Road(forward)),
            (ColumnKind::Basis(_), Detail::Period(period_s)) => Some(Variable::Phase(period_s)),
            (ColumnKind::Basis(BasisFunction::Bin(covariate, _)), _) => {
                Some(Variable::Signal(covariate))
            }
            (ColumnKind::Basis(BasisFunction::Rises(play)), _) => Some(Variable::Rises(play)),
            _ => None,
        }
    }

    /// Returns the number of columns.
    #[must_use]
    pub fn width(&self) -> usize {
        self.columns.len()
    }
}

impl Choice {
    /// Returns whether the choice is a cycle. The phase of a cycle is each drive's own.
    #[must_use]
    pub const fn is_cycle(&self) -> bool {
        matches!(self.detail, Detail::Period(_))
    }
}
