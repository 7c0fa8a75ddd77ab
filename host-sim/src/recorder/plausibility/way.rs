//! Units of speed, clock, positions and course: how they fit each other.

use super::distribution::Distribution;
use super::integral::Integral;
use super::positions::Positions;
use super::warning::Warning;
use estimator_core::{Instant, Signal};

/// Least number of stretches from which anything is concluded: 2 km.
const STRETCHES: u32 = 10;
/// Ratio of the ways of wheels and positions that no wheel and no curve makes.
const IMPLAUSIBLE: f64 = 1.25;
/// Difference from a known factor that still shows a unit.
const NEAR: f64 = 1.12;
/// Time between two speeds beyond which an estimate has gaps between all of them, s.
const LONGEST_S: f64 = 2.5;
/// Change of speed over which an acceleration is measured, m/s.
const CHANGE_MPS: f64 = 3.0;
/// Acceleration that no road vehicle keeps up, m/s².
const LARGEST_MPS2: f64 = 15.0;
/// Factors of speed units over m/s, and their names.
const SPEEDS: [(f64, &str); 6] = [
    (3.6, "km/h"),
    (2.236_94, "mph"),
    (1.943_84, "knots"),
    (3.280_84, "ft/s"),
    (1.0 / 3.6, "m/s that were scaled from km/h twice"),
    (0.001, "km/s"),
];
/// Factors of time units over seconds, and their names.
const CLOCKS: [(f64, &str); 7] = [
    (1e3, "milliseconds"),
    (1e6, "microseconds"),
    (10.0, "tenths of a second"),
    (100.0, "hundredths of a second"),
    (1.0 / 60.0, "minutes"),
    (1.0 / 3_600.0, "hours"),
    (1.0 / 86_400.0, "days"),
];
const CLOCK_ADVICE: &str = "give time in seconds (column time_s), from one clock for all signals";

/// Returns the name of the factor that is nearest to a ratio, if one is near.
fn nearest<'n>(known: &[(f64, &'n str)], ratio: f64) -> Option<&'n str> {
    let far = |factor: f64| (ratio / factor).ln().abs();
    let nearest = known.iter().min_by(|a, b| far(a.0).total_cmp(&far(b.0)))?;
    (far(nearest.0) < NEAR.ln()).then_some(nearest.1)
}

fn is_implausible(ratio: f64) -> bool {
    ratio.ln().abs() > IMPLAUSIBLE.ln()
}

/// Collects speeds and positions.
#[derive(Clone, Debug, Default)]
pub(super) struct Way {
    wheels: Integral,
    wheels_from: Option<Signal>,
    ground: Integral,
    speeds: u32,
    /// Of these, speeds below zero.
    backward: u32,
    intervals_s: Distribution,
    change_from: Option<(Instant, f64)>,
    accelerations: Distribution,
    positions: Positions,
}

impl Way {
    /// Takes a speed of wheels, m/s. One signal counts.
    pub(super) fn wheels(&mut self, now: Instant, signal: Signal, mps: f64) {
        if signal == Signal::WheelSpeed || self.wheels_from.is_none() {
            if self.wheels_from.replace(signal) != Some(signal) {
                self.wheels = Integral::default();
            }
        } else if self.wheels_from != Some(signal) {
            return;
        }
        self.speeds = self.speeds.saturating_add(1);
        self.backward += u32::from(mps < 0.0);
        if let Some(seconds) = self.wheels.add(now, mps) {
            self.intervals_s.add(seconds);
        }
        let (time, from_mps) = *self.change_from.get_or_insert((now, mps));
        let change_mps = (mps - from_mps).abs();
        if change_mps >= CHANGE_MPS {
            let seconds = now.since(time).as_secs_f64();
            self.accelerations.add(change_mps / seconds);
            self.change_from = Some((now, mps));
        }
    }

    /// Takes a speed over ground, m/s.
    pub(super) fn ground(&mut self, now: Instant, mps: f64) {
        self.ground.add(now, mps);
    }

    /// Takes a latitude, 1e-7 degrees.
    pub(super) const fn latitude(&mut self, e7: i32) {
        self.positions.latitude(e7);
    }

    /// Takes a longitude, 1e-7 degrees.
    pub(super) fn longitude(&mut self, e7: i32) {
        self.positions.longitude(e7, &self.wheels, &self.ground);
    }

    /// Takes a course, °.
    pub(super) fn course(&mut self, degrees: f64) {
        self.positions.course(degrees, &self.wheels);
    }

    /// Returns the way of the wheels so far, m.
    pub(super) const fn wheels_m(&self) -> f64 {
        self.wheels.metres()
    }

    /// Returns the newest speed of the wheels, m/s.
    pub(super) fn speed_mps(&self) -> Option<f64> {
        self.wheels.speed_mps()
    }

    /// Returns what is not plausible.
    pub(super) fn judge(&self, found: &mut Vec<Warning>) {
        if let Some(position) = self.positions_in_radians().or_else(|| self.swapped()) {
            found.push(position);
        } else if let Some(unit) = self.unit() {
            found.push(unit);
        }
        let is_clock_told = found.iter().any(|warning| warning.code == "clock_unit");
        if let Some(clock) = self.clock().filter(|_| !is_clock_told) {
            found.push(clock);
        }
        if found.is_empty() {
            found.extend(self.ground_unit());
            found.extend(self.course_unit());
        }
    }

    fn positions_in_radians(&self) -> Option<Warning> {
        if self.positions.are_zero() {
            return self.positions.are_in_radians().then(|| {
                Warning::major(
                    "positions_zero",
                    "the positions are zero",
                    "most positions are exactly 0° N 0° E".to_owned(),
                    "leave positions empty where the receiver has no fix",
                )
            });
        }
        self.positions.are_in_radians().then(|| {
            Warning::major(
                "positions_in_radians",
                "the positions are not in degrees",
                "the positions lie within 1.6° N and 3.2° E of 0°, where no road is: they look \
                 like radians"
                    .to_owned(),
                "give latitude_deg and longitude_deg in degrees: multiply by 57.29578",
            )
        })
    }

    fn swapped(&self) -> Option<Warning> {
        let positions = &self.positions;
        let warning = |message: String| {
            Warning::major(
                "positions_swapped",
                "latitude and longitude are swapped",
                message,
                "exchange latitude_deg and longitude_deg",
            )
        };
        let agreements =
            (positions.course.mean(STRETCHES)).zip(positions.course_if_swapped.mean(STRETCHES));
        if let Some((as_given, if_swapped)) = agreements
            && as_given < 0.7
            && if_swapped > 0.9
            && !self.course_is_in_radians()
        {
            return Some(warning(
                "the positions move along the course only with latitude and longitude swapped"
                    .to_owned(),
            ));
        }
        let ratio = positions.wheels_if_swapped.median_of(STRETCHES)?;
        let (given, swapped) = (
            positions.wheels.spread()?,
            positions.wheels_if_swapped.spread()?,
        );
        // Where the road always leads in one direction both are steady.
        let is_swapped = given > 0.1 && swapped < 0.3 * given && !is_implausible(ratio);
        is_swapped.then(|| {
            warning(
                "the positions are as far apart as the wheels rolled only with latitude and \
                 longitude swapped"
                    .to_owned(),
            )
        })
    }

    /// Returns the unit of speed or time that ways of wheels and positions show.
    fn unit(&self) -> Option<Warning> {
        let positions = &self.positions;
        let ratio = positions
            .wheels
            .median_of(STRETCHES)
            .filter(|ratio| is_implausible(*ratio))?;
        let ground = positions.ground.median_of(STRETCHES);
        // A wrong clock makes both ways wrong alike.
        let looks_like_clock = nearest(&CLOCKS, ratio).is_some();
        let is_no_speed = nearest(&SPEEDS[..5], ratio).is_none();
        let is_clock = match ground {
            // Speeds so far apart say nothing about each other.
            _ if self.speeds_apart_s().is_some() && looks_like_clock => is_no_speed,
            Some(ground) => !is_implausible(ratio / ground) && is_no_speed,
            None => looks_like_clock,
        };
        if ratio > 1e4 && nearest(&CLOCKS, ratio).is_none() {
            return Some(Warning::major(
                "positions_frozen",
                "the positions do not move",
                "the positions do not move while the wheels turn".to_owned(),
                "check that latitude_deg and longitude_deg are those of the drive",
            ));
        }
        if is_clock {
            let unit = nearest(&CLOCKS, ratio).unwrap_or("another unit");
            return Some(clock_warning(format!(
                "the speeds times the time give {ratio:.4} times the way of the positions: the \
                 time looks like {unit}"
            )));
        }
        let looks = nearest(&SPEEDS, ratio)
            .map_or_else(String::new, |unit| format!(": the speed looks like {unit}"));
        let looks = if self.backward > self.speeds / 2 {
            ": the speed is below zero".to_owned()
        } else {
            looks
        };
        Some(Warning::major(
            "speed_unit",
            "the wheel speed is not in m/s",
            format!("the wheels rolled {ratio:.3} times the way of the positions{looks}"),
            "give the wheel speed in m/s (column wheel_speed_mps): divide km/h by 3.6, multiply \
             mph by 0.44704",
        ))
    }

    /// Returns the time between two speeds, s, if it is too long for an estimate.
    fn speeds_apart_s(&self) -> Option<f64> {
        let interval_s = self.intervals_s.median_of(20);
        interval_s.filter(|seconds| *seconds > LONGEST_S)
    }

    /// Returns what the times between speeds, and the accelerations, say about the clock.
    fn clock(&self) -> Option<Warning> {
        if let Some(interval_s) = self.speeds_apart_s() {
            return Some(clock_warning(format!(
                "wheel speeds are {interval_s:.1} s apart (median), and an estimate needs one each \
                 {LONGEST_S} s: the time looks like milliseconds, or the logger asks for the speed too \
                 seldom"
            )));
        }
        let mps2 = self
            .accelerations
            .median_of(10)
            .filter(|mps2| *mps2 > LARGEST_MPS2)?;
        Some(clock_warning(format!(
            "the speed changes by {mps2:.0} m/s² (median of changes by {CHANGE_MPS} m/s), which \
             no road vehicle does: the time looks like minutes"
        )))
    }

    fn ground_unit(&self) -> Option<Warning> {
        let ratio = self
            .positions
            .ground
            .median_of(STRETCHES)
            .filter(|ratio| is_implausible(*ratio))?;
        let looks = nearest(&SPEEDS, ratio)
            .map_or_else(String::new, |unit| format!(": it looks like {unit}"));
        Some(Warning::minor(
            "gnss_speed_unit",
            format!("the GNSS speed is {ratio:.3} times that of the positions{looks}"),
            "give the speed over ground in m/s (column gnss_speed_mps)",
        ))
    }

    fn course_is_in_radians(&self) -> bool {
        let if_radians = self.positions.course_if_radians.mean(STRETCHES);
        self.positions.largest_course < 6.4 && if_radians.is_some_and(|cosine| cosine > 0.9)
    }

    fn course_unit(&self) -> Option<Warning> {
        let positions = &self.positions;
        let as_given = positions.course.mean(STRETCHES)?;
        if as_given > 0.7 {
            return None;
        }
        let looks = if self.course_is_in_radians() {
            ": it looks like radians"
        } else {
            ""
        };
        Some(Warning::minor(
            "course_unit",
            format!("the course is not the direction in which the positions move{looks}"),
            "give the course over ground in degrees, clockwise from north (column course_deg)",
        ))
    }
}

fn clock_warning(message: String) -> Warning {
    Warning::major(
        "clock_unit",
        "the clock is not in seconds",
        message,
        CLOCK_ADVICE,
    )
}
