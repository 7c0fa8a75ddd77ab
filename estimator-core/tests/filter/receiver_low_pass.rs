//! Altitudes whose low-pass is inverted.

use estimator_core::filter::VehicleCells;
use estimator_core::sample::AltitudeContinuity;
use estimator_core::{Context, Delay, Tuning};
use test_kit::{altitude, sample, speed, truck};

/// Two receivers have two datums: the rise from one to the other is no climb.
#[test]
fn no_altitude_is_inverted_across_two_receivers() {
    let context = Context::new(truck(), Tuning::default()).unwrap();
    let mut cells = VehicleCells::with_low_pass(Delay::Estimated {
        delay_s: 10.0,
        sigma_s: 0.0,
    });
    let (mut inverted, mut first_of_second) = (0, None);
    for cell in 0..800 {
        let mut sample = sample(cell, 4_000.0, 20.0);
        sample.speed = speed(20.0);
        if cell % 16 == 0 {
            let is_second = cell >= 400;
            sample.altitude = altitude(if is_second { 40.0 } else { 0.0 });
            if cell == 400 {
                sample.altitude.as_mut().unwrap().continuity = AltitudeContinuity::Switched;
            }
        }
        let cell_input = cells
            .next(&context.tuning.estimation, &context, &sample, None)
            .unwrap();
        if cell == 400 {
            first_of_second = Some(cell_input.altitude);
        } else if cell_input.altitude.is_some() {
            let datum_m = if cell > 400 { 40.0 } else { 0.0 };
            assert_eq!(cell_input.altitude.value, datum_m, "cell {cell}");
            inverted += 1;
        }
    }
    assert!(!first_of_second.unwrap().is_some());
    assert!(inverted > 40);
}
