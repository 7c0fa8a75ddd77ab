//! What one drive leaves for the next, in two slots as a controller's flash has them.
//!
//! ```text
//! cargo run -p estimator-core --example kept_state
//! ```
//!
//! A write that is interrupted damages one slot; the other one still has the drive before.

use estimator_core::{
    Estimator, Instant, ParameterError, PersistentState, Reading, Signal, Traction, Tuning, Value,
    VehicleParameters,
};

/// A slot: erased flash reads as ones.
type Slot = [u8; PersistentState::LEN];

fn main() -> Result<(), ParameterError> {
    let mut slots: [Slot; 2] = [[0xff; PersistentState::LEN]; 2];
    for drive in 0..3 {
        let mut estimator = begin(&slots)?;
        climb(&mut estimator);
        let scale = estimator.live().map(|live| live.estimate.scale);
        if let Some(scale) = scale {
            let (value, sigma) = (scale.value, scale.sigma);
            println!("drive {drive}: scale of the traction {value:.3} (sigma {sigma:.3})");
        }
        // The ignition goes off.
        if let Some(state) = estimator.persistent_state() {
            slots[drive % 2] = state.to_bytes();
        }
    }
    Ok(())
}

/// Begins with the slot that can be used and knows most; without one, with the parameters alone.
fn begin(slots: &[Slot; 2]) -> Result<Estimator<f32>, ParameterError> {
    let states = slots
        .iter()
        .filter_map(|slot| PersistentState::from_bytes(slot).ok());
    let best = states.min_by(|a, b| {
        let variance = |state: &PersistentState| state.slow_states().scale.variance;
        variance(a).total_cmp(&variance(b))
    });
    if let Some(state) = best
        && let Ok(estimator) = Estimator::restore(truck(), Tuning::default(), &state)
    {
        return Ok(estimator);
    }
    Estimator::new(truck(), Tuning::default())
}

/// The parameters say 10 % too little drag and rolling resistance.
fn truck() -> VehicleParameters {
    VehicleParameters {
        mass_kg: 19_000.0,
        drag_area_m2: 4.7,
        rolling_resistance: 0.0072,
        wheel_radius_m: 0.48,
        wheel_inertia_kgm2: 60.0,
        traction: Traction::Force,
    }
}

/// Drives 10 km of long hills at 20 m/s.
fn climb(estimator: &mut Estimator<f32>) {
    for tenth in 0..5_000_u32 {
        let now = Instant::from_micros(u64::from(tenth) * 100_000);
        let phase = 2.0 * tenth as f32 / 300.0;
        let force_n =
            19_000.0 * 9.81 * (0.03 * phase.sin() + 0.008) + 0.5 * 1.2 * 5.2 * 20.0 * 20.0;
        let altitude_m = 400.0 + 9.0 * (1.0 - phase.cos());
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
            while estimator.next_cell().is_some() {}
        }
    }
}
