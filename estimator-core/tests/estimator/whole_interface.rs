//! Calls that a controller makes and a bench does not: creation in place, shares of work at the end of
//! a drive, a signal that is left out.

use core::mem::MaybeUninit;
use estimator_core::signal::encode;
use estimator_core::{Cell, Estimator, Instant, Outcome, Reading, Signal, Tuning, Value};
use test_kit::{TestFrame, by_force, truck};

/// Drives for some seconds at 20 m/s, and fetches cells if asked.
fn drive(estimator: &mut Estimator<f32>, seconds: u64) -> Vec<Cell> {
    let mut cells = Vec::new();
    for ms in (0..seconds * 1_000).step_by(100) {
        let altitude = 100.0 + 0.02 * 20.0 * ms as f32 / 1_000.0;
        for (signal, value) in [
            (Signal::TractionForce, 9_000.0),
            (Signal::Altitude, altitude),
            (Signal::WheelSpeed, 20.0),
        ] {
            let value = Value::Real(value);
            estimator.on_reading(Instant::from_micros(ms * 1_000), Reading { signal, value });
        }
        while estimator.step().is_some() {
            cells.extend(std::iter::from_fn(|| estimator.next_cell()));
        }
    }
    cells
}

#[test]
fn an_estimator_in_its_place_is_one_by_value() {
    let tuning = Tuning::default();
    let mut by_value = Estimator::<f32>::new(by_force(), tuning.clone()).unwrap();
    let mut place = MaybeUninit::uninit();
    let in_place = Estimator::new_in(&mut place, &by_force().into(), &tuning).unwrap();
    assert_eq!(drive(&mut by_value, 60), drive(in_place, 60));
    assert_eq!(by_value.live(), in_place.live());

    let mut impossible = by_force();
    impossible.mass_kg = 0.0;
    let mut place = MaybeUninit::<Estimator<f32>>::uninit();
    let refused = Estimator::new_in(&mut place, &impossible.into(), &tuning);
    assert_eq!(refused.unwrap_err().key, "vehicle.mass_kg");
}

#[test]
fn shares_of_work_at_the_end_give_the_cells_of_all_at_once() {
    let mut at_once = Estimator::<f32>::new(by_force(), Tuning::default()).unwrap();
    let mut in_shares = at_once.clone();
    let mut expected = drive(&mut at_once, 90);
    expected.extend(std::iter::from_fn(|| at_once.drain_cell()));
    let mut cells = drive(&mut in_shares, 90);
    while in_shares.drain_step() {
        cells.extend(std::iter::from_fn(|| in_shares.next_cell()));
    }
    assert_eq!(cells, expected);
    assert_eq!(in_shares.counters().cells_lost, 0);
    assert!(!in_shares.drain_step(), "there is nothing more to do");
}

#[test]
fn cells_can_be_fetched_after_all_shares_of_the_end() {
    let mut estimator = Estimator::<f32>::new(by_force(), Tuning::default()).unwrap();
    let fetched = drive(&mut estimator, 90).len();
    while estimator.drain_step() {}
    let rest = std::iter::from_fn(|| estimator.next_cell()).count();
    let counters = estimator.counters();
    assert_eq!(counters.cells_lost, 0);
    assert_eq!(fetched + rest, counters.steps as usize);
}

/// Returns a frame of CCVS1 with a wheel speed, from a source address.
fn speed(source: u8, mps: f32) -> TestFrame {
    let mut payload = [0; 8];
    encode(65_265, &mut payload, |signal| match signal {
        Signal::WheelSpeed => Value::Real(mps),
        _ => Value::NotAvailable,
    });
    TestFrame::of_pgn(65_265, source, &payload)
}

/// Returns a frame of ERC1 with a retarder torque, from a source address.
fn retarder(source: u8) -> TestFrame {
    let mut payload = [0; 8];
    encode(61_440, &mut payload, |signal| match signal {
        Signal::RetarderTorque => Value::Real(-50.0),
        _ => Value::NotAvailable,
    });
    TestFrame::of_pgn(61_440, source, &payload)
}

#[test]
fn a_signal_that_is_left_out_is_not_on_the_bus() {
    let mut estimator = Estimator::<f32>::new(truck(), Tuning::default()).unwrap();
    estimator.ignore(Signal::WheelSpeed);
    estimator.ignore(Signal::RetarderTorque);
    // Reserving it does not bring it back.
    estimator.reserve(Signal::WheelSpeed);
    for k in 0..200 {
        let now = Instant::from_micros(k * 100_000);
        assert_eq!(
            estimator.on_frame(now, &speed((k % 3) as u8, 20.0)),
            Outcome::Ignored
        );
        assert_eq!(estimator.on_frame(now, &retarder(16)), Outcome::Ignored);
        let reading = Reading {
            signal: Signal::WheelSpeed,
            value: Value::Real(20.0),
        };
        assert_eq!(estimator.on_reading(now, reading), Outcome::Ignored);
    }
    assert!(estimator.step().is_none());
    let counters = estimator.counters();
    assert_eq!((counters.speeds_used, counters.other_source), (0, 0));
}

#[test]
fn a_reserved_retarder_is_refused_on_the_bus_and_counted() {
    let mut estimator = Estimator::<f32>::new(truck(), Tuning::default()).unwrap();
    estimator.reserve(Signal::RetarderTorque);
    let now = Instant::from_micros(1_000_000);
    assert_eq!(estimator.on_frame(now, &retarder(16)), Outcome::Ignored);
    assert_eq!(estimator.counters().other_source, 1);
}

#[test]
fn the_latency_of_fixes_is_the_assumed_one_until_a_drive_shows_it() {
    let tuning = Tuning::default();
    let estimator = Estimator::<f32>::new(truck(), tuning.clone()).unwrap();
    assert_eq!(estimator.gnss_latency(), tuning.hold_times.gnss_latency);
}
