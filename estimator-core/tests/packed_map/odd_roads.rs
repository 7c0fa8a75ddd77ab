//! Roads that cross the date line, that have gaps, that lie beside others, and drives with gaps.

use super::file::{TestWay, packed};
use super::{WAYS, before_the_exit, finished, known_cell, live};
use estimator_core::roadmap::{Horizon, MapLive, MapMatch, PackedMap};
use estimator_core::{Cell, Live, Uncertain};

const LONG: TestWay = TestWay {
    name: "long",
    cells: 900,
    grade: 400,
    begin_e7: [1_000_000, 20_000_000],
    heading: [10, 0],
    joins: &[],
    gap: None,
};

#[test]
fn a_road_goes_on_over_the_date_line() {
    for (begin, heading) in [(1_799_900_000, 10), (-1_799_900_000, -10)] {
        let road = TestWay {
            begin_e7: [1_000_000, begin],
            heading: [0, heading],
            ..LONG
        };
        let bytes = packed(&[road]);
        let map = PackedMap::open(&bytes).unwrap();
        let mut on_map = MapLive::new(map);
        // Up to the end of the way, less the error of the place.
        for cell in 0..895 {
            let (_, longitude_e7) = road.place_e7(cell);
            // The line is after 444 cells.
            assert_eq!(
                longitude_e7.signum() == begin.signum(),
                cell < 445,
                "{cell}"
            );
            on_map.advance(&live(&road, cell, cell as u32));
            if cell < 100 {
                continue;
            }
            let known = known_cell(&on_map, "long").expect("a place");
            assert!((known - cell as f32).abs() < 8.0, "{known} {cell}");
            let MapMatch::On(place) = on_map.matcher().place() else {
                panic!("{cell}");
            };
            if cell == 300 {
                let horizon = Horizon::new(map, &place, 1_000.0).unwrap();
                let mut points = horizon.points(&horizon.branches()[0], 25.0);
                assert!(points.all(|point| point.grade_percent.is_some()));
            }
        }
    }
}

#[test]
fn in_a_gap_of_the_map_there_is_no_grade_and_behind_it_the_place_is_known() {
    let (from, to) = (300, 340);
    let road = TestWay {
        gap: Some((from, to)),
        ..LONG
    };
    let bytes = packed(&[road]);
    let mut on_map = MapLive::new(PackedMap::open(&bytes).unwrap());
    for cell in 0..600 {
        on_map.advance(&live(&road, cell, cell as u32));
        let grade = on_map.map_grade_percent();
        if (from + 8..to - 8).contains(&cell) {
            assert_eq!(grade, None, "{cell}");
        } else if cell > to + 8 {
            assert!(grade.is_some(), "{cell}");
        }
    }
    let known = known_cell(&on_map, "long").expect("a place");
    assert!((known - 599.0).abs() < 8.0, "{known}");
    let counters = on_map.counters();
    assert_eq!((counters.cells_left_out, counters.times_left_out), (0, 0));
    assert!((400..600).contains(&counters.cells_on_map), "{counters:?}");
}

#[test]
fn after_a_gap_of_the_drive_the_place_is_known_if_it_was_short() {
    let bytes = packed(&[LONG]);
    for (gap, is_known) in [(20, true), (450, false)] {
        let mut on_map = MapLive::new(PackedMap::open(&bytes).unwrap());
        (0..200).for_each(|cell| on_map.advance(&live(&LONG, cell, cell as u32)));
        assert!(known_cell(&on_map, "long").is_some());
        let behind = 200 + gap;
        on_map.advance(&live(&LONG, behind, behind as u32));
        assert_eq!(known_cell(&on_map, "long").is_some(), is_known, "{gap}");
        (behind + 1..behind + 100).for_each(|cell| on_map.advance(&live(&LONG, cell, cell as u32)));
        let known = known_cell(&on_map, "long").expect("a place");
        assert!((known - behind as f32 - 99.0).abs() < 8.0, "{gap}: {known}");
    }
}

#[test]
fn the_next_drive_begins_without_a_place() {
    let bytes = packed(&[LONG]);
    let mut on_map = MapLive::new(PackedMap::open(&bytes).unwrap());
    (0..300).for_each(|cell| on_map.advance(&live(&LONG, cell, cell as u32)));
    assert!(on_map.combined_percent().is_some());
    let before = *on_map.counters();
    // Its cells are numbered from the start.
    on_map.advance(&live(&LONG, 600, 0));
    assert_eq!(on_map.matcher().place(), MapMatch::Off);
    assert_eq!(on_map.matcher().hypotheses().count(), 0);
    assert_eq!(on_map.combined_percent(), None);
    (1..200).for_each(|cell| on_map.advance(&live(&LONG, 600 + cell, cell as u32)));
    let known = known_cell(&on_map, "long").expect("a place");
    assert!((known - 799.0).abs() < 8.0, "{known}");
    assert!(on_map.counters().cells_on_map > before.cells_on_map + 50);
}

#[test]
fn of_many_roads_side_by_side_the_best_are_followed() {
    // 4 m apart; the vehicle is on the last one.
    const EAST_E7: i32 = 360;
    let beside = |number: i32| TestWay {
        begin_e7: [1_000_000, 20_000_000 + number * EAST_E7],
        ..LONG
    };
    let mut roads = [0, 1, 2, 3, 4, 5, 6, 7].map(beside);
    roads[7].name = "last";
    let bytes = packed(&roads);
    let map = PackedMap::open(&bytes).unwrap();
    let mut on_map = MapLive::new(map);
    let mut most = 0;
    for cell in 0..800 {
        on_map.advance(&live(&roads[7], cell, cell as u32));
        most = most.max(on_map.matcher().hypotheses().count());
    }
    assert_eq!(most, 6);
    // A worse one does not take the place of a better one.
    let mut from_the_first = MapLive::new(map);
    for cell in 0..800 {
        from_the_first.advance(&live(&roads[0], cell, cell as u32));
        let hypotheses = from_the_first.matcher().hypotheses();
        assert!(hypotheses.count() <= 6);
    }
    let ways: Vec<_> = from_the_first.matcher().hypotheses().collect();
    let first = map.ways().next().unwrap().unwrap().offset;
    assert!(ways.iter().any(|place| place.way == first), "{ways:?}");
    let best = on_map
        .matcher()
        .hypotheses()
        .max_by(|a, b| a.probability.total_cmp(&b.probability));
    let way = map.way(best.unwrap().way).unwrap();
    assert_eq!(way.name().unwrap(), "last");
}

#[test]
fn positions_that_stand_still_show_no_course_and_lose_no_place() {
    let bytes = packed(&[LONG]);
    let mut on_map = MapLive::new(PackedMap::open(&bytes).unwrap());
    for cell in 0..400 {
        // The receiver repeats a position over 40 m, now and then.
        let seen = if cell % 100 < 16 {
            cell / 100 * 100
        } else {
            cell
        };
        on_map.advance(&live(&LONG, seen, cell as u32));
        if cell > 150 {
            let known = known_cell(&on_map, "long").expect("a place");
            assert!((known - cell as f32).abs() < 16.0, "{known} {cell}");
        }
    }
}

#[test]
fn a_road_without_length_is_not_entered() {
    let point = TestWay {
        name: "point",
        heading: [0, 0],
        begin_e7: [1_020_000, 20_000_000],
        ..LONG
    };
    let bytes = packed(&[point, LONG]);
    let mut on_map = MapLive::new(PackedMap::open(&bytes).unwrap());
    for cell in 0..400 {
        on_map.advance(&live(&LONG, cell, cell as u32));
        let ways = on_map.matcher().hypotheses().map(|place| place.way);
        for way in ways.collect::<Vec<_>>() {
            let way = on_map.matcher().map().way(way).unwrap();
            assert_eq!(way.name().unwrap(), "long", "{cell}");
        }
    }
    assert!(known_cell(&on_map, "long").is_some());
}

#[test]
fn grades_that_are_no_numbers_say_nothing_of_the_map() {
    let bytes = packed(&WAYS);
    let mut on_map = before_the_exit(&bytes);
    for cell in 100..390 {
        let mut live = live(&WAYS[0], cell, cell as u32);
        let is_broken = cell % 3 == 0;
        if is_broken {
            live.estimate.grade_percent.value = f32::NAN;
        }
        on_map.advance(&live);
        on_map.finish(&Cell {
            lagged_grade_percent: Uncertain {
                value: if is_broken { f32::INFINITY } else { 2.0 },
                sigma: 0.1,
            },
            ..finished(&live)
        });
        assert!(!on_map.is_left_out(), "{cell}");
        let shift = on_map.shift_m();
        assert!(shift.value.is_finite() && shift.sigma.is_finite());
    }
    assert!(known_cell(&on_map, "road").is_some());
}

/// A road, a lane that leaves it 250 m before its end, 8 m beside it, and the road behind both. By the map
/// the road ends so many cells too early.
fn lane_beside_a_road(early: i32) -> [TestWay; 3] {
    let road = TestWay {
        name: "road",
        cells: 200 - early,
        joins: Box::leak(Box::new([(100, 1), (199 - early, 2)])),
        ..LONG
    };
    let lane = TestWay {
        name: "lane",
        cells: 100,
        begin_e7: [1_022_500, 20_000_700],
        joins: &[(99, 2)],
        ..LONG
    };
    let behind = TestWay {
        name: "behind",
        cells: 300,
        begin_e7: [1_045_000, 20_000_450],
        ..LONG
    };
    [road, lane, behind]
}

/// Returns the live estimate at a cell of a drive on the lane.
fn on_the_lane([road, lane, behind]: &[TestWay; 3], number: i32) -> Live {
    let (way, cell) = match number {
        0..100 => (road, number),
        100..200 => (lane, number - 100),
        _ => (behind, number - 200),
    };
    live(way, cell, number as u32)
}

#[test]
fn a_lane_that_leaves_a_road_and_comes_back_is_followed() {
    let ways = lane_beside_a_road(0);
    let bytes = packed(&ways);
    let mut on_map = MapLive::new(PackedMap::open(&bytes).unwrap());
    let mut most = 0;
    for number in 0..400 {
        on_map.advance(&on_the_lane(&ways, number));
        let hypotheses = on_map.matcher().hypotheses().count();
        if number < 200 {
            most = most.max(hypotheses);
        } else if number > 240 {
            assert_eq!(hypotheses, 1, "{number}");
        }
    }
    assert!(most > 1);
    let known = known_cell(&on_map, "behind").expect("a place");
    assert!((known - 199.0).abs() < 8.0, "{known}");
}

#[test]
fn of_two_hypotheses_that_come_together_the_better_one_stays() {
    // The hypothesis of the road gets behind it first, is farther along, and fits worse.
    for early in 4..24 {
        let ways = lane_beside_a_road(early);
        let bytes = packed(&ways);
        let mut on_map = MapLive::new(PackedMap::open(&bytes).unwrap());
        (0..400).for_each(|number| on_map.advance(&on_the_lane(&ways, number)));
        assert_eq!(on_map.matcher().hypotheses().count(), 1);
        let known = known_cell(&on_map, "behind").expect("a place");
        assert!((known - 199.0).abs() < 8.0, "{early}: {known}");
    }
}
