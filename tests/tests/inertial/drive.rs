//! A simulated drive through the chain from frames to live estimates, with an accelerometer added
//! to the samples.

use cross_tests::faults::signals::{replaced, stuck};
use cross_tests::faults::{Frames, seconds};
use estimator_core::filter::gross_mass::ModelMass;
use estimator_core::filter::{BodySensors, Filter, SensorNoiseRatios, SlowStates};
use estimator_core::{
    Condition, Context, Counters, Disagreement, Instant, Intake, Reading, Sampler, Signal, Tuning,
    Value,
};
use host_sim::numeric::slope::sine;
use host_sim::simulator::Recording;
use host_sim::simulator::random::{OrnsteinUhlenbeck, Purpose, normal, stream};
use host_sim::simulator::scenario::Scenario;
use std::path::Path;

const TORQUE: &[Signal] = &[Signal::EngineTorque, Signal::EngineTorqueFraction];

/// What is wrong with the torque, from and to a time in s.
#[derive(Clone, Copy, Debug)]
pub enum Fault {
    None,
    TorqueMissing(f64, f64),
    TorqueStuck(f64, f64),
}

impl Fault {
    fn received<'a>(self, frames: Frames<'a>) -> Frames<'a> {
        let window = |from, to| Instant::ZERO + seconds(from)..Instant::ZERO + seconds(to);
        match self {
            Self::None => frames,
            Self::TorqueMissing(from, to) => {
                replaced(frames, window(from, to), TORQUE, Value::NotAvailable)
            }
            Self::TorqueStuck(from, to) => stuck(frames, window(from, to), TORQUE),
        }
    }
}

/// A live estimate beside the truth.
#[derive(Clone, Copy, Debug)]
pub struct LiveCell {
    pub time_s: f64,
    pub distance_m: f64,
    pub condition: Condition,
    pub disagreement: Disagreement,
    pub grade_error_percent: f64,
    pub grade_sigma_percent: f64,
    pub altitude_error_m: Option<f64>,
    pub altitude_sigma_m: f64,
    pub traction_percent: f64,
}

/// The live estimates of a drive, what was counted, and what it leaves for the next.
pub struct LiveDrive {
    pub cells: Vec<LiveCell>,
    pub counters: Counters,
    pub kept: Kept,
}

/// What a drive leaves for the next.
#[derive(Clone, Copy, Debug)]
pub struct Kept {
    pub slow: SlowStates,
    pub noise: SensorNoiseRatios,
    pub body: BodySensors,
}

/// Returns the text of a scenario: a truck on a road of 30 km, unlike its file, in wind and on cold
/// tyres.
pub fn scenario(truck: &str, seed: u64, more: &str) -> String {
    let errors = "{ mass_factor = 1.08, drag_factor = 0.92, rolling_factor = 1.05, \
                  torque_factor = 0.97 }";
    format!(
        "seed = {seed}\n[road]\nlength_m = 30000.0\n\
         [wind]\nspeed_mps = 2.0\nfrom_deg = 250.0\ngust_sigma_mps = 0.3\n\
         [tyres]\ncold_amount = 0.2\n{more}\n\
         [[runs]]\nname = \"x\"\ntruck = \"{truck}\"\nerrors = {errors}\n"
    )
}

/// Drives a scenario with a fault of the torque, with or without an accelerometer.
pub fn live(text: &str, fault: Fault) -> LiveDrive {
    live_with(text, fault, None)
}

/// As [`live`], with what an earlier drive left.
pub fn live_next(text: &str, fault: Fault, kept: &Kept) -> LiveDrive {
    drive_live(text, fault, None, Some(kept))
}

/// A GNSS receiver that gives its vertical speed with each fix.
#[derive(Clone, Copy, Debug)]
pub struct VerticalSpeed {
    /// Fast error, 1 sigma, m/s, and the slow one, which keeps its value for half a minute.
    pub fast_mps: f64,
    pub slow_mps: f64,
    /// Age of what it reads, s: receivers filter.
    pub late_s: f64,
    /// Factor on the reading.
    pub factor: f64,
}

/// As [`live`], with a vertical speed each second.
pub fn live_with(text: &str, fault: Fault, vertical: Option<VerticalSpeed>) -> LiveDrive {
    drive_live(text, fault, vertical, None)
}

fn drive_live(
    text: &str,
    fault: Fault,
    vertical: Option<VerticalSpeed>,
    kept: Option<&Kept>,
) -> LiveDrive {
    let scenario = Scenario::parse(text, Path::new("inertial")).unwrap();
    let recording = Recording::new(&scenario, 0).unwrap();
    let drive = recording.drive();
    let mut context =
        Context::new(scenario.runs[0].vehicle.model.clone(), Tuning::default()).unwrap();
    let mut intake = Intake::new(&context.tuning);
    let mut sampler = Sampler::new();
    let mut filter = Filter::<f32>::new(&context.tuning, &SensorNoiseRatios::default(), None);
    if let Some(Kept { slow, noise, body }) = kept {
        filter.resume(&context.tuning, noise, *slow, body);
    }
    let mut mass_kg = 0.0;
    let mut cells = Vec::new();
    let mut rng = stream(scenario.seed, 0, Purpose::Inertial);
    let mut slow_error = OrnsteinUhlenbeck::new(1.0, 30.0, &mut rng);
    let mut next_s = 30.0;
    for timed in fault.received(Box::new(recording.frames())) {
        intake.on_frame(&mut context, timed.time, &timed.frame, &mut sampler);
        let now_s = timed.time.micros() as f64 * 1e-6;
        if let Some(sensor) = vertical.filter(|_| now_s >= next_s) {
            next_s = now_s + 1.0;
            let at = drive.at(now_s - sensor.late_s);
            let error_mps = sensor.fast_mps * normal(&mut rng)
                + sensor.slow_mps * slow_error.advance(1.0, &mut rng);
            let climb_mps = at.speed_mps * sine(drive.road.grade(at.distance_m));
            let mps = sensor.factor * (climb_mps + error_mps);
            let reading = Reading {
                signal: Signal::VerticalSpeed,
                value: Value::Real(mps as f32),
            };
            intake.on_reading(&mut context, timed.time, reading, &mut sampler);
        }
        while let Some(sample) = sampler.next_sample() {
            let Some(record) = filter.step(&mut context, &sample) else {
                continue;
            };
            let state = filter.state().unwrap();
            mass_kg = sample.forces.mass_kg;
            let estimate = state.estimate(&ModelMass::of(&context, &sample));
            let time_s = record.end.time.micros() as f64 * 1e-6;
            let truth = drive.at(time_s);
            let road = &drive.road;
            cells.push(LiveCell {
                time_s,
                distance_m: truth.distance_m,
                condition: record.end.condition,
                disagreement: record.disagreement,
                grade_error_percent: f64::from(estimate.grade_percent.value)
                    - 100.0 * road.grade(truth.distance_m),
                grade_sigma_percent: estimate.grade_percent.sigma.into(),
                altitude_error_m: estimate
                    .altitude_m
                    .map(|z| f64::from(z.value) - road.altitude_m(truth.distance_m)),
                traction_percent: 100.0 * truth.traction_n / (9.81 * drive.truck.mass_kg),
                altitude_sigma_m: estimate.altitude_m.map_or(0.0, |z| z.sigma.into()),
            });
        }
    }
    LiveDrive {
        cells,
        counters: context.counters,
        kept: Kept {
            slow: SlowStates::of(filter.state().unwrap(), mass_kg),
            noise: filter.noise(),
            body: filter.body_sensors(&context.tuning),
        },
    }
}

/// Root mean square error and mean normalised squared error of cells.
#[derive(Clone, Copy, Debug, Default)]
pub struct Errors {
    pub cells: usize,
    pub rmse_percent: f64,
    pub nees: f64,
}

/// Returns the errors of the cells that are chosen.
pub fn errors<'a>(
    cells: impl IntoIterator<Item = &'a LiveCell>,
    chosen: impl Fn(&LiveCell) -> bool,
) -> Errors {
    let (mut count, mut squares, mut normalised) = (0, 0.0, 0.0);
    for cell in cells.into_iter().filter(|cell| chosen(cell)) {
        count += 1;
        let squared = cell.grade_error_percent * cell.grade_error_percent;
        squares += squared;
        normalised += squared / (cell.grade_sigma_percent * cell.grade_sigma_percent);
    }
    Errors {
        cells: count,
        rmse_percent: (squares / count.max(1) as f64).sqrt(),
        nees: normalised / count.max(1) as f64,
    }
}
