//! An electric car's table: torque in Nm through a single reduction, without gear and engine speed.

use test_kit::command::{folder, program};
use test_kit::electric_car::{VEHICLE, slope, table};
use test_kit::tables::columns;

#[test]
fn an_electric_car_needs_no_gear_and_has_no_column_that_is_not_ours() {
    let folder = folder();
    std::fs::write(folder.path().join("car.toml"), VEHICLE).unwrap();
    std::fs::write(folder.path().join("car.csv"), table()).unwrap();
    let run = program()
        .current_dir(folder.path())
        .args([
            "estimate",
            "--vehicle",
            "car.toml",
            "--out",
            "run.csv",
            "car.csv",
        ])
        .assert()
        .success();
    let words = String::from_utf8(run.get_output().stderr.clone()).unwrap();
    assert!(!words.contains("ignored"), "{words}");
    let run = columns(&folder.path().join("run.csv"));
    let [distances_m, grades, valid] = ["distance_m", "grade_percent", "valid"].map(|name| {
        let numbers = run[name].iter().map(|text| text.parse().unwrap());
        numbers.collect::<Vec<f64>>()
    });
    assert!(distances_m.len() > 4_000);
    assert!(valid.iter().all(|valid| *valid == 1.0));
    let inner = 400..distances_m.len() - 400;
    let squares = inner.clone().map(|cell| {
        let truth = 100.0 * slope(distances_m[cell] - 1.25);
        (grades[cell] - truth).powi(2)
    });
    let rmse = (squares.sum::<f64>() / inner.len() as f64).sqrt();
    assert!(rmse < 0.1, "{rmse} %");
}
