//! Every fault on every drive, and which requirements are met.

use super::catalogue::{Fault, catalogue};
use super::drive::drive;
use super::outcome::{Counted, Phases, Times, TrueDrive, estimated, is_sound};
use crate::verdict::Verdict;
use estimator_core::Counters;
use host_sim::error::Result;
use host_sim::recorder::SmoothedRun;
use host_sim::simulator::SimulatedRun;
use host_sim::terminal::counters::events;
use rayon::prelude::*;
use std::collections::BTreeMap;

/// Trucks, and the seeds of the drives of each. The errors of one drive alone are no statistics.
pub const TRUCKS: [&str; 2] = ["A", "B"];
const SEEDS: std::ops::RangeInclusive<u64> = 1..=4;

/// Largest accepted mean of squared errors over stated variances, smoothed and lagged.
const HONEST: f64 = 3.0;
/// Largest accepted error after a fault: a factor of the error without the fault, and an addend, %.
const RECOVERED: (f64, f64) = (1.25, 0.01);
/// Largest accepted error of the distance, where the fault declares no shortfall, m.
const DISTANCE_ERROR_M: f64 = 10.0;

/// A drive, and its estimate without a fault.
struct Subject {
    run: SimulatedRun,
    truth: TrueDrive,
    clean: SmoothedRun,
}

/// The outcome of a fault on all drives of one truck.
#[derive(Clone, Debug)]
pub struct FaultOutcome {
    /// The truck.
    pub truck: &'static str,
    /// Errors with the fault.
    pub with: Phases,
    /// Those of the cells that are not marked as suspect.
    pub unmarked: Phases,
    /// Errors without it, over the same stretches.
    pub without: Phases,
    /// Increase of the counters by the fault, by key.
    pub counted: BTreeMap<&'static str, u64>,
    /// Whether all numbers are finite and all sigmas positive.
    pub is_sound: bool,
    /// Whether each cell equals the one without the fault.
    pub is_harmless: bool,
    /// Distance less the distance without the fault, of the drive where it is largest, m.
    pub distance_m: f64,
    /// Mean number of missing cells.
    pub cells_missing: f64,
}

/// A fault and its outcome on each truck.
pub struct FaultRow {
    /// The fault.
    pub fault: Fault,
    /// By truck.
    pub outcomes: Vec<FaultOutcome>,
}

impl Subject {
    fn new(truck: &str, seed: u64) -> Result<Self> {
        let run = drive(truck, seed)?;
        let recorded = Box::new(run.frames.iter().copied());
        Ok(Self {
            truth: TrueDrive::new(&run),
            clean: estimated::<f32>(&run.vehicle.model, recorded),
            run,
        })
    }

    fn with(&self, truck: &'static str, fault: &Fault) -> FaultOutcome {
        let heard = fault.received(&self.run.frames);
        let run = estimated::<f32>(&self.run.vehicle.model, heard);
        let times = Times {
            window_s: fault.window_s,
            ahead_s: fault.ahead_s,
        };
        let right = Times {
            ahead_s: 0.0,
            ..times
        };
        let distance_m = |run: &SmoothedRun| run.rows.last().map_or(0.0, |row| row.distance_m);
        FaultOutcome {
            truck,
            with: self.truth.phases(&run.rows, &times, Counted::All),
            unmarked: self.truth.phases(&run.rows, &times, Counted::Unmarked),
            without: self.truth.phases(&self.clean.rows, &right, Counted::All),
            counted: more(&run.counters, &self.clean.counters),
            is_sound: is_sound(&run.rows),
            is_harmless: run.rows == self.clean.rows,
            distance_m: distance_m(&run) - distance_m(&self.clean),
            cells_missing: self.clean.rows.len() as f64 - run.rows.len() as f64,
        }
    }
}

/// Returns the increase of each counter over the run without a fault.
fn more(with: &Counters, without: &Counters) -> BTreeMap<&'static str, u64> {
    let all = |counters: &Counters| -> BTreeMap<&'static str, u64> {
        let others = [
            ("frames not decoded", counters.frames_ignored),
            ("cells without a valid model", counters.invalid_steps.into()),
        ];
        let counted = events(counters)
            .into_iter()
            .map(|event| (event.key, event.count));
        counted.chain(others).collect()
    };
    let before = all(without);
    let more = all(with).into_iter().filter_map(|(name, count)| {
        let more = count.checked_sub(before.get(name).copied().unwrap_or(0))?;
        (more > 0).then_some((name, more))
    });
    more.collect()
}

impl FaultOutcome {
    /// Merges the outcomes of all drives of one truck.
    fn merged(mut outcomes: impl Iterator<Item = Self>) -> Option<Self> {
        let mut all = outcomes.next()?;
        let mut drives = 1.0;
        for one in outcomes {
            all.with.merge(&one.with);
            all.unmarked.merge(&one.unmarked);
            all.without.merge(&one.without);
            for (name, count) in one.counted {
                *all.counted.entry(name).or_default() += count;
            }
            all.is_sound &= one.is_sound;
            all.is_harmless &= one.is_harmless;
            if one.distance_m.abs() > all.distance_m.abs() {
                all.distance_m = one.distance_m;
            }
            all.cells_missing += one.cells_missing;
            drives += 1.0;
        }
        all.cells_missing /= drives;
        Some(all)
    }

    /// Returns whether the sigmas of unmarked cells, smoothed and lagged, are large enough during
    /// the fault and over the whole drive.
    #[must_use]
    pub fn is_honest(&self) -> bool {
        is_honest(&self.unmarked)
    }

    /// Returns whether the unmarked cells are right again after the fault: smoothed, lagged and live.
    #[must_use]
    pub fn is_recovered(&self) -> bool {
        is_recovered(&self.unmarked, &self.without)
    }

    /// Returns the bars that are not met.
    #[must_use]
    pub fn missed(&self) -> Vec<&'static str> {
        [
            ("NEES", self.is_honest()),
            ("error after", self.is_recovered()),
        ]
        .into_iter()
        .filter_map(|(bar, is_met)| (!is_met).then_some(bar))
        .collect()
    }

    /// Returns what becomes of the fault.
    #[must_use]
    pub fn verdict(&self) -> Verdict {
        if !self.missed().is_empty() {
            Verdict::NotWithstood
        } else if self.is_harmless {
            Verdict::NoEffect
        } else if is_honest(&self.with) && is_recovered(&self.with, &self.without) {
            Verdict::Withstood
        } else {
            Verdict::Marked
        }
    }

    /// Returns the marked part of the cells from the start of the fault until the recovery, %:
    /// smoothed, lagged and live.
    #[must_use]
    pub fn marked_percent(&self) -> [f64; 3] {
        let (all, unmarked) = (self.with.during.cells(), self.unmarked.during.cells());
        [0, 1, 2].map(|kind| 100.0 * (all[kind] - unmarked[kind]) as f64 / all[kind].max(1) as f64)
    }

    /// Returns whether the distance is that without the fault.
    #[must_use]
    pub fn is_as_long(&self) -> bool {
        self.distance_m.abs() <= DISTANCE_ERROR_M
    }

    /// Returns whether the fault was counted, or had no effect.
    #[must_use]
    pub fn is_counted(&self) -> bool {
        self.is_harmless || !self.counted.is_empty()
    }
}

impl FaultRow {
    /// Returns the requirements that are not met although the fault does not declare it, and those
    /// that are met although it does.
    #[must_use]
    pub fn complaints(&self) -> Vec<String> {
        let mut complaints = Vec::new();
        let short = &self.fault.short;
        for (what, is_well, declared) in [
            (
                "non-finite values",
                &FaultOutcome::is_sound as &dyn Fn(&FaultOutcome) -> bool,
                false,
            ),
            (
                "sigmas too small",
                &FaultOutcome::is_honest,
                short.dishonest,
            ),
            ("no recovery", &FaultOutcome::is_recovered, short.lasting),
            ("not counted", &FaultOutcome::is_counted, short.unseen),
            ("distance error", &FaultOutcome::is_as_long, short.displaced),
        ] {
            let of: Vec<_> = self
                .outcomes
                .iter()
                .filter(|outcome| !is_well(outcome))
                .collect();
            let trucks: Vec<_> = of.iter().map(|outcome| outcome.truck).collect();
            match (trucks.is_empty(), declared) {
                (false, false) => complaints.push(format!("{what} ({})", trucks.join(", "))),
                (true, true) => complaints.push(format!("declared, but not the case: {what}")),
                _ => {}
            }
        }
        complaints
    }
}

/// Returns whether the mean squares are those of honest sigmas, smoothed and lagged.
fn is_honest(errors: &Phases) -> bool {
    let honest = |means: [f64; 3]| means[..2].iter().all(|mean| *mean < HONEST);
    honest(errors.during.normalised()) && honest(errors.whole.normalised())
}

/// Returns whether the errors after a fault are like those without it.
fn is_recovered(with: &Phases, without: &Phases) -> bool {
    let with = with.after.rmse_percent();
    with.iter()
        .zip(without.after.rmse_percent())
        .all(|(with, without)| *with <= RECOVERED.0 * without + RECOVERED.1)
}

impl FaultOutcome {
    const fn is_sound(&self) -> bool {
        self.is_sound
    }
}

/// Runs faults on every drive: all, or those whose names contain one of these words.
///
/// # Errors
/// Returns the errors of the simulator.
pub fn matrix(only: &[String]) -> Result<Vec<FaultRow>> {
    let mut faults = catalogue();
    faults.retain(|fault| only.is_empty() || only.iter().any(|words| fault.name.contains(words)));
    let drives: Vec<(&'static str, u64)> = TRUCKS
        .into_iter()
        .flat_map(|truck| SEEDS.map(move |seed| (truck, seed)))
        .collect();
    // Drive by drive: each is simulated once, and few are in memory at the same time.
    let by_drive: Vec<Vec<FaultOutcome>> = drives
        .par_iter()
        .map(|&(truck, seed)| {
            let subject = Subject::new(truck, seed)?;
            Ok(faults
                .iter()
                .map(|fault| subject.with(truck, fault))
                .collect())
        })
        .collect::<Result<_>>()?;
    let rows = faults.into_iter().enumerate().map(|(index, fault)| {
        let of_truck = |truck: &&str| {
            let outcomes = by_drive.iter().map(|outcomes| &outcomes[index]);
            FaultOutcome::merged(outcomes.filter(|outcome| outcome.truck == *truck).cloned())
        };
        FaultRow {
            fault,
            outcomes: TRUCKS.iter().filter_map(of_truck).collect(),
        }
    });
    Ok(rows.collect())
}
