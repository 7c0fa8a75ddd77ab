//! Drives with two or three manoeuvres or faults at once, drawn at random.

use super::catalogue::{
    END_M, add_edit, add_load_change, add_section, add_stop, masses_kg, retarder,
};
use super::drives::{BenchTruck, Plan, When};
use super::road::Profile;
use super::signals::Edit;
use host_sim::simulator::manoeuvre_file::{Section, Stop};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::ops::Range;

/// Where manoeuvres begin, m.
const ONSETS_M: Range<f64> = 6_000.0..26_000.0;
/// Stretches of the road that drives are on.
const STRETCHES: Range<u64> = 1..5;
/// Least way between stops, m.
const BETWEEN_STOPS_M: f64 = 1_500.0;
/// Least way between other profiles, m.
const BETWEEN_PROFILES_M: f64 = 4_000.0;

/// What can be drawn.
const KINDS: &[fn(&mut Plan, &mut ChaCha8Rng) -> Option<String>] = &[
    reversing,
    load_change,
    ferry,
    untold_brakes,
    crest,
    wrong_gear,
    low_range,
    power_take_off,
    slip,
    torque,
    wind,
    surface,
    speed,
    altitude,
    drift,
    multipath,
    late_receiver,
    tunnel,
    silence,
];

/// Returns `count` drives; the same for the same seed.
#[must_use]
pub fn drawn(count: usize, seed: u64) -> Vec<Plan> {
    (0..count)
        .map(|index| {
            let mut rng = ChaCha8Rng::seed_from_u64(seed);
            rng.set_stream(index as u64);
            draw(&mut rng)
        })
        .collect()
}

fn draw(rng: &mut ChaCha8Rng) -> Plan {
    let truck = BenchTruck::ALL[rng.random_range(0..BenchTruck::ALL.len())];
    let mut plan = Plan::new("", truck, rng.random_range(STRETCHES));
    let wanted = rng.random_range(2..=3);
    let mut names: Vec<String> = Vec::new();
    let mut kinds = Vec::new();
    while names.len() < wanted {
        let kind = rng.random_range(0..KINDS.len());
        if kinds.contains(&kind) {
            continue;
        }
        if let Some(name) = KINDS[kind](&mut plan, rng) {
            names.push(name);
            kinds.push(kind);
        }
    }
    plan.name = names.join(" + ");
    plan
}

/// Returns a place and the name of a manoeuvre there.
fn onset(rng: &mut ChaCha8Rng) -> f64 {
    rng.random_range(ONSETS_M).round()
}

fn km(distance_m: f64) -> String {
    format!("km {:.1}", 1e-3 * distance_m)
}

/// Adds a stop in its place among the others; `None` if one is too near.
fn stop(plan: &mut Plan, stop: Stop, mass_kg: Option<f64>) -> Option<()> {
    // Stops are numbered in order, and a ferry skips the places behind it.
    let last = plan.stops.last();
    if last.is_some_and(|last| last.at_m + last.carried_m + BETWEEN_STOPS_M > stop.at_m) {
        return None;
    }
    match mass_kg {
        Some(mass_kg) => add_load_change(plan, stop, mass_kg),
        None => add_stop(plan, stop),
    }
    Some(())
}

fn profile(plan: &mut Plan, profile: Profile) -> Option<()> {
    let near = |other: &Profile| (other.from_m - profile.from_m).abs() < BETWEEN_PROFILES_M;
    if plan.profiles.iter().any(near) {
        return None;
    }
    plan.profiles.push(profile);
    Some(())
}

fn reversing(plan: &mut Plan, rng: &mut ChaCha8Rng) -> Option<String> {
    let (at_m, reverse_m) = (onset(rng), rng.random_range(10.0_f64..120.0).round());
    let halt = Stop {
        reverse_m,
        ..Stop::new(at_m, rng.random_range(10.0..200.0))
    };
    stop(plan, halt, None)?;
    Some(format!("reverses {reverse_m} m at {}", km(at_m)))
}

fn load_change(plan: &mut Plan, rng: &mut ChaCha8Rng) -> Option<String> {
    let (at_m, seconds) = (onset(rng), rng.random_range(15.0_f64..600.0).round());
    let (loaded_kg, empty_kg) = masses_kg(plan.truck);
    let mut load = || rng.random_range(empty_kg..loaded_kg).round();
    let (from_kg, to_kg) = (load(), load());
    stop(plan, Stop::new(at_m, seconds), Some(to_kg))?;
    plan.mass_kg = Some(from_kg);
    let tonnes = |kg: f64| 1e-3 * kg;
    Some(format!(
        "{:.0} to {:.0} t in {seconds} s at {}",
        tonnes(from_kg),
        tonnes(to_kg),
        km(at_m)
    ))
}

fn ferry(plan: &mut Plan, rng: &mut ChaCha8Rng) -> Option<String> {
    let (at_m, carried_m) = (onset(rng), rng.random_range(500.0_f64..4_000.0).round());
    let halt = Stop {
        carried_m,
        ..Stop::new(at_m, rng.random_range(300.0..1_200.0))
    };
    stop(plan, halt, None)?;
    Some(format!("ferry of {carried_m} m at {}", km(at_m)))
}

fn untold_brakes(plan: &mut Plan, rng: &mut ChaCha8Rng) -> Option<String> {
    let percent = rng.random_range(4.0_f64..8.0).round();
    let length_m = rng.random_range(800.0_f64..3_000.0).round();
    let from_m = onset(rng);
    profile(
        plan,
        Profile {
            from_m,
            corners: vec![(0.0, -percent), (length_m, -percent)],
        },
    )?;
    if rng.random_bool(0.5) {
        plan.sections.push(retarder());
    }
    plan.edits.push((When::Always, Edit::BrakesUntold));
    plan.faults.push(When::Way(from_m, from_m + length_m));
    Some(format!("brakes not told, {percent} % at {}", km(from_m)))
}

fn crest(plan: &mut Plan, rng: &mut ChaCha8Rng) -> Option<String> {
    let (from_m, percent) = (onset(rng), rng.random_range(10.0_f64..17.0).round());
    let half = 0.5 * percent;
    profile(
        plan,
        Profile {
            from_m,
            corners: vec![(0.0, half), (200.0, half), (600.0, -half), (800.0, -half)],
        },
    )?;
    plan.sections.push(retarder());
    plan.faults.push(When::Way(from_m, from_m + 800.0));
    Some(format!("crest of {percent} % at {}", km(from_m)))
}

fn wrong_gear(plan: &mut Plan, rng: &mut ChaCha8Rng) -> Option<String> {
    let (from_m, seconds) = (onset(rng), rng.random_range(20.0_f64..400.0).round());
    let off = if rng.random_bool(0.5) { 1 } else { -1 };
    add_edit(plan, When::Seconds(from_m, seconds), Edit::GearOff(off));
    Some(format!("gear {off:+} for {seconds} s at {}", km(from_m)))
}

fn low_range(plan: &mut Plan, rng: &mut ChaCha8Rng) -> Option<String> {
    let (from_m, ratio) = (onset(rng), rng.random_range(1.5_f64..4.0));
    let length_m = rng.random_range(2_000.0_f64..5_000.0);
    let section = Section {
        range_ratio: ratio,
        set_speed_mps: Some(22.2 / ratio),
        ..Section::new(from_m, from_m + length_m)
    };
    add_section(plan, section);
    Some(format!("low range {ratio:.1} at {}", km(from_m)))
}

fn power_take_off(plan: &mut Plan, rng: &mut ChaCha8Rng) -> Option<String> {
    let (from_m, pto_nm) = (onset(rng), rng.random_range(80.0_f64..400.0).round());
    let to_m = from_m + rng.random_range(3_000.0..20_000.0);
    let section = Section {
        pto_nm,
        ..Section::new(from_m, to_m)
    };
    add_section(plan, section);
    Some(format!("take-off of {pto_nm} Nm at {}", km(from_m)))
}

fn slip(plan: &mut Plan, rng: &mut ChaCha8Rng) -> Option<String> {
    let (from_m, part) = (onset(rng), rng.random_range(0.03_f32..0.15));
    let to_m = from_m + rng.random_range(300.0..2_000.0);
    add_edit(plan, When::Way(from_m, to_m), Edit::Slip(part));
    Some(format!("slip of {:.0} % at {}", 100.0 * part, km(from_m)))
}

fn torque(plan: &mut Plan, rng: &mut ChaCha8Rng) -> Option<String> {
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

fn wind(plan: &mut Plan, rng: &mut ChaCha8Rng) -> Option<String> {
    let (speed_mps, gust_mps) = (
        rng.random_range(2.0_f64..12.0),
        rng.random_range(0.5_f64..2.5),
    );
    plan.wind = (speed_mps, gust_mps, rng.random_range(10.0_f64..90.0));
    plan.faults.push(When::Always);
    Some(format!("gusts {gust_mps:.1} in {speed_mps:.0} m/s"))
}

fn surface(plan: &mut Plan, rng: &mut ChaCha8Rng) -> Option<String> {
    let (from_m, rolling_factor) = (onset(rng), rng.random_range(0.8_f64..3.0));
    let to_m = if rng.random_bool(0.5) {
        END_M
    } else {
        from_m + rng.random_range(1_000.0..10_000.0)
    };
    let section = Section {
        rolling_factor,
        ..Section::new(from_m, to_m)
    };
    add_section(plan, section);
    Some(format!("rolling x{rolling_factor:.1} at {}", km(from_m)))
}

fn speed(plan: &mut Plan, rng: &mut ChaCha8Rng) -> Option<String> {
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

fn altitude(plan: &mut Plan, rng: &mut ChaCha8Rng) -> Option<String> {
    let time_s = rng.random_range(3.0_f64..30.0);
    add_edit(plan, When::Always, Edit::AltitudeLowPass(time_s));
    Some(format!("altitude low-passed {time_s:.0} s"))
}

fn drift(plan: &mut Plan, rng: &mut ChaCha8Rng) -> Option<String> {
    let (from_m, length_m) = (onset(rng), rng.random_range(1_000.0_f64..10_000.0));
    let metres = rng.random_range(-25.0_f64..25.0).round();
    plan.ramps.push((from_m, from_m + length_m, metres));
    plan.faults.push(When::Way(from_m, from_m + length_m));
    Some(format!("drift of {metres:+} m at {}", km(from_m)))
}

fn multipath(plan: &mut Plan, rng: &mut ChaCha8Rng) -> Option<String> {
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

fn late_receiver(plan: &mut Plan, rng: &mut ChaCha8Rng) -> Option<String> {
    let late_s = rng.random_range(0.5_f64..4.0);
    plan.gnss_late_s = Some(late_s);
    plan.faults.push(When::Always);
    Some(format!("GNSS {late_s:.1} s late"))
}

fn tunnel(plan: &mut Plan, rng: &mut ChaCha8Rng) -> Option<String> {
    let (from_m, length_m) = (onset(rng), rng.random_range(500.0_f64..6_000.0));
    plan.outages.push((from_m, from_m + length_m));
    plan.faults.push(When::Way(from_m, from_m + length_m));
    Some(format!("tunnel of {} at {}", km(length_m), km(from_m)))
}

fn silence(plan: &mut Plan, rng: &mut ChaCha8Rng) -> Option<String> {
    let (from_m, seconds) = (onset(rng), rng.random_range(1.0_f64..40.0));
    add_edit(plan, When::Seconds(from_m, seconds), Edit::Silence);
    Some(format!("silence of {seconds:.0} s at {}", km(from_m)))
}
