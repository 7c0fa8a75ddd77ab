//! The road ahead in parts, as it goes on a bus, against the horizon as a whole.

use crate::network_drives::{drive, grid, map_of};
use estimator_core::roadmap::{
    Horizon, HorizonPart, HorizonParts, MapLive, MapPlace, NextGrade, NumberedPart, PART_LENGTH_M,
    PART_STEP_M, PackedMap,
};
use estimator_core::{CellEnd, Disagreement, Estimate, Instant, Live, Uncertain};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

/// Returns a live estimate that every map fits.
fn live_at(cell: u32, position_e7: Option<(i32, i32)>) -> Live {
    let grade_percent = Uncertain {
        value: 0.0,
        sigma: 3.0,
    };
    Live {
        end: CellEnd {
            cell,
            time: Instant::from_micros(u64::from(cell) * 125_000),
            position_e7,
            speed_mps: 20.0,
            ..CellEnd::default()
        },
        estimate: Estimate {
            grade_percent,
            ..Estimate::default()
        },
        disagreement: Disagreement::default(),
    }
}

/// A grade as told: branch, distance ahead, value, sigma.
type Told = (u8, f32, Uncertain);

/// Returns the branches and the known grades of the parts of one horizon.
fn told(parts: &[NumberedPart]) -> (Vec<(f32, f32)>, Vec<Told>) {
    let (mut branches, mut grades) = (Vec::new(), Vec::new());
    for part in parts {
        match part.part {
            HorizonPart::Unknown => panic!("the place is known"),
            HorizonPart::Branch {
                branch,
                from_m,
                to_m,
                probability,
            } => {
                assert_eq!((usize::from(branch), to_m), (branches.len(), PART_LENGTH_M));
                branches.push((from_m, probability));
            }
            HorizonPart::Grades {
                branch,
                ahead_m,
                grades_percent,
            } => {
                let known = grades_percent.into_iter().enumerate();
                grades.extend(known.filter_map(|(index, grade)| {
                    Some((branch, ahead_m + index as f32 * PART_STEP_M, grade?))
                }));
            }
        }
    }
    (branches, grades)
}

/// Returns the same of a whole horizon.
fn whole(map: PackedMap<'_>, place: &MapPlace) -> (Vec<(f32, f32)>, Vec<Told>) {
    let horizon = Horizon::new(map, place, PART_LENGTH_M).expect("a horizon");
    let mut grades = Vec::new();
    for (number, branch) in horizon.branches().iter().enumerate() {
        let points = horizon.points(branch, PART_STEP_M);
        grades.extend(
            points.filter_map(|point| Some((number as u8, point.ahead_m, point.grade_percent?))),
        );
    }
    let branches = horizon.branches().iter();
    (
        branches.map(|b| (b.from_m, b.probability)).collect(),
        grades,
    )
}

/// Returns the next grade of the first branch.
fn next_grade(grades: &[Told]) -> Option<NextGrade> {
    let mut first = grades.iter().filter(|grade| grade.0 == 0);
    let present = first.clone().next()?.2.value;
    let differs = |grade: &&Told| (grade.2.value - present).abs() >= 0.5;
    let next = first.clone().find(differs).or(first.next_back())?;
    Some(NextGrade {
        ahead_m: next.1,
        grade_percent: next.2.value,
    })
}

#[test]
fn the_parts_of_a_horizon_are_the_horizon() {
    let bytes = map_of(&grid());
    let map = PackedMap::open(&bytes).expect("a map");
    let (mut horizons, mut forks, mut ended) = (0, 0, 0);
    for seed in 0..6 {
        let driven = drive(&map, 2_000, &mut ChaCha8Rng::seed_from_u64(seed));
        let mut on_map = MapLive::new(map);
        let mut parts = HorizonParts::new();
        for (cell, driven) in driven.iter().enumerate() {
            let live = live_at(cell as u32, Some(driven.position_e7));
            on_map.advance(&live);
            let Some(place) = on_map.trusted_place() else {
                let told = parts.next_part(&on_map, &live).map(|told| told.part);
                ended += usize::from(told == Some(HorizonPart::Unknown));
                assert!(told.is_none() || told == Some(HorizonPart::Unknown));
                assert_eq!(parts.next_part(&on_map, &live), None, "told once");
                assert_eq!(parts.next_grade(&live), None);
                continue;
            };
            if cell % 10 != 0 {
                continue;
            }
            // All of it at one place: so the place is that of the beginning.
            let mut all = Vec::new();
            for _ in 0..300 {
                all.extend(parts.next_part(&on_map, &live));
            }
            let Some(first) = all.first() else { continue };
            assert!(
                all.iter()
                    .all(|part| (part.sequence, part.cell) == (first.sequence, cell as u32))
            );
            let (wanted, found) = (whole(map, &place), told(&all));
            assert_eq!(found, wanted);
            assert_eq!(parts.next_grade(&live), next_grade(&wanted.1));
            horizons += 1;
            forks += found.0.len() - 1;
        }
    }
    println!("{horizons} horizons, {forks} branches that leave them, {ended} ended");
    assert!(horizons > 100 && forks > horizons && ended > 0);
}

#[test]
fn the_next_grade_comes_nearer_and_a_horizon_follows_another() {
    let bytes = map_of(&grid());
    let map = PackedMap::open(&bytes).expect("a map");
    let driven = drive(&map, 2_000, &mut ChaCha8Rng::seed_from_u64(2));
    let mut on_map = MapLive::new(map);
    let mut parts = HorizonParts::new();
    let mut before: Option<(u32, NextGrade)> = None;
    let (mut sequences, mut nearer, mut is_lost) = (Vec::new(), 0, false);
    let mut ways = Vec::new();
    for (cell, driven) in driven.iter().enumerate() {
        let live = live_at(cell as u32, Some(driven.position_e7));
        on_map.advance(&live);
        ways.push(on_map.trusted_place().map(|place| place.way));
        // As a program does it at 90 km/h: five frames in 100 ms.
        for _ in 0..5 {
            if let Some(part) = parts.next_part(&on_map, &live) {
                if part.part == HorizonPart::Unknown {
                    is_lost = true;
                    continue;
                }
                sequences.push((part.sequence, part.cell as usize, is_lost));
                is_lost = false;
                assert!(
                    cell as u32 - part.cell < 100,
                    "a horizon takes at most ten seconds"
                );
            }
        }
        let next = parts.next_grade(&live);
        if let (Some((at, before)), Some(next)) = (before, next)
            && before.grade_percent == next.grade_percent
        {
            let driven_m = 2.5 * (cell as u32 - at) as f32;
            assert_eq!(next.ahead_m, before.ahead_m - driven_m);
            nearer += 1;
        }
        before = next.map(|next| (cell as u32, next));
    }
    sequences.dedup_by_key(|told| (told.0, told.1));
    assert!(sequences.len() > 10, "{} horizons", sequences.len());
    for pair in sequences.windows(2) {
        // A horizon that is lost before it is told has a number too.
        assert!(pair[1].2 || pair[1].0 == (pair[0].0 + 1) % 15);
        let is_later = pair[1].1 >= pair[0].1 + 80;
        let is_new = ways[pair[1].1] != ways[pair[0].1] || pair[1].2;
        assert!(is_later || is_new, "{pair:?}");
    }
    assert!(nearer > 100);
}

/// A controller that stays on may begin the next drive with a new estimator and the same map.
#[test]
fn the_next_drive_begins_anew_on_the_same_map() {
    let bytes = map_of(&grid());
    let map = PackedMap::open(&bytes).expect("a map");
    let driven = drive(&map, 1_000, &mut ChaCha8Rng::seed_from_u64(2));
    let (mut on_map, mut parts) = (MapLive::new(map), HorizonParts::new());
    let mut drives = Vec::new();
    for _ in 0..2 {
        let mut places = Vec::new();
        for (cell, driven) in driven.iter().enumerate() {
            let live = live_at(cell as u32, Some(driven.position_e7));
            on_map.advance(&live);
            places.push(on_map.trusted_place());
            if let Some(part) = parts.next_part(&on_map, &live) {
                assert!(part.cell <= cell as u32 || part.part == HorizonPart::Unknown);
            }
        }
        drives.push(places);
    }
    let known = drives[0].iter().flatten().count();
    assert!(known > 500, "{known} cells");
    assert_eq!(drives[0], drives[1]);
    assert_eq!(on_map.counters().cells_on_map as usize, 2 * known);
}
