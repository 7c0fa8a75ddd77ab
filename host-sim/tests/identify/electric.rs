//! The vehicle file that the table of an electric car asks for.

use estimator_core::Traction;
use host_sim::files::vehicle::VehicleFile;
use serde_json::Value;
use test_kit::command::{folder, roadgrade};
use test_kit::electric_car::{VEHICLE, table};

#[test]
fn an_electric_car_has_one_gear_and_needs_no_reference_torque() {
    let folder = folder();
    let path = folder.path();
    std::fs::write(path.join("car.csv"), table()).unwrap();
    std::fs::write(path.join("car.toml"), VEHICLE).unwrap();
    let arguments = ["identify", "--json", "--out", "found.toml", "car.csv"];
    let done = roadgrade(path, &arguments).success();
    let values: Vec<Value> = serde_json::from_slice(&done.get_output().stdout).unwrap();
    let torque = |of: &&Value| of["key"] == "powertrain.reference_torque_nm";
    assert_eq!(values.iter().find(torque).unwrap()["origin"], "read");
    let turns_per_m = |name: &str| {
        let vehicle = VehicleFile::read(&path.join(name)).unwrap().model.vehicle;
        let Traction::Powertrain(powertrain) = &vehicle.traction else {
            panic!("no powertrain");
        };
        let gear = powertrain.only_gear().expect("one gear");
        gear.ratio * powertrain.final_drive_ratio / vehicle.wheel_radius_m
    };
    let off = turns_per_m("found.toml") / turns_per_m("car.toml") - 1.0;
    assert!(off.abs() < 0.01, "{off}");
}
