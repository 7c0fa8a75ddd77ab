//! What the readings of a log show of the vehicle, in constant memory.

use super::ratio_histogram::RatioHistogram;
use crate::error::Result;
use crate::source::input::{LogInput, for_each_input};
use crate::source::read_options::ReadOptions;
use estimator_core::{Decoder, Instant, Reading, Signal};
use std::collections::{BTreeMap, VecDeque};
use std::f64::consts::PI;
use std::path::Path;

/// Slowest speed at which a ratio of speeds counts, m/s: wheel speeds are coarse below.
const SLOWEST_MPS: f64 = 1.5;
/// Oldest engine speed that counts, s.
const OLDEST_S: f64 = 0.25;
/// Time over which a ratio must not change, s.
const STEADY_S: f32 = 1.0;
/// Largest change of a ratio over that time, relative: a gear is engaged, and no clutch slips.
const STEADY: f64 = 0.025;
/// Relative acceleration (1/s) at which a ratio has half its weight: engine speed and wheel speed
/// are not of the same time.
const HALF_WEIGHT_PER_S: f64 = 0.02;
/// Net torque from which an engine is loaded, % of the reference torque: it drives the vehicle, and does not
/// idle in neutral at a steady speed.
const LOADED_PERCENT: f64 = 10.0;
/// Clutch slip above which no ratio counts, %.
const SLIP_PERCENT: f64 = 5.0;
/// Slowest speed for a comparison with GNSS speed, m/s, ...
const FAST_MPS: f64 = 8.0;
/// ... and how little it changes, m/s, for so long, s.
const STEADY_MPS: f64 = 0.4;
const STEADY_SPEED_S: f32 = 3.0;
/// Longest time between two speeds over which a way counts, s.
const LONGEST_S: f64 = 5.0;
/// What the bus tells of the vehicle.
const TOLD: [Signal; 3] = [
    Signal::Mass,
    Signal::EngineReferenceTorque,
    Signal::EngineInertia,
];
/// Speeds of the vehicle, the one to prefer last.
const SPEEDS: [Signal; 3] = [
    Signal::TachographSpeed,
    Signal::FrontAxleSpeed,
    Signal::WheelSpeed,
];
/// Steps of a reported gear ratio: SPN 526 has 0.001.
const RATIO_STEPS: f64 = 1000.0;

/// What a log shows.
#[derive(Clone, Debug, Default)]
pub struct Observation {
    /// Engine turns for one metre (rad/m) while a gear is engaged, whatever gear it is.
    pub turns: RatioHistogram,
    /// The same while the engine is loaded. A weight is a time, s, however much the vehicle accelerates.
    pub loaded_turns: RatioHistogram,
    /// Engine turns for one metre for each reported gear number.
    pub by_gear: BTreeMap<i32, RatioHistogram>,
    /// The same while the engine is loaded, weighted by the time, s.
    pub loaded_by_gear: BTreeMap<i32, RatioHistogram>,
    /// The same for each reported gear ratio, in thousandths.
    pub by_ratio: BTreeMap<i64, RatioHistogram>,
    /// For each gear number, the gear ratios reported with it, in thousandths, and how often.
    pub ratio_of_gear: BTreeMap<i32, BTreeMap<i64, u32>>,
    /// GNSS speed over wheel speed at steady speed.
    pub ground: RatioHistogram,
    /// Fastest turns of the engine, rpm.
    pub fastest_rpm: f64,
    /// Whether the engine torque is that of diagnostic answers: trucks broadcast theirs (J1939).
    pub is_light_vehicle: bool,
    /// The vehicle identification number (VIN); `None` if the bus does not send it.
    pub vehicle_number: Option<String>,
    /// Way of the wheels, m.
    pub distance_m: f64,
    /// Values that the bus tells of the vehicle.
    told: BTreeMap<Signal, Told>,
    /// Number of measurements of each signal.
    counts: BTreeMap<Signal, u64>,
}

/// Values of a signal that is a property of the vehicle.
#[derive(Clone, Copy, Debug, Default)]
struct Told {
    count: u32,
    sum: f64,
    sum_of_squares: f64,
}

/// The newest readings, while a log is read.
#[derive(Default)]
struct Newest {
    values: BTreeMap<Signal, (Instant, f64)>,
    /// Ratios, and speeds (m/s), of the last second.
    recent: VecDeque<(Instant, (f64, f64))>,
    /// Whether the last ratio was steady.
    was_steady: bool,
    /// Wheel speeds of the last seconds, m/s.
    speeds: VecDeque<(Instant, f64)>,
    /// The speed that counts: its place in the list.
    speed: usize,
    /// The first source of each signal. Others are left out.
    sources: BTreeMap<Signal, u8>,
}

/// A ratio that has not changed over the last second.
struct Steady {
    /// Time since the last ratio, s, less where the vehicle accelerates.
    weight: f64,
    /// Time since the last steady ratio, s: since the last one, or all of the second in which it turned out
    /// to be steady.
    time_s: f64,
}

impl Observation {
    /// Reads a log.
    ///
    /// # Errors
    /// Returns an error with file and line if the log cannot be read to its end.
    pub fn of(log: &Path, options: &ReadOptions) -> Result<Self> {
        let mut found = Self::default();
        let mut newest = Newest::default();
        let mut decoder = Decoder::new();
        let is_wanted = |reading: &Reading| !options.ignore.contains(&reading.signal);
        let own: Vec<Signal> = options
            .signals
            .iter()
            .flat_map(|own| own.signals())
            .collect();
        let report = for_each_input(
            log,
            options,
            |_| (),
            |input| match input {
                LogInput::Frame(timed) => {
                    decoder.decode_at(timed.time, &timed.frame, |_, pgn, reading| {
                        let first = newest.sources.entry(reading.signal).or_insert(pgn.source);
                        if *first == pgn.source
                            && is_wanted(&reading)
                            && !own.contains(&reading.signal)
                        {
                            found.take(&mut newest, timed.time, reading);
                        }
                    });
                }
                LogInput::Reading(time, reading) if is_wanted(&reading) => {
                    found.take(&mut newest, time, reading);
                }
                LogInput::Reading(..) => {}
            },
        )?;
        found.is_light_vehicle = report.has_diagnostic_torque;
        found.vehicle_number = report.vehicle_number;
        Ok(found)
    }

    /// Adds what another log shows.
    pub fn merge(&mut self, other: &Self) {
        self.turns.merge(&other.turns);
        self.loaded_turns.merge(&other.loaded_turns);
        self.ground.merge(&other.ground);
        self.fastest_rpm = self.fastest_rpm.max(other.fastest_rpm);
        self.is_light_vehicle |= other.is_light_vehicle;
        self.distance_m += other.distance_m;
        merge_each(&mut self.by_gear, &other.by_gear);
        merge_each(&mut self.loaded_by_gear, &other.loaded_by_gear);
        merge_each(&mut self.by_ratio, &other.by_ratio);
        for (gear, ratios) in &other.ratio_of_gear {
            let own = self.ratio_of_gear.entry(*gear).or_default();
            for (ratio, count) in ratios {
                *own.entry(*ratio).or_default() += count;
            }
        }
        for (signal, told) in &other.told {
            let own = self.told.entry(*signal).or_default();
            own.count += told.count;
            own.sum += told.sum;
            own.sum_of_squares += told.sum_of_squares;
        }
        for (signal, count) in &other.counts {
            *self.counts.entry(*signal).or_default() += count;
        }
    }

    /// Returns whether a signal has measurements.
    #[must_use]
    pub fn has(&self, signal: Signal) -> bool {
        self.counts.contains_key(&signal)
    }

    /// Returns whether torque comes in Nm, so that no reference torque is needed.
    #[must_use]
    pub fn has_torque_in_nm(&self) -> bool {
        self.has(Signal::MotorTorque) || self.has(Signal::NetEngineTorque)
    }

    /// Returns mean and standard deviation of what the bus tells of the vehicle.
    #[must_use]
    pub fn told(&self, signal: Signal) -> Option<(f64, f64)> {
        let told = self.told.get(&signal)?;
        let mean = told.sum / f64::from(told.count);
        let variance = told.sum_of_squares / f64::from(told.count) - mean * mean;
        Some((mean, variance.max(0.0).sqrt()))
    }

    fn take(&mut self, newest: &mut Newest, time: Instant, reading: Reading) {
        // A motor in the engine's place turns as an engine does.
        let signal = match reading.signal {
            Signal::MotorSpeed => Signal::EngineSpeed,
            signal => signal,
        };
        let place = SPEEDS.iter().position(|speed| *speed == signal);
        let signal = match place {
            Some(place) if place < newest.speed => return,
            Some(place) if reading.value.is_available() => {
                newest.speed = place;
                Signal::WheelSpeed
            }
            _ => signal,
        };
        if !reading.value.is_available() {
            newest.values.remove(&signal);
            return;
        }
        *self.counts.entry(signal).or_default() += 1;
        let Some(value) = reading.value.real().map(f64::from) else {
            return;
        };
        newest.values.insert(signal, (time, value));
        match signal {
            Signal::WheelSpeed => self.take_speed(newest, time, value),
            Signal::GnssSpeed => {
                if let Some(wheels_mps) = newest.steady_mps(time) {
                    self.ground.add(value / wheels_mps, wheels_mps);
                }
            }
            Signal::EngineSpeed => self.fastest_rpm = self.fastest_rpm.max(value),
            _ if value > 0.0 && TOLD.contains(&signal) => self.take_told(signal, value),
            _ => {}
        }
    }

    fn take_told(&mut self, signal: Signal, value: f64) {
        let told = self.told.entry(signal).or_default();
        told.count += 1;
        told.sum += value;
        told.sum_of_squares += value * value;
    }

    fn take_speed(&mut self, newest: &mut Newest, time: Instant, speed_mps: f64) {
        if let Some((last, mps)) = newest.speeds.back() {
            let seconds = time.since(*last).as_secs_f64();
            self.distance_m += 0.5 * (mps + speed_mps) * seconds.min(LONGEST_S);
        }
        newest.take_speed(time, speed_mps);
        let Some(turns) = newest.turns_per_metre(time, speed_mps) else {
            newest.recent.clear();
            return;
        };
        let gear = newest
            .value(Signal::CurrentGear)
            .map(|gear| gear.round() as i32);
        let ratio = newest
            .value(Signal::GearRatio)
            .map(|ratio| (ratio * RATIO_STEPS).round() as i64);
        let ratio = ratio.filter(|ratio| *ratio > 0);
        if let Some((gear, ratio)) = gear.zip(ratio) {
            let own = self.ratio_of_gear.entry(gear).or_default();
            *own.entry(ratio).or_default() += 1;
        }
        let Some(Steady { weight, time_s }) = newest.steadiness(time, turns, speed_mps) else {
            return;
        };
        self.turns.add(turns, weight);
        if newest.is_loaded() {
            self.loaded_turns.add(turns, time_s);
            if let Some(gear) = gear {
                let of_gear = self.loaded_by_gear.entry(gear).or_default();
                of_gear.add(turns, time_s);
            }
        }
        if let Some(gear) = gear {
            self.by_gear.entry(gear).or_default().add(turns, weight);
        }
        if let Some(ratio) = ratio {
            self.by_ratio.entry(ratio).or_default().add(turns, weight);
        }
    }
}

/// Merges the histograms of another map into those of the same keys.
fn merge_each<K: Copy + Ord>(
    own: &mut BTreeMap<K, RatioHistogram>,
    other: &BTreeMap<K, RatioHistogram>,
) {
    for (key, turns) in other {
        own.entry(*key).or_default().merge(turns);
    }
}

/// Drops what is older than this, but keeps one value that reaches back so far.
fn forget_older<T>(values: &mut VecDeque<(Instant, T)>, now: Instant, span_s: f32) {
    let is_old = |(at, _): &(Instant, T)| now.since(*at).seconds() > span_s;
    while values.len() > 2 && values.get(1).is_some_and(is_old) {
        values.pop_front();
    }
}

impl Newest {
    fn value(&self, signal: Signal) -> Option<f64> {
        self.values.get(&signal).map(|(_, value)| *value)
    }

    fn take_speed(&mut self, now: Instant, speed_mps: f64) {
        self.speeds.push_back((now, speed_mps));
        forget_older(&mut self.speeds, now, STEADY_SPEED_S);
    }

    /// Returns the mean wheel speed of the last seconds if it was steady, so that the ages of both
    /// speeds do not matter.
    fn steady_mps(&self, now: Instant) -> Option<f64> {
        let (first, _) = *self.speeds.front()?;
        let (last, _) = *self.speeds.back()?;
        let is_full = last.since(first).seconds() >= STEADY_SPEED_S;
        let is_fresh = now.since(last).seconds() < 1.0;
        let (mut least, mut most, mut sum) = (f64::INFINITY, 0.0_f64, 0.0);
        for (_, mps) in &self.speeds {
            (least, most, sum) = (least.min(*mps), most.max(*mps), sum + mps);
        }
        (is_full && is_fresh && least > FAST_MPS && most - least < STEADY_MPS)
            .then(|| sum / self.speeds.len() as f64)
    }

    /// Returns the acceleration between the last two wheel speeds, m/s²; 0 before them.
    fn acceleration_mps2(&self) -> f64 {
        let mut newest = self.speeds.iter().rev();
        let (Some((now, mps)), Some((last, last_mps))) = (newest.next(), newest.next()) else {
            return 0.0;
        };
        let seconds = now.since(*last).as_secs_f64();
        if seconds > 0.0 {
            (mps - last_mps) / seconds
        } else {
            0.0
        }
    }

    /// Returns how far the engine turns for one metre, rad/m; `None` where no gear may be engaged. The
    /// wheel speed is that of the time of the engine speed, which is the older one.
    fn turns_per_metre(&self, now: Instant, speed_mps: f64) -> Option<f64> {
        let is_on = |signal| self.value(signal).is_some_and(|value| value > 0.5);
        let (at, rpm) = *self.values.get(&Signal::EngineSpeed)?;
        let age_s = now.since(at).as_secs_f64();
        let is_open = self
            .value(Signal::DrivelineEngaged)
            .is_some_and(|engaged| engaged < 0.5)
            || is_on(Signal::ShiftInProcess)
            || is_on(Signal::ClutchSwitch)
            || self
                .value(Signal::ClutchSlip)
                .is_some_and(|slip| slip > SLIP_PERCENT)
            || self
                .value(Signal::CurrentGear)
                .is_some_and(|gear| gear < 0.5);
        if is_open || speed_mps < SLOWEST_MPS || rpm <= 0.0 || age_s > OLDEST_S {
            return None;
        }
        Some(rpm * PI / 30.0 / (speed_mps - self.acceleration_mps2() * age_s))
    }

    /// Returns whether the engine drives the vehicle.
    fn is_loaded(&self) -> bool {
        self.value(Signal::EngineTorque).is_some_and(|torque| {
            torque - self.value(Signal::FrictionTorque).unwrap_or(0.0) > LOADED_PERCENT
        })
    }

    /// Takes a ratio. Returns how much it counts; `None` if it has changed over the last second.
    fn steadiness(&mut self, now: Instant, turns: f64, speed_mps: f64) -> Option<Steady> {
        let was_steady = std::mem::take(&mut self.was_steady);
        let last = self.recent.back().map(|(at, ..)| *at);
        self.recent.push_back((now, (turns, speed_mps)));
        forget_older(&mut self.recent, now, STEADY_S);
        let (first, (_, first_mps)) = *self.recent.front()?;
        let length_s = now.since(first).seconds();
        if !(STEADY_S..=4.0 * STEADY_S).contains(&length_s) {
            return None;
        }
        let of = |pick: fn(f64, f64) -> f64| {
            let ratios = self.recent.iter().map(|(_, (turns, _))| *turns);
            ratios.reduce(pick)
        };
        if of(f64::max)? > of(f64::min)? * (1.0 + STEADY) {
            return None;
        }
        self.was_steady = true;
        let per_s = (speed_mps / first_mps).ln() / f64::from(length_s);
        let duration_s = f64::from(now.since(last?).seconds());
        let before_s = if was_steady { 0.0 } else { f64::from(STEADY_S) };
        Some(Steady {
            weight: duration_s / (1.0 + (per_s / HALF_WEIGHT_PER_S).powi(2)),
            time_s: before_s + duration_s,
        })
    }
}
