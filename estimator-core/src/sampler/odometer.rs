//! Time to distance: speed readings move an odometer, which divides the drive into cells.

use super::inertial::{CellAcceleration, IntervalAcceleration};
use super::latest::TimedValue;
use crate::cell::{CELL_LENGTH_M, Condition};
use crate::sample::SpeedMeasurement;
use crate::scalar::Scalar;
use crate::time::{Duration, Instant};

/// The cell that is being driven.
#[derive(Clone, Copy, Debug, Default)]
struct OpenCell {
    length_m: f32,
    duration_s: f32,
    work_nm: f32,
    retarder_work_nm: f32,
    service_braking: bool,
    condition: Condition,
    square_sum: f32,
    resolution_mps: f32,
    speed_distance_sum_m: f32,
    speed_count: u8,
    gap_cells: u32,
    acceleration: CellAcceleration,
}

/// A cell that was driven to its end.
#[derive(Clone, Copy, Debug)]
pub(super) struct DrivenCell {
    pub number: u32,
    pub time: Instant,
    pub speed_mps: f32,
    pub duration_s: f32,
    pub mean_force_n: f32,
    /// Mean force of the retarder, N.
    pub retarder_n: f32,
    /// Whether a brake that reports no force was on.
    pub service_braking: bool,
    pub condition: Condition,
    pub speed: Option<SpeedMeasurement>,
    pub gap_cells: u32,
    pub acceleration: CellAcceleration,
}

/// Force, acceleration and condition between two speed readings.
#[derive(Clone, Copy, Debug)]
pub(super) struct Interval {
    pub mean_force_n: f32,
    /// Mean force of the retarder, N.
    pub retarder_n: f32,
    /// Whether a brake that reports no force is on.
    pub service_braking: bool,
    pub acceleration: Option<IntervalAcceleration>,
    pub condition: Condition,
    /// Resolution of the speed reading, m/s.
    pub resolution_mps: f32,
}

/// The driven distance.
#[derive(Clone, Debug, Default)]
pub(super) struct Odometer {
    started: Option<Instant>,
    last_speed: Option<TimedValue>,
    cell: u32,
    open: OpenCell,
}

impl Odometer {
    /// Starts the drive with the first input: distance counts from the first frame, not from the
    /// first speed.
    pub(super) fn start(&mut self, now: Instant) {
        if self.started.is_none() {
            self.started = Some(now);
        }
    }

    /// Returns the number of the last cell that was driven to its end.
    pub(super) const fn cell(&self) -> u32 {
        self.cell
    }

    /// Returns the last speed, m/s.
    pub(super) fn speed_mps(&self) -> Option<f32> {
        self.last_speed.map(|last| last.value)
    }

    /// Returns the distance from the start of the open cell at the time `ago` before `now`, m. `longest`
    /// is the longest time for which the last speed is continued.
    pub(super) fn distance_m(&self, now: Instant, ago: Duration, longest: Duration) -> f32 {
        let Some(last) = self.last_speed else {
            return self.open.length_m;
        };
        let ahead = now.since(last.time);
        let ahead_s = if ahead < longest {
            ahead.seconds()
        } else {
            0.0
        };
        self.open.length_m + last.value * (ahead_s - ago.seconds())
    }

    /// Takes a speed reading. Drives the distance since the one before, and gives each cell that
    /// ends on it to `closed`. Returns false if the time since is `longest` or more, which is too
    /// long to say what was driven; cells are then skipped.
    pub(super) fn drive(
        &mut self,
        to: TimedValue,
        interval: Interval,
        longest: Duration,
        mut closed: impl FnMut(DrivenCell),
    ) -> bool {
        let from = self.last_speed.replace(to).unwrap_or(TimedValue {
            value: to.value,
            time: self.started.unwrap_or(to.time).max(to.time - longest),
        });
        let duration = to.time.since(from.time);
        let bridged = duration <= longest;
        if bridged {
            self.drive_interval(from, to, interval, &mut closed);
        } else {
            let distance_m = 0.5 * (from.value + to.value) * duration.seconds();
            self.skip(distance_m, duration);
        }
        // One reading is enough at standstill, and the counter of readings is short.
        if self.open.speed_count < u8::MAX && (to.value > 0.0 || from.value > 0.0) {
            self.open.square_sum += to.value * to.value;
            self.open.resolution_mps = interval.resolution_mps;
            self.open.speed_distance_sum_m += self.open.length_m;
            self.open.speed_count += 1;
        }
        bridged
    }

    /// Marks a gap: the next cell does not follow the last one.
    pub(super) fn interrupt(&mut self) {
        self.open.gap_cells = self.open.gap_cells.max(1);
    }

    /// Takes back so many cells: they were driven backwards.
    pub(super) fn take_back(&mut self, cells: u8) {
        self.cell = self.cell.saturating_sub(cells.into());
    }

    /// Takes a speed that moves the vehicle, but not forward: the distance stands still, and the next
    /// cell does not follow the last one.
    pub(super) fn stand(&mut self, speed: TimedValue) {
        let before = self.last_speed.replace(speed);
        let seconds = before.map_or(0.0, |last| speed.time.seconds_since(last.time));
        self.open = OpenCell {
            length_m: self.open.length_m,
            duration_s: self.open.duration_s + seconds,
            gap_cells: self.open.gap_cells.max(1),
            ..OpenCell::default()
        };
    }

    /// Skips a distance of which only the approximate length is known.
    fn skip(&mut self, distance_m: f32, duration: Duration) {
        let cells = (distance_m / CELL_LENGTH_M).clamp(0.0, 4e9) as u32;
        self.cell = self.cell.saturating_add(cells);
        self.open = OpenCell {
            gap_cells: self.open.gap_cells.saturating_add(cells.max(1)),
            duration_s: duration.seconds(),
            ..OpenCell::default()
        };
    }

    fn drive_interval(
        &mut self,
        from: TimedValue,
        to: TimedValue,
        interval: Interval,
        closed: &mut impl FnMut(DrivenCell),
    ) {
        let duration = to.time.since(from.time);
        let seconds = duration.seconds();
        // At most 2.5 s, so 32 bits are enough.
        let micros = duration.micros() as u32 as f32;
        let distance_m = 0.5 * (from.value + to.value) * seconds;
        if distance_m <= 0.0 {
            // Errors that depend on time go on while the vehicle stands.
            self.open.duration_s += seconds;
            return;
        }
        let mut left_m = distance_m;
        // At most 70 m/s for 2.5 s: 70 cells.
        while left_m > 0.0 {
            let room_m = CELL_LENGTH_M - self.open.length_m;
            let piece_m = Scalar::min(left_m, room_m);
            self.open.work_nm += interval.mean_force_n * piece_m;
            self.open.retarder_work_nm += interval.retarder_n * piece_m;
            self.open.service_braking |= interval.service_braking;
            self.open.duration_s += seconds * piece_m / distance_m;
            if let Some(acceleration) = interval.acceleration {
                let part = piece_m / distance_m;
                self.open.acceleration.add(acceleration, piece_m, part);
            }
            self.open.condition = self.open.condition.or(interval.condition);
            left_m -= piece_m;
            if piece_m < room_m {
                self.open.length_m += piece_m;
                break;
            }
            let done = 1.0 - left_m / distance_m;
            let into = Duration::from_micros(u64::from((micros * done) as u32));
            let speed_mps = from.value + done * (to.value - from.value);
            closed(self.close(from.time + into, speed_mps));
        }
    }

    fn close(&mut self, time: Instant, speed_mps: f32) -> DrivenCell {
        let open = core::mem::take(&mut self.open);
        self.cell = self.cell.saturating_add(1);
        let count = f32::from(open.speed_count);
        DrivenCell {
            number: self.cell,
            time,
            speed_mps,
            duration_s: open.duration_s,
            mean_force_n: open.work_nm / CELL_LENGTH_M,
            retarder_n: open.retarder_work_nm / CELL_LENGTH_M,
            service_braking: open.service_braking,
            condition: open.condition,
            speed: (open.speed_count > 0).then(|| SpeedMeasurement {
                mean_mps: Scalar::sqrt(open.square_sum / count),
                behind_m: CELL_LENGTH_M - open.speed_distance_sum_m / count,
                count: open.speed_count,
                resolution_mps: open.resolution_mps,
            }),
            gap_cells: open.gap_cells,
            acceleration: open.acceleration,
        }
    }
}
