//! A vehicle file of another vehicle, or in other units.

use crate::drive::{estimate_with, table, vehicle};
use estimator_core::Signal;

/// Returns the vehicle file with the number of a key changed.
fn vehicle_with(key: &str, change: impl Fn(f64) -> f64) -> String {
    let lines = vehicle();
    let lines = lines.lines().map(|line| match line.split_once(" = ") {
        Some((name, value)) if name == key => {
            let number = value.split_whitespace().next().unwrap();
            format!("{key} = {:?}\n", change(number.parse().unwrap()))
        }
        _ => format!("{line}\n"),
    });
    lines.collect()
}

#[test]
fn mass_in_tonnes_is_an_error_that_names_the_key() {
    let printed = estimate_with(&vehicle_with("mass_kg", |kg| kg * 1e-3), &table());
    assert_eq!(printed.code, 1);
    assert!(printed.stderr.contains("vehicle.mass_kg"), "{printed:?}");
    assert!(printed.stderr.contains("500 to 200000 kg"), "{printed:?}");
}

#[test]
fn mass_in_pounds() {
    let printed = estimate_with(&vehicle_with("mass_kg", |kg| kg / 0.453_592), &table());
    printed.warns(&["scale"], "", "which may be in pounds");
}

#[test]
fn reported_mass_of_another_load() {
    let mut wrong = table();
    for (_, row) in &mut wrong {
        if row.contains_key(&Signal::BrakeSwitch) {
            row.insert(Signal::Mass, 60_000.0);
        }
    }
    let printed = estimate_with(&vehicle(), &wrong);
    printed.warns(&["scale"], "", "the reported mass (CVW)");
}

#[test]
fn reference_torque_of_another_engine() {
    let file = vehicle_with("reference_torque_nm", |nm| nm * 0.7);
    // EC1 on the bus would go before the file.
    let mut table = table();
    for (_, row) in &mut table {
        row.retain(|signal, _| *signal != Signal::EngineReferenceTorque);
    }
    estimate_with(&file, &table).warns(&["scale"], "", "check mass_kg");
}

#[test]
fn gears_that_never_match() {
    let mut table = table();
    let gears = [Signal::CurrentGear, Signal::SelectedGear, Signal::GearRatio];
    for (_, row) in &mut table {
        row.retain(|signal, _| !gears.contains(signal));
    }
    let file = vehicle_with("final_drive_ratio", |ratio| ratio * 6.0);
    let printed = estimate_with(&file, &table);
    printed.tells("no force is: the engine turns");
    if printed.code == 0 {
        assert_eq!(printed.codes, ["no_gear"], "{printed:?}");
        assert!(
            printed
                .verdict
                .contains("no gear of the vehicle file ever matches")
        );
    }
}
