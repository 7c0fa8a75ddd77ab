//! Drives through a network with crossings, bridges, ramps and roundabouts.

use estimator_core::roadmap::{Join, MapMatch, MapPoint, Matcher, PackedMap};
use estimator_core::{CellEnd, Instant};
use host_sim::map::{MapRow, Network, WayRows, packed_map};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use serde_json::Value;
use std::collections::BTreeSet;
use std::f64::consts::TAU;
use test_kit::roads::Spot;
use test_kit::roads::network::{network, way};

/// Junctions on each side of the network, and the distance between two.
const SIDE: usize = 8;
const SPACING_M: f64 = 700.0;
const ROUNDABOUT_M: f64 = 25.0;
const RAMP_M: f64 = 180.0;

/// A point of the plane, east and north, m.
type Point = [f64; 2];

#[derive(Clone, Copy, PartialEq)]
enum Junction {
    Crossing,
    /// One road above the other, with ramps between them.
    Bridge,
    Roundabout,
}

fn junction(i: usize, j: usize) -> Junction {
    match (i * 5 + j * 3) % 4 {
        0 => Junction::Bridge,
        1 => Junction::Roundabout,
        _ => Junction::Crossing,
    }
}

/// Returns the place of a junction. The rows and columns are not straight.
fn node(i: usize, j: usize) -> Point {
    let (x, y) = (i as f64, j as f64);
    [
        SPACING_M * x + 60.0 * (1.3 * y + 0.7 * x).sin(),
        SPACING_M * y + 60.0 * (1.1 * x - 0.4 * y).cos(),
    ]
}

/// Returns spots every 20 m or so on the lines through these points.
fn spots(points: &[Point]) -> Vec<Spot> {
    let mut spots: Vec<Spot> = Vec::new();
    for pair in points.windows(2) {
        let chord = [pair[1][0] - pair[0][0], pair[1][1] - pair[0][1]];
        let length = chord[0].hypot(chord[1]);
        let parts = (length / 20.0).ceil().max(1.0);
        for part in 0..parts as usize {
            let share = part as f64 / parts;
            spots.push(spot([
                pair[0][0] + share * chord[0],
                pair[0][1] + share * chord[1],
            ]));
        }
    }
    spots.push(spot(points[points.len() - 1]));
    spots
}

fn spot(point: Point) -> Spot {
    Spot {
        distance_m: 0.0,
        east_m: point[0],
        north_m: point[1],
        altitude_m: 400.0,
        grade_percent: 0.0,
    }
}

/// Returns a way whose every spot is a point.
fn line(name: &str, oneway: &str, points: &[Point]) -> Value {
    // `way` takes every eighth spot.
    let spots: Vec<Spot> = spots(points);
    let last = spots.len() - 1;
    let repeated: Vec<Spot> = spots[..last]
        .iter()
        .flat_map(|spot| std::iter::repeat_n(*spot, 8))
        .chain([spots[last]])
        .collect();
    way(name, oneway, &repeated)
}

/// Returns the point on the way from one to another, at a distance from the first.
fn towards(from: Point, to: Point, metres: f64) -> Point {
    let chord = [to[0] - from[0], to[1] - from[1]];
    let length = chord[0].hypot(chord[1]);
    [
        from[0] + metres * chord[0] / length,
        from[1] + metres * chord[1] / length,
    ]
}

/// Appends the ways of a row or a column. They end at roundabouts.
fn street(ways: &mut Vec<Value>, name: &str, places: &[(usize, usize)]) {
    let mut points: Vec<Point> = Vec::new();
    let mut piece = 0;
    for (k, &(i, j)) in places.iter().enumerate() {
        let here = node(i, j);
        if junction(i, j) != Junction::Roundabout {
            points.push(here);
            continue;
        }
        let side =
            |other: Option<&(usize, usize)>| other.map(|&(i, j)| circle_point(here, node(i, j)));
        if let Some(end) = k.checked_sub(1).and_then(|k| side(places.get(k))) {
            points.push(end);
            ways.push(line(&format!("{name}.{piece}"), "no", &points));
            piece += 1;
        }
        points = side(places.get(k + 1)).into_iter().collect();
    }
    if points.len() > 1 {
        ways.push(line(&format!("{name}.{piece}"), "no", &points));
    }
}

/// Returns the point of a roundabout at which the road to another place begins.
fn circle_point(centre: Point, other: Point) -> Point {
    towards(centre, other, ROUNDABOUT_M)
}

/// Returns a network of crossings, bridges with ramps, and roundabouts.
pub fn grid() -> Network {
    let mut ways = Vec::new();
    for k in 0..SIDE {
        let row: Vec<_> = (0..SIDE).map(|i| (i, k)).collect();
        let column: Vec<_> = (0..SIDE).map(|j| (k, j)).collect();
        street(&mut ways, &format!("row{k}"), &row);
        street(&mut ways, &format!("column{k}"), &column);
    }
    for i in 0..SIDE {
        for j in 0..SIDE {
            let here = node(i, j);
            let around: Vec<Point> = [(1, 0), (0, 1), (-1, 0), (0, -1)]
                .iter()
                .filter_map(|(x, y)| {
                    let (i, j) = (i.checked_add_signed(*x)?, j.checked_add_signed(*y)?);
                    (i < SIDE && j < SIDE).then(|| node(i, j))
                })
                .collect();
            match junction(i, j) {
                Junction::Roundabout => {
                    let mut points: Vec<Point> = around
                        .iter()
                        .map(|other| circle_point(here, *other))
                        .collect();
                    points.extend((0..16).map(|k| {
                        let angle = TAU * f64::from(k) / 16.0;
                        [
                            here[0] + ROUNDABOUT_M * angle.cos(),
                            here[1] + ROUNDABOUT_M * angle.sin(),
                        ]
                    }));
                    let angle = |p: &Point| (p[1] - here[1]).atan2(p[0] - here[0]);
                    points.sort_by(|a, b| angle(a).total_cmp(&angle(b)));
                    points.dedup_by(|a, b| (a[0] - b[0]).hypot(a[1] - b[1]) < 1.0);
                    points.push(points[0]);
                    ways.push(line(&format!("round{i}.{j}"), "yes", &points));
                }
                Junction::Bridge if around.len() == 4 => {
                    for k in 0..4 {
                        let (from, to) = (around[k], around[(k + 3) % 4]);
                        let (a, d) = (towards(here, from, RAMP_M), towards(here, to, RAMP_M));
                        let (b, c) = (towards(here, from, 60.0), towards(here, to, 60.0));
                        let curve = |share: f64| {
                            let weights = [
                                (1.0 - share).powi(3),
                                3.0 * share * (1.0 - share).powi(2),
                                3.0 * share.powi(2) * (1.0 - share),
                                share.powi(3),
                            ];
                            [0, 1].map(|axis| {
                                weights[0] * a[axis]
                                    + weights[1] * b[axis]
                                    + weights[2] * c[axis]
                                    + weights[3] * d[axis]
                            })
                        };
                        let points: Vec<Point> =
                            (0..=12).map(|k| curve(f64::from(k) / 12.0)).collect();
                        ways.push(line(&format!("ramp{i}.{j}.{k}"), "yes", &points));
                    }
                }
                _ => {}
            }
        }
    }
    network(&ways)
}

/// Returns the map of a network with rolling hills.
pub fn map_of(network: &Network) -> Vec<u8> {
    let ways: Vec<WayRows> = network
        .ways()
        .iter()
        .map(|way| WayRows {
            name: way.name.clone(),
            rows: way
                .line
                .on_grid()
                .iter()
                .map(|point| MapRow {
                    distance_m: point.distance_m,
                    latitude_deg: point.latitude_deg,
                    longitude_deg: point.longitude_deg,
                    altitude_m: Some(400.0),
                    grade_percent: 2.0 * (point.distance_m / 150.0).sin(),
                    grade_sigma_percent: 0.1,
                    runs: 1,
                })
                .collect(),
        })
        .collect();
    packed_map(&ways).expect("packed")
}

/// A cell of a drive: the way and its place.
#[derive(Clone, Copy)]
pub struct Driven {
    way: u32,
    pub position_e7: (i32, i32),
}

/// Returns whether a join turns by more than 100 degrees from this direction.
fn is_sharp(map: &PackedMap<'_>, from: [MapPoint; 2], join: &Join) -> bool {
    let mut entered = map.block(join.to_block).expect("a block").points();
    let mut to = [
        entered.next().expect("a point"),
        entered.next().expect("a point"),
    ];
    for next in entered {
        if to[1].cell > join.to_cell {
            break;
        }
        to = [to[1], next];
    }
    let direction = |[a, b]: [MapPoint; 2]| {
        let (a, b) = (a.position_deg(), b.position_deg());
        [(b.1 - a.1) * a.0.to_radians().cos(), b.0 - a.0]
    };
    let (out, on) = (direction(from), direction(to));
    let product = out[0].hypot(out[1]) * on[0].hypot(on[1]);
    out[0] * on[0] + out[1] * on[1] < -0.17 * product
}

/// Drives a distance over the map, turning at random.
pub fn drive(map: &PackedMap<'_>, cells: usize, random: &mut ChaCha8Rng) -> Vec<Driven> {
    let ways: Vec<_> = map.ways().map(|way| way.expect("a way")).collect();
    let mut way = ways[random.random_range(0..ways.len())];
    let mut cell = way.first_cell;
    let mut driven = Vec::with_capacity(cells);
    'ways: while driven.len() < cells {
        let mut points = Vec::new();
        for block in map.blocks(&way) {
            points.extend(block.expect("a block").points());
        }
        let joins: Vec<_> = map.joins(&way).map(|join| join.expect("a join")).collect();
        while cell <= way.last_cell && driven.len() < cells {
            let next = points
                .partition_point(|p| p.cell < cell)
                .max(1)
                .min(points.len() - 1);
            let (a, b) = (points[next - 1], points[next]);
            let share = f64::from(cell - a.cell) / f64::from((b.cell - a.cell).max(1));
            let between = |a: i32, b: i32| a + (share * f64::from(b - a)) as i32;
            driven.push(Driven {
                way: way.offset,
                position_e7: (
                    between(a.latitude_e7, b.latitude_e7),
                    between(a.longitude_e7, b.longitude_e7),
                ),
            });
            cell += 1;
            let here: Vec<_> = joins
                .iter()
                .filter(|join| join.at_cell == cell - 1)
                .filter(|join| !is_sharp(map, [a, b], join))
                .collect();
            let must = cell > way.last_cell;
            if !here.is_empty() && (must || random.random_bool(0.4)) {
                let join = here[random.random_range(0..here.len())];
                way = map.way(join.to_way).expect("a way");
                cell = join.to_cell + 1;
                continue 'ways;
            }
        }
        if driven.len() < cells {
            // The edge of the network: another drive begins elsewhere.
            break;
        }
    }
    driven
}

#[test]
fn no_road_is_entered_that_was_not_driven() {
    let network = grid();
    let bytes = map_of(&network);
    let map = PackedMap::open(&bytes).expect("a map");
    let (mut cells, mut known, mut right) = (0, 0, 0);
    let mut seed = 0;
    let mut entered = Vec::new();
    while cells < 400_000 {
        seed += 1;
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let driven = drive(&map, 8_000, &mut random);
        let ways: BTreeSet<u32> = driven.iter().map(|driven| driven.way).collect();
        let mut matcher = Matcher::new(map);
        let mut error_m = [0.0_f64; 2];
        for (number, driven) in driven.iter().enumerate() {
            for error in &mut error_m {
                let fresh: f64 = StandardNormal.sample(&mut random);
                *error = 0.99 * *error + 2.0 * (1.0_f64 - 0.99 * 0.99).sqrt() * fresh;
            }
            let moved = (
                driven.position_e7.0 + (error_m[0] / 0.0111) as i32,
                driven.position_e7.1 + (error_m[1] / 0.0075) as i32,
            );
            matcher.advance(&CellEnd {
                cell: number as u32,
                time: Instant::from_micros(number as u64 * 125_000),
                position_e7: Some(moved),
                speed_mps: 20.0,
                ..CellEnd::default()
            });
            cells += 1;
            if let MapMatch::On(place) = matcher.place() {
                known += 1;
                right += usize::from(place.way == driven.way);
                if !ways.contains(&place.way) {
                    let way = |offset| {
                        let way = map.way(offset).expect("a way");
                        format!("{} {:?}", way.name().expect("text"), way.direction)
                    };
                    entered.push((seed, number, way(place.way), way(driven.way)));
                }
            }
        }
    }
    let percent = |part: usize, of: usize| 100.0 * part as f64 / of as f64;
    println!(
        "known {:.1} % of {cells} cells, right {:.2} % of them, entered {}",
        percent(known, cells),
        percent(right, known),
        entered.len()
    );
    let mut names: Vec<_> = entered
        .iter()
        .map(|(s, n, a, b)| (s, n / 40, a, b))
        .collect();
    names.dedup();
    assert!(entered.is_empty(), "{:?}", &names[..names.len().min(12)]);
    assert!(percent(known, cells) > 80.0 && percent(right, known) > 95.0);
}
