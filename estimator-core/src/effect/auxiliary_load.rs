//! Power that does not get to the wheels.

use super::{Acts, Bounds, Effect};

/// Speed below which the force of a power grows no more, m/s: torque is limited.
const SLOWEST_MPS: f32 = 2.0;

/// F = a / v, and of it the part at which the fan runs where that is told.
pub static EFFECT: Effect = Effect {
    name: "auxiliary_load",
    unit: "W",
    about: "Fan, compressor, alternator, steering or cooling take this power from the driveline; with a fan signal (SPN 975), at full speed of the fan.",
    source: "VECTO long haul: 4 to 6 kW all in all; a fan engaged takes 15 to 30 kW",
    typical: 10_000.0,
    range: Bounds::new(-50_000.0, 200_000.0, "-50000 to 200000 W"),
    details: &[],
    acts: Acts::Resists,
    physics: |_, sample, _, amount| {
        if !sample.circumstances.engaged {
            return 0.0;
        }
        let part = sample
            .circumstances
            .fan_percent
            .get()
            .map_or(1.0, |percent| 0.01 * percent);
        amount * part / sample.place.speed_mps.max(SLOWEST_MPS)
    },
};
