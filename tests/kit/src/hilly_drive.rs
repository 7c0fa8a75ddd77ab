//! A drive over hills, from which a filter learns the error of its mass.

use crate::by_force;
use estimator_core::{Estimator, Instant, PersistentState, Reading, Scalar, Signal, Tuning, Value};
use std::sync::LazyLock;

/// The signals on the bus besides force and speed.
#[derive(Clone, Copy)]
pub struct BusSignals {
    pub gnss: bool,
    pub mass_kg: Option<f32>,
}

pub const USUAL: BusSignals = BusSignals {
    gnss: true,
    mass_kg: None,
};

/// Drives at 20 m/s over hills of 1.2 km. The true mass is 10 % larger than the parameter.
pub fn drive<S: Scalar>(mut estimator: Estimator<S>, metres: u32, bus: BusSignals) -> Estimator<S> {
    let vehicle = by_force();
    let weight_n = 1.1 * vehicle.mass_kg * 9.806_65;
    let drag_n = 0.5 * vehicle.drag_area_m2 * 1.2 * 400.0;
    let (steepest, hill_m) = (0.02_f32, 1_200.0_f32);
    for tick in 0..u64::from(metres / 2) {
        let now = Instant::from_micros(tick * 100_000);
        let mut put = |signal, value| {
            let value = Value::Real(value);
            estimator.on_reading(now, Reading { signal, value });
        };
        let phase = |driven_m: f32| core::f32::consts::TAU * driven_m / hill_m;
        let driven_m = tick as f32 * 2.0;
        let sine = steepest * phase(driven_m).sin();
        if let Some(mass_kg) = bus.mass_kg {
            put(Signal::Mass, mass_kg);
        }
        let force_n = drag_n + weight_n * (vehicle.rolling_resistance + sine);
        put(Signal::TractionForce, force_n);
        if bus.gnss && tick % 10 == 2 {
            let fix = phase(driven_m - 3.0);
            let wave_m = steepest * hill_m / core::f32::consts::TAU;
            put(Signal::Altitude, 200.0 + wave_m * (1.0 - fix.cos()));
        }
        put(Signal::WheelSpeed, 20.0);
        while estimator.step().is_some() {
            while estimator.next_cell().is_some() {}
        }
    }
    estimator
}

pub fn fresh<S: Scalar>() -> Estimator<S> {
    Estimator::new(by_force(), Tuning::default()).unwrap()
}

/// The persistent state after 12 km of the drive.
pub static KEPT: LazyLock<PersistentState> = LazyLock::new(|| {
    drive::<f32>(fresh(), 12_000, USUAL)
        .persistent_state()
        .unwrap()
});
