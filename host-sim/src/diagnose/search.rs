//! Search for effects: the candidates of a set of drives, their evidence, and their effects.

use super::accelerometer;
use super::candidates::{Detail, DriveFacts, Menu};
use super::case::CandidateFit;
use super::drive::{CommonRoad, LoggedDrive};
use super::evidence::{self, Evidence, WINDS_MPS, judging_tuning, segments};
use super::findings::{FittedAmounts, Unexplained};
use super::rivals::SelectionStep;
use super::selection::{Selection, Selector};
use crate::files::vehicle::VehicleFile;
use crate::numeric::statistics::quantile;
use estimator_core::effect::{Varies, search_of};
use estimator_core::{AdoptedEffect, Effect, Model, Tuning};
use nalgebra::Vector2;
use rayon::prelude::*;

/// Search over drives, with its candidates.
pub struct EffectSearch<'a> {
    drives: &'a [LoggedDrive],
    fitted: usize,
    model: &'a Model,
    tuning: &'a Tuning,
    /// The common road of the drives.
    pub road: Option<CommonRoad>,
    menu: Menu,
    /// Columns of the errors of the accelerometer, if it is part of the evidence.
    sensor_errors: Option<[usize; 2]>,
}

impl<'a> EffectSearch<'a> {
    /// Creates a search. The drives were read with this model. The first `fitted` of them are to
    /// fit, the others are held out.
    #[must_use]
    pub fn new(
        drives: &'a [LoggedDrive],
        fitted: usize,
        model: &'a Model,
        tuning: &'a Tuning,
    ) -> Self {
        let road = CommonRoad::of(drives);
        let mut menu = Menu::new(&DriveFacts {
            fitted,
            of: drives.len(),
            road_m: road.as_ref().map(CommonRoad::length_m),
            temperatures_k: temperature_range_k(&drives[..fitted]),
            duration_s: duration_s(&drives[..fitted]),
        });
        let is_sensed = |drive: &LoggedDrive| drive.accelerometer.is_some();
        let sensor_errors = drives[..fitted]
            .iter()
            .any(is_sensed)
            .then(|| menu.add_sensor_errors(accelerometer::ERROR_SIGMAS));
        Self {
            drives,
            fitted,
            model,
            tuning,
            road,
            menu,
            sensor_errors,
        }
    }

    /// Returns the evidence of the drives, with the wind of the highest likelihood, and the
    /// effects that are selected from it.
    #[must_use]
    pub fn evidence(&self) -> (Evidence, Selection) {
        let columns: Vec<Vec<evidence::ForceColumn>> = self
            .drives
            .par_iter()
            .enumerate()
            .map(|(number, drive)| {
                let places = self.road.as_ref().map(|road| road.places(drive));
                self.menu
                    .columns(&self.model.vehicle, number, drive, places.as_deref())
            })
            .collect();
        let mut best: Option<(Evidence, Selection)> = None;
        // Sequential, because the sums of a fleet's drives are large.
        for wind_mps in WINDS_MPS {
            let tuning = judging_tuning(self.tuning, wind_mps);
            let drives: Vec<_> = self.drives.iter().zip(&columns).enumerate().collect();
            let evidence: Evidence = drives
                .into_par_iter()
                .map(|(number, (drive, columns))| {
                    let mut sums = segments(number, drive, self.model, &tuning, columns);
                    if let Some(errors) = self.sensor_errors {
                        let model = self.model;
                        accelerometer::add_evidence(&mut sums, drive, model, columns, errors);
                    }
                    sums
                })
                .collect::<Vec<_>>()
                .into_iter()
                .flatten()
                .collect();
            let selection = self.select(&evidence, None);
            let is_better = |(_, best): &(_, Selection)| {
                selection.negative_log_likelihood < best.negative_log_likelihood
            };
            if best.as_ref().is_none_or(is_better) {
                best = Some((evidence, selection));
            }
        }
        best.unwrap_or_default()
    }

    /// Selects effects on the evidence; `first` as in [`Selector::select`].
    #[must_use]
    pub fn select(&self, evidence: &Evidence, first: Option<usize>) -> Selection {
        Selector::new(&self.menu, evidence, |drive| drive >= self.fitted).select(first)
    }

    /// Returns the vehicle with all effects of a selection.
    #[must_use]
    pub fn vehicle_with(&self, vehicle: &VehicleFile, selection: &Selection) -> VehicleFile {
        let mut vehicle = vehicle.clone();
        for step in &selection.steps {
            if let Some(adopted) = self.adopted(&step.adopted) {
                let _ = vehicle.model.effects.adopt(adopted);
            }
        }
        vehicle
    }

    /// Returns the names of the effects that a step cannot separate from the adopted one, alone or
    /// in pairs.
    #[must_use]
    pub fn names(&self, step: &SelectionStep) -> Vec<&'static str> {
        let alone = step.group.iter().map(|case| case.candidate);
        let mut names = Vec::new();
        for candidate in alone.chain(step.pairs.iter().flatten().copied()) {
            let name = self.menu.candidates[candidate].name;
            if !names.contains(&name) {
                names.push(name);
            }
        }
        names
    }

    /// Returns the names of the pairs of a step.
    #[must_use]
    pub fn pairs(&self, step: &SelectionStep) -> Vec<[&'static str; 2]> {
        let pairs = step.pairs.iter();
        pairs
            .map(|pair| pair.map(|candidate| self.menu.candidates[candidate].name))
            .collect()
    }

    /// Returns the effect of a case, as a vehicle file has it; `None` for a plain dependence.
    #[must_use]
    pub fn adopted(&self, case: &CandidateFit) -> Option<AdoptedEffect> {
        let candidate = &self.menu.candidates[case.candidate];
        let effect: &'static Effect = candidate.effect?;
        let (amount, sigma) = (case.amounts[0] as f32, case.sigma(0) as f32);
        let mut adopted = AdoptedEffect::new(effect, amount, sigma);
        match case.choice.detail {
            Detail::None | Detail::Period(_) => {}
            Detail::Value(key, value) => {
                let _ = adopted.set(key, value);
            }
            Detail::EachDrive(key, value) => {
                // The amount differs from drive to drive, and that of the next drive is unknown.
                let count = case.amounts.len() as f64;
                let mean = case.amounts.iter().sum::<f64>() / count;
                let between = case.amounts.iter().map(|a| (a - mean).powi(2)).sum::<f64>() / count;
                let own = case.covariance.diagonal().mean();
                adopted =
                    AdoptedEffect::new(effect, mean.max(0.0) as f32, (between + own).sqrt() as f32);
                let _ = adopted.set(key, value);
            }
            Detail::SomeDrives {
                key,
                value,
                with,
                of,
            } => {
                // Whether the next drive is one of them is unknown.
                let (part, amount) = (with as f64 / of as f64, case.amounts[0]);
                let between = part * (1.0 - part) * amount * amount;
                let own = part * case.covariance[(0, 0)];
                let mean = (part * amount).max(0.0);
                adopted = AdoptedEffect::new(effect, mean as f32, (between + own).sqrt() as f32);
                let _ = adopted.set(key, value);
            }
            Detail::Direction(key) => {
                let (north, east) = (case.amounts[0], case.amounts[1]);
                let size = north.hypot(east);
                let along = Vector2::new(north, east) / size.max(1e-9);
                let sigma = along.dot(&(&case.covariance * along)).sqrt();
                adopted = AdoptedEffect::new(effect, size as f32, sigma as f32);
                let direction_deg = east.atan2(north).to_degrees().rem_euclid(360.0);
                let _ = adopted.set(key, direction_deg as f32);
            }
            Detail::RoadSection(from_m, to_m) => {
                if let (
                    Some(road),
                    Some(Varies::RoadSection {
                        latitude_key,
                        longitude_key,
                        length_key,
                    }),
                ) = (&self.road, search_of(effect).map(|search| search.varies))
                {
                    let (latitude_deg, longitude_deg) = road.position_at(0.5 * (from_m + to_m));
                    let _ = adopted.set(latitude_key, latitude_deg as f32);
                    let _ = adopted.set(longitude_key, longitude_deg as f32);
                    let _ = adopted.set(length_key, (to_m - from_m) as f32);
                }
            }
        }
        Some(adopted)
    }

    /// Returns the amounts of a case that a vehicle file does not have one by one; `None` for a
    /// single amount that it has.
    #[must_use]
    pub fn amounts(&self, case: &CandidateFit) -> Option<FittedAmounts> {
        let names = match case.choice.detail {
            Detail::Direction(_) => ["from north", "from east"].map(str::to_owned).to_vec(),
            Detail::EachDrive(..) => (1..=case.amounts.len())
                .map(|drive| format!("drive {drive}"))
                .collect(),
            Detail::SomeDrives { with, of, .. } => vec![format!("{with} of {of} drives")],
            _ => return None,
        };
        Some(FittedAmounts {
            names,
            amounts: case.amounts.clone(),
            covariance: case.covariance.clone(),
        })
    }

    /// Returns an adopted plain dependence for the report.
    #[must_use]
    pub fn unexplained(&self, case: &CandidateFit) -> Unexplained {
        let candidate = &self.menu.candidates[case.candidate];
        let size = case.amounts.iter().map(|a| a * a).sum::<f64>().sqrt();
        let (where_or_when, rms_percent) = match case.choice.detail {
            Detail::Period(period_s) => (
                format!(", period {period_s:.0} s"),
                0.1 * size / 2f64.sqrt(),
            ),
            Detail::RoadSection(from_m, to_m) => (
                format!(", km {:.1} to {:.1}", from_m * 1e-3, to_m * 1e-3),
                100.0 * size,
            ),
            _ => (
                String::new(),
                0.1 * size / (case.amounts.len() as f64).sqrt(),
            ),
        };
        Unexplained {
            depends_on: format!("{}{where_or_when}", candidate.name),
            rms_percent,
            evidence: case.evidence,
            variable: self.menu.variable(&case.choice),
            figure: None,
        }
    }
}

/// Returns the range of the air temperatures of nine cells in ten, K; 0 where none is known.
fn temperature_range_k(drives: &[LoggedDrive]) -> f32 {
    let samples = drives.iter().flat_map(|drive| &drive.samples);
    let mut celsius: Vec<f32> = samples
        .filter_map(|sample| sample.effect_inputs.ambient_celsius.get())
        .collect();
    celsius.sort_by(f32::total_cmp);
    let ends = [celsius.len() / 20, celsius.len() - celsius.len() / 20];
    match celsius.get(ends[0]..ends[1]) {
        Some([first, .., last]) => last - first,
        _ => 0.0,
    }
}

/// Returns the duration of the drive in the middle, s.
fn duration_s(drives: &[LoggedDrive]) -> f64 {
    quantile(
        drives.iter().filter_map(|drive| {
            let rows = &drive.run.rows;
            Some(rows.last()?.time_s - rows.first()?.time_s)
        }),
        0.5,
    )
}
