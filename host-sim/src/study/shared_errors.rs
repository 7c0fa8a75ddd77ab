//! Errors that runs share: within a day, a truck, the fleet. What the sigma of a map knows of them,
//! how maps improve with the number of runs, and of what the error consists that stays.

mod curve;
pub mod drives;
mod tables;

use super::alignment::campaign::{Campaign, CampaignRun, Stretch};
use super::definition::{Setting, Study, StudyOutcome};
use crate::error::{Error, Result};
use crate::report::page::Section;
use crate::terminal::progress;
use curve::{CampaignFigures, curve_of};
use drives::{Conditions, RUNS, Shared, Without, groups};
use estimator_core::Tuning;
use std::path::Path;

/// The study, for the list.
pub const STUDY: Study = Study {
    name: "shared_errors",
    about: "maps of runs that err alike within a day, a truck or the fleet: sigmas, and the error that stays",
    run,
};

/// Parts of the measured profile that are driven: their starts and their length, m.
const STARTS_M: [f64; 5] = [5_000.0, 27_000.0, 49_000.0, 71_000.0, 93_000.0];
const LENGTH_M: f64 = 20_000.0;
/// Campaigns on each part.
const SEEDS: u64 = 2;

fn run(setting: &Setting) -> Result<StudyOutcome> {
    let road = match setting.e4_road() {
        Ok(road) => road,
        Err(skipped) => return Ok(skipped),
    };
    let drives = STARTS_M.len() as u64 * SEEDS * RUNS as u64 * Conditions::all().len() as u64;
    let bar = progress::count(drives, "runs");
    let mut campaigns = Vec::new();
    for seed in 0..SEEDS {
        for (part, from_m) in STARTS_M.into_iter().enumerate() {
            let number = setting
                .seed
                .wrapping_add(seed * STARTS_M.len() as u64 + part as u64);
            campaigns.push(campaign(number, &road, from_m, || bar.inc(1))?);
        }
    }
    bar.finish_and_clear();
    Ok(StudyOutcome::Done(Section {
        heading: "Errors that runs share".to_owned(),
        words: vec![
            format!(
                "{} campaigns of {RUNS} runs on parts of {:.0} km of the measured profile of the E4: \
                 two trucks, four days, three runs each. Mass, drag and rolling resistance are wrong \
                 by 10 % (1 sigma), torque by 4 %. These errors belong to each run, to a day of a \
                 truck, to a truck, or to the whole fleet; of the mixed ones each level has a quarter \
                 of the variance.",
                campaigns.len(),
                LENGTH_M * 1e-3
            ),
            "Each day has a wind of 3 m/s with gusts of 0.3, each run tyres that begin with 30 % more \
             resistance, each truck fixes that are 0 to 400 ms late. In a map, the runs of a truck on \
             a day are a session. From two runs on, half of the runs of a map are those of either truck."
                .to_owned(),
        ],
        tables: tables::tables(&campaigns),
        figures: tables::figures(&campaigns),
        ..Section::default()
    }))
}

fn campaign(
    seed: u64,
    road: &Path,
    from_m: f64,
    done: impl Fn() + Sync,
) -> Result<CampaignFigures> {
    let stretch = Stretch {
        road: Some(std::path::absolute(road).map_err(Error::io(road))?),
        from_m,
        length_m: LENGTH_M,
    };
    let campaign = Campaign::new(seed, stretch)?;
    let drive = |conditions: Conditions| {
        campaign.drive_groups(&groups(seed, conditions), &Tuning::default(), &done)
    };
    let true_places = |runs: &[CampaignRun]| -> Vec<CampaignRun> {
        runs.iter().map(|run| campaign.truly_placed(run)).collect()
    };
    let mut figures = CampaignFigures {
        shared: Default::default(),
        without: Default::default(),
    };
    let mut mixed = Vec::new();
    for (curve, shared) in figures.shared.iter_mut().zip(Shared::ALL) {
        let runs = drive(Conditions::of(shared, Without::Nothing))?;
        *curve = curve_of(&campaign, &runs)?;
        if shared == Shared::Mixed {
            mixed = runs;
        }
    }
    for (curve, without) in figures.without.iter_mut().zip(Without::ALL) {
        let runs = match without {
            Without::Nothing => mixed.clone(),
            Without::Places => true_places(&mixed),
            Without::Everything => true_places(&drive(Conditions::of(Shared::Mixed, without))?),
            _ => drive(Conditions::of(Shared::Mixed, without))?,
        };
        *curve = curve_of(&campaign, &runs)?;
    }
    Ok(figures)
}
