//! GNSS fixes, placed along the driven distance.

use super::accepted_ranges::ALTITUDES_M;
use super::latest::Latest;
use crate::angle::cos_deg;
use crate::cell::CELL_LENGTH_M;
use crate::sample::{AltitudeContinuity, AltitudeMeasurement};
use crate::scalar::Scalar;
use crate::signal::{Signal, Value};
use crate::time::Instant;
use crate::tuning::Tuning;

/// A position, and its distance from the start of the open cell.
#[derive(Clone, Copy, Debug)]
struct PositionFix {
    latitude_e7: i32,
    longitude_e7: i32,
    at_m: f32,
    /// Where this position was first reported: a receiver may be frozen.
    since_m: f32,
}

/// Units of 1e-7 degrees in a metre along a meridian.
const UNITS_PER_M: f32 = 89.8;
/// Units of 1e-7 degrees of longitude in a metre at 85 degrees of latitude, the most of any road.
const UNITS_PER_M_EAST: f32 = 1_031.0;
/// A fix may be this far from the one before beyond what was driven, m: position errors, and steps
/// of a receiver ...
const STEP_SLACK_M: f32 = 200.0;
/// ... and this times what was driven.
const STEP_RATIO: f32 = 2.0;
/// A vehicle whose wheels stand, and that is this far from where they stopped, m, was carried, by a
/// ferry or a train; or its speeds are wrong.
const CARRIED_M: f32 = 300.0;
/// Largest dilution of precision that counts: a fix beyond has no weight.
const LARGEST_DILUTION: f32 = 50.0;
/// Fewest satellites that give an altitude: position and clock are four unknowns.
const FEWEST_SATELLITES: f32 = 4.0;

impl PositionFix {
    /// Returns whether a vehicle can have come here from an earlier fix.
    fn follows(&self, earlier: &Self) -> bool {
        let reach_m = STEP_SLACK_M + STEP_RATIO * Scalar::max(0.0, self.at_m - earlier.since_m);
        // Wrapping: the date line.
        let north = self.latitude_e7.wrapping_sub(earlier.latitude_e7) as f32;
        let east = self.longitude_e7.abs_diff(earlier.longitude_e7);
        let east = east.min(3_600_000_000 - east.min(3_600_000_000)) as f32;
        north.abs() <= UNITS_PER_M * reach_m && east <= UNITS_PER_M_EAST * reach_m
    }

    /// Returns whether the vehicle was carried here from an earlier fix, since which its wheels stand.
    fn is_carried_from(&self, earlier: &Self) -> bool {
        let north = self.latitude_e7.wrapping_sub(earlier.latitude_e7) as f32;
        let east = self.longitude_e7.wrapping_sub(earlier.longitude_e7) as f32;
        let east = east * cos_deg(1e-7 * self.latitude_e7 as f32);
        let reach = UNITS_PER_M * CARRIED_M;
        north * north + east * east > reach * reach
    }
}

/// What became of an altitude.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum AltitudeOutcome {
    /// It waits for its cell, or is no altitude.
    Taken,
    /// It has too few satellites, or no fix.
    Poor,
    /// The receiver is stuck.
    Frozen,
}

/// An altitude that the receiver repeats.
#[derive(Clone, Copy, Debug)]
struct Repeated {
    altitude_m: f32,
    /// Distance at which it was first reported, from the start of the open cell, m.
    from_m: f32,
    fixes: u8,
}

/// The newest positions, and the altitude that waits for its cell with its distance.
#[derive(Clone, Debug, Default)]
pub(super) struct Gnss {
    method: Latest,
    satellites: Latest,
    hdop: Latest,
    vdop: Latest,
    latitude_e7: Option<i32>,
    fix: Option<PositionFix>,
    earlier_fix: Option<PositionFix>,
    /// The first fix of those since which the wheels hardly turned.
    standing_fix: Option<PositionFix>,
    /// A fix where the vehicle cannot be, unless the next one confirms it.
    doubted_fix: Option<PositionFix>,
    altitude: Option<(AltitudeMeasurement, f32)>,
    repeated: Option<Repeated>,
}

const fn is_on_earth(latitude_e7: i32, longitude_e7: i32) -> bool {
    latitude_e7.unsigned_abs() <= 900_000_000 && longitude_e7.unsigned_abs() <= 1_800_000_000
}

impl Gnss {
    /// Takes a reading of the quality of fixes.
    pub(super) fn quality(&mut self, now: Instant, signal: Signal, value: Option<f32>) {
        match signal {
            Signal::FixMethod => self.method.set(value, now),
            Signal::Satellites => self.satellites.set(value, now),
            Signal::Hdop => self.hdop.set(value, now),
            Signal::Vdop => self.vdop.set(value, now),
            _ => {}
        }
    }

    /// Takes a latitude, which waits for its longitude.
    pub(super) fn latitude(&mut self, value: Value) {
        self.latitude_e7 = value.degrees_e7();
    }

    /// Takes a longitude, which completes a position taken at the distance `at_m`. Returns whether the
    /// vehicle was carried there.
    pub(super) fn longitude(&mut self, value: Value, at_m: f32) -> bool {
        let (Some(latitude_e7), Some(longitude_e7)) = (self.latitude_e7.take(), value.degrees_e7())
        else {
            return false;
        };
        if !is_on_earth(latitude_e7, longitude_e7) {
            return false;
        }
        let repeated = self
            .fix
            .filter(|last| (last.latitude_e7, last.longitude_e7) == (latitude_e7, longitude_e7));
        let fix = PositionFix {
            latitude_e7,
            longitude_e7,
            at_m,
            since_m: repeated.map_or(at_m, |last| last.since_m),
        };
        if let Some(last) = self.fix
            && !fix.follows(&last)
        {
            let Some(doubted) = self.doubted_fix.replace(fix).filter(|of| fix.follows(of)) else {
                return false;
            };
            self.fix = Some(doubted);
            self.earlier_fix = None;
        }
        self.doubted_fix = None;
        // Two fixes close together give no direction.
        if self
            .fix
            .is_none_or(|last| fix.at_m - last.at_m > 0.5 * CELL_LENGTH_M)
        {
            self.earlier_fix = self.fix;
        }
        self.fix = Some(fix);
        let stands = |since: &PositionFix| (fix.at_m - since.at_m).abs() < CELL_LENGTH_M;
        let standing_fix = self.standing_fix.filter(stands);
        let is_carried = standing_fix.is_some_and(|since| fix.is_carried_from(&since));
        self.standing_fix = standing_fix.filter(|_| !is_carried).or(Some(fix));
        is_carried
    }

    /// Takes an altitude, which completes a fix taken at the distance `at_m`.
    pub(super) fn altitude(
        &mut self,
        tuning: &Tuning,
        now: Instant,
        value: Option<f32>,
        at_m: f32,
        continuity: AltitudeContinuity,
    ) -> AltitudeOutcome {
        let Some(altitude_m) = value.filter(|altitude_m| ALTITUDES_M.contains(altitude_m)) else {
            return AltitudeOutcome::Taken;
        };
        if self.is_poor(tuning, now) {
            return AltitudeOutcome::Poor;
        }
        if self.is_frozen(tuning, altitude_m, at_m) {
            return AltitudeOutcome::Frozen;
        }
        let timeout = tuning.hold_times.state_timeout;
        let quality = |latest: &Latest| latest.within(now, timeout);
        let satellites = quality(&self.satellites);
        let dilution = quality(&self.vdop).or(quality(&self.hdop)).unwrap_or(1.0);
        // Not of none: fewer than four give no altitude.
        let few = satellites.map_or(1.0, |count| {
            let missing = tuning.measurement_noise.many_satellites / Scalar::max(1.0, count);
            missing * missing
        });
        let measurement = AltitudeMeasurement {
            altitude_m,
            behind_m: 0.0,
            dilution: Scalar::max(
                Scalar::min(dilution, LARGEST_DILUTION),
                Scalar::max(few, 1.0),
            ),
            continuity,
        };
        self.altitude = Some((measurement, at_m));
        AltitudeOutcome::Taken
    }

    /// Returns whether there is no fix, or one of too few satellites.
    #[inline(never)] // Called from two places.
    pub(super) fn is_poor(&self, tuning: &Tuning, now: Instant) -> bool {
        let timeout = tuning.hold_times.state_timeout;
        let method = self.method.within(now, timeout);
        let satellites = self.satellites.within(now, timeout);
        method.is_some_and(|method| method < 0.5)
            || satellites.is_some_and(|count| count < FEWEST_SATELLITES)
    }

    /// Returns whether an altitude has been repeated for so long that the receiver is stuck.
    fn is_frozen(&mut self, tuning: &Tuning, altitude_m: f32, at_m: f32) -> bool {
        let repeated = self
            .repeated
            .filter(|repeated| repeated.altitude_m == altitude_m)
            .unwrap_or(Repeated {
                altitude_m,
                from_m: at_m,
                fixes: 0,
            });
        let fixes = repeated.fixes.saturating_add(1);
        self.repeated = Some(Repeated { fixes, ..repeated });
        fixes >= tuning.detection.frozen_readings
            && at_m - repeated.from_m > tuning.detection.fix_reach_m
    }

    /// Returns the altitude if it was taken before the distance `end_m`. Otherwise it waits for the
    /// next cell.
    pub(super) fn altitude_before(&mut self, end_m: f32) -> Option<AltitudeMeasurement> {
        let (mut measurement, at_m) = self.altitude?;
        if at_m > end_m {
            return None;
        }
        self.altitude = None;
        measurement.behind_m = end_m - at_m;
        Some(measurement)
    }

    /// Returns the position at the distance `at_m`, on the line through the last two fixes, 1e-7
    /// degrees.
    pub(super) fn position_at(&self, tuning: &Tuning, at_m: f32) -> Option<(i32, i32)> {
        let fix = self.fix?;
        let beyond_m = at_m - fix.at_m;
        if beyond_m > tuning.detection.fix_reach_m {
            return None;
        }
        let Some(earlier) = self.earlier_fix else {
            return Some((fix.latitude_e7, fix.longitude_e7));
        };
        let ratio = beyond_m / (fix.at_m - earlier.at_m);
        let extend = |now: i32, before: i32| {
            let step = now.wrapping_sub(before) as f32 * ratio;
            now.saturating_add(step as i32)
        };
        if fix.longitude_e7.abs_diff(earlier.longitude_e7) > 1_800_000_000 {
            // Between the two is the date line.
            return Some((fix.latitude_e7, fix.longitude_e7));
        }
        let latitude_e7 = extend(fix.latitude_e7, earlier.latitude_e7);
        let longitude_e7 = extend(fix.longitude_e7, earlier.longitude_e7);
        is_on_earth(latitude_e7, longitude_e7).then_some((latitude_e7, longitude_e7))
    }

    /// Closes a cell: distances count from its end.
    pub(super) fn cell_closed(&mut self) {
        self.put_back(CELL_LENGTH_M);
    }

    /// Puts all fixes back by a distance.
    #[inline(never)] // Called from several places.
    pub(super) fn put_back(&mut self, metres: f32) {
        let fixes = [
            &mut self.fix,
            &mut self.earlier_fix,
            &mut self.standing_fix,
            &mut self.doubted_fix,
        ];
        for fix in fixes.into_iter().flatten() {
            fix.at_m -= metres;
            fix.since_m -= metres;
        }
        if let Some((_, at_m)) = &mut self.altitude {
            *at_m -= metres;
        }
        if let Some(repeated) = &mut self.repeated {
            repeated.from_m -= metres;
        }
    }

    /// Drops all fixes: the distance since the last one is not known.
    pub(super) fn clear(&mut self) {
        self.fix = None;
        self.earlier_fix = None;
        self.doubted_fix = None;
        self.altitude = None;
        self.repeated = None;
    }
}
