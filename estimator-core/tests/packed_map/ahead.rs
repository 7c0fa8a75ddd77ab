//! The grade ahead: branches, forks of branches, and gaps.

use super::file::{TestWay, packed};
use super::{WAYS, before_the_exit, live};
use estimator_core::roadmap::{
    Horizon, HorizonPart, HorizonParts, MapError, MapLive, MapMatch, PackedMap,
};
use std::collections::{BTreeMap, BTreeSet};

/// Returns the horizon of 2 km before the exit, as the place in cells and its branches' begins and
/// probabilities.
fn branches(ways: &[TestWay]) -> Vec<(f32, f32)> {
    let bytes = packed(ways);
    let on_map = before_the_exit(&bytes);
    let MapMatch::On(place) = on_map.matcher().place() else {
        panic!("no place");
    };
    let horizon = Horizon::new(*on_map.matcher().map(), &place, 2_000.0).unwrap();
    let branches = horizon.branches().iter();
    branches
        .map(|branch| (branch.from_m, branch.probability))
        .collect()
}

#[test]
fn what_leaves_a_branch_is_no_branch() {
    let plain = branches(&WAYS);
    let mut ways = WAYS;
    // A way that leaves the exit.
    ways[1].joins = &[(100, 2)];
    let forked = branches(&ways);
    assert_eq!(forked.len(), plain.len());
    let of = |branches: &[(f32, f32)], from_m: f32| {
        let found = branches.iter().find(|of| (of.0 - from_m).abs() < 20.0);
        found.unwrap().1
    };
    // One vehicle of ten leaves the exit again.
    assert!((of(&forked, 250.0) / of(&plain, 250.0) - 0.9).abs() < 1e-3);
    assert_eq!(of(&forked, 0.0), of(&plain, 0.0));
}

#[test]
fn straight_on_is_straight_on_in_whatever_order_the_map_has_the_ways() {
    let mut ways = WAYS;
    ways[0].joins = &[(200, 1), (399, 3), (399, 2)];
    assert_eq!(branches(&ways), branches(&WAYS));
    for ways in [WAYS, ways] {
        let bytes = packed(&ways);
        let on_map = before_the_exit(&bytes);
        let place = on_map.trusted_place().unwrap();
        let horizon = Horizon::new(*on_map.matcher().map(), &place, 2_000.0).unwrap();
        let last = horizon.points(&horizon.branches()[0], 25.0).last().unwrap();
        // The grade of the way "on".
        let grade = last.grade_percent.unwrap();
        assert!((grade.value + 1.0).abs() < 0.05, "{grade:?}");
    }
}

/// Returns the grades in the parts, by branch and whole metres ahead, and the next grade.
fn told(bytes: &[u8]) -> (BTreeMap<(u8, u32), f32>, Option<f32>) {
    let mut on_map = before_the_exit(bytes);
    let mut parts = HorizonParts::new();
    let mut grades = BTreeMap::new();
    let mut next = None;
    // A horizon begins every 200 m: the first one only.
    for cell in 100..175 {
        let live = live(&WAYS[0], cell, cell as u32);
        on_map.advance(&live);
        for part in parts.due_parts(&on_map, &live).collect::<Vec<_>>() {
            if let HorizonPart::Grades {
                branch,
                ahead_m,
                grades_percent,
            } = part.part
            {
                for (index, grade) in (0_u8..).zip(grades_percent) {
                    let Some(grade) = grade else { continue };
                    let metres = ahead_m + 25.0 * f32::from(index);
                    grades.insert((branch, metres as u32), grade.value);
                }
            }
        }
        next = parts.next_grade(&live).map(|next| next.grade_percent);
    }
    (grades, next)
}

#[test]
fn the_parts_tell_every_branch() {
    let (grades, next) = told(&packed(&WAYS));
    let mut found: BTreeMap<u8, Vec<f32>> = BTreeMap::new();
    for ((branch, _), grade) in &grades {
        found.entry(*branch).or_default().push(*grade);
    }
    assert_eq!(found.keys().copied().collect::<Vec<_>>(), [0, 1, 2]);
    // The exit has 0.5 %, the way to the east -1.5 %.
    for grade in [0.5, -1.5] {
        let is = |of: &&Vec<f32>| of.iter().all(|found| (found - grade).abs() < 0.05);
        assert_eq!(found.values().filter(is).count(), 1, "{grade}");
    }
    // The first one that differs on the way straight on.
    assert!((next.unwrap() + 1.0).abs() < 0.05, "{next:?}");
}

#[test]
fn a_damaged_block_ahead_is_a_gap_in_the_parts() {
    let bytes = packed(&WAYS);
    let map = PackedMap::open(&bytes).unwrap();
    let road = map.ways().next().unwrap().unwrap();
    let third = map.blocks(&road).nth(2).unwrap().unwrap().offset as usize;
    let mut damaged = bytes.clone();
    damaged[third + 30] ^= 1;
    let (whole, _) = told(&bytes);
    let (grades, next) = told(&damaged);
    let of_road = |grades: &BTreeMap<(u8, u32), f32>| {
        let ahead = grades.range((0, 0)..(0, 700)).map(|((_, ahead), _)| *ahead);
        ahead.collect::<Vec<_>>()
    };
    assert!(of_road(&whole).contains(&500));
    // The block begins some 390 m ahead.
    let left = of_road(&grades);
    assert!(
        left.contains(&300) && left.iter().all(|ahead| *ahead < 420),
        "{left:?}"
    );
    // The road has one grade up to there. Which of the ways behind it leads straight on is not known.
    assert!((next.unwrap() - 2.0).abs() < 0.05, "{next:?}");
}

#[test]
fn a_branch_that_is_damaged_at_its_begin_has_no_grades() {
    let bytes = packed(&WAYS);
    let map = PackedMap::open(&bytes).unwrap();
    let damaged_at = |way: usize| {
        let block = map.ways().nth(way).unwrap().unwrap().first_block as usize;
        let mut damaged = bytes.clone();
        damaged[block + 30] ^= 1;
        damaged
    };
    let (whole, next) = told(&bytes);
    // Without the exit, the other branches are as before.
    let (grades, next_without) = told(&damaged_at(1));
    let branches = |grades: &BTreeMap<(u8, u32), f32>| {
        let branches: BTreeSet<u8> = grades.keys().map(|(branch, _)| *branch).collect();
        branches.len()
    };
    assert_eq!((branches(&whole), branches(&grades)), (3, 2));
    assert!(grades.iter().all(|(at, grade)| whole[at] == *grade));
    assert_eq!(next_without, next);
    // Without the way straight on, the road is told to its end.
    let (grades, _) = told(&damaged_at(3));
    assert!(grades.iter().all(|(at, grade)| whole[at] == *grade));
    let last = grades.range((0, 0)..(1, 0)).map(|((_, ahead), _)| *ahead);
    assert!((600..800).contains(&last.max().unwrap()), "{grades:?}");
    // The same if no other way leads on.
    let mut ways = WAYS;
    ways[0].joins = &[(399, 3)];
    let mut single = packed(&ways);
    let on = PackedMap::open(&single).unwrap().ways().nth(3);
    let on_block = on.unwrap().unwrap().first_block as usize;
    single[on_block + 30] ^= 1;
    let (grades, _) = told(&single);
    let last = grades.keys().map(|(_, ahead)| *ahead).max();
    assert!((600..800).contains(&last.unwrap()), "{grades:?}");
    // Without the way of the vehicle, there is nothing.
    let on_map = before_the_exit(&bytes);
    let place = on_map.trusted_place().unwrap();
    let damaged = damaged_at(0);
    let horizon = Horizon::new(PackedMap::open(&damaged).unwrap(), &place, 2_000.0);
    assert_eq!(horizon.err(), Some(MapError::Checksum));
}

#[test]
fn behind_a_damaged_join_the_way_goes_on() {
    let bytes = packed(&WAYS);
    let map = PackedMap::open(&bytes).unwrap();
    let road = map.ways().next().unwrap().unwrap();
    // The joins of all ways lie before the blocks, those of the road first.
    let joins: usize = WAYS.iter().map(|way| way.joins.len()).sum();
    let mut damaged = bytes.clone();
    damaged[road.first_block as usize - 20 * joins + 3] ^= 1;
    let (whole, _) = told(&bytes);
    let (grades, _) = told(&damaged);
    let last = grades.keys().map(|(branch, ahead)| (*branch, *ahead)).max();
    let (branch, ahead) = last.unwrap();
    assert_eq!(branch, 0);
    assert!((600..800).contains(&ahead), "{ahead}");
    assert!(grades.iter().all(|(at, grade)| whole[at] == *grade));
}

#[test]
fn a_horizon_begins_after_200_m_on_another_way_and_in_the_next_drive() {
    let mut ways = WAYS;
    ways[0].joins = &[(399, 3)];
    let bytes = packed(&ways);
    let mut on_map = MapLive::new(PackedMap::open(&bytes).unwrap());
    let mut parts = HorizonParts::new();
    let mut begun = Vec::new();
    let mut drive = |way: usize, cell: i32, driven: u32, is_told: bool| {
        let live = live(&ways[way], cell, driven);
        on_map.advance(&live);
        if !is_told {
            return;
        }
        for part in parts.due_parts(&on_map, &live).collect::<Vec<_>>() {
            if let HorizonPart::Branch { branch: 0, .. } = part.part {
                begun.push(part.cell);
            }
        }
    };
    (0..399).for_each(|cell| drive(0, cell, cell as u32, true));
    (0..300).for_each(|cell| drive(3, cell, 399 + cell as u32, true));
    // Its cells are numbered from the start, on the same way. No part is asked for before the place is
    // known.
    (300..600).for_each(|cell| drive(3, cell, cell as u32 - 300, cell > 450));
    let pauses: Vec<i64> = begun
        .windows(2)
        .map(|pair| i64::from(pair[1]) - i64::from(pair[0]))
        .collect();
    let soon = pauses.iter().filter(|pause| (0..80).contains(*pause));
    assert_eq!(soon.count(), 1, "the other way: {begun:?}");
    let back = pauses.iter().filter(|pause| **pause < 0);
    assert_eq!(back.count(), 1, "the next drive: {begun:?}");
    assert!(begun.len() > 6, "{begun:?}");
}
