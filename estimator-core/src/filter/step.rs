//! The filter: one step is one cell.

use super::backward::{break_matrix, break_vector};
use super::climb::{Correction, Fixed, Way};
use super::doubt::Doubt;
use super::far_scale::FarScale;
use super::gate::{AltitudeEvent, Gate, Judged, Verdict};
use super::learned::{SensorNoise, Spread};
use super::prior::{SlowStates, reopen, state_at_start};
use super::record::{Link, Moved, Record, Trace};
use super::state::{ALTITUDE, BIAS, ENERGY, GNSS_ERROR, SCALE, SLOPE, SLOPE_RATE, State, WIND};
use super::transition::{Transition, wind_variance};
use super::update::{Observation, Update};
use crate::counters::Counters;
use crate::sampler::{AltitudeMeasurement, Continuity, Sample, SpeedMeasurement};
use crate::scalar::Scalar;
use crate::tuning::Tuning;
use crate::vehicle::{GRAVITY, VehicleParameters};

/// Time without an altitude that is more than a slow receiver, s.
const ALTITUDE_GAP_S: f32 = 10.0;
/// Normalised squared innovation beyond which a speed is a step: five standard deviations, as of
/// altitudes.
const SPEED_LIMIT: f32 = 25.0;

/// The filter: a state that samples move.
#[derive(Clone, Debug)]
pub struct Filter<S> {
    state: Option<State<S>>,
    prior: Option<SlowStates>,
    gate: Gate,
    /// How far the receiver's altitudes have stepped since the altitude was set from them, m.
    datum_m: f32,
    speed_spread: Spread,
    /// Way since the last speed up to the last cell, m.
    unmeasured_m: f32,
    doubt: Doubt,
    far_scale: FarScale,
}

impl<S: Scalar> Filter<S> {
    /// Before the first sample.
    #[must_use]
    pub fn new() -> Self {
        Self::with_noise(&SensorNoise::default())
    }

    /// Before the first sample, with what is known of the sensors' noise.
    #[must_use]
    pub fn with_noise(noise: &SensorNoise) -> Self {
        Self::with_known(noise, None)
    }

    /// Before the first sample, with what is known of the sensors' noise and, from an earlier
    /// drive, of the slow states.
    #[must_use]
    pub fn with_known(noise: &SensorNoise, prior: Option<SlowStates>) -> Self {
        Self {
            state: None,
            prior,
            gate: Gate::new(noise),
            datum_m: 0.0,
            // A third to five times the believed sigma; some hundred readings.
            speed_spread: Spread::new(noise.speed, 0.1, 25.0, 0.01),
            unmeasured_m: 0.0,
            doubt: Doubt::new(),
            far_scale: FarScale::new(),
        }
    }

    /// What has been learned of the sensors' noise.
    #[must_use]
    pub const fn noise(&self) -> SensorNoise {
        SensorNoise {
            speed: self.speed_spread.ratio(),
            altitude: self.gate.spread(),
            gnss_error: self.gate.error_spread(),
        }
    }

    /// A filter before its first sample that knows of the slow states what this one knew at its
    /// own, of the sensors' noise what this one knows now, and of the scale that it may be far from
    /// one, if it was: for a second look at the same drive.
    #[must_use]
    pub fn anew<T: Scalar>(&self) -> Filter<T> {
        let mut filter = Filter::with_known(&self.noise(), self.prior);
        filter.far_scale = self.far_scale.anew();
        filter
    }

    /// The state now; `None` before the first speed.
    #[must_use]
    pub const fn state(&self) -> Option<&State<S>> {
        self.state.as_ref()
    }

    /// Moves over one cell, and notes where that led. `None` as long as no speed has been read.
    pub fn step(
        &mut self,
        vehicle: &VehicleParameters,
        tuning: &Tuning,
        sample: &Sample,
        counters: &mut Counters,
    ) -> Option<Record<S>> {
        let moved = self.advance(vehicle, tuning, sample, counters)?;
        self.state.map(|state| Record {
            place: moved.place,
            trace: moved.trace,
            state,
            event: moved.event,
        })
    }

    /// The same without the note: a state is half of it.
    pub fn advance(
        &mut self,
        vehicle: &VehicleParameters,
        tuning: &Tuning,
        sample: &Sample,
        counters: &mut Counters,
    ) -> Option<Moved<S>> {
        let Self {
            state: known,
            prior,
            gate,
            datum_m,
            speed_spread,
            unmeasured_m,
            doubt,
            far_scale,
        } = self;
        if let Some(state) = known
            && sample.reopened
        {
            reopen(state, vehicle, tuning, sample);
            far_scale.begin(state, tuning);
            counters.loads_reopened = counters.loads_reopened.saturating_add(1);
        }
        let transition = Transition::new(
            vehicle,
            tuning,
            sample,
            known.as_ref(),
            gate.error_spread(),
            doubt.pass(vehicle, sample),
        );
        let mut link = Link::Chained;
        // In its place: copies of a state cost more than its prediction.
        let (state, energy_before) = match (&mut *known, sample.speed) {
            (Some(state), _) if sample.gap_cells == 0 => {
                let before = state.x[ENERGY];
                transition.predict(state);
                (state, before)
            }
            (_, Some(speed)) => {
                link = Link::Broken;
                let state = known.get_or_insert_with(|| {
                    let mut state = state_at_start(prior.as_ref(), vehicle, tuning, sample);
                    let unsure = S::from_f32(far_scale.added());
                    state.p.add_variance(SCALE, unsure);
                    far_scale.begin(&state, tuning);
                    state
                });
                begin(state, tuning, speed);
                state.load = transition.motion().load;
                let energy = state.x[ENERGY];
                (state, energy)
            }
            (_, None) => return None,
        };
        gate.pass(way(state, &transition, sample), sample.duration_s);
        let mut fix = sample.altitude.map(|altitude| Fix {
            altitude_m: altitude_at_end(state, &altitude) - *datum_m,
            variance: {
                let sigma = tuning.altitude_sigma_m * altitude.dilution;
                S::from_f32(gate.spread() * sigma * sigma)
            },
            continuity: altitude.continuity,
        });
        if fix.is_some() && gate.silent_s() > ALTITUDE_GAP_S {
            counters.altitude_gaps = counters.altitude_gaps.saturating_add(1);
        }
        let (verdict, event) = fix.as_ref().map_or((Verdict::Reject, None), |fix| {
            judge(gate, state, fix, vehicle, tuning, sample)
        });
        match (&mut fix, verdict) {
            (Some(fix), Verdict::SetAnew | Verdict::Believe(_)) => {
                if let Verdict::Believe(off_percent) = verdict {
                    let variance = S::from_f32(off_percent * off_percent);
                    state.p.add_variance(BIAS, variance);
                }
                fix.altitude_m += *datum_m;
                *datum_m = 0.0;
                set_altitude(state, fix);
                link = match link {
                    Link::Chained => Link::AltitudeSet,
                    _ => Link::BrokenAltitudeSet,
                };
            }
            (Some(fix), Verdict::MoveDatum) => {
                let step_m = fix.innovation(state).to_f32();
                let unsure = fix.innovation_variance(state);
                fix.altitude_m -= step_m;
                *datum_m += step_m;
                state.p.add_variance(GNSS_ERROR, unsure);
            }
            (Some(_), Verdict::Reject | Verdict::Undo(_)) => {
                if let Verdict::Undo(known) = verdict {
                    undo(state, &known);
                }
                counters.altitudes_rejected += 1;
            }
            _ => {}
        }
        if let Some(event) = event {
            count(counters, event);
        }

        let speed = if let Some(speed) = sample.speed {
            let gradient = (state.x[ENERGY] - energy_before) * S::from_f32(1.0 / sample.length_m);
            let update = speed_update(state, tuning, speed, gradient, speed_spread.ratio());
            let way_m = core::mem::take(unmeasured_m) + sample.length_m;
            if is_step(state, tuning, way_m, &update) {
                // Of the speed, and not of what moves it: it may be there and nowhere else.
                state.p.add_variance(ENERGY, update.innovation.squared());
                counters.speed_steps = counters.speed_steps.saturating_add(1);
            }
            Some(update.apply(state))
        } else {
            *unmeasured_m += sample.length_m;
            None
        };
        if let Some(applied) = &speed {
            let normalised = applied.innovation.squared() / applied.innovation_variance;
            let condition = sample.place.condition;
            if link == Link::Chained && condition.is_valid() && !condition.crawling {
                speed_spread.learn(normalised.to_f32());
            }
        }
        let altitude = fix
            .filter(|_| matches!(verdict, Verdict::Fuse | Verdict::MoveDatum))
            .map(|fix| {
                let update = Update {
                    observation: Observation::Altitude,
                    innovation: fix.innovation(state),
                    variance: fix.variance,
                };
                counters.altitudes_used += 1;
                let applied = update.apply(state);
                if far_scale.widen(state, sample.place.cell) {
                    // What the model was off by passed for the sensors' noise.
                    gate.unlearn();
                    counters.scales_reopened = counters.scales_reopened.saturating_add(1);
                }
                applied
            });
        counters.steps += 1;
        if !sample.place.condition.is_valid() {
            counters.invalid_steps += 1;
        }
        if !state.is_sound() {
            // Cannot come from sound input; if it does, the next speed starts the filter anew.
            counters.restarts = counters.restarts.saturating_add(1);
            *known = None;
            return None;
        }
        Some(Moved {
            place: sample.place,
            trace: Trace {
                motion: *transition.motion(),
                link,
                speed,
                altitude,
            },
            event,
        })
    }
}

impl<S: Scalar> Default for Filter<S> {
    fn default() -> Self {
        Self::new()
    }
}

/// What to do with a fix, by how it fits the state before the measurements.
fn judge<S: Scalar>(
    gate: &mut Gate,
    state: &State<S>,
    fix: &Fix<S>,
    vehicle: &VehicleParameters,
    tuning: &Tuning,
    sample: &Sample,
) -> (Verdict, Option<AltitudeEvent>) {
    if state.origin_m.is_none()
        || fix.continuity == Continuity::Switched
        || gate.silent_s() >= tuning.gnss_silence.seconds()
    {
        gate.forget();
        return (Verdict::SetAnew, Some(AltitudeEvent::SetAnew));
    }
    if fix.continuity == Continuity::Drifted {
        gate.forget();
        return (Verdict::MoveDatum, None);
    }
    let error_sigma_m = tuning.gnss_error_sigma_m;
    let judged = Judged {
        innovation: fix.innovation(state),
        variance: fix.innovation_variance(state),
        cell: sample.place.cell,
        fixed: Fixed {
            altitude_m: fix.altitude_m,
            variance: fix.variance.to_f32(),
            error_variance: gate.error_spread() * error_sigma_m * error_sigma_m,
            wind_variance: wind_variance(vehicle, tuning, sample),
            per_wind_length: 1.0 / tuning.wind_length_m,
        },
        drifts: tuning.drift_sigmas * tuning.drift_sigmas,
    };
    gate.judge(&judged, state)
}

/// Begins anew at a first cell, or behind a gap, which leaves the slow states as they were.
fn begin<S: Scalar>(state: &mut State<S>, tuning: &Tuning, speed: SpeedMeasurement) {
    let square = |sigma: f32| S::from_f32(sigma * sigma);
    break_vector(&mut state.x);
    break_matrix(&mut state.p);
    state.origin_m = None;
    let mps = speed.mean_mps;
    state.x[ENERGY] = S::from_f32(0.5 * mps * mps);
    // The speed itself follows as a measurement: what is set here only has to be wider.
    state.p.set(ENERGY, ENERGY, square(mps.max(1.0)));
    state.p.set(SLOPE, SLOPE, square(tuning.slope_sigma));
    state
        .p
        .set(SLOPE_RATE, SLOPE_RATE, square(tuning.slope_rate_sigma));
}

/// What the model reads of the way over a cell.
fn way<S: Scalar>(state: &State<S>, transition: &Transition<S>, sample: &Sample) -> Way {
    let per_percent = 0.01 * sample.length_m;
    Way {
        length_m: sample.length_m,
        error_kept: transition.motion().keep_gnss_error.to_f32(),
        climb_m: per_percent * state.x[SLOPE].to_f32(),
        load_climb_m: per_percent * state.load.to_f32(),
        doubt_m: if sample.place.condition.is_valid() {
            0.0
        } else {
            per_percent * state.sigma(SLOPE).to_f32()
        },
    }
}

fn count(counters: &mut Counters, event: AltitudeEvent) {
    let counter = match event {
        AltitudeEvent::Outlier => &mut counters.altitude_outliers,
        AltitudeEvent::Stepped(_) => &mut counters.altitude_steps,
        AltitudeEvent::DriftBegan(_) => &mut counters.altitude_drifts,
        AltitudeEvent::DriftEnded(_) => return,
        AltitudeEvent::DriftBelieved => &mut counters.altitude_drifts_believed,
        AltitudeEvent::SetAnew => &mut counters.altitude_resets,
    };
    *counter = counter.saturating_add(1);
}

/// The altitude carried along the slope from where it was taken to the cell's end, m.
fn altitude_at_end<S: Scalar>(state: &State<S>, altitude: &AltitudeMeasurement) -> f32 {
    let slope_percent =
        state.x[SLOPE] - state.x[BIAS] - state.x[WIND] + state.load * state.x[SCALE];
    altitude.altitude_m + altitude.behind_m * 0.01 * slope_percent.to_f32()
}

/// A GNSS altitude at the cell's end.
struct Fix<S> {
    altitude_m: f32,
    variance: S,
    continuity: Continuity,
}

impl<S: Scalar> Fix<S> {
    fn innovation(&self, state: &State<S>) -> S {
        let origin_m = state.origin_m.unwrap_or(self.altitude_m);
        S::from_f32(self.altitude_m - origin_m) - Observation::Altitude.of(&state.x)
    }

    fn innovation_variance(&self, state: &State<S>) -> S {
        let observation = Observation::Altitude;
        observation.of(&observation.cross(&state.p)) + self.variance
    }
}

/// Returns to what was known of the model before fixes drifted; what they moved it by is doubt.
fn undo<S: Scalar>(state: &mut State<S>, known: &Correction) {
    for (i, before) in [
        (BIAS, known.bias_percent),
        (WIND, known.wind_percent),
        (SCALE, known.scale),
    ] {
        let before = S::from_f32(before);
        if let Some(x) = state.x.get_mut(i) {
            let moved = *x - before;
            *x = before;
            state.p.add_variance(i, moved * moved);
        }
    }
}

/// Altitude := fix − GNSS error, so that the two share the fix's error.
fn set_altitude<S: Scalar>(state: &mut State<S>, fix: &Fix<S>) {
    let origin_m = *state.origin_m.get_or_insert(fix.altitude_m);
    state.x[ALTITUDE] = S::from_f32(fix.altitude_m - origin_m) - state.x[GNSS_ERROR];
    state.p.clear(ALTITUDE);
    state.p.shear(ALTITUDE, GNSS_ERROR, -S::ONE);
    state.p.add_variance(ALTITUDE, fix.variance);
}

/// Whether the speed is another than noise, a road or a brake can make it over the way since the
/// last one: a sensor that slipped, stuck or was changed.
fn is_step<S: Scalar>(state: &State<S>, tuning: &Tuning, way_m: f32, update: &Update<S>) -> bool {
    let innovation = update.innovation.to_f32();
    let variance = (state.p.get(ENERGY, ENERGY) + update.variance).to_f32();
    let most = || 0.01 * GRAVITY * tuning.invalid_noise_percent * way_m;
    innovation * innovation > SPEED_LIMIT * variance && innovation.abs() > most()
}

/// The mean speed as a measurement of v²/2 at the cell's end, moved there along the predicted
/// change of energy.
fn speed_update<S: Scalar>(
    state: &State<S>,
    tuning: &Tuning,
    speed: SpeedMeasurement,
    gradient: S,
    spread: f32,
) -> Update<S> {
    let mps = speed.mean_mps;
    let sigma = if mps < tuning.crawl_mps {
        tuning.crawl_speed_sigma_mps
    } else {
        tuning.speed_sigma_mps
    };
    let measured = S::from_f32(0.5 * mps * mps) + gradient * S::from_f32(speed.behind_m);
    let sigma_squared = spread * sigma * sigma;
    let variance = mps * mps * sigma_squared / f32::from(speed.count.max(1));
    Update {
        observation: Observation::Energy,
        innovation: measured - state.x[ENERGY],
        // d(v²/2) = v dv, and dv²/2 where v itself is no larger than that.
        variance: S::from_f32(variance + 0.5 * sigma_squared * sigma_squared),
    }
}
