//! The points that a chart draws: gaps, extremes, axes.

use host_sim::report::chart_data::chart;
use host_sim::report::plot::{Mark, Plot, Series, colour};
use host_sim::report::profile::ProfilePoint;
use host_sim::report::thin::{Points, runs, thinned};
use serde_json::{Value, json};

#[test]
fn extremes_and_gaps_stay() {
    let wave = |i: usize| if i == 500 { 9.0 } else { (i % 7) as f64 };
    let mut points: Vec<(f64, f64)> = (0..1000).map(|i| (i as f64, wave(i))).collect();
    points[300].1 = f64::NAN;
    let lower: Vec<f64> = points.iter().map(|p| p.1 - 1.0).collect();
    let line = thinned(
        &Points {
            points: points.clone(),
            lower: Vec::new(),
        },
        100,
    );
    assert!(line.points.len() <= 110, "{}", line.points.len());
    assert!(line.points.contains(&(500.0, 9.0)));
    assert_eq!(runs(&line.points).len(), 2);
    assert!(line.points.windows(2).all(|pair| pair[0].0 <= pair[1].0));
    let band = thinned(&Points { points, lower }, 100);
    assert_eq!(band.points.len(), band.lower.len());
    assert!(band.lower.contains(&-1.0) && band.points.iter().any(|p| p.1 == 9.0));
}

#[test]
fn short_series_stay_as_they_are() {
    let series = Points {
        points: vec![(0.0, 1.0), (1.0, f64::NAN)],
        lower: Vec::new(),
    };
    let same = thinned(&series, 2);
    assert_eq!(same.points[0], (0.0, 1.0));
    assert!(same.points[1].1.is_nan());
}

#[test]
fn gaps_of_the_road_are_gaps_of_the_curve() {
    let at = |distance_m| ProfilePoint {
        distance_m,
        value: 1.0,
        sigma: Some(0.1),
    };
    let points = [0.0, 2.5, 5.0, 50.0, 52.5].map(at);
    let plot = Plot::profile("grade (%)", "road").with_profile("map", colour::BLUE, points);
    let [band, line] = &plot.series[..] else {
        panic!("{plot:?}");
    };
    assert_eq!((line.points.len(), band.points.len()), (6, 6));
    assert!(line.points[3].1.is_nan() && band.points[3].1.is_nan());
    assert_eq!(line.points[4], (0.05, 1.0));
    assert!(!plot.to_csv().contains("NaN"));
}

#[test]
fn equal_axes_are_shared_and_gaps_are_null() {
    let y = |x: f64| if x == 1.0 { f64::NAN } else { 1.0 / 3.0 };
    let points = [0.0, 1.0, 2.0].map(|x| (x, y(x)));
    let plot = Plot::new("x", "</script>")
        .with(Series::line("a", colour::BLUE, points))
        .with(Series::line("b", colour::BLACK, points));
    let drawn = chart(&plot, 100);
    assert!(!drawn.json.contains('<') && drawn.words.is_empty());
    let value: Value = serde_json::from_str(&drawn.json).unwrap();
    assert_eq!(value["axes"].as_array().unwrap().len(), 1);
    assert_eq!(value["series"][1]["y"], json!([0.333_333, null, 0.333_333]));
    assert_eq!(value["y"], "</script>");
}

#[test]
fn dots_at_the_same_place_stay_apart() {
    let dots = [(2.0, 1.0), (1.0, 2.0), (2.0, 3.0)];
    let series = Series::line("", colour::BLUE, dots).drawn(Mark::Dots);
    let drawn = chart(&Plot::new("x", "y").with(series), 100);
    let value: Value = serde_json::from_str(&drawn.json).unwrap();
    let x: Vec<f64> = serde_json::from_value(value["axes"][0].clone()).unwrap();
    assert!(
        x[0] == 1.0 && x[1] == 2.0 && x[2] > 2.0 && x[2] < 2.0001,
        "{x:?}"
    );
}
