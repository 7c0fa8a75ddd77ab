//! Signals without a bus: a program that reads its sensors itself gives readings instead of frames.
//!
//! ```text
//! cargo run -p estimator-core --example own_signals
//! ```

use estimator_core::{
    Estimator, Instant, ParameterError, Reading, Signal, Traction, Tuning, Value, VehicleParameters,
};

fn main() -> Result<(), ParameterError> {
    let truck = VehicleParameters {
        mass_kg: 19_000.0,
        drag_area_m2: 5.2,
        rolling_resistance: 0.008,
        wheel_radius_m: 0.48,
        wheel_inertia_kgm2: 60.0,
        traction: Traction::Force,
    };
    let mut estimator = Estimator::<f32>::new(truck, Tuning::default())?;
    // A steady climb of 3 % at 20 m/s: weight times grade and rolling resistance, and air.
    let force_n = 19_000.0 * 9.81 * (0.03 + 0.008) + 0.5 * 1.2 * 5.2 * 20.0 * 20.0;
    let mut finished = 0;
    for tenth in 0..3_000_u32 {
        let now = Instant::from_micros(u64::from(tenth) * 100_000);
        let altitude_m = 400.0 + 0.03 * 2.0 * tenth as f32;
        // A fix once a second; forces before the speed that closes an interval.
        let fix = [
            (Signal::Satellites, 9.0),
            (Signal::Hdop, 1.0),
            (Signal::Altitude, altitude_m),
        ];
        let fix = fix.into_iter().filter(|_| tenth.is_multiple_of(10));
        let motion = [(Signal::TractionForce, force_n), (Signal::WheelSpeed, 20.0)];
        for (signal, value) in fix.chain(motion) {
            let value = Value::Real(value);
            estimator.on_reading(now, Reading { signal, value });
        }
        while estimator.step().is_some() {
            while let Some(cell) = estimator.next_cell() {
                finished += 1;
                if finished % 400 == 0 {
                    let lagged = cell.lagged_grade_percent;
                    let (at_m, grade, sigma) = (cell.end.distance_m(), lagged.value, lagged.sigma);
                    println!("{at_m:6.0} m: {grade:.2} % (sigma {sigma:.2} %)");
                }
            }
        }
    }
    // What the estimator could not use is counted, by kind.
    println!("{:?}", estimator.counters());
    Ok(())
}
