//! A truck reverses to a dock, and drives on.

use crate::faulty_drive::{edited, judged, reported, simulated};
use estimator_core::Signal;

const STOP: &str = "[[runs.stops]]\nat_m = 8000.0\nseconds = 20.0\n";

#[test]
fn reversing_leaves_no_cells_and_spoils_nothing() {
    for truck in ["A", "B"] {
        let plain = simulated(truck, 4, 20, "", STOP);
        let without = judged(&plain, &reported(&plain), 8_000.0);
        let run = simulated(truck, 4, 20, "", &format!("{STOP}reverse_m = 60.0\n"));
        let told = reported(&run);
        // Without any gear on the bus, the course over ground shows it.
        let untold: Vec<_> = told
            .iter()
            .filter(|reading| {
                let gears = [Signal::CurrentGear, Signal::SelectedGear];
                !gears.contains(&reading.1)
            })
            .copied()
            .collect();
        for (what, reported) in [("told", told), ("untold", untold)] {
            let found = judged(&run, &reported, 8_000.0);
            let what = format!("{truck}, {what}");
            assert_eq!(found.counters.reversals, 1, "{what}");
            found.keeps_the_rule(&what);
            found.is_hardly_worse_than(&without, &what);
            // No cell ends while it reverses: in the truth, distance stands still there.
            let still = run.truth.windows(2);
            let still: Vec<f64> = still
                .filter(|pair| pair[1].distance_m <= pair[0].distance_m)
                .map(|pair| pair[0].time_s)
                .collect();
            let (from_s, to_s) = (still[0], still[still.len() - 1]);
            assert!(to_s - from_s > 50.0, "{from_s} to {to_s} s");
            let cells = found.rows.iter();
            let within = cells.filter(|row| (from_s + 4.0..to_s).contains(&row.time_s));
            assert!(within.count() <= 1, "{what}");
            // The way back and forth is no way.
            let driven_m = found.rows.last().unwrap().distance_m;
            let true_m = run.truth.last().unwrap().distance_m;
            assert!(
                (driven_m - true_m).abs() < 0.01 * true_m,
                "{what}: {driven_m} m, {true_m} m"
            );
        }
    }
}

#[test]
fn a_gear_that_only_seems_to_be_reverse_is_one_brief_gap() {
    // A single wrong frame at speed.
    let run = simulated("A", 4, 8, "", "");
    let mut wrong = 0;
    let reported = edited(&reported(&run), Signal::CurrentGear, |seconds, gear| {
        let is_wrong = wrong == 0 && seconds > 200.0;
        wrong += u32::from(is_wrong);
        Some(if is_wrong { -1.0 } else { gear })
    });
    assert_eq!(wrong, 1);
    let found = judged(&run, &reported, 4_000.0);
    found.keeps_the_rule("one wrong frame");
    let driven_m = found.rows.last().unwrap().distance_m;
    let true_m = run.truth.last().unwrap().distance_m;
    assert!((driven_m - true_m).abs() < 80.0, "{driven_m} m, {true_m} m");
}
