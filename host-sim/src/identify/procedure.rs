//! All steps of an identification.

use super::account::{self, Findings};
use super::class::{self, Class, Usual};
use super::delays;
use super::draft::{Draft, Parameter};
use super::estimate::Estimate;
use super::fit::{Amounts, FittedDrive, Priors, fit};
use super::gears::{self, FoundGear};
use super::identified::{Identified, Origin};
use super::limits;
use super::observation::Observation;
use super::one_vehicle;
use crate::diagnose::drive::LoggedDrive;
use crate::error::{Error, Result, on_one_line};
use crate::files::vehicle::VehicleFile;
use crate::numeric::statistics;
use crate::source::read_options::ReadOptions;
use estimator_core::{Delays, Model, Signal, Tuning};
use rayon::prelude::*;
use std::path::{Path, PathBuf};

/// Most drives that are fitted, and the most way of all of them, m: their samples are in memory. The
/// others still show gears.
const MOST_DRIVES: usize = 24;
const MOST_FITTED_M: f64 = 1_500_000.0;
/// Way from which a drive shows a mass, m.
const LEAST_FITTED_M: f64 = 500.0;
/// Most times that the drives are read until the masses agree, ...
const ROUNDS: usize = 4;
/// ... which is within this part.
const MASSES_AGREE: f64 = 0.05;
/// Engines of trucks turn slower than this, rpm.
const TRUCK_RPM: f64 = 3_200.0;
/// Relative sigma of a torque signal, of a told mass, and of a measured traction force.
const TORQUE_SIGNAL: f64 = 0.03;
const TOLD_MASS: f64 = 0.02;
/// A traction scale is written from this size on, and from this many sigmas.
const SCALE_WRITTEN: (f64, f64) = (0.01, 2.0);
/// Distance after which two means of GNSS speed are independent, m.
const INDEPENDENT_M: f64 = 2_000.0;
/// Sigma of the ratio of GNSS speed and wheel speed itself: slip, climb.
const GROUND_FLOOR: f64 = 5e-4;

/// What the vehicle is like.
#[derive(Clone, Debug)]
pub enum Like {
    /// A class.
    Class(Class),
    /// Another vehicle.
    File(Box<VehicleFile>),
}

impl Like {
    /// Returns the class of this name, or the vehicle of the file at this path.
    ///
    /// # Errors
    /// Returns a usage error that names the classes, or the error of the vehicle file.
    pub fn named(name: &str) -> Result<Self> {
        if let Some(class) = class::named(name) {
            return Ok(Self::Class(class));
        }
        let path = Path::new(name);
        if path.is_file() {
            return Ok(Self::File(Box::new(VehicleFile::read(path)?)));
        }
        let names: Vec<String> = class::all().into_iter().map(|class| class.name).collect();
        Err(Error::Usage(format!(
            "{}: is neither a class nor a file; expected a vehicle file, or one of {}",
            on_one_line(path),
            names.join(", ")
        )))
    }
}

/// What is asked.
#[derive(Clone, Debug)]
pub struct Request {
    /// Drives of one vehicle.
    pub logs: Vec<PathBuf>,
    /// What it is like; recognised by itself if `None`.
    pub like: Option<Like>,
    /// Tuning of the estimator.
    pub tuning: Tuning,
    /// How logs are read.
    pub options: ReadOptions,
}

/// Identifies the vehicle of the logs. `progress` gets one line for each step. Logs that cannot be read
/// are left out, unless none can, a file is missing, or reading is strict.
///
/// # Errors
/// Returns an error, with file and line, if a log cannot be read; and one that names the missing
/// signal if no log has what an estimate needs.
pub fn identify(request: &Request, progress: impl Fn(&str)) -> Result<Identified> {
    progress("reading the logs");
    let results: Vec<Result<Observation>> = request
        .logs
        .par_iter()
        .map(|log| Observation::of(log, &request.options))
        .collect();
    let (mut logs, mut observed, mut problems) = (Vec::new(), Vec::new(), Vec::new());
    for (log, result) in request.logs.iter().zip(results) {
        match result {
            Ok(observation) => {
                logs.push(log.clone());
                observed.push(observation);
            }
            Err(problem) if request.options.strict || !is_of_content(&problem) => {
                return Err(problem);
            }
            Err(problem) => problems.push(problem),
        }
    }
    if logs.is_empty() {
        return Err(problems.swap_remove(0));
    }
    if request.like.is_none() {
        one_vehicle::check(&logs, &observed)?;
    }
    let mut observation = Observation::default();
    for one in &observed {
        observation.merge(one);
    }
    let fitted = fitted(&observed);
    let drives: Vec<(&PathBuf, &Observation)> = fitted
        .iter()
        .map(|number| (&logs[*number], &observed[*number]))
        .collect();
    let mut search = Search::new(request, observation, &logs[0])?;
    search.read_until_masses_agree(&drives, &progress)?;
    progress("fitting resistance, drag and traction");
    search.fit();
    search.measure_radius();
    let mut found = account::identified(&search.findings());
    let delays: Vec<Delays> = search
        .drives
        .iter()
        .map(|of| of.logged.run.delays)
        .collect();
    found.delays = delays::found(&delays);
    found.unknown.extend(delays::unknown(&delays));
    found.left_out = problems.iter().map(ToString::to_string).collect();
    limits::check_vehicle(&logs[0], &found)?;
    Ok(found)
}

/// Returns whether a problem is in the content of a log.
const fn is_of_content(problem: &Error) -> bool {
    matches!(problem, Error::Line { .. } | Error::Content { .. })
}

/// Returns the drives to fit: all that are long enough, or every second, third and so on, so that they
/// fit into memory.
fn fitted(observed: &[Observation]) -> Vec<usize> {
    let long = |number: &usize| observed[*number].distance_m >= LEAST_FITTED_M;
    let mut candidates: Vec<usize> = (0..observed.len()).filter(long).collect();
    if candidates.is_empty() {
        candidates = (0..observed.len()).collect();
    }
    for step in 1..candidates.len() {
        let some: Vec<usize> = candidates.iter().copied().step_by(step).collect();
        let way_m: f64 = some.iter().map(|number| observed[*number].distance_m).sum();
        if some.len() <= MOST_DRIVES && way_m <= MOST_FITTED_M {
            return some;
        }
    }
    candidates.truncate(1);
    candidates
}

struct Search<'a> {
    request: &'a Request,
    observation: Observation,
    /// The gears; none for a measured traction force.
    gears: Vec<FoundGear>,
    class: Class,
    draft: Draft,
    drives: Vec<FittedDrive>,
    masses_kg: Vec<f64>,
    traction_scale: Option<Estimate>,
}

impl<'a> Search<'a> {
    fn new(request: &'a Request, observation: Observation, first: &Path) -> Result<Self> {
        limits::check_signals(first, &observation)?;
        let class = match &request.like {
            Some(Like::Class(class)) => class.clone(),
            Some(Like::File(file)) => like_file(file),
            None => first_guess(&observation),
        };
        let by_torque = observation.has(Signal::EngineTorque) || observation.has_torque_in_nm();
        let mut gears = if by_torque {
            gears::find(&observation)
        } else {
            Vec::new()
        };
        if by_torque && gears.is_empty() {
            let is_motor = observation.has(Signal::MotorTorque);
            if !is_motor || observation.has(Signal::EngineSpeed) {
                return Err(Error::content(first, limits::no_gears(&observation)));
            }
            let usual = &class.usual;
            let turns = usual.final_drive_ratio.value / usual.wheel_radius_m.value;
            let sigma = turns * usual.final_drive_ratio.relative_sigma();
            gears.push(gears::single(Estimate::new(turns, sigma)));
        }
        let draft = Draft::new(&class.usual, &class.name, &observation, &gears);
        Ok(Self {
            request,
            observation,
            gears,
            class,
            draft,
            drives: Vec::new(),
            masses_kg: Vec::new(),
            traction_scale: None,
        })
    }

    fn read_until_masses_agree(
        &mut self,
        drives: &[(&PathBuf, &Observation)],
        progress: &impl Fn(&str),
    ) -> Result<()> {
        let logs: Vec<&PathBuf> = drives.iter().map(|(log, _)| *log).collect();
        let told = |number: usize| drives.get(number)?.1.told(Signal::Mass);
        let mass_kg = self.draft.mass_kg.value();
        self.masses_kg = (0..logs.len())
            .map(|number| told(number).map_or(mass_kg, |(mean, _)| mean))
            .collect();
        for round in 1..=ROUNDS {
            progress(&format!("estimating the drives, pass {round}"));
            self.read_drives(&logs)?;
            let mut agree = true;
            for (number, drive) in self.drives.iter().enumerate() {
                let last = drive
                    .logged
                    .run
                    .rows
                    .iter()
                    .rev()
                    .find_map(|row| row.mass_kg);
                let Some(mass_kg) = last.filter(|_| told(number).is_none()) else {
                    continue;
                };
                agree &= (mass_kg / self.masses_kg[number]).ln().abs() < MASSES_AGREE;
                self.masses_kg[number] = mass_kg;
            }
            agree &= self.scale_torque();
            let class_fits = self.choose_class();
            if agree && class_fits {
                break;
            }
        }
        self.read_drives(&logs)
    }

    /// Reads the drives with the vehicle as it is now, unless they were.
    fn read_drives(&mut self, logs: &[&PathBuf]) -> Result<()> {
        let model = self.draft.model();
        let with_mass = |mass_kg: &f64| {
            let mut model = model.clone();
            model.vehicle.mass_kg = *mass_kg as f32;
            model
        };
        let models: Vec<Model> = self.masses_kg.iter().map(with_mass).collect();
        if self.drives.iter().map(|drive| &drive.model).eq(&models) {
            return Ok(());
        }
        let of = |(log, model): (&&PathBuf, Model)| {
            let logged =
                LoggedDrive::read(log, &model, &self.request.tuning, &self.request.options)?;
            Ok(FittedDrive { model, logged })
        };
        let drives: Result<Vec<_>> = logs.par_iter().zip(models).map(of).collect();
        self.drives = drives?;
        Ok(())
    }

    /// Scales a reference torque that is not told, if the mass is. Returns whether it was right.
    fn scale_torque(&mut self) -> bool {
        let scales = self
            .drives
            .iter()
            .filter_map(|drive| drive.logged.run.rows.last());
        let scale = statistics::mean(&scales.map(|row| row.scale).collect::<Vec<_>>());
        match &mut self.draft.driveline {
            Some(driveline)
                if self.draft.mass_kg.origin == Origin::Read
                    && driveline.reference_torque_nm.origin != Origin::Read
                    && scale > 0.0 =>
            {
                driveline.reference_torque_nm.estimate.value *= scale;
                scale.ln().abs() < MASSES_AGREE
            }
            _ => true,
        }
    }

    /// Chooses the class by the mass, unless one was named. Returns whether it was the right one.
    fn choose_class(&mut self) -> bool {
        if self.request.like.is_some() {
            return true;
        }
        let class = class_of(statistics::mean(&self.masses_kg), &self.observation);
        let fits = class.name == self.class.name;
        if !fits {
            self.draft = Draft::new(&class.usual, &class.name, &self.observation, &self.gears);
            self.class = class;
        }
        fits
    }

    fn priors(&self) -> Priors {
        let usual = &self.class.usual;
        let torque = self.draft.driveline.as_ref().map_or(TORQUE_SIGNAL, |of| {
            let efficiency = of.final_drive_efficiency.estimate.relative_sigma();
            of.reference_torque_nm
                .estimate
                .relative_sigma()
                .max(TORQUE_SIGNAL)
                .hypot(efficiency)
        });
        let mass = match self.draft.mass_kg.origin {
            Origin::Read => TOLD_MASS,
            _ => usual.mass_kg.relative_sigma(),
        };
        Priors {
            rolling_resistance: usual.rolling_resistance.sigma,
            drag_area_m2: usual.drag_area_m2.sigma,
            traction: torque,
            mass,
        }
    }

    fn fit(&mut self) {
        let priors = self.priors();
        let Some(amounts) = fit(&self.drives, &priors, &self.request.tuning) else {
            return;
        };
        let how = "innovations of the filter";
        let refine = |parameter: &mut Parameter, amount: Estimate, prior: f64| {
            let value = (parameter.value() + amount.value).max(0.2 * parameter.value());
            // Data that leave the prior as it is measure nothing.
            if amount.sigma < 0.9 * prior {
                *parameter = Parameter::measured(Estimate::new(value, amount.sigma), how);
            }
        };
        refine(
            &mut self.draft.rolling_resistance,
            amounts.rolling_resistance,
            priors.rolling_resistance,
        );
        refine(
            &mut self.draft.drag_area_m2,
            amounts.drag_area_m2,
            priors.drag_area_m2,
        );
        self.apply_traction(&amounts);
        self.apply_masses(&amounts);
    }

    fn apply_traction(&mut self, amounts: &Amounts) {
        let Estimate { value, sigma } = amounts.traction;
        if let Some(driveline) = &mut self.draft.driveline
            && driveline.reference_torque_nm.origin != Origin::Read
        {
            let torque = &mut driveline.reference_torque_nm;
            let nm = torque.value() * (1.0 + value);
            let how = "traction that the drives need for this mass; EC1 is not on the bus";
            *torque = Parameter::measured(Estimate::new(nm, sigma * torque.value()), how);
            return;
        }
        let (least, sigmas) = SCALE_WRITTEN;
        if value.abs() > least && value.abs() > sigmas * sigma {
            self.traction_scale = Some(amounts.traction);
        }
    }

    fn apply_masses(&mut self, amounts: &Amounts) {
        if self.draft.mass_kg.origin == Origin::Read {
            return;
        }
        for (mass_kg, amount) in self.masses_kg.iter_mut().zip(&amounts.mass) {
            *mass_kg *= (1.0 + amount.value).clamp(0.3, 3.0);
        }
        let count = self.masses_kg.len() as f64;
        let mean_kg = statistics::mean(&self.masses_kg);
        let scatter = self
            .masses_kg
            .iter()
            .map(|kg| (kg - mean_kg).powi(2))
            .sum::<f64>();
        let own = amounts
            .mass
            .iter()
            .map(|mass| (mass.sigma * mean_kg).powi(2))
            .sum::<f64>();
        let sigma_kg = ((scatter + own) / count).sqrt();
        let how = "acceleration and climbing under traction; each drive estimates its own";
        self.draft.mass_kg = Parameter::measured(Estimate::new(mean_kg, sigma_kg), how);
    }

    fn measure_radius(&mut self) {
        let Some(ratio) = self.observation.ground.highest() else {
            return;
        };
        // The weights are speeds at one fix a second or more often: at most the distance.
        let blocks = ratio.weight / INDEPENDENT_M;
        if blocks < 1.0 {
            return;
        }
        let sigma = (ratio.scatter / blocks.sqrt()).hypot(GROUND_FLOOR);
        let nominal_m = self.draft.wheel_radius_m.value();
        let radius_m = nominal_m * ratio.ratio;
        let how = format!(
            "GNSS distance is {:.4} of the distance on the bus, which takes {nominal_m} m (usual for {})",
            ratio.ratio, self.class.name
        );
        self.draft.wheel_radius_m =
            Parameter::measured(Estimate::new(radius_m, radius_m * sigma), how);
    }

    fn findings(&self) -> Findings<'_> {
        Findings {
            observation: &self.observation,
            class: &self.class.name,
            draft: &self.draft,
            traction_scale: self.traction_scale,
        }
    }
}

fn first_guess(observation: &Observation) -> Class {
    let usual_kg = match observation.told(Signal::Mass) {
        Some((mean_kg, _)) => mean_kg,
        None if observation.is_light_vehicle || observation.fastest_rpm > TRUCK_RPM => 1_600.0,
        // The middle of trucks: the mass shows itself on the first drive.
        None => 18_000.0,
    };
    class_of(usual_kg, observation)
}

fn class_of(mass_kg: f64, observation: &Observation) -> Class {
    class::of_mass(mass_kg, observation.has(Signal::Passengers))
}

fn like_file(file: &VehicleFile) -> Class {
    let rest = class::of_mass(f64::from(file.model.vehicle.mass_kg), false).usual;
    Class {
        name: file.name.clone(),
        about: String::new(),
        usual: Usual::of_vehicle(file, &rest),
    }
}
