//! How samples become cells: the force balance, and the base variances of its parts.

use super::cell_input::{CellInput, Marks, Reading};
use crate::cell::CELL_LENGTH_M;
use crate::context::Context;
use crate::filter::EffectUncertainty;
use crate::sample::{AltitudeContinuity, Sample};
use crate::scalar::Scalar;
use crate::tuning::Numbers;
use crate::vehicle::Traction;

/// What earlier cells leave for the next one.
#[derive(Clone, Debug)]
pub struct VehicleCells {
    effects: EffectUncertainty,
    has_begun: bool,
    energy_before: f32,
    net_traction_percent: f32,
    retarder_percent: f32,
    since_stop_m: f32,
    origin_m: Option<f32>,
}

impl Default for VehicleCells {
    fn default() -> Self {
        Self {
            effects: EffectUncertainty::new(),
            has_begun: false,
            energy_before: 0.0,
            net_traction_percent: 0.0,
            retarder_percent: 0.0,
            since_stop_m: f32::INFINITY,
            origin_m: None,
        }
    }
}

/// A rest of the torque that ended in a cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EndedRest {
    /// Its duration, s.
    pub duration_s: f32,
    /// Sigma of the force meanwhile, as a slope, %.
    pub percent: f32,
}

impl EndedRest {
    /// Returns the rest that ended in the cell of a sample; `None` if none did, or if the torque rested
    /// at a limit, where it was known.
    #[must_use]
    pub fn of(numbers: &Numbers, sample: &Sample) -> Option<Self> {
        let rest = &sample.torque_rest;
        if rest.ended_s <= 0.0 || rest.ended_at_limit {
            return None;
        }
        let walk_n = walk_n(numbers, rest.ended_s, rest.per_percent_n);
        let sigma_n = Scalar::sqrt(square(rest.jump_n) + square(walk_n));
        Some(Self {
            duration_s: rest.ended_s,
            percent: 100.0 * sigma_n / sample.forces.weight_n(),
        })
    }

    /// Marks the cells over which the torque rested, of which the newest one is the last.
    pub fn mark(&self, cells: &mut [CellInput]) {
        let mut left_s = self.duration_s;
        for cell in cells.iter_mut().rev() {
            cell.rest_percent = Scalar::max(cell.rest_percent, self.percent);
            left_s -= cell.duration_s;
            if left_s < 0.0 {
                cell.marks.rest_begins = true;
                return;
            }
        }
    }
}

/// Returns by how much a torque may be off that is not renewed, N.
fn walk_n(numbers: &Numbers, rest_s: f32, per_percent_n: f32) -> f32 {
    if rest_s > numbers.rest_long_s {
        numbers.rest_walk_percent * Scalar::sqrt(rest_s) * per_percent_n
    } else {
        0.0
    }
}

/// The forces of a cell, as slopes.
struct Forces<'a> {
    numbers: &'a Numbers,
    context: &'a Context,
    sample: &'a Sample,
    weight_n: f32,
    drag_n: f32,
}

impl VehicleCells {
    /// Returns the altitude from which those of the cells count, m; `None` before the first.
    #[must_use]
    pub const fn origin_m(&self) -> Option<f32> {
        self.origin_m
    }

    /// Returns the cell of a sample; `None` before the first speed.
    pub fn next(
        &mut self,
        numbers: &Numbers,
        context: &Context,
        sample: &Sample,
    ) -> Option<CellInput> {
        let begins = !self.has_begun;
        if begins && sample.speed.is_none() {
            return None;
        }
        self.has_begun = true;
        let gap = begins || sample.gap_cells > 0;
        let effects = self.effects.advance(context, sample);
        let forces = &Forces::new(numbers, context, sample);
        let marks = forces.marks(gap);
        let before_percent = self.net_traction_percent;
        if sample.after_stop {
            self.net_traction_percent = 0.0;
        } else if !marks.invalid {
            self.net_traction_percent = forces.percent(sample.forces.traction_n - forces.drag_n);
        }
        let launches = self.launches(numbers, sample, gap);
        let traction_jump_percent = if (launches || sample.after_stop) && !gap {
            self.net_traction_percent - before_percent
        } else {
            0.0
        };
        let retarder_percent = forces.percent(sample.retarder_n);
        let retarder_before = core::mem::replace(&mut self.retarder_percent, retarder_percent);
        let retarder_step_percent = if gap {
            0.0
        } else {
            retarder_percent - retarder_before
        };
        let (force_variance, fixed_force_variance) =
            forces.variances(&marks, traction_jump_percent, retarder_step_percent);
        let balance = context.model.vehicle.force_balance(&sample.forces);
        let drag = balance.drag * CELL_LENGTH_M;
        let braking_n = effects.force_n + sample.retarder_n;
        let braking = braking_n / sample.forces.accelerated_kg();
        let mps = sample.end.speed_mps;
        Some(CellInput {
            duration_s: sample.duration_s,
            speed_mps: mps,
            // exp(-drag) to second order.
            keep_energy: 1.0 - drag * (1.0 - 0.5 * drag),
            work: (balance.traction - balance.rolling - braking) * CELL_LENGTH_M,
            gravity: balance.gravity * CELL_LENGTH_M,
            net_traction_percent: self.net_traction_percent,
            traction_jump_percent,
            retarder_percent,
            retarder_step_percent,
            force_variance,
            fixed_force_variance,
            bias_variance: forces.bias_variance(),
            effect_variance: effects.bias_variance,
            wind_variance: forces.wind_variance(),
            energy: speed(numbers, sample),
            energy_per_slip: mps * mps * 0.01 * forces.percent(sample.forces.traction_n),
            altitude: self.altitude(numbers, sample),
            rest_percent: forces.resting_percent(),
            marks,
        })
    }

    /// Follows launches: for some distance behind a stop, what the traction changes while the vehicle
    /// gains speed is the driver's, and no answer to the road.
    fn launches(&mut self, numbers: &Numbers, sample: &Sample, gap: bool) -> bool {
        let mps = sample.end.speed_mps;
        let energy = 0.5 * mps * mps;
        let before = core::mem::replace(&mut self.energy_before, energy);
        if sample.duration_s > numbers.launch_stop_s {
            self.since_stop_m = 0.0;
        }
        let launches = !gap
            && self.since_stop_m < numbers.launch_length_m
            && energy - before > numbers.launch_mps2 * CELL_LENGTH_M;
        self.since_stop_m += CELL_LENGTH_M;
        launches
    }

    fn altitude(&mut self, numbers: &Numbers, sample: &Sample) -> Reading {
        let Some(altitude) = &sample.altitude else {
            return Reading::NONE;
        };
        let origin_m = *self.origin_m.get_or_insert(altitude.altitude_m);
        Reading {
            value: altitude.altitude_m - origin_m,
            behind_m: altitude.behind_m,
            variance: square(numbers.altitude_noise_m * altitude.dilution),
        }
    }
}

impl<'a> Forces<'a> {
    fn new(numbers: &'a Numbers, context: &'a Context, sample: &'a Sample) -> Self {
        let vehicle = &context.model.vehicle;
        Self {
            numbers,
            context,
            sample,
            weight_n: sample.forces.weight_n(),
            drag_n: vehicle.drag_n(&sample.forces, sample.end.speed_mps),
        }
    }

    fn percent(&self, force_n: f32) -> f32 {
        100.0 * force_n / self.weight_n
    }

    fn marks(&self, gap: bool) -> Marks {
        let sample = self.sample;
        let condition = sample.end.condition;
        let continuity = sample.altitude.map(|altitude| altitude.continuity);
        let traction_percent = self.percent(sample.forces.traction_n);
        Marks {
            invalid: condition.shifting || sample.service_braking || condition.no_traction,
            overrun: self.context.model.vehicle.traction != Traction::Force
                && traction_percent < self.numbers.overrun_percent,
            rest_begins: false,
            load_stop: sample.after_stop && !gap,
            gap,
            receiver_switched: continuity
                .is_some_and(|continuity| continuity != AltitudeContinuity::Followed),
            crawling: condition.crawling,
        }
    }

    /// Returns the variance of the force that its level multiplies, and the rest, %².
    fn variances(
        &self,
        marks: &Marks,
        traction_jump_percent: f32,
        retarder_step_percent: f32,
    ) -> (f32, f32) {
        let numbers = self.numbers;
        if marks.invalid {
            return (0.0, square(numbers.invalid_noise_percent));
        }
        let forces = &self.sample.forces;
        // In low gears most of the torque turns the engine itself.
        let turning_n = forces.traction_n * forces.rotating_kg / forces.accelerated_kg();
        let fixed = square(numbers.inertia_noise * self.percent(turning_n))
            + square(numbers.jump_noise * traction_jump_percent)
            + square(numbers.retarder_step_noise * retarder_step_percent);
        (square(self.percent(numbers.force_noise_n)), fixed)
    }

    /// Returns the sigma of the force of a torque that may be stuck, %.
    fn resting_percent(&self) -> f32 {
        let rest = &self.sample.torque_rest;
        if rest.rests_at_limit {
            return 0.0;
        }
        self.percent(walk_n(self.numbers, rest.resting_s, rest.per_percent_n))
    }

    /// Auxiliaries and steady wind are forces, which weigh less on a heavy vehicle. Errors of tyres and
    /// shape are proportional to their resistance.
    fn bias_variance(&self) -> f32 {
        let numbers = self.numbers;
        let rolling = 100.0 * self.context.model.vehicle.rolling_resistance;
        square(self.percent(numbers.bias_force_n))
            + square(numbers.bias_rolling * rolling)
            + square(numbers.bias_drag * self.percent(self.drag_n))
    }

    /// Changing wind, by the derivative of thesis eq. 5 with respect to the speed, and torque that is
    /// off by some per cent for some kilometres.
    fn wind_variance(&self) -> f32 {
        let (numbers, sample) = (self.numbers, self.sample);
        let drag_area_m2 = self.context.model.vehicle.drag_area_m2;
        let per_mps_n = drag_area_m2 * sample.forces.air_density * sample.end.speed_mps;
        square(numbers.wind_noise_mps * self.percent(per_mps_n))
            + square(numbers.traction_noise * self.percent(sample.forces.traction_n))
    }
}

const fn square(number: f32) -> f32 {
    number * number
}

fn speed(numbers: &Numbers, sample: &Sample) -> Reading {
    let Some(speed) = &sample.speed else {
        return Reading::NONE;
    };
    let mps = speed.mean_mps;
    let sigma = if sample.end.condition.crawling {
        numbers.crawl_speed_noise_mps
    } else {
        numbers.speed_noise_mps
    };
    let variance = sigma * sigma;
    // Steps are the same for all readings of a cell: their mean is no better than one of them.
    let step = speed.resolution_mps * speed.resolution_mps / 12.0;
    let count = f32::from(speed.count.max(1));
    Reading {
        value: 0.5 * mps * mps,
        behind_m: speed.behind_m,
        // d(v²/2) = v dv, and dv²/2 where v is no larger than its noise.
        variance: mps * mps * (variance / count + step) + 0.5 * variance * variance,
    }
}
