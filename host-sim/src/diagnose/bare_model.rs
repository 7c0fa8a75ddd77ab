//! The slope from the force balance alone, without GNSS and without a filter.

use estimator_core::vehicle::ForceBalance;

/// Returns the sine of the slope in % over `length_m`, between two kinetic energies per kilogram
/// (m²/s²). It is the force balance (thesis eq. 9) solved for the slope. `effects_mps2` is the
/// deceleration by adopted effects, m/s².
#[must_use]
pub fn slope_percent(
    balance: &ForceBalance,
    effects_mps2: f64,
    (from, to): (f64, f64),
    length_m: f64,
) -> f64 {
    let force = f64::from(balance.traction)
        - f64::from(balance.drag) * 0.5 * (from + to)
        - f64::from(balance.rolling)
        - effects_mps2
        - (to - from) / length_m;
    force / f64::from(balance.gravity)
}
