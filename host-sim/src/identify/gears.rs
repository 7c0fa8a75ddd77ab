//! The gears of a gearbox, from engine speed over wheel speed.

use super::estimate::Estimate;
use super::identified::Origin;
use super::observation::Observation;
use super::ratio_histogram::{Peak, RatioHistogram};
use estimator_core::vehicle::MAX_GEARS;
use std::collections::BTreeMap;

/// Least weight of a gear, s of steady travel, or of a lasting ratio under load: gears of a launch are driven
/// for a second or two.
const LEAST_WEIGHT_S: f64 = 1.0;
/// Least part of all steady travel that a gear has which no signal reports.
const LEAST_PART: f64 = 0.003;
/// Fewest readings of a gear with its ratio.
const LEAST_COUNT: u32 = 5;
/// Systematic error of a ratio of speeds, relative: rounding, slip of the tyres.
const FLOOR: f64 = 0.002;
/// The same of a gear of a launch: the clutch still slips a little, and speeds are of different ages.
const BRIEF_FLOOR: f64 = 0.005;
/// Relative sigma of the ratio of a gear that was not driven.
const UNSEEN: f64 = 0.1;

/// Returns the gear of an electric motor without a speed signal: one fixed reduction with these turns.
#[must_use]
pub fn single(turns_per_m: Estimate) -> FoundGear {
    FoundGear {
        turns_per_m,
        reported: None,
        origin: Origin::Assumed,
    }
}

/// One gear.
#[derive(Clone, Debug, PartialEq)]
pub struct FoundGear {
    /// Engine turns to a metre, rad/m: ratio of the gear times final drive over wheel radius.
    pub turns_per_m: Estimate,
    /// Ratio of the gear, where the bus reports it.
    pub reported: Option<f64>,
    /// Measured; read for a gear that was driven too briefly; assumed for one that was not.
    pub origin: Origin,
}

/// Returns the forward gears, first gear first; none if no gear was driven.
#[must_use]
pub fn find(observation: &Observation) -> Vec<FoundGear> {
    let by_ratio = peaks(&observation.by_ratio);
    let by_gear = peaks(&observation.by_gear);
    let mut gears = if by_ratio.is_empty() && by_gear.is_empty() {
        unreported(observation)
    } else if observation.ratio_of_gear.is_empty() && !by_ratio.is_empty() {
        let gear = |(ratio, peak): (&i64, &Peak)| measured(peak, Some(thousandths(*ratio)), FLOOR);
        by_ratio.iter().rev().map(gear).collect()
    } else {
        let brief = peaks(&observation.loaded_by_gear);
        numbered(&by_gear, &reported(observation), &brief)
    };
    gears.truncate(MAX_GEARS);
    gears
}

/// Returns the ratios of gears that a bus reports with their numbers, each the one that it reports most
/// often.
pub(super) fn reported(observation: &Observation) -> BTreeMap<i32, f64> {
    let most_often = |(gear, ratios): (&i32, &BTreeMap<i64, u32>)| {
        let (ratio, count) = ratios.iter().max_by_key(|(_, count)| **count)?;
        (*gear > 0 && *count >= LEAST_COUNT).then(|| (*gear, thousandths(*ratio)))
    };
    let ratios = observation.ratio_of_gear.iter();
    ratios.filter_map(most_often).collect()
}

/// Returns the gears of a bus that reports none: ratios that are driven for long, and those that last under
/// load.
fn unreported(observation: &Observation) -> Vec<FoundGear> {
    let long = observation
        .turns
        .peaks(LEAST_PART * observation.turns.weight());
    let mut brief = observation.loaded_turns.peaks(LEAST_WEIGHT_S);
    brief.retain(|peak| !long.iter().any(|other| other.is_near(peak)));
    brief.sort_by(|a, b| b.weight.total_cmp(&a.weight));
    brief.truncate(MAX_GEARS.saturating_sub(long.len()));
    let long = long.iter().map(|peak| measured(peak, None, FLOOR));
    let brief = brief.iter().map(|peak| measured(peak, None, BRIEF_FLOOR));
    let mut gears: Vec<FoundGear> = long.chain(brief).collect();
    gears.sort_by(|a, b| b.turns_per_m.value.total_cmp(&a.turns_per_m.value));
    gears
}

/// Returns the engine turns to a metre of a gear of ratio one, rad/m: final drive over wheel radius.
/// `None` if the bus reports no ratio with a gear that was driven.
#[must_use]
pub fn direct_turns_per_m(observation: &Observation) -> Option<f64> {
    let peaks = peaks(&observation.by_ratio);
    let longest = peaks
        .iter()
        .max_by(|a, b| a.1.weight.total_cmp(&b.1.weight))?;
    Some(longest.1.ratio / thousandths(*longest.0))
}

fn thousandths(ratio: i64) -> f64 {
    ratio as f64 / 1000.0
}

fn peaks<K: Copy + Ord>(turns: &BTreeMap<K, RatioHistogram>) -> BTreeMap<K, Peak> {
    let peak = |(key, turns): (&K, &RatioHistogram)| {
        let peak = turns.highest()?;
        // A gear that is mostly reported with other ratios is a wrong report.
        (peak.weight >= LEAST_WEIGHT_S && peak.weight > 0.5 * turns.weight())
            .then_some((*key, peak))
    };
    turns.iter().filter_map(peak).collect()
}

fn measured(peak: &Peak, reported: Option<f64>, floor: f64) -> FoundGear {
    FoundGear {
        turns_per_m: Estimate::new(peak.ratio, peak.ratio * floor.hypot(0.2 * peak.scatter)),
        reported,
        origin: Origin::Measured,
    }
}

/// Returns gears 1 to the highest one that was driven. A gear that was driven for too short a time
/// has the ratio that the bus reports, else the one that it had under load. Otherwise its ratio follows
/// from its neighbours: the steps of a gearbox are nearly equal.
fn numbered(
    driven: &BTreeMap<i32, Peak>,
    reported: &BTreeMap<i32, f64>,
    brief: &BTreeMap<i32, Peak>,
) -> Vec<FoundGear> {
    let is_forward = |(number, _): &(&i32, &Peak)| **number > 0;
    let mut known: BTreeMap<i32, FoundGear> = driven
        .iter()
        .filter(is_forward)
        .map(|(number, peak)| {
            let ratio = reported.get(number).copied();
            (*number, measured(peak, ratio, FLOOR))
        })
        .collect();
    // Turns to a metre of a gear of ratio one, from the gear that was driven for longest.
    let longest = driven
        .iter()
        .filter(|(number, _)| reported.contains_key(number));
    let longest = longest.max_by(|a, b| a.1.weight.total_cmp(&b.1.weight));
    if let Some((number, peak)) = longest {
        let direct = peak.ratio / reported[number];
        for (number, ratio) in reported {
            known.entry(*number).or_insert_with(|| FoundGear {
                turns_per_m: Estimate::new(direct * ratio, direct * ratio * FLOOR),
                reported: Some(*ratio),
                origin: Origin::Read,
            });
        }
    }
    for (number, peak) in brief.iter().filter(is_forward) {
        let gear = || measured(peak, None, BRIEF_FLOOR);
        known.entry(*number).or_insert_with(gear);
    }
    let Some(&highest) = known.keys().next_back() else {
        return Vec::new();
    };
    (1..=highest.min(MAX_GEARS as i32))
        .map(|number| {
            let own = known.get(&number).cloned();
            own.unwrap_or_else(|| between(&known, number))
        })
        .collect()
}

/// Returns a gear that was not driven. The highest gear is among the known ones.
fn between(known: &BTreeMap<i32, FoundGear>, number: i32) -> FoundGear {
    let turns = |gear: &FoundGear| gear.turns_per_m.value;
    let below = known.range(..number).next_back();
    let above = known.range(number..).next();
    let turns_per_m = match (below, above) {
        (Some((&a, from)), Some((&b, to))) => {
            let part = f64::from(number - a) / f64::from(b - a);
            turns(from) * (turns(to) / turns(from)).powf(part)
        }
        (None, Some((&b, to))) => turns(to) * usual_step(known).powi(b - number),
        (Some((_, nearest)), None) => turns(nearest),
        (None, None) => 1.0,
    };
    FoundGear {
        turns_per_m: Estimate::new(turns_per_m, turns_per_m * UNSEEN),
        reported: None,
        origin: Origin::Assumed,
    }
}

/// Returns the ratio of one gear to the next, on average; 1.3 if only one is known.
fn usual_step(known: &BTreeMap<i32, FoundGear>) -> f64 {
    let ends = known.iter().next().zip(known.iter().next_back());
    match ends {
        Some(((&a, from), (&b, to))) if b > a => {
            (from.turns_per_m.value / to.turns_per_m.value).powf(1.0 / f64::from(b - a))
        }
        _ => 1.3,
    }
}
