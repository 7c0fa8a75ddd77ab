//! The slope that the force balance alone reads: no GNSS and no filter help it.

use estimator_core::vehicle::ForceBalance;

/// Returns sine of the slope in %, of the force balance (thesis eq. 9) solved for it, over
/// `length_m` between two kinetic energies a kilogram, m²/s²; `effects_mps2` is what adopted
/// effects take.
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
