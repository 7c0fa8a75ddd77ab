//! How a diagnosis searches each effect of the core's catalogue: one table, by the name of the
//! effect, and nothing else in this room knows an effect by its name. An effect that has no line here
//! is searched as one amount with its details at their defaults.

use estimator_core::effect::Effect;

/// How one effect is searched.
#[derive(Clone, Copy, Debug)]
pub struct HowSearched {
    /// What is fitted, and what is chosen from.
    pub amounts: Amounts,
    /// Whether it is a wrong parameter of the base model: preferred where the evidence is equal.
    pub is_base_parameter: bool,
    /// Data that would tell it from other effects.
    pub told_apart_by: Option<&'static str>,
}

/// The amounts of an effect that are fitted, and what is chosen from.
#[derive(Clone, Copy, Debug)]
pub enum Amounts {
    /// One amount, all details at their defaults.
    One,
    /// One amount for each of these values of a detail, the first of the effect; the best is taken.
    OneForEachValue {
        /// Key of the detail.
        key: &'static str,
        /// Values that are tried.
        values: &'static [f32],
    },
    /// As [`Amounts::OneForEachValue`], with an amount for each drive that is fitted. What is adopted
    /// is their mean, not below zero, with a sigma that holds their scatter too.
    OneForEachDrive {
        /// Key of the detail.
        key: &'static str,
        /// Values that are tried.
        values: &'static [f32],
    },
    /// Two amounts, towards north and east, that become a size and a direction, which is a detail in
    /// degrees, the first of the effect.
    NorthAndEast {
        /// Key of the detail.
        key: &'static str,
    },
    /// One amount on each part of the road that the drives share; the middle and the length of the
    /// part become details.
    OnPartOfRoad {
        /// Key of the latitude of the middle, degrees.
        latitude_key: &'static str,
        /// Key of the longitude of the middle, degrees.
        longitude_key: &'static str,
        /// Key of the length, m.
        length_key: &'static str,
    },
    /// Not from forces: from GNSS speed against wheel speed ([`super::radius`]).
    FromGnssSpeed,
}

/// Times in which tyres warm up that are tried, s.
const WARMUP_TIMES_S: [f32; 4] = [600.0, 1_000.0, 1_700.0, 2_800.0];
/// Power that is always there, and that goes with the fan.
const WITHOUT_AND_WITH_FAN: [f32; 2] = [0.0, 1.0];

/// How this effect is searched.
#[must_use]
pub fn how_searched(effect: &Effect) -> HowSearched {
    by_name(effect.name)
}

/// What data would tell an effect from others.
#[must_use]
pub fn told_apart_by(name: &str) -> Option<&'static str> {
    by_name(name).told_apart_by
}

fn by_name(name: &str) -> HowSearched {
    let (amounts, is_base_parameter, told_apart_by) = match name {
        "rolling_resistance" => (
            Amounts::One,
            true,
            "drives with another load: rolling resistance goes with the weight, a dragging brake does not",
        ),
        "tyre_warmup" => (
            Amounts::OneForEachDrive {
                key: "time_s",
                values: &WARMUP_TIMES_S,
            },
            false,
            "drives that begin warm: tyres are warm after half an hour",
        ),
        "air_drag" => (
            Amounts::One,
            true,
            "drives at other speeds: air resistance goes with the square of the speed",
        ),
        "headwind" => (
            Amounts::NorthAndEast { key: "from_deg" },
            false,
            "drives both ways, or on other days: wind turns with the course",
        ),
        "cornering" => (Amounts::One, false, "straight roads"),
        "driveline_loss" => (
            Amounts::One,
            false,
            "engine braking and long descents: losses brake there too, a torque scale drives",
        ),
        "auxiliary_load" => (
            Amounts::OneForEachValue {
                key: "with_fan",
                values: &WITHOUT_AND_WITH_FAN,
            },
            false,
            "drives at other speeds, and coasting with an open driveline: the force of a power goes down with speed",
        ),
        "mass" => (
            Amounts::One,
            true,
            "coasting, and speeding up: mass takes part in both, torque in neither or only one",
        ),
        "torque_scale" => (
            Amounts::One,
            true,
            "coasting in neutral, where no torque acts, and engine braking",
        ),
        "wheel_radius" => (Amounts::FromGnssSpeed, false, "GNSS speed"),
        "brake_drag" => (
            Amounts::One,
            false,
            "drives with another load: rolling resistance goes with the weight, a dragging brake does not",
        ),
        "road_surface" => (
            Amounts::OnPartOfRoad {
                latitude_key: "latitude_deg",
                longitude_key: "longitude_deg",
                length_key: "length_m",
            },
            false,
            "drives over other roads, and both ways over this one",
        ),
        _ => {
            return HowSearched {
                amounts: Amounts::One,
                is_base_parameter: false,
                told_apart_by: None,
            };
        }
    };
    HowSearched {
        amounts,
        is_base_parameter,
        told_apart_by: Some(told_apart_by),
    }
}
