//! Where the vehicle is on a map, from its positions and its odometer.

use estimator_core::roadmap::{MapMatch, MapPlace, Matcher, PackedMap};
use estimator_core::{CELL_LENGTH_M, CellEnd, Instant};
use host_sim::map::{WayRows, packed_map};
use test_kit::roads::network::{map, network, way};
use test_kit::roads::{Spot, drive, hills, moved, reversed, run, with_position_noise};

/// What happens on a drive.
#[derive(Clone, Copy)]
struct Conditions {
    /// Driven over true distance.
    odometer: f64,
    /// No positions between these distances, m.
    tunnel_m: (f64, f64),
}

const PLAIN: Conditions = Conditions {
    odometer: 1.0,
    tunnel_m: (0.0, 0.0),
};

/// Returns the place at every spot of a drive over a map.
fn places(bytes: &[u8], spots: &[Spot], conditions: Conditions) -> Vec<MapMatch> {
    let mut matcher = Matcher::new(PackedMap::open(bytes).expect("a map"));
    let (from_m, to_m) = conditions.tunnel_m;
    let mut last = None;
    spots
        .iter()
        .map(|spot| {
            let cell = (spot.distance_m * conditions.odometer / f64::from(CELL_LENGTH_M)) as u32;
            let (latitude, longitude) = spot.latitude_longitude_deg();
            let e7 = |degrees: f64| (degrees * 1e7).round() as i32;
            let is_dark = (from_m..to_m).contains(&spot.distance_m);
            let end = CellEnd {
                cell,
                time: Instant::from_micros((spot.distance_m * 5e4) as u64),
                position_e7: (!is_dark).then(|| (e7(latitude), e7(longitude))),
                speed_mps: 20.0,
                ..CellEnd::default()
            };
            if last.replace(cell) != Some(cell) {
                matcher.advance(&end);
            }
            matcher.place()
        })
        .collect()
}

/// Returns the name of the way of a place.
fn name_of(bytes: &[u8], place: &MapPlace) -> String {
    let map = PackedMap::open(bytes).expect("a map");
    map.way(place.way)
        .expect("a way")
        .name()
        .expect("a name")
        .to_owned()
}

fn metres(place: &MapPlace) -> f64 {
    f64::from(place.cell * CELL_LENGTH_M)
}

fn packed(ways: &[WayRows]) -> Vec<u8> {
    packed_map(ways).expect("packed")
}

/// Returns a map of one road under these spots.
fn road(spots: &[Spot]) -> Vec<u8> {
    packed(&map(&network(&[way("road", "yes", spots)]), &[&run(spots)]))
}

/// Returns a road of 20 km with bends.
fn long_road() -> Vec<Spot> {
    drive(
        (0.0, 0.0),
        20_000.0,
        |s| 40.0 + 40.0 * (s / 800.0).sin(),
        |s| 2.0 * (s / 400.0).sin(),
    )
}

#[test]
fn the_place_on_a_road_is_known_within_metres() {
    let spots = long_road();
    let bytes = road(&spots);
    for seed in 0..5 {
        let found = places(
            &bytes,
            &with_position_noise(&spots, 2.5, 300.0, seed),
            PLAIN,
        );
        let mut errors = Vec::new();
        for (spot, found) in spots.iter().zip(&found).take(7_950).skip(200) {
            let MapMatch::On(place) = found else {
                panic!("not on the map at {} m: {found:?}", spot.distance_m)
            };
            errors.push((metres(place) - spot.distance_m, place.sigma_m));
        }
        let count = errors.len() as f64;
        let rms = (errors.iter().map(|(e, _)| e * e).sum::<f64>() / count).sqrt();
        let normalised = errors
            .iter()
            .map(|(e, s)| (e / f64::from(*s)).powi(2))
            .sum::<f64>();
        assert!(rms < 4.0, "{rms} m");
        assert!(normalised / count < 4.0, "{}", normalised / count);
    }
}

#[test]
fn a_tunnel_is_driven_by_the_odometer_whose_scale_is_learned() {
    let spots = long_road();
    let bytes = road(&spots);
    for (seed, odometer) in [(1, 1.01), (2, 0.99), (3, 1.0)] {
        let conditions = Conditions {
            odometer,
            tunnel_m: (12_000.0, 15_000.0),
        };
        let found = places(
            &bytes,
            &with_position_noise(&spots, 2.5, 300.0, seed),
            conditions,
        );
        let MapMatch::On(place) = found[5_999] else {
            panic!("lost in the tunnel: {:?}", found[5_999])
        };
        let error_m = metres(&place) - spots[5_999].distance_m;
        assert!(error_m.abs() < 10.0, "{error_m} m with {odometer}");
        assert!(
            error_m.abs() < 3.0 * f64::from(place.sigma_m),
            "{error_m} of {place:?}"
        );
    }
}

#[test]
fn a_fork_keeps_both_ways_until_one_is_clear() {
    let trunk = hills();
    let fork = &trunk[1200];
    let ramp = drive(
        (fork.east_m, fork.north_m),
        1500.0,
        |s| 30.0 + 40.0 * (s / 500.0).min(1.0),
        |_| -2.0,
    );
    let network = network(&[
        way("trunk", "yes", &trunk[..=1200]),
        way("on", "yes", &trunk[1200..]),
        way("ramp", "yes", &ramp),
    ]);
    let off: Vec<Spot> = trunk[..=1200]
        .iter()
        .chain(&ramp[1..])
        .enumerate()
        .map(|(i, spot)| Spot {
            distance_m: 2.5 * i as f64,
            ..*spot
        })
        .collect();
    let bytes = packed(&map(&network, &[&run(&trunk), &run(&off)]));
    for (spots, name) in [(&trunk, "on"), (&off, "ramp")] {
        for seed in 0..4 {
            let found = places(&bytes, &with_position_noise(spots, 2.0, 300.0, seed), PLAIN);
            for found in &found[1500..1750] {
                let MapMatch::On(place) = found else {
                    panic!("{name}: {found:?}")
                };
                assert_eq!(name_of(&bytes, place), name);
            }
            // Before it is clear, the place is not told rather than wrong.
            let wrong = found[1200..1500].iter().filter(|found| match found {
                MapMatch::On(place) => name_of(&bytes, place) != name,
                _ => false,
            });
            assert!(wrong.count() < 60, "{name}");
        }
    }
}

#[test]
fn other_roads_are_not_entered() {
    let spots = hills();
    let parallel = moved(&spots, 15.0, -13.0);
    let crossing = drive((-1500.0, 2000.0), 6000.0, |_| 110.0, |_| 1.0);
    let noisy = |seed| with_position_noise(&spots, 2.0, 300.0, seed);
    for (name, other) in [
        ("parallel", &parallel),
        ("opposite", &reversed(&spots)),
        ("crossing", &crossing),
    ] {
        let alone = road(other);
        for seed in 0..3 {
            let on = places(&alone, &noisy(seed), PLAIN);
            let on = on.iter().filter(|found| matches!(found, MapMatch::On(_)));
            assert_eq!(on.count(), 0, "{name} alone");
        }
        let both = network(&[way("own", "yes", &spots), way("other", "yes", other)]);
        let bytes = packed(&map(&both, &[&run(&spots), &run(other)]));
        for seed in 0..3 {
            let found = places(&bytes, &noisy(seed), PLAIN);
            for found in &found[200..found.len() - 50] {
                let MapMatch::On(place) = found else {
                    panic!("{name}: {found:?}")
                };
                assert_eq!(name_of(&bytes, place), "own", "{name}");
            }
        }
    }
}

#[test]
fn a_vehicle_that_leaves_the_map_is_off_it_and_comes_back() {
    let spots = hills();
    // The map has a road of 2 km; the drive goes on for 4 km and returns by the same road.
    let bytes = road(&spots[..=800]);
    let found = places(&bytes, &with_position_noise(&spots, 2.0, 300.0, 1), PLAIN);
    assert!(matches!(found[700], MapMatch::On(_)));
    assert!(found[900..].iter().all(|found| *found == MapMatch::Off));
    let twice: Vec<Spot> = spots
        .iter()
        .chain(&spots)
        .enumerate()
        .map(|(i, spot)| Spot {
            distance_m: 2.5 * i as f64,
            ..*spot
        })
        .collect();
    let found = places(&bytes, &twice, PLAIN);
    assert!(matches!(found[spots.len() + 400], MapMatch::On(_)));
}

#[test]
fn a_damaged_block_is_a_gap() {
    let spots = hills();
    let mut bytes = road(&spots);
    let offsets: Vec<u32> = {
        let map = PackedMap::open(&bytes).expect("a map");
        let way = map.ways().next().expect("a way").expect("a way");
        map.blocks(&way)
            .map(|block| block.expect("a block").offset)
            .collect()
    };
    bytes[offsets[7] as usize + 30] ^= 0x10;
    let found = places(&bytes, &spots, PLAIN);
    let on = |range: std::ops::Range<usize>| {
        found[range]
            .iter()
            .all(|found| matches!(found, MapMatch::On(_)))
    };
    // Blocks have 128 cells.
    assert!(on(200..128 * 7) && on(128 * 8 + 200..spots.len() - 100));
    assert!(!on(128 * 7..128 * 8));
}
