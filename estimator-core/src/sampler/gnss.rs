//! GNSS fixes, placed on the driven way.

use super::latest::Latest;
use super::{AltitudeMeasurement, Continuity};
use crate::cell::CELL_LENGTH_M;
use crate::signal::{Signal, Value};
use crate::time::Instant;

/// A position this far behind is no longer extended along the road, m.
const POSITION_REACH_M: f32 = 200.0;
/// Fewest satellites that give an altitude, and how many it takes until more do not help.
const FEWEST_SATELLITES: f32 = 4.0;
const MANY_SATELLITES: f32 = 8.0;
/// Dilution of precision that each of the missing ones adds. Geometry tells more (and is told by
/// most receivers); on average four satellites have about three times the vertical error of many.
const DILUTION_PER_MISSING: f32 = 0.5;
/// Way along which, and fixes in which, no receiver tells the same altitude to the last digit
/// unless it is stuck, m.
const FROZEN_M: f32 = 100.0;
const FROZEN_FIXES: u8 = 6;
/// Altitudes of roads, m.
const ALTITUDES_M: core::ops::Range<f32> = -1_000.0..10_000.0;

/// A position with its place, as metres from the start of the open cell.
#[derive(Clone, Copy, Debug)]
struct Fix {
    latitude_e7: i32,
    longitude_e7: i32,
    at_m: f32,
}

/// What became of an altitude.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum FixOutcome {
    /// Waits for its cell, or was no altitude.
    Taken,
    /// Too few satellites, or no fix at all.
    Poor,
    /// The receiver is stuck.
    Frozen,
}

/// The altitude told last, and for how long.
#[derive(Clone, Copy, Debug)]
struct Repeated {
    altitude_m: f32,
    /// Where it was first told, as metres from the start of the open cell.
    from_m: f32,
    fixes: u8,
}

/// The newest positions, and the altitude that waits for its cell.
#[derive(Clone, Debug, Default)]
pub(super) struct Gnss {
    method: Latest,
    satellites: Latest,
    hdop: Latest,
    vdop: Latest,
    latitude_e7: Option<i32>,
    fix: Option<Fix>,
    earlier_fix: Option<Fix>,
    altitude: Option<(AltitudeMeasurement, f32)>,
    repeated: Option<Repeated>,
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

    /// Takes a latitude; it waits for its longitude.
    pub(super) fn latitude(&mut self, value: Value) {
        self.latitude_e7 = value.degrees_e7();
    }

    /// Takes a longitude, which completes a position taken at `at_m`.
    pub(super) fn longitude(&mut self, value: Value, at_m: f32) {
        let (Some(latitude_e7), Some(longitude_e7)) = (self.latitude_e7.take(), value.degrees_e7())
        else {
            return;
        };
        if latitude_e7.unsigned_abs() > 900_000_000 || longitude_e7.unsigned_abs() > 1_800_000_000 {
            return;
        }
        let fix = Fix {
            latitude_e7,
            longitude_e7,
            at_m,
        };
        // Two fixes close together give no direction.
        if self
            .fix
            .is_none_or(|last| fix.at_m - last.at_m > 0.5 * CELL_LENGTH_M)
        {
            self.earlier_fix = self.fix;
        }
        self.fix = Some(fix);
    }

    /// Takes an altitude, which completes a fix taken at `at_m`.
    pub(super) fn altitude(
        &mut self,
        now: Instant,
        value: Option<f32>,
        at_m: f32,
        continuity: Continuity,
    ) -> FixOutcome {
        let Some(altitude_m) = value.filter(|altitude_m| ALTITUDES_M.contains(altitude_m)) else {
            return FixOutcome::Taken;
        };
        let no_fix = self.method.state(now).is_some_and(|method| method < 0.5);
        let too_few = self
            .satellites
            .state(now)
            .is_some_and(|count| count < FEWEST_SATELLITES);
        if no_fix || too_few {
            return FixOutcome::Poor;
        }
        if self.is_frozen(altitude_m, at_m) {
            return FixOutcome::Frozen;
        }
        let dilution = self.vdop.state(now).or(self.hdop.state(now)).unwrap_or(1.0);
        let few = self.satellites.state(now).map_or(1.0, |count| {
            1.0 + DILUTION_PER_MISSING * (MANY_SATELLITES - count).max(0.0)
        });
        let measurement = AltitudeMeasurement {
            altitude_m,
            behind_m: 0.0,
            dilution: dilution.max(few).clamp(1.0, 50.0),
            continuity,
        };
        self.altitude = Some((measurement, at_m));
        FixOutcome::Taken
    }

    /// Whether an altitude has been told for so long that the receiver is stuck.
    fn is_frozen(&mut self, altitude_m: f32, at_m: f32) -> bool {
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
        fixes >= FROZEN_FIXES && at_m - repeated.from_m > FROZEN_M
    }

    /// The waiting altitude, if it was taken before `end_m`; else it waits for the next cell.
    pub(super) fn altitude_before(&mut self, end_m: f32) -> Option<AltitudeMeasurement> {
        let (mut measurement, at_m) = self.altitude?;
        if at_m > end_m {
            return None;
        }
        self.altitude = None;
        measurement.behind_m = end_m - at_m;
        Some(measurement)
    }

    /// The position at `at_m`, on the line through the last two fixes.
    pub(super) fn position_at(&self, at_m: f32) -> Option<(i32, i32)> {
        let fix = self.fix?;
        let beyond_m = at_m - fix.at_m;
        if beyond_m > POSITION_REACH_M {
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
        Some((
            extend(fix.latitude_e7, earlier.latitude_e7),
            extend(fix.longitude_e7, earlier.longitude_e7),
        ))
    }

    /// A cell was closed: places count from its end.
    pub(super) fn cell_closed(&mut self) {
        let fixes = [&mut self.fix, &mut self.earlier_fix];
        for fix in fixes.into_iter().flatten() {
            fix.at_m -= CELL_LENGTH_M;
        }
        if let Some((_, at_m)) = &mut self.altitude {
            *at_m -= CELL_LENGTH_M;
        }
        if let Some(repeated) = &mut self.repeated {
            repeated.from_m -= CELL_LENGTH_M;
        }
    }

    /// Nothing is known of the way since the last fix.
    pub(super) fn forget_places(&mut self) {
        self.fix = None;
        self.earlier_fix = None;
        self.altitude = None;
        self.repeated = None;
    }
}
