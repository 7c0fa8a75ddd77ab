//! The thesis on its own road: its ten experiments (tables 5-8) and its convergence (figures 10 and
//! 11) on the measured profile of the E4 from Södertälje southwards, by its two methods and by ours.

mod convergence;

use super::definition::{Setting, Study, StudyOutcome};
use super::experiments::campaign::{Campaign, LENGTH_M};
use super::experiments::method::ThesisMethod;
use super::experiments::{beside, campaigns, modified};
use crate::comparison::STEP_M;
use crate::error::{Error, Result};
use crate::report::page::{Figure, Section, Table};
use crate::simulator::road_file;

/// The study, for the list.
pub const STUDY: Study = Study {
    name: "e4",
    about: "thesis tables 5-8 and its convergence on the measured profile of its own road, three methods",
    run,
};

fn run(setting: &Setting) -> Result<StudyOutcome> {
    let path = match setting.e4_road() {
        Ok(path) => path,
        Err(skipped) => return Ok(skipped),
    };
    let road = road_file::read(&path)?;
    if road.length_m() < LENGTH_M {
        let problem = format!(
            "{:.1} km long; expected at least {:.0} km",
            road.length_m() / 1000.0,
            LENGTH_M / 1000.0
        );
        return Err(Error::content(&path, problem));
    }
    let southbound: Vec<f64> = (0..(LENGTH_M / STEP_M) as usize)
        .map(|k| 100.0 * road.grade(k as f64 * STEP_M))
        .collect();
    Ok(StudyOutcome::Done(section(&southbound, setting.seed)))
}

fn section(southbound: &[f64], seed: u64) -> Section {
    let campaign = |seed| Campaign::on(southbound.to_vec(), seed);
    let runs = campaign(seed).replicas();
    let all = ThesisMethod::ALL.map(|method| method.apply(&runs));
    let over_campaigns = campaigns::estimated(seed, campaign);
    let converged = convergence::converge(southbound, seed);
    let mut words = vec![
        "The thesis drove between Södertälje and Nyköping. The profile is that of the benchmark of \
         Linköping University (Eriksson, Larsson and Thomasson, 2016), its first 47 km, southbound as \
         it is and northbound reversed. Everything else is as in the study modified: the errors of \
         each run are fitted to tables 2 and 3, the rest is predicted."
            .to_owned(),
    ];
    words.extend(beside::words(&all));
    words.push(format!(
        "Ten more campaigns on the same profile have other GPS errors, wind and noise. {}",
        campaigns::words(&over_campaigns)
    ));
    words.push(converged.words());
    let mut tables = modified::tables(&runs, &all);
    tables.extend(campaigns::tables(&over_campaigns));
    let tables = tables.into_iter().map(|table| Table {
        name: format!("e4_{}", table.name),
        ..table
    });
    let figures = beside::figures(&all).into_iter().map(|figure| Figure {
        name: format!("e4_{}", figure.name),
        ..figure
    });
    Section {
        heading: "The thesis on its own road (tables 5-8, figures 10 and 11)".to_owned(),
        words,
        tables: tables.chain([converged.table()]).collect(),
        figures: figures.chain([converged.figure()]).collect(),
        ..Section::default()
    }
}
