//! A packed map on the vehicle: the live grade with it, and the grade ahead.
//!
//! ```text
//! roadgrade demo --out demo
//! roadgrade pack --out map.grade demo/map.csv
//! cargo run -p estimator-core --example map -- map.grade LATITUDE_DEG LONGITUDE_DEG COURSE_DEG
//! ```
//!
//! drives along the map from a place on it, and prints the two kilometres ahead.

use estimator_core::roadmap::{Horizon, MapLive, MapMatch, PackedMap};
use estimator_core::{
    Estimator, Instant, Reading, Signal, Step, Traction, Tuning, Value, VehicleParameters,
};

/// Length of a degree of latitude, m.
const DEGREE_M: f64 = 111_200.0;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [file, latitude_deg, longitude_deg, course_deg] = arguments.as_slice() else {
        return Err("expected MAP.grade LATITUDE_DEG LONGITUDE_DEG COURSE_DEG".into());
    };
    let start = (latitude_deg.parse()?, longitude_deg.parse()?);
    let course_deg: f64 = course_deg.parse()?;
    // On a controller: a slice of flash. Nothing is copied.
    let bytes = std::fs::read(file)?;
    let map = PackedMap::open(&bytes).map_err(|e| format!("{file}: {e:?}"))?;
    let mut follower = MapLive::new(map);
    let mut estimator = Estimator::<f32>::new(truck(), Tuning::default())?;
    for tenth in 0..300_u32 {
        drive_on(&mut estimator, tenth, start, course_deg);
        while let Some(step) = estimator.step() {
            if let (Step::Moved, Some(live)) = (step, estimator.live()) {
                follower.advance(&live);
            }
            while let Some(cell) = estimator.next_cell() {
                follower.finish(&cell);
            }
        }
    }
    let MapMatch::On(place) = follower.matcher().place() else {
        return Err(
            "the drive is not on the map; expected a place on it, and the course there".into(),
        );
    };
    let horizon = Horizon::new(map, &place, 2_000.0).map_err(|e| format!("{file}: {e:?}"))?;
    for (number, branch) in horizon.branches().iter().enumerate() {
        println!("branch {number}, probability {:.2}", branch.probability);
        for point in horizon.points(branch, 250.0) {
            match point.grade_percent {
                Some(grade) => println!("{:6.0} m: {:+.2} %", point.ahead_m, grade.value),
                None => println!("{:6.0} m: not known", point.ahead_m),
            }
        }
    }
    Ok(())
}

fn truck() -> VehicleParameters {
    VehicleParameters {
        mass_kg: 19_000.0,
        drag_area_m2: 5.2,
        rolling_resistance: 0.008,
        wheel_radius_m: 0.48,
        wheel_inertia_kgm2: 60.0,
        traction: Traction::Force,
    }
}

/// Gives a tenth of a second of a drive straight on at 20 m/s.
fn drive_on(
    estimator: &mut Estimator<f32>,
    tenth: u32,
    (latitude_deg, longitude_deg): (f64, f64),
    course_deg: f64,
) {
    let now = Instant::from_micros(u64::from(tenth) * 100_000);
    let driven_m = 2.0 * f64::from(tenth);
    let (east, north) = course_deg.to_radians().sin_cos();
    let latitude = latitude_deg + driven_m * north / DEGREE_M;
    let longitude = longitude_deg + driven_m * east / (DEGREE_M * latitude_deg.to_radians().cos());
    let e7 = |degrees: f64| Value::DegreesE7((degrees * 1e7).round() as i32);
    let fix = [
        (Signal::Satellites, Value::Real(9.0)),
        (Signal::Hdop, Value::Real(1.0)),
        (Signal::Latitude, e7(latitude)),
        (Signal::Longitude, e7(longitude)),
        (Signal::Altitude, Value::Real(100.0)),
    ];
    let fix = fix.into_iter().filter(|_| tenth.is_multiple_of(10));
    let motion = [
        (Signal::TractionForce, Value::Real(2_700.0)),
        (Signal::WheelSpeed, Value::Real(20.0)),
    ];
    for (signal, value) in fix.chain(motion) {
        estimator.on_reading(now, Reading { signal, value });
    }
}
