//! Stops: which masses count, and what a stop resets.

use estimator_core::estimator::CellEstimator;
use estimator_core::sample::Sample;
use estimator_core::{Context, Estimate, Signal, Tuning};
use test_kit::readings_drive::ReadingsDrive;
use test_kit::{altitude, by_force, sample, speed, truck};

fn at(mps: f32, mass_kg: Option<f32>) -> Vec<(Signal, f32)> {
    let mass = mass_kg.map(|kg| (Signal::Mass, kg));
    let force = (Signal::TractionForce, 4_000.0);
    let speed = (Signal::WheelSpeed, mps);
    mass.into_iter().chain([force, speed]).collect()
}

fn masses(samples: &[Sample]) -> Vec<f32> {
    let mut masses: Vec<f32> = samples.iter().map(|sample| sample.forces.mass_kg).collect();
    masses.dedup();
    masses
}

fn reopenings(drive: &ReadingsDrive) -> usize {
    drive
        .samples
        .iter()
        .filter(|sample| sample.after_load_change)
        .count()
}

#[test]
fn the_first_mass_counts_and_its_changes_while_driving_do_not() {
    let mut drive = ReadingsDrive::of(by_force());
    assert_eq!(masses(&drive.on(5.0, &at(20.0, None))), [39_000.0]);
    assert_eq!(
        masses(&drive.on(5.0, &at(20.0, Some(40_000.0)))),
        [40_000.0]
    );
    let changed = drive.on(5.0, &at(20.0, Some(40_400.0)));
    assert_eq!(masses(&changed), [40_000.0]);
    // A stop of two seconds is a traffic light; one of ten may be a ramp.
    drive.on(2.0, &at(0.0, Some(40_400.0)));
    assert_eq!(masses(&drive.on(2.0, &at(20.0, None))), [40_000.0]);
    drive.on(10.0, &at(0.0, Some(40_400.0)));
    assert_eq!(masses(&drive.on(2.0, &at(20.0, None))), [40_400.0]);
    assert_eq!(
        reopenings(&drive),
        0,
        "one percent is within the error of weighing"
    );
}

#[test]
fn another_load_at_a_stop_reopens_once_whenever_it_is_reported() {
    // While it stands, just after, and first reported long after.
    for (standing, soon) in [
        (Some(20_000.0), Some(20_000.0)),
        (Some(39_000.0), Some(20_000.0)),
        (None, None),
    ] {
        let mut drive = ReadingsDrive::of(by_force());
        drive.on(20.0, &at(20.0, Some(39_000.0)));
        drive.on(10.0, &at(0.0, standing));
        drive.on(50.0, &at(20.0, soon));
        drive.on(1.0, &at(20.0, Some(20_000.0)));
        let after = drive.on(20.0, &at(20.0, Some(20_400.0)));
        assert_eq!(masses(&after), [20_000.0]);
        assert_eq!(reopenings(&drive), 1);
    }
}

#[test]
fn masses_that_no_such_vehicle_has_are_rejected() {
    let mut drive = ReadingsDrive::of(by_force());
    for kg in [0.0, 3_000.0, 640_000.0, f32::NAN] {
        assert_eq!(masses(&drive.on(5.0, &at(20.0, Some(kg)))), [39_000.0]);
        drive.on(10.0, &at(0.0, Some(kg)));
    }
    assert_eq!(reopenings(&drive), 0);
}

#[test]
fn a_long_standstill_reopens_whether_awake_or_asleep() {
    let stop = |minutes: u64, awake: bool| {
        let mut drive = ReadingsDrive::of(by_force());
        drive.on(20.0, &at(20.0, None));
        drive.on(5.0, &at(0.0, None));
        if awake {
            drive.on(60.0 * minutes as f64, &at(0.0, None));
        } else {
            drive.now_ms += 60_000 * minutes;
        }
        drive.on(5.0, &at(0.0, None));
        let after = drive.on(20.0, &at(20.0, None));
        assert_eq!(reopenings(&drive), usize::from(after[0].after_load_change));
        after[0].after_load_change
    };
    for awake in [true, false] {
        assert!(!stop(9, awake));
        assert!(stop(10, awake));
    }
    assert!(stop(16 * 60, false));
}

#[test]
fn a_log_that_continues_the_next_day_reopens() {
    let mut drive = ReadingsDrive::of(by_force());
    drive.on(20.0, &at(20.0, None));
    drive.now_ms += 12 * 3_600_000;
    let after = drive.on(20.0, &at(20.0, None));
    assert!(after[0].after_load_change && after[0].gap_cells > 0);
    assert_eq!(reopenings(&drive), 1);
}

#[test]
fn a_cell_in_which_the_vehicle_stood_long_is_measured_where_it_is() {
    let mut drive = ReadingsDrive::of(by_force());
    drive.on(20.0, &at(2.0, None));
    // 1.3 m into a cell.
    drive.on(300.0, &at(0.0, None));
    let after = drive.on(5.0, &at(2.0, None));
    let speed = after[0].speed.unwrap();
    assert!((0.0..2.5).contains(&speed.behind_m), "{speed:?}");
    assert!((0.0..=2.0).contains(&speed.mean_mps), "{speed:?}");
    assert!(after[0].duration_s > 300.0);
}

#[test]
fn a_cell_counts_no_more_speeds_than_its_counter_holds() {
    let mut drive = ReadingsDrive::of(by_force());
    drive.on(10.0, &at(2.0, None));
    // 5 cm/s: fifty seconds a cell, with five hundred readings.
    let crept = drive.on(200.0, &at(0.05, None));
    assert!((3..=5).contains(&crept.len()), "{}", crept.len());
    for sample in &crept[1..] {
        let speed = sample.speed.unwrap();
        assert_eq!(speed.count, u8::MAX);
        assert!((speed.mean_mps - 0.05).abs() < 1e-3, "{speed:?}");
    }
}

/// Drives hills of 2 % and 2 km at a steady speed; `change` is applied to each sample. Returns the live
/// estimate at the end, and after how many stops the load was opened.
fn hills(change: impl Fn(u16, &mut Sample)) -> (Estimate, u32) {
    let mut context = Context::new(truck(), Tuning::default()).unwrap();
    let mut estimator = Box::new(CellEstimator::<f64>::new());
    let mut live = None;
    for cell in 0..11_990_u16 {
        let angle = f32::from(cell) * (2.5 / 2_000.0 * core::f32::consts::TAU);
        let force_n = 3_926.0 + 39_000.0 * 9.806_65 * 0.02 * angle.sin();
        let mut sample = sample(cell.into(), force_n, 20.0);
        sample.speed = speed(20.0);
        if cell % 8 == 0 {
            sample.altitude = altitude(100.0 - 6.366 * angle.cos());
        }
        change(cell, &mut sample);
        estimator.push_and_work(&mut context, &sample);
        live = estimator.live(&context, &sample);
    }
    (live.unwrap().estimate, context.counters.loads_reopened)
}

/// Makes a sample the first one behind a stop, at walking speed.
fn launched(sample: &mut Sample) {
    sample.after_stop = true;
    sample.end.condition.crawling = true;
    sample.end.condition.shifting = true;
}

#[test]
fn a_stop_opens_the_load_and_a_long_one_cools_the_tyres() {
    let (before, none) = hills(|_, _| ());
    let at_end = |is_long: bool| {
        hills(|cell, sample| {
            if cell == 11_988 {
                sample.after_load_change = is_long;
                launched(sample);
            }
        })
    };
    let ((short, once), (long, _)) = (at_end(false), at_end(true));
    assert_eq!((none, once), (0, 1));
    assert!(
        before.scale.sigma < 0.03 && before.bias_percent.sigma < 0.2,
        "{before:?}"
    );
    for after in [short, long] {
        assert!(after.scale.sigma > 0.45, "{after:?}");
        assert!(
            (after.scale.value - before.scale.value).abs() < 0.02,
            "{after:?}"
        );
    }
    assert!(short.bias_percent.sigma < 0.25, "{short:?}");
    assert!(long.bias_percent.sigma > 0.3, "{long:?}");
}

#[test]
fn a_load_that_did_not_change_is_known_again_within_a_kilometre() {
    let (never, _) = hills(|_, _| ());
    let (after, once) = hills(|cell, sample| {
        if cell == 11_599 {
            launched(sample);
        }
    });
    assert_eq!(once, 1);
    assert!(after.scale.sigma < 0.12, "{after:?}");
    assert!(
        (after.scale.value - never.scale.value).abs() < 0.03,
        "{never:?} {after:?}"
    );
}
