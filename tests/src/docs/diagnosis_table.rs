//! The diagnosis of the measured bus.

use super::pipe_table::pipe_table;
use crate::image::measured_mission;
use host_sim::diagnose::judgement::Judgement;
use host_sim::diagnose::{Diagnosis, Request, diagnose};
use host_sim::error::{Error, Result};
use host_sim::source::ztbus::Mission;
use std::path::PathBuf;

/// Number of passes that are fitted; the others are held out.
const FITTED: usize = 4;

/// Makes the table of the bare model: as imported, with what was adopted, and with each other
/// candidate alone.
pub fn bus() -> Result<Option<String>> {
    let mission = measured_mission();
    if !mission.exists() {
        return Ok(None);
    }
    let mission = Mission::read(&mission)?;
    let folder = tempfile::tempdir().map_err(Error::io(&std::env::temp_dir()))?;
    let mut logs = Vec::new();
    for (number, pass) in mission.passes().iter().enumerate() {
        let log: PathBuf = folder.path().join(format!("pass_{number}.csv"));
        mission.write_pass(&log, pass)?;
        logs.push(log);
    }
    let held_out = logs.split_off(FITTED.min(logs.len()));
    let diagnosis = diagnose(&Request {
        vehicle: mission.vehicle(),
        logs,
        held_out,
        reference: None,
        terrain: None,
        accelerometer: false,
        tuning: Default::default(),
        options: Default::default(),
    })?;
    Ok(Some(table(&diagnosis)))
}

fn table(diagnosis: &Diagnosis) -> String {
    let mut rows = vec![[
        "as imported".to_owned(),
        String::new(),
        drift(&diagnosis.before),
        rmse(&diagnosis.before),
    ]];
    for finding in &diagnosis.findings {
        let adopted = &finding.adopted;
        let (amount, sigma) = (adopted.amount.into(), adopted.amount_sigma.into());
        let amount = with_sigma(amount, sigma, adopted.effect.unit);
        rows.push([
            format!("with `{}` {amount}", adopted.effect.name),
            format!("{:.0}", finding.evidence),
            drift(&diagnosis.after),
            rmse(&diagnosis.after),
        ]);
    }
    let is_adopted = |name| {
        let mut findings = diagnosis.findings.iter();
        findings.any(|finding| finding.adopted.effect.name == name)
    };
    let others = diagnosis.candidates.iter();
    for case in others.filter(|case| !is_adopted(case.name)) {
        let amount = with_sigma(case.amount, case.sigma, case.unit);
        rows.push([
            format!("instead, `{}` {amount}", case.name),
            format!("{:.0}", case.evidence),
            String::new(),
            format!("{:.3}", case.after.rmse_percent),
        ]);
    }
    pipe_table(["the bare model", "evidence", "drift m/km", "RMSE %"], rows)
}

fn drift(of: &Judgement) -> String {
    // 1 % is 10 m per km.
    let (low, high) = of.bias_interval;
    let [low, high] = [low, high].map(|percent| 10.0 * percent);
    format!("{:+.2} ({low:+.1} to {high:+.1})", of.drift_m_per_km)
}

fn rmse(of: &Judgement) -> String {
    let (low, high) = of.rmse_interval;
    format!("{:.3} ({low:.3} to {high:.3})", of.rmse_percent)
}

/// Formats an amount with the decimals of two digits of its sigma.
fn with_sigma(amount: f64, sigma: f64, unit: &str) -> String {
    let decimals = (1.0 - sigma.log10().floor()).clamp(0.0, 6.0) as usize;
    let unit = if unit == "1" {
        String::new()
    } else {
        format!(" {unit}")
    };
    format!("{amount:.decimals$} ± {sigma:.decimals$}{unit}")
}

#[cfg(test)]
mod tests {
    use super::with_sigma;

    #[test]
    fn amounts_have_the_digits_of_their_sigma() {
        assert_eq!(with_sigma(0.119_52, 0.018_06, "1"), "0.120 ± 0.018");
        assert_eq!(with_sigma(865.51, 127.7, "N"), "866 ± 128 N");
        assert_eq!(with_sigma(8.146, 3.112, "m²"), "8.1 ± 3.1 m²");
    }
}
