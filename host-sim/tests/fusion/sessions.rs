//! The common error of runs of one session. It is learned from the differences of the runs, and it
//! increases the sigma of the map.

use host_sim::files::run::RunRow;
use host_sim::map::{GradeMap, MapRow, Network, RoadLine, SessionRun, fuse};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use test_kit::roads::{Spot, alone, drive, hill_percent, points, run};

/// Returns a drive of 40 km straight east.
fn long_road() -> Vec<Spot> {
    drive((-20e3, 0.0), 40e3, |_| 90.0, hill_percent)
}

/// Returns white noise for each cell.
fn noise(seed: u64, cells: usize) -> Vec<f64> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    StandardNormal.sample_iter(&mut rng).take(cells).collect()
}

/// Returns a run with these grade errors, which states this sigma.
fn off_by(spots: &[Spot], error_percent: impl Fn(usize) -> f64, sigma_percent: f64) -> Vec<RunRow> {
    let mut rows = run(spots);
    for (i, row) in rows.iter_mut().enumerate() {
        row.grade_percent += error_percent(i);
        row.grade_sigma_percent = sigma_percent;
    }
    rows
}

/// Returns runs of true sigma 0.1 %, of which a share is common. They state `stated` times as much.
fn sharing(spots: &[Spot], count: u64, share: f64, stated: f64, seed: u64) -> Vec<Vec<RunRow>> {
    let common = noise(1000 * seed, spots.len());
    (1..=count)
        .map(|number| {
            let own = noise(1000 * seed + number, spots.len());
            let error = |i: usize| 0.1 * (share.sqrt() * common[i] + (1.0 - share).sqrt() * own[i]);
            off_by(spots, error, 0.1 * stated)
        })
        .collect()
}

fn session<'a>(name: &'a str, runs: &'a [Vec<RunRow>]) -> Vec<SessionRun<'a>> {
    let of = |rows| SessionRun {
        session: Some(name),
        rows,
    };
    runs.iter().map(|rows| of(rows.as_slice())).collect()
}

fn line(spots: &[Spot]) -> Network {
    RoadLine::new(points(spots)).expect("a road").into()
}

/// Returns the mean squared error over the stated variance.
fn nees(map: &[MapRow]) -> f64 {
    assert!(map.len() > 1000);
    let squares = map.iter().map(|row| {
        ((row.grade_percent - hill_percent(row.distance_m)) / row.grade_sigma_percent).powi(2)
    });
    squares.sum::<f64>() / map.len() as f64
}

#[test]
fn a_session_of_one_run_is_that_run() {
    let spots = long_road();
    let road = line(&spots);
    let rows = off_by(&spots, |_| 0.0, 0.07);
    for session in [None, Some("x")] {
        let fused = fuse(
            &road,
            &[SessionRun {
                session,
                rows: &rows,
            }],
        )
        .map
        .fused();
        for row in &fused.rows() {
            // Besides, a place that is wrong by metres costs up to 0.016 % on these hills.
            let sigma_percent = row.grade_sigma_percent;
            assert!((0.07 - 1e-12..0.072).contains(&sigma_percent), "{row:?}");
        }
        assert_eq!(fused.between.disagreement.ratio(), None);
    }
}

#[test]
fn the_share_is_learned_and_enters_the_sigma_of_the_map() {
    let spots = long_road();
    let road = line(&spots);
    for (share, count) in [(0.2, 3), (0.3, 5), (0.3, 12)] {
        let runs = sharing(&spots, count, share, 1.0, 7);
        let fused = fuse(&road, &session("day", &runs)).map.fused();
        let (name, within) = &fused.within[0];
        assert_eq!(name, "day");
        // The prior still has a small weight.
        let learned = within.dependence.share;
        assert!((learned - share).abs() < 0.02, "{share}: {learned}");
        assert!(within.dependence.inflation < 1.01);
        let honest = 0.1 * (share + (1.0 - share) / count as f64).sqrt();
        for row in &fused.rows() {
            // White noise reads as changes of the grade, which an error of the place multiplies.
            assert!((row.grade_sigma_percent / honest - 1.0).abs() < 0.12);
        }
        let nees = nees(&fused.rows());
        assert!((0.9..1.1).contains(&nees), "{share} of {count}: {nees}");
        // With independent runs assumed, the sigma of the map would be far too small.
        let claimed = nees * (honest / 0.1).powi(2) * count as f64;
        assert!(claimed > 1.3, "{claimed}");
    }
}

#[test]
fn sigmas_that_are_too_small_are_detected() {
    let spots = long_road();
    let road = line(&spots);
    let runs = sharing(&spots, 4, 0.15, 0.5, 11);
    let fused = fuse(&road, &session("day", &runs)).map.fused();
    let inflation = fused.within[0].1.dependence.inflation;
    assert!((3.3..4.3).contains(&inflation), "{inflation}");
    let nees_of_session = nees(&fused.rows());
    assert!((0.8..1.3).contains(&nees_of_session), "{nees_of_session}");
    // Without the session's name, each run is a session of its own.
    let unnamed: Vec<SessionRun> = runs.iter().map(|rows| alone(rows)).collect();
    let fused = fuse(&road, &unnamed).map.fused();
    assert!(fused.between.dependence.inflation > 3.0);
    let nees = nees(&fused.rows());
    assert!((0.8..1.5).contains(&nees), "{nees}");
}

#[test]
fn sigmas_that_are_too_large_are_read_as_a_share_and_stay_safe() {
    let spots = long_road();
    let road = line(&spots);
    let runs = sharing(&spots, 5, 0.2, 1.5, 13);
    let fused = fuse(&road, &session("day", &runs)).map.fused();
    let dependence = fused.within[0].1.dependence;
    // The share is the usual one, though the runs agree better than that.
    assert!((0.3..=0.4).contains(&dependence.share), "{dependence:?}");
    assert!((dependence.inflation - 1.0).abs() < 1e-12);
    let nees = nees(&fused.rows());
    assert!((0.2..1.0).contains(&nees), "{nees}");
}

#[test]
fn a_poor_run_does_not_make_the_map_worse() {
    let spots = long_road();
    let road = line(&spots);
    let good = sharing(&spots, 3, 0.2, 1.0, 17);
    let far_off = noise(18, spots.len());
    let poor = off_by(&spots, |i| 3.0 * far_off[i], 3.0);
    let mut runs = session("day", &good);
    let before = fuse(&road, &runs).map.fused().rows();
    runs.push(SessionRun {
        session: Some("day"),
        rows: &poor,
    });
    let beside = fuse(&road, &runs).map.fused().rows();
    runs[3].session = None;
    let apart = fuse(&road, &runs).map.fused().rows();
    for after in [beside, apart] {
        for (before, after) in before.iter().zip(&after) {
            assert!(after.grade_sigma_percent < 1.02 * before.grade_sigma_percent);
            assert!((after.grade_percent - before.grade_percent).abs() < 0.02);
        }
    }
}

#[test]
fn many_runs_of_one_session_do_not_outvote_another() {
    let spots = long_road();
    let road = line(&spots);
    // Twelve runs with the same error of +0.1 %, and one with -0.1 %.
    let common = |sign: f64, seed: u64| {
        let own = noise(seed, spots.len());
        off_by(&spots, move |i| sign * 0.1 + 0.05 * own[i], 0.1)
    };
    let many: Vec<Vec<RunRow>> = (0..12).map(|seed| common(1.0, seed)).collect();
    let one = [common(-1.0, 99)];
    let mut runs = session("many", &many);
    runs.extend(session("one", &one));
    let bias = |runs: &[SessionRun]| {
        let rows = fuse(&road, runs).map.fused().rows();
        let sum: f64 = rows
            .iter()
            .map(|row| row.grade_percent - hill_percent(row.distance_m))
            .sum();
        sum / rows.len() as f64
    };
    let reported = bias(&runs);
    for run in &mut runs {
        run.session = None;
    }
    let untold = bias(&runs);
    // With equal weights the error would be +0.085.
    assert!((untold - 0.085).abs() < 0.005, "{untold}");
    assert!(reported < 0.05, "{reported}");
}

#[test]
fn the_order_of_merging_does_not_matter() {
    let spots = &long_road()[..6000];
    let road = line(spots);
    let (a, b) = (
        sharing(spots, 3, 0.3, 1.0, 19),
        sharing(spots, 2, 0.2, 0.7, 23),
    );
    let c = sharing(spots, 2, 0.1, 1.3, 29);
    let mut runs = session("a", &a);
    runs.extend(session("b", &b));
    runs.extend(c.iter().map(|rows| alone(rows)));
    let whole = fuse(&road, &runs).map.fused();

    // One by one, backwards.
    let mut single = GradeMap::new(&road);
    for run in runs.iter().rev() {
        single.add_run(run);
    }
    // Two maps, both with runs of both sessions.
    let (odd, even): (Vec<_>, Vec<_>) = runs.iter().enumerate().partition(|(i, _)| i % 2 == 1);
    let half = |part: Vec<(usize, &SessionRun)>| {
        fuse(
            &road,
            &part.iter().map(|(_, run)| **run).collect::<Vec<_>>(),
        )
        .map
    };
    let mut merged = half(odd);
    merged.merge(&half(even));
    for other in [single.fused(), merged.fused()] {
        assert_eq!(whole.rows().len(), other.rows().len());
        for (a, b) in whole.rows().iter().zip(&other.rows()) {
            let close = |a: f64, b: f64| (a - b).abs() <= 1e-12 * a.abs().max(1.0);
            assert!(close(a.grade_percent, b.grade_percent), "{a:?} {b:?}");
            let ratio = a.grade_sigma_percent / b.grade_sigma_percent;
            assert!((ratio - 1.0).abs() < 1e-12, "{a:?} {b:?}");
            assert_eq!((a.distance_m, a.runs), (b.distance_m, b.runs));
        }
        assert_eq!(other.within.len(), 2);
    }
}
