//! The one trigonometric function that effects need, in single precision alone.
//!
//! A general cosine reduces its angle in double precision, which a controller has to emulate: eight
//! kilobytes of flash. Degrees reduce without an error: 360 is a number, 2π is none.

/// Cosine of an angle in degrees, to 2e-7.
#[inline(never)] // Several places call it.
#[must_use]
pub(crate) fn cos_deg(angle_deg: f32) -> f32 {
    let turns = (angle_deg / 360.0) as i32;
    let within_turn_deg = (angle_deg - 360.0 * turns as f32).abs();
    // cos x = cos(360° − x) = sin(90° − x): an angle from −90° to 90°.
    let other_way_deg = 360.0 - within_turn_deg;
    let short_way_deg = if other_way_deg < within_turn_deg {
        other_way_deg
    } else {
        within_turn_deg
    };
    let x = (90.0 - short_way_deg).to_radians();
    let y = x * x;
    // Taylor's series; the next term is (π/2)¹³/13!, 6e-8.
    let series = [
        -1.0 / 110.0,
        -1.0 / 72.0,
        -1.0 / 42.0,
        -1.0 / 20.0,
        -1.0 / 6.0,
    ];
    x * series
        .into_iter()
        .fold(1.0, |inner, factor| 1.0 + factor * y * inner)
}

#[cfg(test)]
mod tests {
    use super::cos_deg;

    #[test]
    fn it_is_the_cosine() {
        for tenths in -7_300..=7_300_i16 {
            let angle_deg = 0.1 * f32::from(tenths);
            let expected = libm::cos(f64::from(angle_deg).to_radians());
            let error = f64::from(cos_deg(angle_deg)) - expected;
            assert!(error.abs() < 2e-7, "{angle_deg}: off by {error}");
        }
    }

    #[test]
    fn of_no_number_it_is_none() {
        assert!(cos_deg(f32::NAN).is_nan());
        assert!(!cos_deg(f32::INFINITY).is_finite());
    }
}
