//! Groups of different rates become rows in the order of time, however they are stored.

use super::{at, group, plain, read, readings, reals};
use estimator_core::{Signal, Value};
use std::fmt::Write as _;
use test_kit::mdf::MdfBlocks;
use test_kit::mdf_signals::{MdfChannel, MdfGroup, MdfLayout, mdf_signals};

/// Three groups: 100 ms, 250 ms and a second; the first has marks.
fn drive() -> Vec<MdfGroup> {
    let force = MdfChannel {
        invalid_bit: Some(1),
        ..MdfChannel::of_type("traction_force_n", 3, 8, 16)
    };
    let brake = MdfChannel::of_type("brake", 0, 10, 8);
    let records = (0..600_u16).map(|k| {
        let marks = if k % 7 == 3 || k > 500 { 2 } else { 0 };
        let [high, low] = (i32::from(k) * 3 - 900).to_be_bytes()[2..] else {
            unreachable!();
        };
        let bytes = vec![high, low, u8::from(k % 50 == 0), marks];
        (f64::from(k) * 0.1, bytes)
    });
    let mut fast = group(vec![force, brake], records);
    fast.invalidation_bytes = 1;
    let speed: Vec<(f64, f64)> = (0..240)
        .map(|k| f64::from(k) * 0.25)
        .map(|t| (t, 20.0 + (t / 9.0).sin()))
        .collect();
    let height: Vec<(f64, f64)> = (0..60)
        .map(|k| (f64::from(k), f64::from(k) * 0.5))
        .collect();
    vec![
        fast,
        reals("wheel_speed_mps", "m/s", &speed),
        reals("altitude_m", "m", &height),
    ]
}

#[test]
fn rates_are_merged_in_the_order_of_time_and_of_signals() {
    let found = readings(&plain(&drive()), "");
    assert!(found.is_sorted_by_key(|(time, signal, _)| (*time, *signal)));
    let first: Vec<Signal> = found.iter().take(4).map(|of| of.1).collect();
    assert_eq!(
        first,
        [
            Signal::TractionForce,
            Signal::Altitude,
            Signal::BrakeSwitch,
            Signal::WheelSpeed
        ]
        .map(|signal| signal)
        .into_iter()
        .collect::<std::collections::BTreeSet<_>>()
        .into_iter()
        .collect::<Vec<_>>()
    );
    let count = |signal| found.iter().filter(|of| of.1 == signal).count();
    let forces = (0..600).filter(|k| k % 7 != 3 && *k <= 500).count();
    assert_eq!(count(Signal::TractionForce), forces);
    assert_eq!(count(Signal::BrakeSwitch), 600);
    assert_eq!(
        (count(Signal::WheelSpeed), count(Signal::Altitude)),
        (240, 60)
    );
    let at_one = found.iter().filter(|of| of.0 == at(1.0)).count();
    assert_eq!(at_one, 3, "{found:?}");
    assert!(found.contains(&(at(1.0), Signal::Altitude, Value::Real(0.5))));
}

#[test]
fn every_way_to_store_them_gives_the_same() {
    let drive = drive();
    let expected = read(&plain(&drive), "").unwrap();
    assert_eq!(
        expected.1.start_utc.as_deref(),
        Some("2023-11-14T22:13:20Z")
    );
    let mut told = String::new();
    for blocks in [
        MdfBlocks::Plain,
        MdfBlocks::Unfinished,
        MdfBlocks::List,
        MdfBlocks::Deflated,
        MdfBlocks::Transposed,
        MdfBlocks::Zstd,
        MdfBlocks::ZstdTransposed,
        MdfBlocks::Lz4,
        MdfBlocks::Lz4Transposed,
    ] {
        for layout in [MdfLayout::Sorted, MdfLayout::Unsorted, MdfLayout::Columns] {
            if (blocks, layout) == (MdfBlocks::Unfinished, MdfLayout::Columns) {
                continue; // Its lists need lengths.
            }
            let found = read(&mdf_signals(&drive, blocks, layout), "");
            if found.as_ref() != Ok(&expected) {
                let _ = writeln!(told, "{blocks:?} {layout:?}: {:?}", found.map(|of| of.1));
            }
        }
    }
    assert!(told.is_empty(), "{told}");
}

#[test]
fn times_before_the_start_are_moved() {
    let values = [(-1.5, 1.0), (-0.5, 2.0), (0.5, 3.0)];
    let (found, report) = read(&plain(&[reals("wheel_speed_mps", "", &values)]), "").unwrap();
    let times: Vec<u64> = found.iter().map(|of| of.0).collect();
    assert_eq!(times, [0, at(1.0), at(2.0)]);
    assert_eq!(
        report.mended,
        ["times begin at -1.500000 s; moved to begin with zero"]
    );
}

#[test]
fn a_group_that_is_not_mapped_is_not_read() {
    let mut drive = drive();
    let text = MdfChannel::of_type("driver", 7, 8, 64);
    drive.push(group(vec![text], [(0.0, b"somebody".to_vec())]));
    let found = readings(&plain(&drive), "");
    assert_eq!(found, readings(&plain(&drive[..3]), ""));
    // A group that counts in another quantity has no times.
    for channel in &mut drive[1].channels {
        channel.sync *= 2;
    }
    let found = readings(&plain(&drive), "");
    assert!(!found.iter().any(|of| of.1 == Signal::WheelSpeed));
    let toml = "[signals.wheel_speed_mps]\nsignal = \"wheel_speed_mps\"\n";
    let message = super::error(&plain(&drive), toml);
    assert!(
        message.contains("its group counts in another quantity than time"),
        "{message}"
    );
}
