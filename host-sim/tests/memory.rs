//! A long drive takes hardly more memory than a short one. The allocator counts it.

use estimator_core::Tuning;
use host_sim::files::run::{Origin, write_rows};
use host_sim::files::vehicle::VehicleFile;
use host_sim::recorder::estimate_log;
use host_sim::source::read_options::ReadOptions;
use peak_alloc::PeakAlloc;
use std::fmt::Write;
use std::fs;
use std::path::Path;
use tempfile::TempDir;

#[global_allocator]
static ALLOCATOR: PeakAlloc = PeakAlloc;

const VEHICLE: &str = "\
[vehicle]
name = \"A\"
mass_kg = 39000.0
drag_area_m2 = 6.0
rolling_resistance = 0.0065
wheel_radius_m = 0.5
wheel_inertia_kgm2 = 100.0
[traction]
source = \"force\"
";

/// Writes the log of a drive over hills at 25 m/s, one line a second.
fn write_log(path: &Path, km: usize) {
    let mut text = String::from(
        "time_s,wheel_speed_mps,traction_force_n,latitude_deg,longitude_deg,altitude_m\n",
    );
    for second in 0..km * 40 {
        let at_m = 25.0 * second as f64;
        let altitude_m = 400.0 + 30.0 * (at_m / 1_000.0).sin();
        let force_n = 4_700.0 + 39_000.0 * 9.81 * 0.03 * (at_m / 1_000.0).cos();
        let latitude_deg = 47.0 + at_m / 111e3 % 1.0;
        writeln!(
            text,
            "{second}.0,25.0,{force_n:.0},{latitude_deg:.7},8.5,{altitude_m:.2}"
        )
        .unwrap();
    }
    fs::write(path, text).unwrap();
}

/// Returns the largest number of allocated bytes between a log and its run file.
fn peak(folder: &Path, km: usize, ending: &str) -> usize {
    let (log, out) = (
        folder.join("drive.csv"),
        folder.join(format!("run.{ending}")),
    );
    let vehicle = folder.join("v.toml");
    fs::write(&vehicle, VEHICLE).unwrap();
    let vehicle = VehicleFile::read(&vehicle).unwrap();
    write_log(&log, km);
    let before = ALLOCATOR.current_usage();
    ALLOCATOR.reset_peak_usage();
    let mut run = estimate_log::<f32>(
        &vehicle.model,
        &Tuning::default(),
        None,
        &log,
        &ReadOptions::default(),
        |_| (),
    )
    .unwrap();
    assert!(run.rows.count() + 50 > km * 400, "{}", run.rows.count());
    write_rows(&out, &mut run.rows, &Origin::default()).unwrap();
    ALLOCATOR.peak_usage() - before
}

// A single test, since others at the same time would be counted, too.
#[test]
fn a_drive_of_a_thousand_km_takes_hardly_more_than_one_of_two_hundred() {
    let folder = TempDir::new().unwrap();
    let peak = |km, ending| peak(folder.path(), km, ending);
    // A piece of 100 km, and 10 km before and behind it, is in memory.
    let (short, long) = (peak(200, "csv"), peak(1_000, "csv"));
    eprintln!("CSV: {short} bytes for 200 km, {long} for 1,000 km");
    assert!(
        long < short * 11 / 10,
        "{short} bytes for 200 km, {long} for 1,000 km"
    );
    assert!(long < 40_000_000, "{long}");
    // A row group of Parquet, which is the rows of 164 km, is in memory.
    let (short, long) = (peak(200, "parquet"), peak(1_000, "parquet"));
    eprintln!("Parquet: {short} bytes for 200 km, {long} for 1,000 km");
    assert!(
        long < short * 5 / 4,
        "{short} bytes for 200 km, {long} for 1,000 km"
    );
}
