//! Whether a memory, and the map that it is, give what they gave, bit by bit.
//!
//! It is no judge of what is right; the other tests are. `digests.txt` has what each drive gave. A change
//! of behaviour that is wanted is accepted by
//! `CHANGE_INDICATOR=write cargo test -p estimator-core --test road_memory change_indicator`.

use super::flash::TestFlash;
// Not those of the platform: the digests are those of any.
use estimator_core::roadmap::{PackedMap, combined_with_roads};
use estimator_core::{Cell, CellEnd, Condition, Disagreement, Estimate, Instant, Live, Uncertain};
use libm::{cos, sin};
use test_kit::{Digest, Noise, check_digests, finished_late, line_on_map};

const CELL_M: f64 = 2.5;
const LATITUDE_M_PER_DEG: f64 = 111_200.0;

/// A cell of a road.
#[derive(Clone, Copy)]
struct Spot {
    north_m: f64,
    east_m: f64,
    heading_rad: f64,
}

/// Returns the altitude of the land, and its slopes to the north and to the east.
fn land(north_m: f64, east_m: f64) -> (f64, f64, f64) {
    let altitude_m =
        9.0 * sin(north_m / 310.0) + 5.0 * sin(east_m / 190.0) + 2.0 * sin(north_m / 70.0);
    let to_north = 9.0 / 310.0 * cos(north_m / 310.0) + 2.0 / 70.0 * cos(north_m / 70.0);
    (altitude_m, to_north, 5.0 / 190.0 * cos(east_m / 190.0))
}

/// Returns a road: cells, and what the heading changes by in each, of one leg after the other.
fn road(east_m: f64, legs: &[(u32, f64)]) -> Vec<Spot> {
    let mut spot = Spot {
        north_m: 0.0,
        east_m,
        heading_rad: 0.0,
    };
    let mut spots = Vec::new();
    for (cells, turn_rad) in legs {
        for _ in 0..*cells {
            spots.push(spot);
            spot.north_m += CELL_M * cos(spot.heading_rad);
            spot.east_m += CELL_M * sin(spot.heading_rad);
            spot.heading_rad += turn_rad;
        }
    }
    spots
}

/// What happens on a drive.
#[derive(Clone, Copy)]
struct Manner {
    /// Cells from one position to the next, and how far beside the road they are.
    fix_cells: u32,
    aside_m: f64,
    noise_m: f32,
    grade_error_percent: f32,
    is_backward: bool,
    has_altitudes: bool,
    /// Whether positions, grades and consistency fail now and then.
    is_rough: bool,
    /// Cells that are driven without an estimate: the first one, and how many.
    gap: (u32, u32),
    /// Whether the power goes before the memory is closed.
    is_cut: bool,
}

const PLAIN: Manner = Manner {
    fix_cells: 1,
    aside_m: 0.0,
    noise_m: 1.5,
    grade_error_percent: 0.0,
    is_backward: false,
    has_altitudes: true,
    is_rough: false,
    gap: (u32::MAX, 0),
    is_cut: false,
};

/// A drive over a road.
struct Drive<'a> {
    spots: &'a [Spot],
    manner: Manner,
    latitude_deg: f64,
    longitude_deg: f64,
    noise: Noise,
    aside_m: f64,
    grade_noise_percent: f32,
}

impl<'a> Drive<'a> {
    fn new(
        spots: &'a [Spot],
        (latitude_deg, longitude_deg): (f64, f64),
        manner: Manner,
        seed: u64,
    ) -> Self {
        Self {
            spots,
            manner,
            latitude_deg,
            longitude_deg,
            noise: Noise(seed),
            aside_m: 0.0,
            grade_noise_percent: 0.0,
        }
    }

    /// Returns a position, 10⁻⁷ degrees.
    fn position_e7(&self, spot: &Spot) -> (i32, i32) {
        let latitude_deg = self.latitude_deg + spot.north_m / LATITUDE_M_PER_DEG;
        let longitude_m = LATITUDE_M_PER_DEG * cos(self.latitude_deg.to_radians());
        let aside_m = self.manner.aside_m + self.aside_m;
        let longitude_deg = self.longitude_deg + (spot.east_m + aside_m) / longitude_m;
        let round_deg = (longitude_deg + 180.0).rem_euclid(360.0) - 180.0;
        ((latitude_deg * 1e7) as i32, (round_deg * 1e7) as i32)
    }

    /// Returns the live estimate at a driven cell, and the cell as it is finished later.
    fn cell(&mut self, cell: u32) -> (Live, Cell) {
        let manner = self.manner;
        let last = self.spots.len() - 1;
        let spot = self.spots[if manner.is_backward {
            last - cell as usize
        } else {
            cell as usize
        }];
        self.aside_m = 0.95 * self.aside_m + 0.3 * f64::from(manner.noise_m * self.noise.draw());
        self.grade_noise_percent = 0.9 * self.grade_noise_percent + 0.03 * self.noise.draw();
        let (altitude_m, to_north, to_east) = land(spot.north_m, spot.east_m);
        let slope = to_north * cos(spot.heading_rad) + to_east * sin(spot.heading_rad);
        let along = if manner.is_backward { -slope } else { slope };
        let is_dark = manner.is_rough && (cell / 60) % 7 == 3;
        let is_fix = cell.is_multiple_of(manner.fix_cells) && !is_dark;
        let mut grade_percent = Uncertain {
            value: 100.0 * along as f32 + self.grade_noise_percent + manner.grade_error_percent,
            sigma: 0.06 + 0.03 * ((cell / 100) % 3) as f32,
        };
        if manner.is_rough && cell % 97 == 5 {
            grade_percent = [
                Uncertain {
                    value: f32::NAN,
                    sigma: 0.1,
                },
                Uncertain {
                    value: 1e9,
                    sigma: 0.1,
                },
                Uncertain {
                    value: 0.0,
                    sigma: f32::INFINITY,
                },
            ][(cell / 97) as usize % 3];
        }
        let end = CellEnd {
            cell,
            time: Instant::from_micros(u64::from(cell) * 110_000),
            position_e7: is_fix.then(|| self.position_e7(&spot)),
            speed_mps: 22.7,
            condition: Condition::default(),
        };
        let is_consistent = !manner.is_rough || (cell / 80) % 5 != 2;
        let live = Live {
            end,
            estimate: Estimate {
                grade_percent,
                ..Estimate::default()
            },
            disagreement: Disagreement::default(),
        };
        let finished = Cell {
            end,
            live_grade_percent: grade_percent,
            lagged_grade_percent: grade_percent,
            altitude_m: manner.has_altitudes.then(|| Uncertain {
                value: 140.0 + altitude_m as f32 + 0.3 * self.noise.draw(),
                sigma: 2.0,
            }),
            live_consistent: is_consistent,
            lagged_consistent: is_consistent,
        };
        (live, finished)
    }

    /// Returns the cells of the drive, each with one that is finished at that time.
    fn cells(mut self) -> Vec<(Live, Option<Cell>)> {
        let (gap_begin, gap_cells) = self.manner.gap;
        let is_driven = |cell: u32| cell < gap_begin || cell >= gap_begin + gap_cells;
        let count = self.spots.len() as u32;
        let all: Vec<_> = (0..count).map(|cell| self.cell(cell)).collect();
        let driven = (0..).zip(all).filter(|(number, _)| is_driven(*number));
        let cells: Vec<_> = driven.map(|(_, cell)| cell).collect();
        finished_late(&cells)
    }
}

/// Drives with a memory that learns. Returns its flash memory and the line of the drive.
fn learned(flash: TestFlash, name: &str, drive: Drive) -> (TestFlash, String) {
    let mut digest = Digest::default();
    let mut memory = flash.open();
    digest.debug(memory.opened());
    while memory.level().expect("a write") {}
    let is_cut = drive.manner.is_cut;
    let (mut known, mut driven) = (0, 0);
    for (live, finished) in drive.cells() {
        memory.advance(&live);
        let grade = memory.grade();
        known += u32::from(grade.is_some());
        driven += 1;
        digest.debug(&(grade, memory.place(), memory.is_left_out()));
        let own = live.estimate.grade_percent;
        digest.debug(&combined_with_roads(own, None, grade));
        if let Some(finished) = finished {
            memory.finish(&finished).expect("a write");
        }
    }
    if !is_cut {
        memory.close().expect("a write");
    }
    let pages = memory.counters();
    digest.debug(&(pages, memory.map_counters()));
    digest.debug(&memory.erases().collect::<Vec<_>>());
    let flash = memory.into_flash();
    digest.add(&flash.bytes);
    let line = format!(
        "{name}: known in {known} of {driven} cells, {} left out, {:016x}",
        pages.cells_left_out,
        digest.value()
    );
    (flash, line)
}

/// Drives with the memory as a map.
fn on_map(flash: &TestFlash, name: &str, drive: Drive) -> String {
    let memory = flash.clone().open();
    line_on_map(PackedMap::of_memory(memory.view()), name, &drive.cells())
}

const SWEDEN: (f64, f64) = (58.0, 15.0);
const DATE_LINE: (f64, f64) = (-17.0, 179.985);

#[test]
fn every_drive_gives_what_is_committed() {
    let trunk = (700, 0.000_4);
    let left = road(0.0, &[trunk, (60, -0.006), (500, 0.000_5)]);
    let right = road(0.0, &[trunk, (60, 0.006), (900, -0.000_3)]);
    let loops = road(900.0, &[(300, 0.0), (240, 0.08), (300, 0.0)]);
    let long = road(-5_000.0, &[(4_000, 0.000_7), (4_000, -0.000_5)]);
    let backward = Manner {
        is_backward: true,
        ..PLAIN
    };
    let sparse = Manner {
        fix_cells: 10,
        ..PLAIN
    };
    let rough = Manner {
        is_rough: true,
        noise_m: 4.0,
        ..PLAIN
    };
    let rebuilt = Manner {
        grade_error_percent: 1.5,
        ..PLAIN
    };
    let beside = Manner {
        aside_m: 14.0,
        has_altitudes: false,
        ..PLAIN
    };
    let with_gap = Manner {
        gap: (400, 150),
        ..PLAIN
    };
    let cut = Manner {
        is_cut: true,
        ..PLAIN
    };
    let drives = [
        ("a new road", &left, SWEDEN, PLAIN),
        ("again", &left, SWEDEN, PLAIN),
        ("a fork", &right, SWEDEN, PLAIN),
        ("backward", &left, SWEDEN, backward),
        ("a rough drive", &right, SWEDEN, rough),
        ("a carriageway beside", &left, SWEDEN, beside),
        ("with a gap", &left, SWEDEN, with_gap),
        ("few positions", &right, SWEDEN, sparse),
        ("loops", &loops, SWEDEN, PLAIN),
        ("loops again", &loops, SWEDEN, PLAIN),
        ("the date line", &right, DATE_LINE, PLAIN),
        ("backward over the date line", &right, DATE_LINE, backward),
        ("a rebuilt road", &left, SWEDEN, rebuilt),
        ("rebuilt, again", &left, SWEDEN, rebuilt),
        ("the power goes", &right, SWEDEN, cut),
        ("a long road, and no room", &long, SWEDEN, PLAIN),
        ("another rough drive", &left, SWEDEN, rough),
    ];
    let mut flash = TestFlash::blank(10);
    let mut found = Vec::new();
    for (seed, (name, spots, place, manner)) in (1_u64..).zip(drives) {
        let drive = |seed| Drive::new(spots, place, manner, seed);
        let (next, line) = learned(flash, name, drive(seed));
        flash = next;
        found.push(line);
        if seed % 3 == 0 || manner.is_rough {
            found.push(on_map(
                &flash,
                &format!("{name}, as a map"),
                drive(seed + 100),
            ));
        }
    }
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/road_memory/digests.txt");
    check_digests(&found, include_str!("digests.txt"), path);
}
