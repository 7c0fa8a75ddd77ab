//! Runs on the ways of a network: each cell on the way that was driven.

use host_sim::files::run::RunRow;
use host_sim::map::{Coverage, Network, RoadLine, WayRows};
use serde_json::Value;
use test_kit::roads::network::{map, names, network, rows_of, way};
use test_kit::roads::{
    Spot, drive, fuse, hills, moved, points, reversed, run, with_position_noise,
};

fn noisy(spots: &[Spot], seed: u64) -> Vec<RunRow> {
    run(&with_position_noise(spots, 3.0, 80.0, seed))
}

fn with_grade(mut rows: Vec<RunRow>, grade_percent: f64) -> Vec<RunRow> {
    for row in &mut rows {
        row.grade_percent = grade_percent;
    }
    rows
}

fn coverage(network: &Network, rows: &[RunRow]) -> Coverage {
    fuse(network, &[rows]).coverage[0]
}

/// Returns ways of the same number of spots, named by their number.
fn pieces(prefix: &str, spots: &[Spot], count: usize) -> Vec<Value> {
    let starts = (0..spots.len() - 1).step_by(count).enumerate();
    starts
        .map(|(number, first)| {
            let end = (first + count).min(spots.len() - 1);
            way(&format!("{prefix}{number:04}"), "yes", &spots[first..=end])
        })
        .collect()
}

fn grades(way: &WayRows) -> impl Iterator<Item = f64> {
    way.rows.iter().map(|row| row.grade_percent)
}

#[test]
fn parallel_carriageways_are_distinguished_by_course() {
    let east = drive(
        (0.0, 0.0),
        4000.0,
        |s| 80.0 + 20.0 * (s / 900.0).sin(),
        |_| 0.0,
    );
    let west = moved(&reversed(&east), 0.0, 15.0);
    let network = network(&[way("east", "yes", &east), way("west", "yes", &west)]);
    for seed in 0..5 {
        let (there, back) = (
            with_grade(noisy(&east, seed), 2.0),
            with_grade(noisy(&west, 100 + seed), -3.0),
        );
        let map = map(&network, &[&there, &back]);
        assert_eq!(names(&map), ["east forward", "west forward"]);
        for (name, grade_percent) in [("east", 2.0), ("west", -3.0)] {
            let way = rows_of(&map, name);
            assert!(way.rows.len() > 1590, "{name}: {}", way.rows.len());
            assert!(way.rows.iter().all(|row| row.runs == 1));
            assert!(grades(way).all(|grade| (grade - grade_percent).abs() < 1e-9));
        }
    }
}

#[test]
fn both_directions_of_a_street_are_ways_of_their_own() {
    let spots = hills();
    let network = network(&[way("street", "no", &spots)]);
    let (there, back) = (run(&spots), run(&reversed(&spots)));
    let map = map(&network, &[&there, &back]);
    assert_eq!(names(&map), ["street forward", "street backward"]);
    let (there, back) = (&map[0].rows, &map[1].rows);
    assert!(there.len() > 2390 && back.len() > 2390);
    for row in back {
        // Distance and sign of the grade are those of the direction of travel.
        let mirror_m = 6000.0 - row.distance_m;
        let opposite = &there[((mirror_m / 2.5) as usize).min(there.len() - 1)];
        assert!(
            (row.grade_percent + opposite.grade_percent).abs() < 0.06,
            "{row:?}"
        );
        assert!((row.latitude_deg - opposite.latitude_deg).abs() < 1e-4);
    }
}

/// Returns a motorway and a service road in the same direction, 15 m to the right. The service road
/// leaves the motorway at 500 m and returns at 5500 m.
fn motorway() -> (Vec<Spot>, Vec<Spot>) {
    let course = |s: f64| 60.0 + 25.0 * (s / 1200.0).sin();
    let motorway = drive((0.0, 0.0), 6000.0, course, |_| 0.0);
    let beside_m = |s: f64| match s {
        s if s <= 500.0 || s >= 5500.0 => 0.0,
        s if s < 600.0 => 15.0 * (s - 500.0) / 100.0,
        s if s > 5400.0 => 15.0 * (5500.0 - s) / 100.0,
        _ => 15.0,
    };
    let service: Vec<Spot> = motorway
        .iter()
        .map(|spot| {
            let right = (course(spot.distance_m) + 90.0).to_radians();
            let m = beside_m(spot.distance_m);
            Spot {
                east_m: spot.east_m + m * right.sin(),
                north_m: spot.north_m + m * right.cos(),
                ..*spot
            }
        })
        .collect();
    (motorway, service)
}

#[test]
fn a_service_road_beside_a_motorway_is_distinguished_by_continuity() {
    let (motorway, service) = motorway();
    // Ways that end where the service road leaves and returns.
    let mut ways = vec![way("m0", "yes", &motorway[..=200])];
    for (number, first) in (200..2200).step_by(280).enumerate() {
        let end = (first + 280).min(2200);
        ways.push(way(
            &format!("m{}", number + 1),
            "yes",
            &motorway[first..=end],
        ));
    }
    ways.push(way("m9", "yes", &motorway[2200..]));
    ways.push(way("service", "yes", &service[200..=2200]));
    let network = network(&ways);
    for seed in 0..5 {
        let fast = with_grade(noisy(&motorway, seed), 1.0);
        let slow = with_grade(noisy(&service, 50 + seed), -1.0);
        let map = map(&network, &[&fast, &slow]);
        let beside = rows_of(&map, "service");
        // Where the roads part and meet, they are closer than the noise.
        let apart = |at_m: &f64| (80.0..4920.0).contains(at_m);
        let rows: Vec<_> = beside
            .rows
            .iter()
            .filter(|row| apart(&row.distance_m))
            .collect();
        assert!(rows.len() > 1930, "{}", rows.len());
        assert!(
            rows.iter()
                .all(|row| row.grade_percent == -1.0 && row.runs == 1)
        );
        for number in 2..=7 {
            let way = rows_of(&map, &format!("m{number}"));
            assert!(way.rows.len() >= 280, "m{number}: {}", way.rows.len());
            assert!(grades(way).all(|grade| grade == 1.0), "m{number}");
        }
        // Both runs drive the road before and after it.
        for name in ["m0", "m9"] {
            let way = rows_of(&map, name);
            assert!(way.rows.len() >= 195, "{name}: {}", way.rows.len());
            assert!(way.rows.iter().filter(|row| row.runs == 2).count() > 190);
        }
    }
}

const RING_M: f64 = 20.0;

/// Returns a drive around a roundabout and the ways. The roundabout has arms to the south and west.
/// The drive goes from south to west, anticlockwise.
fn roundabout() -> (Vec<Spot>, Vec<Value>) {
    let arc_m = 1.5 * std::f64::consts::PI * RING_M;
    let turned_deg = |m: f64| (m / RING_M).to_degrees();
    let course = move |s: f64| match s - 300.0 {
        d if d < 0.0 => 0.0,
        d if d < arc_m => 90.0 - turned_deg(d),
        _ => 270.0,
    };
    let driven = drive((0.0, -300.0), 600.0 + arc_m, course, |s| match s - 300.0 {
        d if d < 0.0 => 0.0,
        d if d < arc_m => 2.0,
        _ => 4.0,
    });
    let round_m = 2.0 * std::f64::consts::PI * RING_M;
    // A closed way. It begins at a point on the east side, which the run passes.
    let mut ring = drive((RING_M, RING_M), round_m, |s| -turned_deg(s), |_| 0.0);
    ring.push(ring[0]);
    let points = |name: &str, spots: &[Spot]| {
        let mut way = way(name, "yes", spots);
        let places = spots.iter().map(|spot| {
            let (latitude, longitude) = spot.latitude_longitude_deg();
            serde_json::json!([longitude, latitude])
        });
        way["geometry"]["coordinates"] = places.collect();
        way
    };
    let ways = vec![
        way("in", "yes", &drive((0.0, -300.0), 300.0, |_| 0.0, |_| 0.0)),
        points("ring", &ring),
        way(
            "out",
            "yes",
            &drive((-RING_M, RING_M), 300.0, |_| 270.0, |_| 0.0),
        ),
        way(
            "north",
            "yes",
            &drive((0.0, 2.0 * RING_M), 300.0, |_| 0.0, |_| 0.0),
        ),
        way(
            "east",
            "yes",
            &drive((RING_M, RING_M), 300.0, |_| 90.0, |_| 0.0),
        ),
    ];
    (driven, ways)
}

#[test]
fn a_roundabout_is_driven_around() {
    let (driven, ways) = roundabout();
    let network = network(&ways);
    let mut worst_off = 0;
    for seed in 0..10 {
        let rows = match seed {
            0 => run(&driven),
            _ => run(&with_position_noise(&driven, 2.0, 80.0, seed)),
        };
        let coverage = coverage(&network, &rows);
        worst_off = worst_off.max(coverage.off_road);
        let map = map(&network, &[&rows]);
        assert_eq!(
            names(&map),
            ["in forward", "out forward", "ring forward"],
            "{seed}"
        );
        let ring = rows_of(&map, "ring");
        // Three quarters of 126 m.
        assert!(
            (34..=42).contains(&ring.rows.len()),
            "{seed}: {}",
            ring.rows.len()
        );
        for (name, grade_percent) in [("in", 0.0), ("ring", 2.0), ("out", 4.0)] {
            let way = rows_of(&map, name);
            let count = way.rows.len();
            let close = grades(way).filter(|grade| (grade - grade_percent).abs() < 0.7);
            assert!(close.count() + 6 >= count, "{seed} {name}: {:?}", way.rows);
            assert!(name == "ring" || count > 115, "{seed} {name}: {count}");
        }
    }
    assert!(worst_off <= 4, "{worst_off}");
}

#[test]
fn a_gap_in_the_network_is_passed() {
    let spots = hills();
    for gap in [10, 24, 120] {
        let ways = [
            way("a", "yes", &spots[..=800]),
            way("b", "yes", &spots[800 + gap..]),
        ];
        let network = network(&ways);
        let rows = noisy(&spots, 3);
        let coverage = coverage(&network, &rows);
        assert!(coverage.off_road <= gap, "{gap}: {coverage:?}");
        let map = map(&network, &[&rows]);
        assert!(rows_of(&map, "a").rows.len() >= 798);
        let behind = rows_of(&map, "b");
        assert!(
            behind.rows.len() + gap >= 1598,
            "{gap}: {}",
            behind.rows.len()
        );
        for row in &behind.rows {
            let at_m = (800 + gap) as f64 * 2.5 + row.distance_m;
            assert!(
                (row.grade_percent - test_kit::roads::hill_percent(at_m)).abs() < 0.1,
                "{row:?}"
            );
        }
    }
}

#[test]
fn a_run_without_positions_keeps_its_way_over_joins() {
    let spots = hills();
    let network = network(&pieces("p", &spots, 150));
    let mut rows = run(&spots);
    for row in &mut rows[700..1100] {
        row.latitude_deg = None;
        row.longitude_deg = None;
    }
    for row in &mut rows {
        row.distance_m *= 1.005;
    }
    let map = map(&network, &[&rows]);
    assert_eq!(map.len(), 16);
    let mut cells = 0;
    for (number, way) in map.iter().enumerate() {
        cells += way.rows.len();
        for row in &way.rows {
            let at_m = number as f64 * 375.0 + row.distance_m;
            let truth = test_kit::roads::hill_percent(at_m);
            assert!((row.grade_percent - truth).abs() < 0.02, "{number} {row:?}");
        }
    }
    assert!(cells > 2390, "{cells}");

    // Missing rows are not made up.
    let without: Vec<RunRow> = [&rows[..700], &rows[1100..]].concat();
    let map = test_kit::roads::network::map(&network, &[&without]);
    let cells: usize = map.iter().map(|way| way.rows.len()).sum();
    assert!((1990..2010).contains(&cells), "{cells}");
    assert!(
        map.iter()
            .flat_map(|way| &way.rows)
            .all(|row| row.runs == 1)
    );
}

#[test]
fn crossings_take_no_cells() {
    let straight = |east_m: f64, north_m: f64, course: f64| {
        drive((east_m, north_m), 1000.0, move |_| course, |_| 0.0)
    };
    let road = straight(0.0, -500.0, 0.0);
    for turn_deg in [15.0_f64, 25.0, 60.0, 90.0] {
        let turn = turn_deg.to_radians();
        let crossing = straight(-500.0 * turn.sin(), -500.0 * turn.cos(), turn_deg);
        let spots = crossing.len() / 2;
        // A bridge, which shares no point, and a level crossing, which shares one. The other road
        // is in one piece or two.
        let bridge = vec![way("road", "no", &road), way("other", "no", &crossing)];
        let mut level = vec![way("road", "no", &road)];
        level.push(way("other", "no", &crossing[..=spots]));
        level.push(way("other on", "no", &crossing[spots..]));
        for (ways, kind) in [(bridge, "bridge"), (level, "level")] {
            let network = network(&ways);
            for seed in 0..5 {
                let rows = noisy(&road, seed);
                let on_road = map(&network, &[&rows]);
                let what = format!("{kind} {turn_deg} {seed}");
                assert_eq!(names(&on_road), ["road forward"], "{what}");
                assert!(on_road[0].rows.len() >= 395, "{what}");
                let over = map(&network, &[&noisy(&crossing, seed)]);
                let over = names(&over);
                assert!(
                    over.iter().all(|name| name.starts_with("other")),
                    "{what}: {over:?}"
                );
            }
        }
    }
}

#[test]
fn a_road_in_pieces_is_the_road_in_one_piece() {
    let spots = hills();
    let whole = Network::from(RoadLine::new(points(&spots)).expect("a road"));
    for seed in 0..3 {
        let rows = noisy(&spots, seed);
        let expected = fuse(&whole, &[&rows]).map.fused().rows();
        for count in [2, 4, 12, 40] {
            let network = network(&pieces("p", &spots, count));
            let map = map(&network, &[&rows]);
            for way in &map {
                let name = way.name.as_ref().expect("a name");
                let number: usize = name.way[1..].parse().expect("a number");
                for row in &way.rows {
                    let at_m = (number * count) as f64 * 2.5 + row.distance_m;
                    let place = ((at_m - expected[0].distance_m) / 2.5).round() as usize;
                    let off =
                        row.grade_percent - expected[place.min(expected.len() - 1)].grade_percent;
                    // 2 m on the steepest change of slope; 5 m where ways are 5 or 10 m long.
                    let limit = if count < 8 { 0.05 } else { 0.02 };
                    assert!(off.abs() < limit, "{count} {name} {row:?}: {off}");
                }
            }
            // Ways may have both their ends as cells; the run may begin behind the road's start.
            let cells: usize = map.iter().map(|way| way.rows.len()).sum();
            assert!(cells > 2376, "{count} {seed}: {cells}");
        }
    }
}

#[test]
fn turning_off_takes_the_street() {
    // North, then left at a crossing of two streets that go on.
    let north = drive((0.0, -600.0), 1200.0, |_| 0.0, |_| 0.0);
    let west = drive((600.0, 0.0), 1200.0, |_| 270.0, |_| 0.0);
    let network = network(&[way("north", "no", &north), way("west", "no", &west)]);
    let driven = drive(
        (0.0, -600.0),
        1200.0,
        |s| if s < 600.0 { 0.0 } else { 270.0 },
        |s| if s < 600.0 { 1.0 } else { 2.0 },
    );
    for seed in 0..5 {
        let rows = noisy(&driven, seed);
        let coverage = coverage(&network, &rows);
        assert_eq!(coverage.off_road, 0, "{coverage:?}");
        let map = map(&network, &[&rows]);
        assert_eq!(names(&map), ["north forward", "west forward"]);
        for (name, within_m, grade_percent) in
            [("north", 0.0..590.0, 1.0), ("west", 610.0..1200.0, 2.0)]
        {
            let way = rows_of(&map, name);
            let inside = way
                .rows
                .iter()
                .filter(|row| within_m.contains(&row.distance_m));
            assert!(inside.clone().count() > 230, "{name}");
            for row in inside {
                assert_eq!(row.grade_percent, grade_percent, "{seed} {name} {row:?}");
            }
            assert!(way.rows.len() < 250, "{name}: {}", way.rows.len());
        }
    }
}

#[test]
fn a_run_away_from_all_ways_is_off_the_network() {
    let spots = hills();
    let network = network(&[way("a", "yes", &spots)]);
    let away = run(&moved(&spots, -40.0, 40.0));
    let all = coverage(&network, &away);
    assert_eq!((all.matched, all.off_road), (0, all.cells));
    let against = coverage(&network, &run(&reversed(&spots)));
    assert_eq!(against.matched, 0);
    assert!(against.opposite >= against.cells - 2);
    assert!(map(&network, &[&away]).is_empty());
}
