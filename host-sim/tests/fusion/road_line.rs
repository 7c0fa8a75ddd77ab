//! A road as a line: from points, from a run's own track, and where positions lie on it.

use host_sim::map::{MatchedPlace, Network, RoadLine, TrackPoint, match_track, road_of_run};
use test_kit::roads::{Spot, drive, fuse, hill_percent, hills, points, run};

#[test]
fn without_a_road_the_first_track_serves() {
    let spots = hills();
    let rows = run(&spots);
    let track = road_of_run(&rows).expect("a track");
    let road_line = RoadLine::new(track).expect("a road");
    let length_m = road_line.end_m();
    let road_line = road_line.into();
    assert!((length_m - 6000.0).abs() < 0.1, "{length_m}");
    let map = fuse(&road_line, &[&rows]).map.fused().rows();
    assert!(map.len() > 2390);
    // The length of the track is within centimetres of the driven distance.
    for row in map {
        assert!(
            (row.grade_percent - hill_percent(row.distance_m)).abs() < 2e-3,
            "{row:?}"
        );
    }
}

#[test]
fn first_track_is_smoothed_against_position_noise() {
    let spots = hills();
    let noisy = run(&test_kit::roads::with_position_noise(&spots, 2.5, 60.0, 1));
    let track = road_of_run(&noisy).expect("a track");
    let length_m = track[track.len() - 1].distance_m;
    assert!((length_m / 6000.0 - 1.0).abs() < 0.005, "{length_m}");
}

/// Returns the place of the middle of a straight drive of 40 m that passes 10 m to the right of a
/// spot.
fn place_of_a_drive(
    network: &Network,
    spot: Spot,
    course_deg: f64,
    mirrored: bool,
) -> MatchedPlace {
    let course = course_deg.to_radians();
    let track: Vec<TrackPoint> = (-8..=8)
        .map(|step| {
            let along_m = 2.5 * f64::from(step);
            let spot = Spot {
                east_m: spot.east_m + 10.0 + along_m * course.sin(),
                north_m: spot.north_m + along_m * course.cos(),
                ..spot
            };
            let (latitude_deg, longitude_deg) = spot.latitude_longitude_deg();
            TrackPoint {
                odometer_m: 20.0 + along_m,
                position: Some(if mirrored {
                    (-latitude_deg, longitude_deg - 180.0)
                } else {
                    (latitude_deg, longitude_deg)
                }),
            }
        })
        .collect();
    match_track(network, &track)[8]
}

#[test]
fn a_position_lies_on_the_road_that_goes_the_same_way() {
    let spots = drive((0.0, 0.0), 1000.0, |_| 0.0, |_| 0.0);
    let network = Network::from(RoadLine::new(points(&spots)).expect("a road"));
    for course_deg in [0.0, 20.0, -40.0] {
        let place = place_of_a_drive(&network, spots[200], course_deg, false);
        let MatchedPlace::OnRoad { way: 0, distance_m } = place else {
            panic!("{course_deg}: {place:?}");
        };
        assert!((distance_m - 500.0).abs() < 0.01, "{distance_m}");
    }
    let place = |course_deg| place_of_a_drive(&network, spots[200], course_deg, false);
    assert_eq!(place(60.0), MatchedPlace::OffRoad);
    assert_eq!(place(120.0), MatchedPlace::OffRoad);
    assert_eq!(place(180.0), MatchedPlace::Opposite);
    // A position alone has no course. It is on the road if it is within 25 m.
    let alone = |east_m: f64| {
        let spot = Spot {
            east_m,
            ..spots[200]
        };
        let position = TrackPoint {
            odometer_m: 0.0,
            position: Some(spot.latitude_longitude_deg()),
        };
        match_track(&network, &[position])[0]
    };
    for east_m in [-24.9, -10.0, 10.0, 24.9] {
        assert!(
            matches!(alone(east_m), MatchedPlace::OnRoad { .. }),
            "{east_m}"
        );
    }
    for east_m in [-25.1, 25.1] {
        assert_eq!(alone(east_m), MatchedPlace::OffRoad, "{east_m}");
    }
    // A position on the other side of the Earth is on no road.
    let mirrored = place_of_a_drive(&network, spots[200], 0.0, true);
    assert_eq!(mirrored, MatchedPlace::OffRoad);
}

#[test]
fn impossible_roads_are_refused() {
    let good = points(&hills());
    assert!(RoadLine::new(good[..1].to_vec()).is_err());
    let mut stuck = good.clone();
    stuck[5].distance_m = stuck[4].distance_m;
    assert!(RoadLine::new(stuck).is_err());
    let mut far = good.clone();
    far[5].latitude_deg = -30.0;
    assert!(RoadLine::new(far).is_err());
    let mut nan = good;
    nan[5].longitude_deg = f64::NAN;
    assert!(RoadLine::new(nan).is_err());
}
