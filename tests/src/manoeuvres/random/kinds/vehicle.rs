//! What happens to the vehicle.

use super::place::{km, onset};
use crate::manoeuvres::drives::Plan;
use crate::manoeuvres::parts::{
    END_M, add_load_change, add_section, add_stop, masses_kg, retarder,
};
use crate::manoeuvres::road::Profile;
use crate::manoeuvres::signals::Edit;
use crate::manoeuvres::truth::When;
use host_sim::simulator::manoeuvre_file::{Section, Stop};
use rand::RngExt;
use rand_chacha::ChaCha8Rng;

/// Way on which a truck slows down before a low range, m.
const SLOWING_M: f64 = 600.0;
/// Least way between stops, m.
const BETWEEN_STOPS_M: f64 = 1_500.0;
/// Least way between other profiles, m.
const BETWEEN_PROFILES_M: f64 = 4_000.0;

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

/// Draws such a manoeuvre.
pub fn reversing(plan: &mut Plan, rng: &mut ChaCha8Rng) -> Option<String> {
    let (at_m, reverse_m) = (onset(rng), rng.random_range(10.0_f64..120.0).round());
    let halt = Stop {
        reverse_m,
        ..Stop::new(at_m, rng.random_range(10.0..200.0))
    };
    stop(plan, halt, None)?;
    let told = if rng.random_bool(0.3) {
        plan.edits.push((When::Always, Edit::ReverseUntold));
        ", gear not told"
    } else {
        ""
    };
    Some(format!("reverses {reverse_m} m{told} at {}", km(at_m)))
}

/// Draws such a manoeuvre.
pub fn load_change(plan: &mut Plan, rng: &mut ChaCha8Rng) -> Option<String> {
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

/// Draws such a manoeuvre.
pub fn ferry(plan: &mut Plan, rng: &mut ChaCha8Rng) -> Option<String> {
    let (at_m, carried_m) = (onset(rng), rng.random_range(500.0_f64..4_000.0).round());
    let halt = Stop {
        carried_m,
        ..Stop::new(at_m, rng.random_range(300.0..1_200.0))
    };
    stop(plan, halt, None)?;
    Some(format!("ferry of {carried_m} m at {}", km(at_m)))
}

/// Draws such a manoeuvre.
pub fn untold_brakes(plan: &mut Plan, rng: &mut ChaCha8Rng) -> Option<String> {
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

/// Draws such a manoeuvre.
pub fn crest(plan: &mut Plan, rng: &mut ChaCha8Rng) -> Option<String> {
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

/// Draws such a manoeuvre.
pub fn low_range(plan: &mut Plan, rng: &mut ChaCha8Rng) -> Option<String> {
    let (from_m, ratio) = (onset(rng), rng.random_range(1.5_f64..4.0));
    let length_m = rng.random_range(2_000.0_f64..5_000.0);
    let slow = Section {
        set_speed_mps: Some(22.2 / ratio),
        ..Section::new(from_m - SLOWING_M, from_m + length_m)
    };
    plan.sections.push(slow);
    let section = Section {
        range_ratio: ratio,
        ..Section::new(from_m, from_m + length_m)
    };
    add_section(plan, section);
    Some(format!("low range {ratio:.1} at {}", km(from_m)))
}

/// Draws such a manoeuvre.
pub fn power_take_off(plan: &mut Plan, rng: &mut ChaCha8Rng) -> Option<String> {
    let (from_m, pto_nm) = (onset(rng), rng.random_range(80.0_f64..400.0).round());
    let to_m = from_m + rng.random_range(3_000.0..20_000.0);
    let section = Section {
        pto_nm,
        ..Section::new(from_m, to_m)
    };
    add_section(plan, section);
    Some(format!("take-off of {pto_nm} Nm at {}", km(from_m)))
}

/// Draws such a manoeuvre.
pub fn wind(plan: &mut Plan, rng: &mut ChaCha8Rng) -> Option<String> {
    let (speed_mps, gust_mps) = (
        rng.random_range(2.0_f64..12.0),
        rng.random_range(0.5_f64..2.5),
    );
    plan.wind = (speed_mps, gust_mps, rng.random_range(10.0_f64..90.0));
    plan.faults.push(When::Always);
    Some(format!("gusts {gust_mps:.1} in {speed_mps:.0} m/s"))
}

/// Draws such a manoeuvre.
pub fn surface(plan: &mut Plan, rng: &mut ChaCha8Rng) -> Option<String> {
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
