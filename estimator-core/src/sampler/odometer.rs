//! Time to distance: speed readings move an odometer, which cuts the drive into cells.

use super::SpeedMeasurement;
use super::latest::Timed;
use crate::cell::{CELL_LENGTH_M, Condition};
use crate::scalar::Scalar;
use crate::time::{Duration, Instant};

/// Longest time between two speed readings that is still bridged.
pub(super) const LONGEST_INTERVAL: Duration = Duration::from_millis(2_500);

/// The cell being driven.
#[derive(Clone, Copy, Debug, Default)]
struct OpenCell {
    length_m: f32,
    duration_s: f32,
    work_nm: f32,
    condition: Condition,
    square_sum: f32,
    speed_place_sum_m: f32,
    speed_count: u8,
    gap_cells: u32,
}

/// A cell that was driven to its end.
#[derive(Clone, Copy, Debug)]
pub(super) struct DrivenCell {
    pub number: u32,
    pub time: Instant,
    pub speed_mps: f32,
    pub duration_s: f32,
    pub mean_force_n: f32,
    pub condition: Condition,
    pub speed: Option<SpeedMeasurement>,
    pub gap_cells: u32,
}

/// What held between two speed readings.
#[derive(Clone, Copy, Debug)]
pub(super) struct Between {
    pub mean_force_n: f32,
    pub condition: Condition,
}

/// Driven distance.
#[derive(Clone, Debug, Default)]
pub(super) struct Odometer {
    started: Option<Instant>,
    last_speed: Option<Timed>,
    cell: u32,
    open: OpenCell,
}

impl Odometer {
    /// Something was heard: distance counts from the first frame, not from the first speed.
    pub(super) fn start(&mut self, now: Instant) {
        if self.started.is_none() {
            self.started = Some(now);
        }
    }

    /// The last speed, m/s.
    pub(super) fn speed_mps(&self) -> Option<f32> {
        self.last_speed.map(|last| last.value)
    }

    /// Way since the start of the open cell as it was `ago` before `now`, m.
    pub(super) fn place_m(&self, now: Instant, ago: Duration) -> f32 {
        let Some(last) = self.last_speed else {
            return self.open.length_m;
        };
        let ahead = now.since(last.time);
        let ahead_s = if ahead < LONGEST_INTERVAL {
            ahead.seconds()
        } else {
            0.0
        };
        self.open.length_m + last.value * (ahead_s - ago.seconds())
    }

    /// Takes a speed reading: the way since the one before is driven, each cell that ends on it
    /// handed to `closed`. Returns false if the time since was too long to say what was driven;
    /// cells are then skipped.
    pub(super) fn drive(
        &mut self,
        now: Instant,
        speed_mps: f32,
        between: Between,
        mut closed: impl FnMut(DrivenCell),
    ) -> bool {
        let to = Timed {
            value: speed_mps,
            time: now,
        };
        let from = self.last_speed.replace(to).unwrap_or(Timed {
            value: speed_mps,
            time: self.started.unwrap_or(now).max(now - LONGEST_INTERVAL),
        });
        let interval = now.since(from.time);
        let bridged = interval <= LONGEST_INTERVAL;
        if bridged {
            self.drive_interval(from, to, between, &mut closed);
        } else {
            let way_m = 0.5 * (from.value + to.value) * interval.seconds();
            self.skip(way_m, interval);
        }
        // Of a standstill one reading tells it all, and the counter of readings is short.
        if self.open.speed_count < u8::MAX && (speed_mps > 0.0 || from.value > 0.0) {
            self.open.square_sum += speed_mps * speed_mps;
            self.open.speed_place_sum_m += self.open.length_m;
            self.open.speed_count += 1;
        }
        bridged
    }

    /// What comes does not follow from what was.
    pub(super) fn interrupt(&mut self) {
        self.open.gap_cells = self.open.gap_cells.max(1);
    }

    /// Nothing is known of the way just driven but its rough length.
    fn skip(&mut self, way_m: f32, interval: Duration) {
        let cells = (way_m / CELL_LENGTH_M).clamp(0.0, 4e9) as u32;
        self.cell = self.cell.saturating_add(cells);
        self.open = OpenCell {
            gap_cells: self.open.gap_cells.saturating_add(cells.max(1)),
            duration_s: interval.seconds(),
            ..OpenCell::default()
        };
    }

    fn drive_interval(
        &mut self,
        from: Timed,
        to: Timed,
        between: Between,
        closed: &mut impl FnMut(DrivenCell),
    ) {
        let interval = to.time.since(from.time);
        let seconds = interval.seconds();
        // No more than LONGEST_INTERVAL: half as wide a number as time has.
        let micros = interval.micros() as u32 as f32;
        let way_m = 0.5 * (from.value + to.value) * seconds;
        if way_m <= 0.0 {
            // Errors that live in time go on while the vehicle stands.
            self.open.duration_s += seconds;
            return;
        }
        let mut left_m = way_m;
        // 70 m/s for LONGEST_INTERVAL at the most: 70 cells.
        while left_m > 0.0 {
            let room_m = CELL_LENGTH_M - self.open.length_m;
            let piece_m = Scalar::min(left_m, room_m);
            self.open.work_nm += between.mean_force_n * piece_m;
            self.open.duration_s += seconds * piece_m / way_m;
            self.open.condition = self.open.condition.or(between.condition);
            left_m -= piece_m;
            if piece_m < room_m {
                self.open.length_m += piece_m;
                break;
            }
            let done = 1.0 - left_m / way_m;
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
            condition: open.condition,
            speed: (open.speed_count > 0).then(|| SpeedMeasurement {
                mean_mps: Scalar::sqrt(open.square_sum / count),
                behind_m: CELL_LENGTH_M - open.speed_place_sum_m / count,
                count: open.speed_count,
            }),
            gap_cells: open.gap_cells,
        }
    }
}
