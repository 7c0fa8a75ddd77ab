//! The drives of a campaign: which runs have their errors in common, and which causes are absent.

use crate::simulator::random::{Purpose, normal, stream};
use crate::simulator::truck::Preset;
use crate::study::alignment::campaign::RunGroup;
use rand::RngExt;

/// The trucks, the days of each, and the runs of a day.
const TRUCKS: [Preset; 2] = [Preset::A, Preset::B];
const DAYS: usize = 4;
const RUNS_A_DAY: usize = 3;
/// Runs of a campaign.
pub const RUNS: usize = TRUCKS.len() * DAYS * RUNS_A_DAY;
/// Stream of the errors. The streams below it are those of a scenario's runs.
const STREAM: usize = 100;
/// Parameters of a vehicle, and how wrong they are, 1 sigma.
const PARAMETERS: [(&str, f64); 4] = [
    ("mass_factor", 0.1),
    ("drag_factor", 0.1),
    ("rolling_factor", 0.1),
    ("torque_factor", 0.04),
];

/// Runs whose parameters are wrong by the same amounts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shared {
    /// None: each run has its own.
    Run,
    /// Those of a truck on a day.
    Day,
    /// Those of a truck.
    Truck,
    /// All.
    Fleet,
    /// A quarter of the variance is of each of these levels.
    Mixed,
}

impl Shared {
    /// Every one, in the order of the tables.
    pub const ALL: [Self; 5] = [Self::Run, Self::Day, Self::Truck, Self::Fleet, Self::Mixed];

    /// Returns its words.
    #[must_use]
    pub fn words(self) -> &'static str {
        match self {
            Self::Run => "each run's own",
            Self::Day => "a day's of a truck",
            Self::Truck => "a truck's",
            Self::Fleet => "the fleet's",
            Self::Mixed => "mixed",
        }
    }

    /// Returns the parts of the variance of run, day, truck and fleet.
    fn parts(self) -> [f64; 4] {
        match self {
            Self::Run => [1.0, 0.0, 0.0, 0.0],
            Self::Day => [0.0, 1.0, 0.0, 0.0],
            Self::Truck => [0.0, 0.0, 1.0, 0.0],
            Self::Fleet => [0.0, 0.0, 0.0, 1.0],
            Self::Mixed => [0.25; 4],
        }
    }
}

/// A cause of errors that is absent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Without {
    /// All are there.
    Nothing,
    /// Errors along the road: positions are replaced by true ones.
    Places,
    /// Slow and white errors of the receiver's altitude.
    Receivers,
    /// Cold tyres.
    Tyres,
    /// Wrong parameters.
    Parameters,
    /// Wind.
    Wind,
    /// All of these.
    Everything,
}

impl Without {
    /// Every one, in the order of the tables.
    pub const ALL: [Self; 7] = [
        Self::Nothing,
        Self::Places,
        Self::Receivers,
        Self::Tyres,
        Self::Parameters,
        Self::Wind,
        Self::Everything,
    ];

    /// Returns its words.
    #[must_use]
    pub fn words(self) -> &'static str {
        match self {
            Self::Nothing => "nothing",
            Self::Places => "errors along the road",
            Self::Receivers => "errors of the receiver's altitude",
            Self::Tyres => "cold tyres",
            Self::Parameters => "wrong parameters",
            Self::Wind => "wind",
            Self::Everything => "all of these",
        }
    }

    fn is(self, cause: Self) -> bool {
        self == cause || self == Self::Everything
    }
}

/// Conditions of a campaign.
#[derive(Clone, Copy, Debug)]
pub struct Conditions {
    shared: Shared,
    without: Without,
}

impl Conditions {
    /// Creates conditions.
    #[must_use]
    pub fn of(shared: Shared, without: Without) -> Self {
        Self { shared, without }
    }

    /// Returns those that are driven. With true places, runs are those with all causes.
    pub(super) fn all() -> Vec<Self> {
        let every = Shared::ALL.map(|shared| Self::of(shared, Without::Nothing));
        let driven = |without: &Without| !matches!(without, Without::Nothing | Without::Places);
        let without = Without::ALL.into_iter().filter(driven);
        let without = without.map(|without| Self::of(Shared::Mixed, without));
        every.into_iter().chain(without).collect()
    }
}

/// Returns the runs of a campaign: those of a truck on a day are a group. The same seed draws the
/// same numbers for all conditions.
#[must_use]
pub fn groups(seed: u64, conditions: Conditions) -> Vec<RunGroup> {
    let mut rng = stream(seed, STREAM, Purpose::Parameters);
    let from_deg: [f64; DAYS] = std::array::from_fn(|_| rng.random_range(0.0..360.0));
    let late_ms: [f64; TRUCKS.len()] = std::array::from_fn(|_| rng.random_range(0.0..400.0));
    let mut draw = || PARAMETERS.map(|_| normal(&mut rng));
    let parts = conditions.shared.parts();
    let of_fleet = draw();
    let mut groups = Vec::new();
    for (truck, late_ms) in TRUCKS.into_iter().zip(late_ms) {
        let of_truck = draw();
        for from_deg in from_deg {
            let of_day = draw();
            let runs = (0..RUNS_A_DAY).map(|_| {
                let levels = [draw(), of_day, of_truck, of_fleet];
                let factors = PARAMETERS.iter().enumerate().map(|(number, (key, sigma))| {
                    let sum: f64 = parts
                        .iter()
                        .zip(&levels)
                        .map(|(part, drawn)| part.sqrt() * drawn[number])
                        .sum();
                    let factor = if conditions.without.is(Without::Parameters) {
                        1.0
                    } else {
                        (1.0 + sigma * sum).clamp(0.7, 1.3)
                    };
                    format!("{key} = {factor:?}")
                });
                let factors: Vec<String> = factors.collect();
                format!("errors = {{ {} }}\n", factors.join(", "))
            });
            groups.push(RunGroup {
                truck,
                runs: runs.collect(),
                sections: sections(conditions.without, late_ms, from_deg),
            });
        }
    }
    groups
}

fn sections(without: Without, late_ms: f64, from_deg: f64) -> String {
    let mut text = format!("[rates]\nfast_ms = 100.0\n[latency_ms]\ngnss = {late_ms:?}\n");
    if without.is(Without::Receivers) {
        text += "[gnss]\naltitude_sigma_m = 0.0\naltitude_white_sigma_m = 0.0\n";
    }
    if !without.is(Without::Tyres) {
        text += "[tyres]\ncold_amount = 0.3\n";
    }
    if !without.is(Without::Wind) {
        text += &format!(
            "[wind]\nspeed_mps = 3.0\nfrom_deg = {from_deg:?}\ngust_sigma_mps = 0.3\n\
             gust_time_s = 120.0\n"
        );
    }
    text
}

/// Returns the indices of a campaign's runs in the order in which they come into a map: trucks take
/// turns, then days.
pub(super) fn order() -> impl Iterator<Item = usize> {
    (0..RUNS_A_DAY).flat_map(|run| {
        (0..DAYS).flat_map(move |day| {
            (0..TRUCKS.len()).map(move |truck| (truck * DAYS + day) * RUNS_A_DAY + run)
        })
    })
}

/// Returns the session of a run: its truck and day.
pub(super) fn session(index: usize) -> String {
    (index / RUNS_A_DAY).to_string()
}

/// Returns whether a run is of the first half of the days.
pub(super) fn is_of_first_days(index: usize) -> bool {
    index / RUNS_A_DAY % DAYS < DAYS / 2
}
