//! A road as a line: from points, from a run's own track, and where positions lie on it.

mod roads;

use host_sim::map::{Network, RoadLine, road_of_run};
use roads::{Spot, drive, fuse, hill_percent, hills, points, run};

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
    // The track's own ruler: within centimetres of the driven distance.
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
    let noisy = run(&roads::with_position_noise(&spots, 2.5, 60.0, 1));
    let track = road_of_run(&noisy).expect("a track");
    let length_m = track[track.len() - 1].distance_m;
    assert!((length_m / 6000.0 - 1.0).abs() < 0.005, "{length_m}");
}

#[test]
fn positions_are_located_with_offset_and_course() {
    let spots = drive((0.0, 0.0), 1000.0, |_| 0.0, |_| 0.0);
    let road_line = Network::from(RoadLine::new(points(&spots)).expect("a road"));
    let east_of_500 = Spot {
        east_m: 10.0,
        ..spots[200]
    };
    let (latitude_deg, longitude_deg) = east_of_500.latitude_longitude_deg();
    let located = road_line
        .locate(latitude_deg, longitude_deg, Some(20.0))
        .expect("on the road");
    assert!((located.distance_m - 500.0).abs() < 0.01);
    assert!((located.lateral_m + 10.0).abs() < 0.01, "right is negative");
    assert!((located.course_difference_deg.expect("known") - 20.0).abs() < 0.1);
    assert!(
        road_line
            .locate(latitude_deg, longitude_deg, Some(60.0))
            .is_none()
    );
    assert!(
        road_line
            .locate(latitude_deg, longitude_deg, Some(180.0))
            .is_none()
    );
    assert!(
        road_line
            .locate(latitude_deg, longitude_deg, None)
            .is_some()
    );
    // The other side of the Earth folds onto no road.
    assert!(
        road_line
            .locate(-latitude_deg, longitude_deg - 180.0, None)
            .is_none()
    );
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
