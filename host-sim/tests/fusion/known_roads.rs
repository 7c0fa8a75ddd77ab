//! Runs over known roads become the expected map.

use host_sim::files::run::{self, RunRow};
use host_sim::map::{GradeMap, MapRow, Network, RoadLine, read_map, road_of_run, write_map};
use host_sim::score::score_map_on_road;
use test_kit::roads::{
    Spot, alone, drive, fuse, hill_percent, hills, moved, points, reversed, road, run,
};

fn line(spots: &[Spot]) -> Network {
    RoadLine::new(points(spots)).expect("a road").into()
}

fn map_of(road: &Network, runs: &[&[RunRow]]) -> Vec<MapRow> {
    fuse(road, runs).map.fused().rows()
}

fn worst_error(map: &[MapRow], truth: impl Fn(f64) -> f64) -> f64 {
    assert!(!map.is_empty());
    map.iter()
        .map(|row| (row.grade_percent - truth(row.distance_m)).abs())
        .fold(0.0, f64::max)
}

#[test]
fn perfect_runs_give_the_grade_of_the_road() {
    let spots = hills();
    let (a, b) = (run(&spots), run(&spots));
    let map = map_of(&line(&spots), &[&a, &b]);
    assert!(map.len() >= spots.len() - 2, "{} cells", map.len());
    assert!(worst_error(&map, hill_percent) < 1e-4);
    assert!(map.iter().all(|row| row.runs == 2));
    for row in &map {
        // Two runs of 0.1 %: the sigma is below that of either, but above that of independent runs.
        assert!((0.0708..0.08).contains(&row.grade_sigma_percent), "{row:?}");
        let altitude_m = spots[(row.distance_m / 2.5).round() as usize].altitude_m;
        assert!((row.altitude_m.expect("known") - altitude_m).abs() < 0.01);
    }
}

#[test]
fn order_of_runs_does_not_matter() {
    let spots = hills();
    let runs: Vec<Vec<RunRow>> = (0..4)
        .map(|seed| {
            let mut rows = run(&test_kit::roads::with_position_noise(
                &spots, 2.0, 80.0, seed,
            ));
            for row in &mut rows {
                row.grade_percent += 0.1 * (row.distance_m / (40.0 + seed as f64)).sin();
                row.grade_sigma_percent = 0.05 + 0.02 * seed as f64;
            }
            rows
        })
        .collect();
    let road_line = line(&spots);
    let forwards: Vec<&[RunRow]> = runs.iter().map(Vec::as_slice).collect();
    let backwards: Vec<&[RunRow]> = runs.iter().rev().map(Vec::as_slice).collect();
    let (a, b) = (
        map_of(&road_line, &forwards),
        map_of(&road_line, &backwards),
    );
    assert_eq!(a.len(), b.len());
    for (a, b) in a.iter().zip(&b) {
        assert!((a.grade_percent - b.grade_percent).abs() < 1e-12);
        assert!((a.grade_sigma_percent - b.grade_sigma_percent).abs() < 1e-12);
        assert_eq!((a.distance_m, a.runs), (b.distance_m, b.runs));
    }
    // Maps merge like runs.
    let (mut left, mut right) = (GradeMap::new(&road_line), GradeMap::new(&road_line));
    left.add_run(&alone(forwards[0]));
    left.add_run(&alone(forwards[3]));
    right.add_run(&alone(forwards[2]));
    right.add_run(&alone(forwards[1]));
    left.merge(&right);
    for (merged, a) in left.fused().rows().iter().zip(&a) {
        assert!((merged.grade_percent - a.grade_percent).abs() < 1e-12);
    }
}

#[test]
fn variances_are_the_weights() {
    let spots = hills();
    let shifted = |by_percent: f64, sigma_percent: f64| {
        let mut rows = run(&spots);
        for row in &mut rows {
            row.grade_percent += by_percent;
            row.grade_sigma_percent = sigma_percent;
        }
        rows
    };
    let road_line = line(&spots);
    let (sure, unsure) = (shifted(0.0, 0.001), shifted(5.0, 1.0));
    let map = map_of(&road_line, &[&unsure, &sure]);
    assert!(worst_error(&map, hill_percent) < 2e-4);

    let (a, b) = (shifted(0.3, 0.1), shifted(-0.6, 0.2));
    let fusion = fuse(&road_line, &[&a, &b]);
    // (0.3 * 100 - 0.6 * 25) / 125
    assert!(worst_error(&fusion.map.fused().rows(), |s| hill_percent(s) + 0.12) < 1e-4);
    // (0.3 - 0.12)² / 0.1² + (-0.6 - 0.12)² / 0.2², one degree of freedom
    let between = fusion.map.fused().between;
    let ratio = between.disagreement.ratio().expect("two runs");
    assert!((ratio - 16.2).abs() < 1e-3, "{ratio}");
}

#[test]
fn the_other_direction_is_rejected() {
    let spots = hills();
    let back = run(&reversed(&spots));
    let forth = run(&spots);
    let road_line = line(&spots);
    let fusion = fuse(&road_line, &[&back, &forth]);
    let coverage = fusion.coverage[0];
    assert_eq!(coverage.matched, 0);
    assert!(coverage.opposite >= coverage.cells - 2, "{coverage:?}");
    assert!(fusion.map.fused().rows().iter().all(|row| row.runs == 1));
    // The other carriageway, 12 m beside.
    let beside = run(&moved(&reversed(&spots), -8.0, 9.0));
    assert_eq!(fuse(&road_line, &[&beside]).coverage[0].matched, 0);
}

#[test]
fn crossing_and_parallel_roads_are_not_the_road() {
    let spots = hills();
    let middle = spots[spots.len() / 2];
    let ahead = spots[spots.len() / 2 + 4];
    let course = (ahead.east_m - middle.east_m)
        .atan2(ahead.north_m - middle.north_m)
        .to_degrees();
    let road_line = line(&spots);
    for turn in [25.0, 60.0, 90.0, -120.0] {
        let away = (course + turn + 180.0).to_radians();
        let start = (
            middle.east_m + 400.0 * away.sin(),
            middle.north_m + 400.0 * away.cos(),
        );
        let crossing = run(&drive(start, 800.0, |_| course + turn, |_| 8.0));
        let coverage = fuse(&road_line, &[&crossing]).coverage[0];
        assert_eq!(coverage.matched, 0, "{turn}: {coverage:?}");
    }
    let parallel = run(&moved(&spots, -35.0, 35.0));
    let coverage = fuse(&road_line, &[&parallel]).coverage[0];
    // Where the road bends towards the shift, the parallel is nearer than 50 m, but not 25.
    assert_eq!(coverage.matched, 0, "{coverage:?}");
}

#[test]
fn a_detour_adds_nothing_and_the_rest_counts() {
    let road_spots = drive((0.0, 0.0), 6000.0, |_| 90.0, hill_percent);
    // Off at 2 km on a half circle of 300 m radius, back on at 2.6 km.
    let bow_m = 300.0 * std::f64::consts::PI;
    let rows = run(&drive(
        (0.0, 0.0),
        6000.0,
        |s| match s - 2000.0 {
            d if d < 0.0 || d > bow_m => 90.0,
            d => d / 300.0 * 180.0 / std::f64::consts::PI,
        },
        |s| if s < 2000.0 { 1.0 } else { 2.0 },
    ));
    let road_line = line(&road_spots);
    let fusion = fuse(&road_line, &[&rows]);
    let map = fusion.map.fused().rows();
    assert!(
        map.iter()
            .all(|row| row.distance_m < 2050.0 || row.distance_m > 2550.0)
    );
    assert!(map.iter().filter(|row| row.distance_m > 2650.0).count() > 1000);
    for row in map {
        let driven_percent = if row.distance_m < 2300.0 { 1.0 } else { 2.0 };
        if (row.distance_m - 2000.0).abs() > 60.0 {
            assert!((row.grade_percent - driven_percent).abs() < 1e-6, "{row:?}");
        }
    }
    assert!(fusion.coverage[0].off_road > 200);
}

#[test]
fn a_wrong_odometer_does_not_smear_the_map() {
    let spots = hills();
    for scale in [0.99, 1.01] {
        let mut rows = run(&spots);
        for row in &mut rows {
            row.distance_m *= scale;
        }
        let map = map_of(&line(&spots), &[&rows]);
        // The hills change by 0.01 % a metre: 60 m of odometer error would show as 0.6 %.
        assert!(worst_error(&map, hill_percent) < 1e-3);
        assert!(map.len() > 2390);
    }
}

#[test]
fn position_noise_shifts_the_grade_by_little_and_smoothly() {
    let spots = hills();
    let noisy = run(&test_kit::roads::with_position_noise(&spots, 3.0, 20.0, 7));
    let map = map_of(&line(&spots), &[&noisy]);
    let rms = (map
        .iter()
        .map(|row| (row.grade_percent - hill_percent(row.distance_m)).powi(2))
        .sum::<f64>()
        / map.len() as f64)
        .sqrt();
    // Unsmoothed, 3 m on slopes of up to 0.01 % a metre would be 0.021 % RMS.
    assert!(rms < 0.012, "{rms}");
    let jump = map
        .windows(2)
        .map(|pair| {
            let change = |s: f64| pair[1].grade_percent - pair[0].grade_percent - s;
            change(hill_percent(pair[1].distance_m) - hill_percent(pair[0].distance_m)).abs()
        })
        .fold(0.0, f64::max);
    assert!(jump < 0.003, "{jump}");
}

#[test]
fn a_run_may_begin_before_the_road_and_end_behind_it() {
    let spots = hills();
    let rows = run(&spots);
    let map = map_of(&line(&spots[40..2300]), &[&rows]);
    assert_eq!(map.len(), 2260);
    assert!(worst_error(&map, hill_percent) < 1e-4);
}

#[test]
fn missing_positions_are_bridged_by_the_odometer() {
    let spots = hills();
    let mut rows = run(&spots);
    for (i, row) in rows.iter_mut().enumerate() {
        // The first 250 m, and a tunnel of 500 m.
        if i < 100 || (1000..1200).contains(&i) {
            row.latitude_deg = None;
            row.longitude_deg = None;
        }
        row.distance_m *= 1.01;
    }
    let road_line = line(&spots);
    let fusion = fuse(&road_line, &[&rows]);
    let coverage = fusion.coverage[0];
    assert_eq!(coverage.no_position, 100);
    assert!(coverage.matched > 2290, "{coverage:?}");
    let map = fusion.map.fused().rows();
    assert!(map[0].distance_m >= 250.0);
    assert!(
        map.windows(2)
            .all(|pair| pair[1].distance_m - pair[0].distance_m < 2.6)
    );
    assert!(worst_error(&map, hill_percent) < 1e-3);

    // As the road itself, the tunnel is as long as the odometer says.
    let track = road_of_run(&rows).expect("a track");
    let driven_m = rows[1200].distance_m - rows[999].distance_m;
    let longest_m = track
        .windows(2)
        .map(|pair| pair[1].distance_m - pair[0].distance_m)
        .fold(0.0, f64::max);
    assert!(
        (longest_m - driven_m).abs() < 1e-6,
        "{longest_m} {driven_m}"
    );
}

#[test]
fn cells_that_no_run_covers_are_left_out() {
    let spots = hills();
    let rows = run(&spots);
    let map = map_of(&line(&spots), &[&rows[..800], &rows[1600..]]);
    assert!(
        map.iter()
            .all(|row| row.distance_m < 2001.0 || row.distance_m > 3999.0)
    );
    assert!(map.len() > 1590);
    // A map with a hole still serves as a road.
    assert!(RoadLine::new(map.iter().map(as_point).collect()).is_ok());
}

fn as_point(row: &MapRow) -> host_sim::map::RoadPoint {
    host_sim::map::RoadPoint {
        distance_m: row.distance_m,
        latitude_deg: row.latitude_deg,
        longitude_deg: row.longitude_deg,
    }
}

#[test]
fn there_and_back_on_one_street_are_two_parts_of_a_road() {
    // 2 km out, a turn of 10 m radius, 2 km back: 20 m beside the way out.
    let turn_m = 10.0 * std::f64::consts::PI;
    let course = |s: f64| match s - 2000.0 {
        d if d < 0.0 => 0.0,
        d if d > turn_m => 180.0,
        d => d / 10.0 * 180.0 / std::f64::consts::PI,
    };
    let grade = |s: f64| if s < 2000.0 { 2.0 } else { -2.0 };
    let spots = drive((0.0, 0.0), 4000.0, course, grade);
    let noisy = run(&test_kit::roads::with_position_noise(&spots, 2.0, 50.0, 3));
    let road_line = line(&spots);
    let fusion = fuse(&road_line, &[&noisy]);
    assert!(fusion.coverage[0].matched > 1580, "{:?}", fusion.coverage);
    for row in fusion.map.fused().rows() {
        if (row.distance_m - 2015.0).abs() > 30.0 {
            assert!(
                (row.grade_percent - grade(row.distance_m)).abs() < 1e-6,
                "{row:?}"
            );
        }
    }
}

#[test]
fn laps_in_the_same_direction_are_kept_apart() {
    // Three laps of a circle of 2 km, distinguished by their grade.
    let spots = drive(
        (0.0, 0.0),
        6000.0,
        |s| s / 2000.0 * 360.0,
        |s| (s / 2000.0).floor(),
    );
    let road_line = line(&spots);
    let three = run(&test_kit::roads::with_position_noise(&spots, 2.0, 50.0, 4));
    let fusion = fuse(&road_line, &[&three]);
    assert!(fusion.coverage[0].matched > 2390, "{:?}", fusion.coverage);
    for row in fusion.map.fused().rows() {
        assert_eq!(row.runs, 1);
        // Near the end of a lap the grade steps.
        if (20.0..1980.0).contains(&row.distance_m.rem_euclid(2000.0)) {
            let lap = (row.distance_m / 2000.0).floor();
            assert!((row.grade_percent - lap).abs() < 1e-9, "{row:?}");
        }
    }
}

#[test]
fn roads_far_from_their_middle_are_still_exact() {
    // 100 km due east: the plane's origin is 50 km away at the ends.
    let spots = drive((-50e3, 0.0), 100e3, |_| 90.0, hill_percent);
    let rows = run(&spots);
    let map = map_of(&line(&spots), &[&rows]);
    assert!(map.len() > 39_990);
    assert!(worst_error(&map, hill_percent) < 1e-4);
}

#[test]
fn a_map_scores_against_a_reference_by_position() {
    let spots = hills();
    let mut rows = run(&spots);
    for row in &mut rows {
        row.grade_percent += 0.05;
    }
    // The map counts from the first run's start, 1 km into the reference.
    let track = road_of_run(&rows[400..]).expect("a track");
    let own = RoadLine::new(track).expect("a road").into();
    let map = map_of(&own, &[&rows[400..]]);
    let score = score_map_on_road(&map, &road(&spots)).expect("scored");
    assert!((score.bias_percent - 0.05).abs() < 1e-3, "{score:?}");
    assert!((score.rmse_percent - 0.05).abs() < 1e-3, "{score:?}");
    assert!((score.nees - 0.25).abs() < 0.01, "{score:?}");
}

#[test]
fn map_files_read_back() {
    let folder = tempfile::tempdir().expect("a folder");
    let spots = hills();
    let rows = run(&spots);
    let mut map = map_of(&line(&spots), &[&rows]);
    map[3].altitude_m = None;
    let path = folder.path().join("map.csv");
    write_map(&path, &map).expect("written");
    let back = read_map(&path).expect("read");
    assert_eq!(back.len(), map.len());
    assert_eq!(back[3].altitude_m, None);
    assert!((back[9].grade_percent - map[9].grade_percent).abs() < 1e-5);
    let header = std::fs::read_to_string(&path).expect("text");
    assert!(header.starts_with(
        "distance_m,latitude_deg,longitude_deg,altitude_m,grade_percent,grade_sigma_percent,runs\n"
    ));
    run::write(&folder.path().join("run.csv"), &rows).expect("written");
    assert!(read_map(&folder.path().join("run.csv")).is_err());
}
