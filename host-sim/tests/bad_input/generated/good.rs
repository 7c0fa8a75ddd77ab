//! Good files of every kind.

use crate::shell::rows;
use flate2::write::GzEncoder;
use host_sim::files::run::{self, Origin};
use std::fs;
use std::io::Write as _;
use tempfile::TempDir;
use test_kit::command::roadgrade;
use test_kit::osm::{Packing, pbf};
use test_kit::roads::{hills, network};

const VEHICLE: &str = "[vehicle]\nname = \"A\"\nmass_kg = 39000.0\ndrag_area_m2 = 6.0\n\
    rolling_resistance = 0.0065\nwheel_radius_m = 0.5\nwheel_inertia_kgm2 = 100.0\n\
    [traction]\nsource = \"force\"\n[effects.tyre_warmup]\namount = 0.3\namount_sigma = 0.04\n";
const SCENARIO: &str = "seed = 3\n[road]\nlength_m = 1200.0\nstart_altitude_m = 40.0\n\
    [gnss]\naltitude_sigma_m = 3.0\nsteps = [[100.0, 200.0, 5.0]]\n[wind]\nspeed_mps = 3.0\n\
    [planted]\nfan_w = 1000.0\n[errors]\nmass_factor = 1.1\n\
    [[runs]]\nname = \"a\"\ntruck = \"A\"\n";

fn table(km: f64, lift_m: f64) -> String {
    let mut text = String::from(
        "time_s,wheel_speed_mps,traction_force_n,latitude_deg,longitude_deg,altitude_m\n",
    );
    for second in 0..(40.0 * km) as usize {
        let at_m = 25.0 * second as f64;
        let altitude_m = 400.0 + 30.0 * (at_m / 1_000.0).sin() + lift_m;
        let force_n = 4_700.0 + 39_000.0 * 9.81 * 0.03 * (at_m / 1_000.0).cos();
        let latitude_deg = 47.0 + at_m / 111e3;
        text += &format!("{second}.0,25.0,{force_n:.0},{latitude_deg:.7},8.5,{altitude_m:.2}\n");
    }
    text
}

fn mission() -> String {
    let header = "time_iso,time_unix,gnss_altitude,gnss_course,gnss_latitude,gnss_longitude,\
        itcs_numberOfPassengers,odometry_vehicleSpeed,status_haltBrakeIsActive,\
        status_parkBrakeIsActive,temperature_ambient,traction_brakePressure,traction_tractionForce\n";
    let row = |second: u32| {
        let latitude = 0.826 + f64::from(second) * 1e-6;
        format!(
            "x,{},400,1.0,{latitude},0.148,-,8,0,0,290,0,5000\n",
            1_571_000_000 + second
        )
    };
    header.to_owned() + &(0..200).map(row).collect::<String>()
}

/// Returns a trip of 3 km at 25 m/s, ten rows a second, with an elevation between two points.
fn trip() -> String {
    let header = "Time [s];Velocity [km/h];Elevation [m];Motor Torque [Nm];\
        Longitudinal Acceleration [m/s^2];Ambient Temperature [°C]\r\n";
    let row = |tenth: u32| {
        let (time_s, noise) = (f64::from(tenth) * 0.1, f64::from(tenth * 7 % 11) * 0.1);
        let climb_m = 20.0 - (time_s - 60.0).abs() / 3.0;
        let speed_kmh = 90.0 + noise;
        format!("{time_s:.1};{speed_kmh:.1};{climb_m:.2};{noise};{noise};9.5\r\n")
    };
    header.to_owned() + &(0..1_200).map(row).collect::<String>()
}

/// Compresses with gzip.
pub fn zipped(content: &[u8]) -> Vec<u8> {
    let mut zip = GzEncoder::new(Vec::new(), Default::default());
    zip.write_all(content).unwrap();
    zip.finish().unwrap()
}

/// Returns the road of a map: its first three columns.
fn line_of(map: &str) -> String {
    let first_three = |row: &str| row.splitn(4, ',').take(3).collect::<Vec<_>>().join(",") + "\n";
    map.lines().map(first_three).collect()
}

/// Writes every good file.
pub fn files() -> TempDir {
    let folder = TempDir::new().unwrap();
    let at = folder.path();
    let write = |name: &str, content: &[u8]| fs::write(at.join(name), content).unwrap();
    let done = |arguments: &str| {
        let arguments: Vec<&str> = arguments.split(' ').collect();
        roadgrade(at, &arguments).success();
    };
    run::write(&at.join("run.csv"), &rows(60, 0)).unwrap();
    run::write(&at.join("folder.csv"), &rows(60, 1)).unwrap();
    let origin = Origin {
        vehicle: Some("A".to_owned()),
        day: Some("2026-11-21".to_owned()),
        ..Origin::default()
    };
    run::write_from(&at.join("run.parquet"), &rows(60, 2), &origin).unwrap();
    done("fuse --out map.csv --store store.csv run.csv run.parquet");
    done("fuse --out map.parquet run.csv");
    write(
        "line.csv",
        line_of(&fs::read_to_string(at.join("map.csv")).unwrap()).as_bytes(),
    );
    network::save(
        &at.join("net.geojson"),
        &[network::way("w", "yes", &hills()[..60])],
    );
    done("fuse --out map_net.csv --store store_net.csv --road net.geojson run.csv");
    done("fuse --out map_net.parquet --road net.geojson run.csv");
    write("net.osm.pbf", &extract());
    done("fuse --out map_osm.csv --road net.osm.pbf run.csv");
    fs::copy(at.join("map_net.csv"), at.join("net.csv")).unwrap();
    fs::create_dir(at.join("runs")).unwrap();
    for name in ["run.csv", "run.parquet"] {
        fs::copy(at.join(name), at.join("runs").join(name)).unwrap();
    }
    write("table.csv", table(1.5, 0.0).as_bytes());
    write("other.csv", table(1.5, 1.0).as_bytes());
    write("table.csv.gz", &zipped(table(1.5, 0.0).as_bytes()));
    write("long_table.csv", table(8.0, 0.0).as_bytes());
    write("force.toml", VEHICLE.as_bytes());
    write(
        "tuning.toml",
        b"[estimation]\nspeed_noise_mps = 0.02\n[hold_times]\nhold_ms = 1500\n",
    );
    write("mission.csv", mission().as_bytes());
    write("TripA01.csv", trip().as_bytes());
    write("TripA02.csv.gz", &zipped(trip().as_bytes()));
    for folder in ["data/ztbus", "data/srtm", "data/i3"] {
        fs::create_dir_all(at.join(folder)).unwrap();
    }
    write("data/ztbus/mission.csv", mission().as_bytes());
    write("data/i3/TripA01.csv", trip().as_bytes());
    write("data/srtm/N47E008.hgt", &[1; 2 * 1201 * 1201]);
    write("scenario.toml", SCENARIO.as_bytes());
    let with_road = "[road]\nfile = \"road.csv\"\n[[runs]]\nname = \"b\"\ntruck = \"B\"\n";
    write("with_road.toml", with_road.as_bytes());
    done("estimate --vehicle force.toml --out long_run.csv --kept kept long_table.csv");
    done("estimate --vehicle force.toml --out table_run.csv table.csv");
    done("fuse --out reference.csv table_run.csv");
    done("simulate --scenario scenario.toml --out sim");
    for name in ["a.vehicle.toml", "a.oracle.toml", "a.truth.csv", "road.csv"] {
        fs::copy(at.join("sim").join(name), at.join(name)).unwrap();
    }
    let log = fs::read(at.join("sim/a.log")).unwrap();
    write("drive.log.gz", &zipped(&log));
    write("drive.log", &log);
    done("estimate --vehicle a.vehicle.toml --out a.csv drive.log");
    done("estimate --vehicle a.vehicle.toml --out a.parquet drive.log");
    for name in ["sim", "long_run.csv", "table_run.csv"] {
        let path = at.join(name);
        let _ = fs::remove_dir_all(&path).or_else(|_| fs::remove_file(&path));
    }
    folder
}

/// Returns a road as an OpenStreetMap extract.
fn extract() -> Vec<u8> {
    let (nodes, of_ways) = network::osm_nodes(&[network::way("w", "yes", &hills()[..60])]);
    let ways: Vec<_> = of_ways
        .into_iter()
        .map(|nodes| (1, nodes, &[("highway", "primary"), ("oneway", "yes")][..]))
        .collect();
    pbf(
        &["OsmSchema-V0.6", "DenseNodes"],
        &nodes,
        &ways,
        Packing::Zlib,
    )
}
