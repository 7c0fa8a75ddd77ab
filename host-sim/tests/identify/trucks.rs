//! Trucks that are neither of the thesis, and their drives.

use estimator_core::{Gear, Model, Powertrain, Traction, VehicleParameters};
use host_sim::files::vehicle::VehicleFile;
use std::fs;
use std::path::Path;
use test_kit::command::roadgrade;

/// A truck: mass (kg), drag area (m²), rolling resistance, wheel radius (m), reference torque (Nm),
/// final drive, largest and smallest gear ratio, gears.
pub struct Truck {
    pub name: &'static str,
    pub mass_kg: f32,
    pub drag_area_m2: f32,
    pub rolling_resistance: f32,
    pub wheel_radius_m: f32,
    pub reference_torque_nm: f32,
    pub final_drive_ratio: f32,
    pub ratios: (f32, f32),
    pub gears: i32,
}

pub const HEAVY: Truck = Truck {
    name: "heavy",
    mass_kg: 56_000.0,
    drag_area_m2: 6.6,
    rolling_resistance: 0.0066,
    wheel_radius_m: 0.515,
    reference_torque_nm: 3_100.0,
    final_drive_ratio: 3.1,
    ratios: (14.6, 1.0),
    gears: 16,
};
pub const LIGHT: Truck = Truck {
    name: "light",
    mass_kg: 9_500.0,
    drag_area_m2: 4.6,
    rolling_resistance: 0.0072,
    wheel_radius_m: 0.42,
    reference_torque_nm: 950.0,
    final_drive_ratio: 4.1,
    ratios: (6.7, 0.73),
    gears: 6,
};

/// It leaves most of its gears at once: each is driven for a second or two, at a launch.
pub const QUICK: Truck = Truck {
    name: "quick",
    mass_kg: 16_600.0,
    drag_area_m2: 5.0,
    rolling_resistance: 0.006,
    wheel_radius_m: 0.47,
    reference_torque_nm: 1_600.0,
    final_drive_ratio: 3.3,
    ratios: (7.2, 1.0),
    gears: 6,
};

impl Truck {
    pub fn parameters(&self) -> VehicleParameters {
        let (largest, smallest) = self.ratios;
        let step = (smallest / largest).powf(1.0 / (self.gears - 1) as f32);
        let gear = |number| Gear {
            // As SPN 526 reports it.
            ratio: (largest * step.powi(number) * 1000.0).round() / 1000.0,
            efficiency: 0.98,
        };
        VehicleParameters {
            mass_kg: self.mass_kg,
            drag_area_m2: self.drag_area_m2,
            rolling_resistance: self.rolling_resistance,
            wheel_radius_m: self.wheel_radius_m,
            wheel_inertia_kgm2: 60.0,
            traction: Traction::Powertrain(Powertrain {
                engine_inertia_kgm2: 0.001 * self.reference_torque_nm,
                reference_torque_nm: self.reference_torque_nm,
                final_drive_ratio: self.final_drive_ratio,
                final_drive_efficiency: 0.975,
                gears: (0..self.gears).map(gear).collect(),
            }),
        }
    }
}

/// Simulates a drive of each truck from standstill on one road, and one back if `both_ways`.
pub fn simulate(folder: &Path, trucks: &[&Truck], length_m: f64, both_ways: bool) {
    let mut scenario = format!("seed = 11\n[road]\nlength_m = {length_m}\n");
    for truck in trucks {
        let file = VehicleFile {
            name: truck.name.to_owned(),
            model: Model::from(truck.parameters()),
        };
        let name = truck.name;
        file.write(&folder.join(format!("{name}.toml"))).unwrap();
        let run = |name: &str, more: &str| {
            let vehicle = truck.name;
            format!(
                "[[runs]]\nname = \"{name}\"\nvehicle = \"{vehicle}.toml\"\nstart = \
                 \"standstill\"\n{more}\n"
            )
        };
        scenario += &run(name, "");
        if both_ways {
            scenario += &run(&format!("{name}_back"), "direction = \"backward\"");
        }
    }
    fs::write(folder.join("scenario.toml"), scenario).unwrap();
    roadgrade(
        folder,
        &["simulate", "--scenario", "scenario.toml", "--out", "."],
    )
    .success();
}

/// Returns the rest of a log without the frames of these PGNs, by the hexadecimal digits of their
/// identifiers.
pub fn without(folder: &Path, from: &str, to: &str, pgns: &[&str]) {
    let text = fs::read_to_string(folder.join(from)).unwrap();
    let has = |line: &&str| {
        let identifier = line.split(' ').nth(2).unwrap_or_default();
        !pgns.iter().any(|pgn| identifier.get(2..6) == Some(*pgn))
    };
    let rest: Vec<&str> = text.lines().filter(has).collect();
    fs::write(folder.join(to), rest.join("\n") + "\n").unwrap();
}

/// Makes the gear ratio (SPN 526, bytes 2 and 3 of ETC2) not available.
pub fn without_ratio(folder: &Path, from: &str, to: &str) {
    let text = fs::read_to_string(folder.join(from)).unwrap();
    let line = |line: &str| match line.split_once("F00503#") {
        Some((start, data)) => format!("{start}F00503#{}FFFF{}\n", &data[..2], &data[6..]),
        None => format!("{line}\n"),
    };
    let lines: String = text.lines().map(line).collect();
    assert_ne!(lines, text);
    fs::write(folder.join(to), lines).unwrap();
}

/// Makes the wheel speed (SPN 84 of CCVS1) the tachograph's (SPN 1624 of TCO1).
pub fn with_tachograph(folder: &Path, from: &str, to: &str) {
    let text = fs::read_to_string(folder.join(from)).unwrap();
    let line = |line: &str| match line.split_once("FEF1") {
        Some((start, rest)) => {
            let (source, data) = rest.split_once('#').unwrap();
            format!("{start}FE6C{source}#FFFFFFFFFFFF{}\n", &data[2..6])
        }
        None => format!("{line}\n"),
    };
    let lines: String = text.lines().map(line).collect();
    assert_ne!(lines, text);
    fs::write(folder.join(to), lines).unwrap();
}
