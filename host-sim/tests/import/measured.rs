//! The measured mission and the terrain. Skipped where the data are absent.

use crate::{check_pass_tables, import, shared};
use host_sim::source::terrain::Terrain;
use host_sim::source::ztbus::{Mission, round_trips};
use host_sim::study::drift::{ForceSample, vehicle_model_drift};
use std::collections::BTreeMap;
use std::path::PathBuf;

fn measured_mission() -> Option<PathBuf> {
    shared("ztbus/B183_2021-07-26_03-53-27_2021-07-26_07-18-47.csv")
}

#[test]
fn the_measured_mission_is_three_round_trips_between_the_ways_from_and_to_the_garage() {
    let Some(file) = measured_mission() else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let run = import(&file, folder.path())
        .arg("--json")
        .assert()
        .success();
    let json: serde_json::Value = serde_json::from_slice(&run.get_output().stdout).unwrap();
    assert_eq!(json["rows"], 12_321);
    assert_eq!(json["first_fix_s"], 692.0);
    let passes = json["passes"].as_array().unwrap();
    assert_eq!(passes.len(), 6);
    for (pass, direction) in passes.iter().zip(["outbound", "inbound"].iter().cycle()) {
        assert_eq!(pass["direction"], *direction);
        let length_m = pass["length_m"].as_f64().unwrap();
        assert!((7_250.0..7_350.0).contains(&length_m), "{length_m}");
        let climb_m = pass["climb_m"].as_f64().unwrap();
        assert!((60.0..80.0).contains(&climb_m.abs()), "{climb_m}");
    }
    check_pass_tables(passes);
}

#[test]
fn the_bare_model_drifts_on_the_measured_mission_as_is_known() {
    let Some(file) = measured_mission() else {
        return;
    };
    let mission = Mission::read(&file).unwrap();
    let vehicle = mission.vehicle().model;
    let trips = round_trips(&mission.passes());
    assert_eq!(trips.len(), 3);
    for rows in trips {
        let samples: Vec<ForceSample> = mission.rows()[rows]
            .iter()
            .map(|row| ForceSample {
                time_s: row.time_s,
                speed_mps: row.speed_mps.unwrap(),
                traction_force_n: row.traction_force_n.unwrap(),
                mass_kg: Some(row.mass_kg()),
                ambient_celsius: row.ambient_celsius,
                air_pressure_pa: None,
            })
            .collect();
        let drift = vehicle_model_drift(&samples, &vehicle.vehicle, 0.0).unwrap();
        println!("{drift:?}");
        assert!((14_500.0..14_700.0).contains(&drift.length_m), "{drift:?}");
        assert!((3.5..6.0).contains(&drift.drift_m_per_km), "{drift:?}");
    }
}

#[test]
fn the_terrain_agrees_with_the_altitude_of_the_bus() {
    let (Some(file), Some(folder)) = (measured_mission(), shared("srtm")) else {
        return;
    };
    let mission = Mission::read(&file).unwrap();
    let mut terrain = Terrain::new(&folder);
    // The mean of all passes in squares of about 20 m: one pass alone is off by 5 m.
    let mut squares: BTreeMap<(i64, i64), (f64, f64, f64)> = BTreeMap::new();
    let passes = mission.passes();
    let rows = passes
        .iter()
        .flat_map(|pass| &mission.rows()[pass.rows.clone()]);
    for row in rows.filter(|row| row.speed_mps.is_some_and(|mps| mps > 1.0)) {
        let (lat, lon) = row.position_deg().unwrap();
        let ground_m = terrain.altitude_m(lat, lon).unwrap().unwrap();
        let square = ((lat / 2e-4) as i64, (lon / 3e-4) as i64);
        let sum = squares.entry(square).or_default();
        sum.0 += row.altitude_m.unwrap();
        sum.1 += ground_m;
        sum.2 += 1.0;
    }
    let differences: Vec<f64> = squares
        .values()
        .filter(|(.., count)| *count >= 6.0)
        .map(|(gnss, ground, count)| (gnss - ground) / count)
        .collect();
    let count = differences.len() as f64;
    let mean_m = differences.iter().sum::<f64>() / count;
    let variance = differences
        .iter()
        .map(|d| (d - mean_m).powi(2))
        .sum::<f64>()
        / count;
    println!(
        "GNSS less SRTM: {mean_m:.1} m, sigma {:.1} m, {count} squares",
        variance.sqrt()
    );
    assert!(count > 300.0);
    assert!(variance.sqrt() < 6.0, "{}", variance.sqrt());
    assert!(mean_m.abs() < 15.0, "{mean_m}");
}
