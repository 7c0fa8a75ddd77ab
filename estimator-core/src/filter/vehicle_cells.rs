//! How samples become cells: the force balance, and the base variances of its parts.

use super::body_sensor::{BodySensor, NOTICED_CELLS};
use super::cell_input::{CellInput, Marks, Reading};
use super::doubt_behind::{DoubtBehind, walk_n};
use super::effect_uncertainty::EffectUncertainty;
use super::late_traction::{Lack, LateTraction};
use super::receiver_low_pass::ReceiverLowPass;
use super::slow_states::SlowStates;
use crate::cell::CELL_LENGTH_M;
use crate::context::Context;
use crate::delay::Delay;
use crate::sample::{AltitudeContinuity, Sample, SlopeSensor};
use crate::scalar::Scalar;
use crate::tuning::{Numbers, Tuning};
use crate::vehicle::{GRAVITY, Traction};

/// What earlier cells leave for the next one.
#[derive(Clone, Debug)]
pub struct VehicleCells {
    effects: EffectUncertainty,
    has_begun: bool,
    by_accelerometer: bool,
    /// That of force and accelerometer, where it begins.
    contradiction: Option<DoubtBehind>,
    energy_before: f32,
    net_traction_percent: f32,
    retarder_percent: f32,
    since_stop_m: f32,
    since_speed_m: f32,
    origin_m: Option<f32>,
    late_traction: LateTraction,
    accelerometer: BodySensor,
    pitch: BodySensor,
    low_pass: ReceiverLowPass,
}

impl Default for VehicleCells {
    fn default() -> Self {
        Self::new()
    }
}

impl VehicleCells {
    /// Creates what there is before the first cell.
    #[must_use]
    #[inline(always)] // See Estimator::new_in().
    pub fn new() -> Self {
        Self {
            effects: EffectUncertainty::new(),
            has_begun: false,
            by_accelerometer: false,
            contradiction: None,
            energy_before: 0.0,
            net_traction_percent: 0.0,
            retarder_percent: 0.0,
            since_stop_m: f32::INFINITY,
            since_speed_m: 0.0,
            origin_m: None,
            late_traction: LateTraction::new(),
            accelerometer: BodySensor::new(),
            pitch: BodySensor::new(),
            low_pass: ReceiverLowPass::new(),
        }
    }

    /// Returns the altitude from which those of the cells count, m; `None` before the first.
    #[must_use]
    pub const fn origin_m(&self) -> Option<f32> {
        self.origin_m
    }

    /// Starts with the low-pass of the receiver that an earlier drive found.
    pub const fn resume(&mut self, altitude: Delay) {
        self.low_pass.resume(altitude);
    }

    /// Creates what there is before the first cell, with a low-pass of the receiver that is known: no
    /// other one is looked for.
    #[must_use]
    pub fn with_low_pass(altitude: Delay) -> Self {
        let mut cells = Self::new();
        cells.low_pass.keep(altitude);
        cells
    }

    /// Returns the low-pass of the receiver, as the drive shows it.
    #[must_use]
    pub const fn altitude_delay(&self) -> Delay {
        self.low_pass.delay()
    }

    /// Returns what the last cell says of those before it.
    #[must_use]
    pub fn doubt_behind(&self, tuning: &Tuning, sample: &Sample) -> Option<DoubtBehind> {
        DoubtBehind::of_rest(tuning, sample).or(self.contradiction)
    }

    /// Returns the cell of a sample; `None` before the first speed. `known` is what an earlier drive has
    /// left.
    pub fn next(
        &mut self,
        numbers: &Numbers,
        context: &Context,
        sample: &Sample,
        known: Option<&SlowStates>,
    ) -> Option<CellInput> {
        let begins = !self.has_begun;
        if begins && sample.speed.is_none() {
            return None;
        }
        self.has_begun = true;
        self.contradiction = None;
        let gap = begins || sample.gap_cells > 0;
        let effects = self.effects.advance(context, sample);
        let forces = &Forces::new(numbers, context, sample);
        let marks = forces.marks(gap);
        let mps = sample.end.speed_mps;
        let energy = 0.5 * mps * mps;
        let energies = (core::mem::replace(&mut self.energy_before, energy), energy);
        let before_percent = self.net_traction_percent;
        if sample.after_stop {
            self.net_traction_percent = 0.0;
        } else if !marks.invalid {
            self.net_traction_percent = forces.percent(sample.forces.traction_n - forces.drag_n);
        }
        let launches = self.launches(context, sample, energies);
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
        let (force_variance, mut fixed_force_variance) =
            forces.variances(&marks, traction_jump_percent, retarder_step_percent);
        let lack = if marks.invalid || gap {
            Lack::default()
        } else {
            let (late_s, percent) = (sample.traction_late_s, forces.moving_percent(energies));
            self.late_traction.lack(late_s, sample.duration_s, percent)
        };
        fixed_force_variance += square(lack.noise_percent);
        let balance = context.model.vehicle.force_balance(&sample.forces);
        let drag = balance.drag * CELL_LENGTH_M;
        let braking_n = effects.force_n + sample.retarder_n;
        let braking = braking_n / sample.forces.accelerated_kg();
        let since_speed_m = self.since_speed_m + CELL_LENGTH_M;
        self.since_speed_m = if sample.speed.is_some() {
            0.0
        } else {
            since_speed_m
        };
        let gravity = balance.gravity * CELL_LENGTH_M;
        let mut cell = CellInput {
            duration_s: sample.duration_s,
            speed_mps: mps,
            // exp(-drag) to second order.
            keep_energy: 1.0 - drag * (1.0 - 0.5 * drag),
            work: (balance.traction - balance.rolling - braking) * CELL_LENGTH_M
                + gravity * lack.percent,
            gravity,
            net_traction_percent: self.net_traction_percent + lack.percent,
            traction_jump_percent,
            retarder_percent,
            retarder_step_percent,
            force_variance,
            fixed_force_variance,
            bias_variance: forces.bias_variance(),
            load_variance: forces.load_variance(begins, known),
            effect_variance: effects.bias_variance + forces.cold_tyres_variance(),
            wind_variance: forces.wind_variance(),
            energy: speed(numbers, sample),
            energy_behind_m: sample.speed.map_or(0.0, |of| of.behind_m),
            since_speed_m,
            energy_per_slip: mps * mps * 0.01 * forces.percent(sample.forces.traction_n),
            altitude: self.altitude(numbers, sample),
            altitude_behind_m: sample.altitude.map_or(0.0, |of| of.behind_m),
            slope: vertical_speed(numbers, sample),
            rest_percent: forces.resting_percent(),
            marks,
        };
        if !gap {
            self.use_body_sensors(numbers, sample, energies, &mut cell);
        }
        self.low_pass
            .follow(&context.tuning.detection, energies, &mut cell);
        // What is wrong with the one says nothing of the other.
        cell.marks.rest_begins = cell.marks.by_accelerometer != self.by_accelerometer;
        self.by_accelerometer = cell.marks.by_accelerometer;
        Some(cell)
    }

    /// Compares the sensors on the body with the force balance where that holds, and lets them stand in
    /// for it elsewhere.
    #[inline(always)]
    fn use_body_sensors(
        &mut self,
        numbers: &Numbers,
        sample: &Sample,
        energies: (f32, f32),
        cell: &mut CellInput,
    ) {
        let pitch = sample
            .slope
            .filter(|slope| slope.sensor == SlopeSensor::Pitch);
        if sample.inertial.is_some() || pitch.is_some() {
            let pitch_percent = pitch.map(|pitch| pitch.slope_percent);
            self.beside_body_sensors(numbers, sample, (energies, pitch_percent), cell);
        }
    }

    #[inline(never)] // Not for the vehicles without such sensors.
    fn beside_body_sensors(
        &mut self,
        numbers: &Numbers,
        sample: &Sample,
        ((before, after), pitch_percent): ((f32, f32), Option<f32>),
        cell: &mut CellInput,
    ) {
        // The specific force of the weight for 1 % of slope, over a cell.
        let per_percent = 0.01 * GRAVITY * CELL_LENGTH_M;
        let specific_percent = sample
            .inertial
            .map(|inertial| inertial.acceleration_mps2 * CELL_LENGTH_M / per_percent);
        let gained_percent = (after - before) / per_percent;
        if !cell.marks.invalid && !cell.marks.crawling {
            let model_percent = cell.read_percent((before, after));
            if let Some(specific_percent) = specific_percent {
                let slope_percent = specific_percent - gained_percent;
                let sensor = &mut self.accelerometer;
                let disagreed = sensor.disagrees() > 0.0;
                sensor.compare(numbers, slope_percent, model_percent);
                // One of the two is wrong: the force is in doubt.
                let doubt = sensor.disagrees() / numbers.rest_doubt;
                cell.rest_percent = Scalar::max(cell.rest_percent, doubt);
                self.contradiction = (doubt > 0.0 && !disagreed).then_some(DoubtBehind {
                    duration_s: NOTICED_CELLS * cell.duration_s,
                    percent: doubt,
                });
            }
            if let Some(pitch_percent) = pitch_percent {
                self.pitch.compare(numbers, pitch_percent, model_percent);
            }
            return;
        }
        let error_percent = |specific_percent: f32| {
            let of_body = numbers.body_noise * specific_percent;
            Scalar::sqrt(square(numbers.body_offset_percent) + square(of_body))
        };
        let by_accelerometer = specific_percent.and_then(|of| self.accelerometer.slope(of));
        if let Some((specific_percent, variance)) = by_accelerometer {
            cell.keep_energy = 1.0;
            cell.gravity = per_percent;
            cell.work = per_percent * specific_percent;
            cell.fixed_force_variance = variance;
            // What is wrong with it lasts as long as it stands in.
            cell.rest_percent = error_percent(specific_percent) / numbers.rest_doubt;
            cell.retarder_step_percent -= cell.retarder_percent;
            (cell.retarder_percent, self.retarder_percent) = (0.0, 0.0);
            cell.marks.by_accelerometer = true;
            cell.marks.invalid = false;
        } else if let Some((slope_percent, variance)) =
            pitch_percent.and_then(|of| self.pitch.slope(of))
        {
            cell.marks.slope_is_read = true;
            cell.slope = Reading {
                value: slope_percent,
                variance: variance + square(error_percent(gained_percent)),
            };
        }
    }

    /// Follows launches: for some distance behind a stop, what the traction changes while the vehicle
    /// gains speed is the driver's, and no answer to the road.
    fn launches(
        &mut self,
        context: &Context,
        sample: &Sample,
        (before, after): (f32, f32),
    ) -> bool {
        let tuning = &context.tuning;
        let numbers = &tuning.estimation;
        if sample.duration_s > tuning.hold_times.stop.seconds() {
            self.since_stop_m = 0.0;
        }
        let is_near_stop = self.since_stop_m < numbers.launch_length_m;
        self.since_stop_m += CELL_LENGTH_M;
        is_near_stop && after - before > numbers.launch_mps2 * CELL_LENGTH_M
    }

    fn altitude(&mut self, numbers: &Numbers, sample: &Sample) -> Reading {
        let Some(altitude) = &sample.altitude else {
            return Reading::NONE;
        };
        let origin_m = *self.origin_m.get_or_insert(altitude.altitude_m);
        Reading {
            value: altitude.altitude_m - origin_m,
            variance: square(numbers.altitude_noise_m * altitude.dilution),
        }
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
                && traction_percent < self.numbers.least_force_percent,
            slope_is_read: false,
            by_accelerometer: false,
            rest_begins: false,
            load_told: self.mass_is_told() && !gap,
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
            + square(numbers.inertia_noise * traction_jump_percent)
            + square(numbers.retarder_step_noise * retarder_step_percent);
        (square(self.percent(numbers.force_noise_n)), fixed)
    }

    /// Returns the sigma of the force of a torque that may be stuck, %.
    fn resting_percent(&self) -> f32 {
        let rest = &self.sample.torque_rest;
        if rest.rests_at_limit {
            return 0.0;
        }
        self.percent(walk_n(
            &self.context.tuning,
            rest.resting_s,
            rest.per_percent_n,
        ))
    }

    /// Auxiliaries and steady wind are forces, which weigh less on a heavy vehicle. Errors of tyres and
    /// shape are proportional to their resistance.
    fn bias_variance(&self) -> f32 {
        let numbers = self.numbers;
        let rolling = 100.0 * self.context.model.vehicle.rolling_resistance;
        square(self.percent(numbers.bias_force_n))
            + square(numbers.bias_resistance * rolling)
            + square(numbers.bias_resistance * self.percent(self.drag_n))
    }

    /// Returns the net traction, %. What turns engine and wheels does not move the mass.
    fn moving_percent(&self, (before, after): (f32, f32)) -> f32 {
        let forces = &self.sample.forces;
        let turning_n = forces.rotating_kg * (after - before) / CELL_LENGTH_M;
        self.percent(forces.traction_n - self.drag_n - turning_n)
    }

    /// Returns the variance of a load change before the cell. A file is for one load of many, and so are
    /// some reports; but reports rarely lack a change.
    fn load_variance(&self, begins: bool, known: Option<&SlowStates>) -> f32 {
        let (sample, numbers) = (self.sample, self.numbers);
        let any = square(numbers.any_load);
        if begins {
            let kept = known.map_or(0.0, |known| known.kept_scale(self.context, sample));
            any * (1.0 - square(kept))
        } else if !sample.after_stop && !sample.after_load_change {
            0.0
        } else if self.mass_is_told() {
            square(numbers.load_told)
        } else {
            any
        }
    }

    fn mass_is_told(&self) -> bool {
        self.sample.mass_is_reported || self.context.model.effects.mass_variance() > 0.0
    }

    /// Tyres are cold again after a long stop.
    fn cold_tyres_variance(&self) -> f32 {
        if self.sample.after_load_change {
            let rolling = 100.0 * self.context.model.vehicle.rolling_resistance;
            square(self.numbers.prior_cold_tyre * rolling)
        } else {
            0.0
        }
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

fn vertical_speed(numbers: &Numbers, sample: &Sample) -> Reading {
    let slope = sample
        .slope
        .filter(|slope| slope.sensor == SlopeSensor::VerticalSpeed);
    slope.map_or(Reading::NONE, |slope| {
        let sigma = 100.0 * numbers.vertical_speed_noise_mps / sample.end.speed_mps;
        Reading {
            value: slope.slope_percent,
            variance: square(sigma),
        }
    })
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
        // d(v²/2) = v dv, and dv²/2 where v is no larger than its noise.
        variance: mps * mps * (variance / count + step) + 0.5 * variance * variance,
    }
}
