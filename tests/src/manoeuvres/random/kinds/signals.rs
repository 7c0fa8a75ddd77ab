//! What is wrong with signals.

use super::place::{km, onset};
use crate::manoeuvres::drives::Plan;
use crate::manoeuvres::parts::add_edit;
use crate::manoeuvres::signals::Edit;
use crate::manoeuvres::truth::When;
use rand::RngExt;
use rand_chacha::ChaCha8Rng;

/// Draws such a fault.
pub fn torque(plan: &mut Plan, rng: &mut ChaCha8Rng) -> Option<String> {
    let size: f64 = rng.random_range(0.5..4.0);
    let (edit, name) = match rng.random_range(0..6) {
        0 => (Edit::TorqueEvery(size), "every"),
        1 => (Edit::TorqueHeld(size), "held for"),
        2 => (Edit::TorqueLowPass(0.5 * size), "low-passed over half of"),
        3 => (Edit::TorqueLate(size), "late by"),
        4 => {
            let (part, seed) = (0.02 * size, rng.random());
            (
                Edit::TorqueWander(part, rng.random_range(10.0..100.0), seed),
                "wandering with 2 % of",
            )
        }
        _ => (Edit::TorqueSteps(size), "in steps of % as"),
    };
    add_edit(plan, When::Always, edit);
    Some(format!("torque {name} {size:.1} s"))
}

/// Draws such a fault.
pub fn speed(plan: &mut Plan, rng: &mut ChaCha8Rng) -> Option<String> {
    let (edit, name) = match rng.random_range(0..3) {
        0 => {
            let factor = rng.random_range(0.9_f32..1.1);
            (Edit::SpeedFactor(factor), format!("x{factor:.2}"))
        }
        1 => {
            let step = rng.random_range(0.05_f32..0.4);
            (Edit::SpeedSteps(step), format!("in steps of {step:.2} m/s"))
        }
        _ => {
            let time_s = rng.random_range(0.3_f64..2.0);
            (
                Edit::SpeedLowPass(time_s),
                format!("low-passed {time_s:.1} s"),
            )
        }
    };
    let (when, place) = if rng.random_bool(0.5) {
        (When::Always, String::new())
    } else {
        let from_m = onset(rng);
        let to_m = from_m + rng.random_range(500.0..8_000.0);
        (When::Way(from_m, to_m), format!(" at {}", km(from_m)))
    };
    add_edit(plan, when, edit);
    Some(format!("speed {name}{place}"))
}

/// Draws such a fault.
pub fn altitude(plan: &mut Plan, rng: &mut ChaCha8Rng) -> Option<String> {
    let time_s = rng.random_range(3.0_f64..30.0);
    add_edit(plan, When::Always, Edit::AltitudeLowPass(time_s));
    Some(format!("altitude low-passed {time_s:.0} s"))
}

/// Draws such a fault.
pub fn drift(plan: &mut Plan, rng: &mut ChaCha8Rng) -> Option<String> {
    let (from_m, length_m) = (onset(rng), rng.random_range(1_000.0_f64..10_000.0));
    let metres = rng.random_range(-25.0_f64..25.0).round();
    plan.ramps.push((from_m, from_m + length_m, metres));
    plan.faults.push(When::Way(from_m, from_m + length_m));
    Some(format!("drift of {metres:+} m at {}", km(from_m)))
}

/// Draws such a fault.
pub fn multipath(plan: &mut Plan, rng: &mut ChaCha8Rng) -> Option<String> {
    let from_m = onset(rng);
    let mut to_m = from_m;
    for _ in 0..rng.random_range(2..8) {
        let length_m = rng.random_range(50.0..600.0);
        plan.steps
            .push((to_m, to_m + length_m, rng.random_range(-20.0..20.0)));
        to_m += length_m + rng.random_range(50.0..500.0);
    }
    plan.faults.push(When::Way(from_m, to_m));
    Some(format!("multipath at {}", km(from_m)))
}

/// Draws such a fault.
pub fn late_receiver(plan: &mut Plan, rng: &mut ChaCha8Rng) -> Option<String> {
    let late_s = rng.random_range(0.5_f64..4.0);
    plan.gnss_late_s = Some(late_s);
    plan.faults.push(When::Always);
    Some(format!("GNSS {late_s:.1} s late"))
}

/// Draws such a fault.
pub fn tunnel(plan: &mut Plan, rng: &mut ChaCha8Rng) -> Option<String> {
    let (from_m, length_m) = (onset(rng), rng.random_range(500.0_f64..6_000.0));
    plan.outages.push((from_m, from_m + length_m));
    plan.faults.push(When::Way(from_m, from_m + length_m));
    Some(format!("tunnel of {} at {}", km(length_m), km(from_m)))
}

/// Draws such a fault.
pub fn silence(plan: &mut Plan, rng: &mut ChaCha8Rng) -> Option<String> {
    let (from_m, seconds) = (onset(rng), rng.random_range(1.0_f64..40.0));
    add_edit(plan, When::Seconds(from_m, seconds), Edit::Silence);
    Some(format!("silence of {seconds:.0} s at {}", km(from_m)))
}

/// Draws such a fault.
pub fn wrong_gear(plan: &mut Plan, rng: &mut ChaCha8Rng) -> Option<String> {
    let (from_m, seconds) = (onset(rng), rng.random_range(20.0_f64..400.0).round());
    let off = [-2, -1, 1][rng.random_range(0..3)];
    if rng.random_bool(0.7) {
        plan.edits.push((When::Always, Edit::RatioUntold));
    }
    add_edit(plan, When::Seconds(from_m, seconds), Edit::GearOff(off));
    Some(format!("gear {off:+} for {seconds} s at {}", km(from_m)))
}

/// Draws such a fault.
pub fn slip(plan: &mut Plan, rng: &mut ChaCha8Rng) -> Option<String> {
    let (from_m, part) = (onset(rng), rng.random_range(0.03_f32..0.15));
    let to_m = from_m + rng.random_range(300.0..2_000.0);
    add_edit(plan, When::Way(from_m, to_m), Edit::Slip(part));
    Some(format!("slip of {:.0} % at {}", 100.0 * part, km(from_m)))
}
