//! Whether the estimator still gives what it gave, bit by bit, on drives of its own.
//!
//! `digests.txt` has what each drive gave. A change of behaviour that is wanted is accepted by
//! `CHANGE_INDICATOR=write cargo test -p estimator-core --features fixed --test change_indicator`. The drives of the
//! whole project, measured ones among them, are in `tests/change_indicator`. These are the core's own, so
//! that its tests alone find a fault in any number of it.

mod drive;
mod scenario;
mod scenarios;

use drive::Drive;
#[cfg(feature = "fixed")]
use estimator_core::FixedPoint;
use estimator_core::effect::CATALOGUE;
use estimator_core::filter::StateVector;
use estimator_core::{
    AdoptedEffect, AdoptedEffects, Cell, Context, Estimator, Instant, Live, Model, Sample, Scalar,
    Tuning, Uncertain,
};
use scenario::Scenario;
use test_kit::{Digest, FilteredStep, by_force, check_digests, smooth, truck};

/// What the indicator adds to a digest.
trait Estimates {
    fn uncertain(&mut self, of: Uncertain);
    fn live(&mut self, live: &Live);
    fn cell(&mut self, cell: &Cell);
}

impl Estimates for Digest {
    fn uncertain(&mut self, of: Uncertain) {
        self.number(of.value);
        self.number(of.sigma);
    }

    fn live(&mut self, live: &Live) {
        let estimate = &live.estimate;
        self.uncertain(estimate.grade_percent);
        self.uncertain(estimate.bias_percent);
        self.uncertain(estimate.scale);
        self.uncertain(estimate.mass_kg);
        self.number(estimate.speed_mps);
        if let Some(altitude_m) = estimate.altitude_m {
            self.uncertain(altitude_m);
        }
        self.add(&live.disagreement.kinds().map(u8::from));
        self.debug(&live.end);
    }

    fn cell(&mut self, cell: &Cell) {
        self.uncertain(cell.lagged_grade_percent);
        self.uncertain(cell.live_grade_percent);
        if let Some(altitude_m) = cell.altitude_m {
            self.uncertain(altitude_m);
        }
        self.add(&[cell.live_consistent, cell.lagged_consistent].map(u8::from));
        self.add(&cell.end.cell.to_le_bytes());
    }
}

/// Returns the model of a scenario.
fn model(scenario: &Scenario) -> Model {
    let vehicle = if scenario.by_force {
        by_force()
    } else {
        truck()
    };
    let mut effects = AdoptedEffects::default();
    for effect in CATALOGUE.into_iter().filter(|_| scenario.effects) {
        let adopted = AdoptedEffect::new(effect, 0.02, 0.01);
        effects.adopt(adopted).expect("there is room for all");
    }
    Model { vehicle, effects }
}

/// What a drive gave.
struct Account {
    digest: Digest,
    cells: u32,
    last: Option<Cell>,
    samples: Vec<Sample>,
}

impl Account {
    fn new() -> Self {
        Self {
            digest: Digest::default(),
            cells: 0,
            last: None,
            samples: Vec::new(),
        }
    }

    fn cell(&mut self, cell: Cell) {
        self.digest.cell(&cell);
        self.cells += 1;
        self.last = Some(cell);
    }

    /// Drives a scenario for some seconds, to its last cell.
    fn drive<S: Scalar>(
        &mut self,
        estimator: &mut Estimator<S>,
        scenario: &Scenario,
        seconds: u32,
    ) {
        let mut drive = Drive::new(scenario, model(scenario).vehicle);
        for _ in 0..10 * seconds {
            let (moment, readings) = drive.step();
            let micros = (f64::from(moment.time_s) * 1e6) as u64;
            for reading in readings {
                estimator.on_reading(Instant::from_micros(micros), reading);
            }
            while let Some(step) = estimator.step() {
                self.digest.debug(&step);
                self.samples.extend(estimator.sample().copied());
                if let Some(live) = estimator.live() {
                    self.digest.live(&live);
                }
                while let Some(cell) = estimator.next_cell() {
                    self.cell(cell);
                }
            }
        }
        while let Some(cell) = estimator.drain_cell() {
            self.cell(cell);
        }
        self.digest.debug(&estimator.counters());
        self.digest.debug(&estimator.persistent_state());
    }

    /// Goes over the samples again, and smooths them as a whole.
    fn second_pass(&mut self, estimator: &Estimator<f32>, model: Model) {
        let mut filter = estimator.second_pass_filter::<f64>();
        let mut context = Context::new(model, Tuning::default()).unwrap();
        let step = |sample: &Sample| {
            let record = filter.step(&mut context, sample)?;
            let state = *filter.state()?;
            Some(FilteredStep { record, state })
        };
        let steps: Vec<_> = self.samples.iter().filter_map(step).collect();
        for estimate in smooth(&steps) {
            self.digest.uncertain(estimate.grade_percent);
            self.digest.uncertain(estimate.mass_kg);
        }
        // A part of the climb that the model lacks, through all steps.
        let mut error = StateVector::ZERO;
        for step in &steps {
            let innovation = step.record.smoother_input.carry_error(&mut error, 0.01);
            self.digest.number(innovation.unwrap_or_default() as f32);
        }
    }

    /// Returns what a reader can follow, and the digest.
    fn line(&self, name: &str) -> String {
        let last = self.last.expect("a drive has cells");
        let grade = last.lagged_grade_percent;
        let altitude = last.altitude_m.unwrap_or_default();
        format!(
            "{name}: {} cells, grade {:.3} ± {:.3} %, altitude {:.1} ± {:.1} m, {:016x}",
            self.cells,
            grade.value,
            grade.sigma,
            altitude.value,
            altitude.sigma,
            self.digest.value()
        )
    }
}

/// Drives a scenario, looks at it again, and drives on another day.
fn line(scenario: &Scenario) -> String {
    let mut account = Account::new();
    let model = model(scenario);
    let mut estimator = Estimator::<f32>::new(model.clone(), Tuning::default()).unwrap();
    account.drive(&mut estimator, scenario, scenario.seconds);
    account.second_pass(&estimator, model.clone());
    if let Some(state) = estimator.persistent_state() {
        let mut next = Estimator::<f32>::restore(model, Tuning::default(), &state).unwrap();
        account.drive(&mut next, scenario, 60);
    }
    account.line(scenario.name)
}

/// Drives the first scenario in fixed-point numbers.
#[cfg(feature = "fixed")]
fn fixed_point(scenario: &Scenario) -> String {
    let mut account = Account::new();
    let tuning = Tuning::default();
    let mut estimator = Estimator::<FixedPoint>::new(model(scenario), tuning).unwrap();
    account.drive(&mut estimator, scenario, 200);
    account.line("fixed point")
}

/// Returns the lines of all drives, on two threads.
fn found() -> Vec<String> {
    let lines = |scenarios: &[Scenario]| -> Vec<String> { scenarios.iter().map(line).collect() };
    let all = scenarios::all();
    let (some, others) = all.split_at(all.len() / 2);
    std::thread::scope(|scope| {
        let others = scope.spawn(|| lines(others));
        let mut found = lines(some);
        found.extend(others.join().expect("no drive panics"));
        #[cfg(feature = "fixed")]
        found.push(fixed_point(&all[0]));
        found
    })
}

#[test]
fn every_drive_gives_what_is_committed() {
    let path = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/tests/change_indicator/digests.txt"
    );
    check_digests(&found(), include_str!("digests.txt"), path);
}
