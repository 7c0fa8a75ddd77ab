//! What can be drawn.

mod place;
mod signals;
mod vehicle;

use crate::manoeuvres::drives::Plan;
use rand_chacha::ChaCha8Rng;
use signals::{
    altitude, drift, late_receiver, multipath, silence, slip, speed, torque, tunnel, wrong_gear,
};
use vehicle::{
    crest, ferry, load_change, low_range, power_take_off, reversing, surface, untold_brakes, wind,
};

/// Adds a manoeuvre to a plan, and returns its name; `None` if there is no room for it.
type Draw = fn(&mut Plan, &mut ChaCha8Rng) -> Option<String>;

/// What can be drawn.
pub const KINDS: &[Draw] = &[
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
