//! The planted effects of one drive: the forces of [`PlantedTable`], step by step.

use super::planted_file::{PlantedTable, ResistanceSection};
use super::random::{Purpose, stream};
use super::truck::{GRAVITY, Truck};
use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use std::f64::consts::PI;
use std::ops::Range;

/// Part of the time that the fan is on.
const FAN_SHARE: f64 = 0.4;
/// Time that the fan stays on or off, as a part of the mean.
const FAN_SPREAD: Range<f64> = 0.3..1.7;

/// Air temperature that coefficients of rolling resistance refer to, °C (ISO 28580).
const TYRES_CELSIUS: f64 = 25.0;

/// The position of the vehicle on the road, for effects of road and tyres.
#[derive(Clone, Copy, Debug)]
pub struct ContactPoint {
    /// Distance along the road in its forward direction, m.
    pub stored_m: f64,
    /// True if it is driven in that direction.
    pub forward: bool,
    /// Change of course with distance, rad/m.
    pub curvature_per_m: f64,
}

/// The effects of one drive.
#[derive(Clone, Debug)]
pub struct PlantedEffects {
    table: PlantedTable,
    fan: Fan,
    /// Air temperature below [`TYRES_CELSIUS`], K.
    colder_k: f64,
    /// Torque at the driveline after hysteresis, Nm.
    followed_nm: f64,
    thermostat_on: bool,
}

/// A fan with its own controller.
#[derive(Clone, Debug)]
struct Fan {
    on: bool,
    /// Time until it switches, s.
    left_s: f64,
    rng: ChaCha8Rng,
}

impl Fan {
    /// Starts at a random time of its cycle.
    fn new(period_s: f64, mut rng: ChaCha8Rng) -> Self {
        let on = rng.random_bool(FAN_SHARE);
        let mut fan = Self {
            on,
            left_s: 0.0,
            rng,
        };
        fan.left_s = fan.draw_s(period_s) * fan.rng.random_range(0.0..1.0);
        fan
    }

    fn draw_s(&mut self, period_s: f64) -> f64 {
        let share = if self.on { FAN_SHARE } else { 1.0 - FAN_SHARE };
        period_s * share * self.rng.random_range(FAN_SPREAD)
    }

    fn advance(&mut self, period_s: f64, step_s: f64) {
        self.left_s -= step_s;
        if self.left_s <= 0.0 {
            self.on = !self.on;
            self.left_s += self.draw_s(period_s);
        }
    }
}

impl PlantedEffects {
    /// Creates the effects of run `index` of the scenario with this `seed`, in air of this
    /// temperature.
    #[must_use]
    pub fn new(table: &PlantedTable, seed: u64, index: usize, air_celsius: f64) -> Self {
        Self {
            fan: Fan::new(table.fan_period_s, stream(seed, index, Purpose::Fan)),
            table: table.clone(),
            colder_k: TYRES_CELSIUS - air_celsius,
            followed_nm: 0.0,
            thermostat_on: false,
        }
    }

    /// Advances by `step_s`, to a time of the log clock.
    pub fn advance(&mut self, clock_s: f64, step_s: f64) {
        self.fan.advance(self.table.fan_period_s, step_s);
        let period_s = self.table.thermostat_period_s;
        self.thermostat_on = clock_s.rem_euclid(period_s) < 0.5 * period_s;
    }

    /// Returns the fan speed as SPN 975 reports it, %.
    #[must_use]
    pub fn fan_percent(&self) -> f64 {
        if self.table.fan_w > 0.0 && self.fan.on {
            100.0
        } else {
            0.0
        }
    }

    /// Returns the planted forces against the motion, outside the driveline, N.
    #[must_use]
    pub fn resistance_n(&self, truck: &Truck, place: ContactPoint, speed_mps: f64) -> f64 {
        let weight_n = truck.mass_kg * GRAVITY;
        let lateral = speed_mps * speed_mps * place.curvature_per_m / GRAVITY;
        let cornering = self.table.cornering_compliance_rad * lateral * lateral;
        let mut rolling = rolling_at(&self.table.rough, place.stored_m);
        if place.forward {
            rolling += rolling_at(&self.table.side_resistance, place.stored_m);
        }
        let cold = self.table.tyre_temperature_per_k * self.colder_k;
        weight_n * (cornering + rolling)
            + cold * truck.rolling_resistance_n()
            + self.table.brake_drag_n
    }

    /// Returns the force lost in the driveline, N, for a net engine torque `net_torque_nm` at
    /// `engine_rpm`, where each newton metre makes `per_torque` newtons. It is zero if the
    /// driveline is open.
    pub fn driveline_n(
        &mut self,
        truck: &Truck,
        net_torque_nm: f64,
        per_torque: f64,
        engine_rpm: f64,
    ) -> f64 {
        let play_nm = 0.01 * self.table.torque_hysteresis * truck.reference_torque_nm;
        self.followed_nm = self
            .followed_nm
            .clamp(net_torque_nm - play_nm, net_torque_nm + play_nm);
        if per_torque == 0.0 {
            return 0.0;
        }
        let lagging_nm = net_torque_nm - self.followed_nm;
        let auxiliary_nm = self.power_w() / (engine_rpm * (PI / 30.0));
        let traction_n = net_torque_nm * per_torque;
        (lagging_nm + auxiliary_nm) * per_torque + self.table.driveline_loss * traction_n.abs()
    }

    /// Returns the auxiliary power of the engine, W.
    fn power_w(&self) -> f64 {
        let while_on = |power_w: f64, on: bool| if on { power_w } else { 0.0 };
        self.table.auxiliary_w
            + while_on(self.table.fan_w, self.fan.on)
            + while_on(self.table.thermostat_w, self.thermostat_on)
    }
}

fn rolling_at(sections: &[ResistanceSection], stored_m: f64) -> f64 {
    sections
        .iter()
        .filter(|&&(from_m, to_m, _)| (from_m..to_m).contains(&stored_m))
        .map(|&(.., rolling)| rolling)
        .sum()
}
