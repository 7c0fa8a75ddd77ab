//! The keys that plant each effect in a scenario of the simulator.

/// An auxiliary load that switches on and off and is reported on the bus.
pub const FAN: &str = "fan";

/// Course of the generated road. A wind can blow along it.
pub const COURSE_DEG: f64 = 225.0;

/// An effect that the simulator can plant.
#[derive(Debug)]
pub struct Known {
    /// Its name.
    pub effect: &'static str,
    /// Initial amount of the search.
    pub first_amount: f64,
    /// Table of the scenario.
    pub table: &'static str,
    /// Returns the keys of that table for an amount and a seed.
    pub keys: fn(f64, u64) -> String,
    /// Whether there can be less of it than assumed.
    pub or_less: bool,
}

impl Known {
    /// Returns the effect as one of which there can be less than assumed.
    const fn or_less(mut self) -> Self {
        self.or_less = true;
        self
    }
}

const fn effect(
    effect: &'static str,
    first_amount: f64,
    table: &'static str,
    keys: fn(f64, u64) -> String,
) -> Known {
    Known {
        effect,
        first_amount,
        table,
        keys,
        or_less: false,
    }
}

const KNOWN: [Known; 17] = [
    effect("rolling_resistance", 0.1, "errors", |amount, _| {
        format!("rolling_factor = {:?}", 1.0 + amount)
    })
    .or_less(),
    effect("tyre_warmup", 0.2, "tyres", |amount, _| {
        format!("cold_amount = {amount:?}")
    }),
    effect("air_drag", 0.1, "errors", |amount, _| {
        format!("drag_factor = {:?}", 1.0 + amount)
    })
    .or_less(),
    effect("headwind", 1.0, "wind", |amount, seed| {
        // Within 40° of the road's course, or of the opposite.
        let turned_deg = if amount < 0.0 { 180.0 } else { 0.0 };
        let from_deg = (COURSE_DEG - 40.0 + spread(seed, 80.0) + turned_deg) % 360.0;
        format!("speed_mps = {:?}\nfrom_deg = {from_deg:?}", amount.abs())
    })
    .or_less(),
    effect("cornering", 0.1, "planted", |amount, _| {
        format!("cornering_compliance_rad = {amount:?}")
    }),
    effect("driveline_loss", 0.02, "planted", |amount, _| {
        format!("driveline_loss = {amount:?}")
    }),
    effect("auxiliary_load", 2_000.0, "planted", |amount, _| {
        format!("auxiliary_w = {amount:?}")
    }),
    effect("mass", 0.05, "errors", |amount, _| {
        format!("mass_factor = {:?}", 1.0 + amount)
    })
    .or_less(),
    effect("torque_scale", 0.02, "errors", |amount, _| {
        format!("torque_factor = {:?}", 1.0 + amount)
    })
    .or_less(),
    effect("wheel_radius", 0.01, "planted", |amount, _| {
        format!("wheel_radius_factor = {:?}", 1.0 + amount)
    })
    .or_less(),
    effect("brake_drag", 100.0, "planted", |amount, _| {
        format!("brake_drag_n = {amount:?}")
    }),
    effect("road_surface", 1e-3, "planted", |amount, seed| {
        stretch("rough", seed, 2_000.0, amount)
    })
    .or_less(),
    effect("tyre_temperature", 0.006, "planted", |amount, _| {
        format!("tyre_temperature_per_k = {amount:?}")
    })
    .or_less(),
    effect("torque_hysteresis", 1.0, "planted", |amount, _| {
        format!("torque_hysteresis = {amount:?}")
    }),
    effect("side_resistance", 1e-3, "planted", |amount, seed| {
        stretch("side_resistance", seed, 4_000.0, amount)
    })
    .or_less(),
    effect("thermostat", 2_000.0, "planted", |amount, seed| {
        let period_s = 60.0 + spread(seed, 90.0);
        format!("thermostat_w = {amount:?}\nthermostat_period_s = {period_s:?}")
    }),
    effect(FAN, 5_000.0, "planted", |amount, _| {
        format!("fan_w = {amount:?}")
    }),
];

/// Returns a stretch of the road, away from its ends.
fn stretch(key: &str, seed: u64, length_m: f64, amount: f64) -> String {
    let from_m = 3_000.0 + spread(seed, 14_000.0 - length_m);
    format!(
        "{key} = [[{from_m:?}, {:?}, {amount:?}]]",
        from_m + length_m
    )
}

/// Returns a value from 0 to `span` for each seed. Steps of the golden ratio spread them evenly.
fn spread(seed: u64, span: f64) -> f64 {
    let part = seed as f64 * 0.618_033_988_75;
    (span * part.fract()).round()
}

/// Returns the effect of that name.
#[must_use]
pub fn known(effect: &str) -> Option<&'static Known> {
    KNOWN.iter().find(|known| known.effect == effect)
}
