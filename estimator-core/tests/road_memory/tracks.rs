//! Roads, drives over them, and what a memory says of them.

use super::flash::{Memory, TestFlash};
use estimator_core::roadmap::PackedMap;
use estimator_core::{
    CELL_LENGTH_M, Cell, CellEnd, Condition, Disagreement, Estimate, Instant, Live, Uncertain,
};
use std::collections::BTreeMap;

/// Cells by which a finished cell lies behind the live one.
const LAG: u32 = 200;
/// Length of 10⁻⁷ degrees, m.
const METRES_PER_E7: f64 = 0.011_12;
/// Microseconds from one cell to the next: 25 m/s. A minute has 600 cells.
const CELL_MICROS: u64 = 100_000;
pub const MINUTE_CELLS: u32 = 600;
/// Cells within which all pages of a write are written: one or a few, in shares.
const WRITE_CELLS: u32 = 30;
/// Standard deviation of an estimate, %.
pub const SIGMA: f32 = 0.08;

/// A road to the north, some way to the east of others, near the equator.
#[derive(Clone, Copy, Debug)]
pub struct Road {
    pub number: i32,
    pub cells: u32,
    /// Added to the grade between these cells, %.
    pub rebuilt: (u32, u32, f32),
}

impl Road {
    pub const fn new(number: i32, cells: u32) -> Self {
        Self {
            number,
            cells,
            rebuilt: (0, 0, 0.0),
        }
    }

    /// Returns the true grade at a cell, %.
    pub fn grade_percent(&self, cell: u32) -> f32 {
        let s = cell as f32 * CELL_LENGTH_M + 97.0 * self.number as f32;
        let (from, to, more) = self.rebuilt;
        let more = if (from..to).contains(&cell) {
            more
        } else {
            0.0
        };
        2.0 * (s / 300.0).sin() + (s / 1100.0).cos() + more
    }

    /// Returns the place of a cell, 10⁻⁷ degrees, this far to the east of the road's middle.
    pub fn place_e7(&self, cell: u32, aside_m: f64) -> (i32, i32) {
        let north_m = f64::from(cell) * f64::from(CELL_LENGTH_M);
        let east_m = f64::from(self.number) * 3_000.0 + 40.0 * (north_m / 2_000.0).sin() + aside_m;
        (
            (north_m / METRES_PER_E7) as i32,
            (east_m / METRES_PER_E7) as i32,
        )
    }

    /// Returns the road and the cell of a place.
    pub fn cell_of(latitude_e7: f64, longitude_e7: f64) -> (i32, f64) {
        let number = (longitude_e7 * METRES_PER_E7 / 3_000.0).round() as i32;
        (
            number,
            latitude_e7 * METRES_PER_E7 / f64::from(CELL_LENGTH_M),
        )
    }
}

/// A drive over a road.
#[derive(Clone, Copy, Debug)]
pub struct Drive {
    pub road: Road,
    pub seed: u32,
    /// Whether positions, grades and consistency fail now and then.
    pub is_rough: bool,
    /// Whether it goes against the direction of the road.
    pub is_reversed: bool,
}

/// What a drive gave.
#[derive(Clone, Debug, Default)]
pub struct Driven {
    /// Errors of the memory's grade at the vehicle, %, and their standard deviations.
    pub errors: Vec<(f32, f32)>,
    /// Finished cells until the flash memory failed.
    pub finished: u32,
    /// When the writes began, in cells.
    pub writes: Vec<u32>,
    /// Most operations of the flash memory for one finished cell.
    pub most_operations: usize,
    pub has_failed: bool,
}

impl Driven {
    pub fn rms(&self) -> f32 {
        let sum: f32 = self.errors.iter().map(|(error, _)| error * error).sum();
        (sum / self.errors.len() as f32).sqrt()
    }

    pub fn normalised(&self) -> f32 {
        let squares = self
            .errors
            .iter()
            .map(|(error, sigma)| (error / sigma).powi(2));
        squares.sum::<f32>() / self.errors.len() as f32
    }
}

/// Returns a smooth noise of standard deviation 1 that lasts for some 50 m.
pub fn noise(seed: u32, cell: u32) -> f32 {
    let value = |knot: u32| {
        // A hash of 32 bits by multiplication (Knuth, The Art of Computer Programming, 6.4).
        let mut hash = (knot ^ seed.wrapping_mul(0x9E37_79B9)).wrapping_mul(0x85EB_CA6B);
        hash ^= hash >> 13;
        hash = hash.wrapping_mul(0xC2B2_AE35);
        hash ^= hash >> 16;
        (hash as f32 / u32::MAX as f32 - 0.5) * 12_f32.sqrt()
    };
    let (knot, part) = (cell / 20, (cell % 20) as f32 / 20.0);
    let mix = (1.0 - part) * value(knot) + part * value(knot + 1);
    mix / (part * part + (1.0 - part) * (1.0 - part)).sqrt()
}

impl Drive {
    pub const fn over(road: Road, seed: u32) -> Self {
        Self {
            road,
            seed,
            is_rough: false,
            is_reversed: false,
        }
    }

    /// Returns the cell of the road at a driven cell.
    const fn place(&self, cell: u32) -> u32 {
        match self.is_reversed {
            true => self.road.cells - cell,
            false => cell,
        }
    }

    pub fn true_percent(&self, cell: u32) -> f32 {
        let grade = self.road.grade_percent(self.place(cell));
        if self.is_reversed { -grade } else { grade }
    }

    fn end(&self, cell: u32) -> CellEnd {
        let aside_m = 1.5 * f64::from(noise(self.seed + 7_000, cell / 10));
        let is_dark = self.is_rough && (cell / 50 + self.seed).is_multiple_of(9);
        CellEnd {
            cell,
            time: Instant::from_micros(u64::from(cell) * CELL_MICROS),
            position_e7: (!is_dark).then(|| self.road.place_e7(self.place(cell), aside_m)),
            speed_mps: 25.0,
            condition: Condition::default(),
        }
    }

    fn grade(&self, cell: u32) -> Uncertain {
        let broken = [f32::NAN, f32::INFINITY, 1e9, -1e9];
        let is_broken = self.is_rough && (cell + self.seed).is_multiple_of(211);
        Uncertain {
            value: match is_broken {
                true => broken[(cell / 211) as usize % 4],
                false => self.true_percent(cell) + SIGMA * noise(self.seed, cell),
            },
            sigma: if is_broken && cell.is_multiple_of(2) {
                f32::NAN
            } else {
                SIGMA
            },
        }
    }

    /// Drives until the flash memory fails, or to the end of the road.
    pub fn with(&self, memory: &mut Memory) -> Driven {
        let mut driven = Driven::default();
        let mut erased: u32 = memory.erases().sum();
        for cell in 0..self.road.cells + LAG {
            if cell < self.road.cells {
                memory.advance(&self.live(cell));
                if let Some(grade) = memory.grade() {
                    let error = grade.grade_percent.value - self.true_percent(cell);
                    driven.errors.push((error, grade.grade_percent.sigma));
                }
            }
            let Some(finished) = cell.checked_sub(LAG) else {
                continue;
            };
            let operations = memory.flash().operations;
            if memory.finish(&self.finished(finished)).is_err() {
                driven.has_failed = true;
                return driven;
            }
            let operations = memory.flash().operations - operations;
            driven.most_operations = driven.most_operations.max(operations);
            driven.finished = finished + 1;
            let now: u32 = memory.erases().sum();
            if now != erased {
                let before = driven.writes.last();
                if before.is_none_or(|begun| finished - begun >= WRITE_CELLS) {
                    driven.writes.push(finished);
                }
                erased = now;
            }
        }
        driven.has_failed = memory.close().is_err();
        driven
    }

    pub fn live(&self, cell: u32) -> Live {
        Live {
            end: self.end(cell),
            estimate: Estimate {
                grade_percent: self.grade(cell),
                ..Estimate::default()
            },
            disagreement: Disagreement::default(),
        }
    }

    pub fn finished(&self, cell: u32) -> Cell {
        Cell {
            end: self.end(cell),
            live_grade_percent: self.grade(cell),
            lagged_grade_percent: self.grade(cell),
            altitude_m: Some(Uncertain {
                value: 100.0,
                sigma: 2.0,
            }),
            live_consistent: true,
            lagged_consistent: !self.is_rough || !(cell / 30).is_multiple_of(11),
        }
    }
}

/// Drives over a road with a memory that is opened before and closed after.
pub fn driven(flash: TestFlash, drive: Drive) -> (TestFlash, Driven) {
    let mut memory = flash.open();
    while memory.level().expect("a write") {}
    let driven = drive.with(&mut memory);
    (memory.into_flash(), driven)
}

/// What a memory says of a cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Known {
    pub grade_percent: f32,
    pub sigma: f32,
    pub runs: u32,
}

/// Returns all cells of a memory by road and cell. What cannot be read is an error of the test: the
/// memory says that it is sound.
pub fn known(memory: &Memory) -> BTreeMap<(i32, u32), Known> {
    let map = PackedMap::of_memory(memory.view());
    let mut known = BTreeMap::new();
    for way in map.ways() {
        let way = way.expect("a way");
        for block in map.blocks(&way) {
            let block = block.expect("a block");
            let points: Vec<_> = block.points().collect();
            let mut count = 0;
            for cell in block.cells().expect("cells") {
                let next = points
                    .partition_point(|point| point.cell < cell.cell)
                    .max(1);
                let (a, b) = (points[next - 1], points[next.min(points.len() - 1)]);
                let part = f64::from(cell.cell - a.cell) / f64::from((b.cell - a.cell).max(1));
                let mix = |a: i32, b: i32| f64::from(a) + part * (f64::from(b) - f64::from(a));
                let latitude = mix(a.latitude_e7, b.latitude_e7);
                let (road, at) = Road::cell_of(latitude, mix(a.longitude_e7, b.longitude_e7));
                let value = Known {
                    grade_percent: cell.grade_percent,
                    sigma: cell.grade_sigma_percent,
                    runs: cell.runs,
                };
                known.insert((road, at.round() as u32), value);
                count += 1;
            }
            assert_eq!(count, usize::from(block.count));
        }
    }
    known
}

/// Checks that all cells of a memory are right.
pub fn check_right(known: &BTreeMap<(i32, u32), Known>, roads: &[Road]) {
    for ((number, cell), known) in known {
        let road = roads.iter().find(|road| road.number == *number);
        let road = road.unwrap_or_else(|| panic!("road {number}"));
        let error = known.grade_percent - road.grade_percent(*cell);
        assert!(error.abs() < 0.4, "{error} % at {cell} of road {number}");
        assert!(known.sigma > 0.01 && known.sigma < 1.0, "{known:?}");
    }
}
