//! Findings in words.

use crate::diagnose::findings::{Diagnosis, Finding};
use crate::diagnose::judgement::WINDOW_M;
use crate::diagnose::signal_judgement::JUDGED;
use estimator_core::effect::{self, search_of};

/// Returns the text of a number, or that it is not known: too few windows have no interval, and none
/// has no error.
pub(super) fn if_known(number: f64, text: String) -> String {
    if number.is_finite() {
        text
    } else {
        "unknown".to_owned()
    }
}

/// Returns a number with three decimals, or that it is not known.
#[must_use]
pub fn three_digits(number: f64) -> String {
    if_known(number, format!("{number:.3}"))
}

/// Returns the errors before and after, or that there are none.
fn errors_in_words(diagnosis: &Diagnosis) -> String {
    if diagnosis.before.windows.is_empty() {
        return format!(" No drive has a valid window of {WINDOW_M:.0} m to judge by.");
    }
    format!(
        " On drives {}, the RMSE of the bare model is {:.3} % grade before and {:.3} % after \
         (windows of {WINDOW_M:.0} m); its altitude drifts by {:+.2} and {:+.2} m per km.",
        if diagnosis.judged_on_fitted {
            "that were fitted too"
        } else {
            "held out"
        },
        diagnosis.before.rmse_percent,
        diagnosis.after.rmse_percent,
        diagnosis.before.drift_m_per_km,
        diagnosis.after.drift_m_per_km,
    )
}

/// Returns what terrain and accelerometer say of the drives judged, if they were asked.
fn beside_in_words(diagnosis: &Diagnosis) -> String {
    let mut words = String::new();
    if let Some([before, after]) = &diagnosis.terrain {
        words += &format!(
            " Against terrain, its altitude drifts by {:+.2} and {:+.2} m per km.",
            before.drift_m_per_km, after.drift_m_per_km
        );
    }
    if let Some([before, after]) = &diagnosis.accelerometer {
        let overall = JUDGED.iter().filter_map(|(name, of)| {
            let (before, after) = (before.overall(*of)?, after.overall(*of)?);
            let rms = [before, after].map(|overall| overall.median_rms_percent);
            Some(format!("{name} {:.3} and {:.3} %", rms[0], rms[1]))
        });
        let overall: Vec<String> = overall.collect();
        words += &format!(
            " Against the accelerometer, the median RMSE of a drive before and after is: {}.",
            overall.join("; ")
        );
    }
    words
}

/// Returns a summary in words.
#[must_use]
pub fn in_a_sentence(diagnosis: &Diagnosis) -> String {
    let names: Vec<String> = diagnosis.findings.iter().map(amount_in_words).collect();
    let mut words = if names.is_empty() {
        "Nothing is adopted: the drives give no evidence of an effect beyond the model.".to_owned()
    } else {
        format!("Adopted: {}.", names.join("; "))
    };
    words += &errors_in_words(diagnosis);
    words += &beside_in_words(diagnosis);
    for rest in &diagnosis.unexplained {
        words += &format!(
            " Unexplained: {:.2} % that depends on {}.",
            rest.rms_percent, rest.depends_on
        );
    }
    words
}

fn amount_in_words(finding: &Finding) -> String {
    let adopted = &finding.adopted;
    let unit = match adopted.effect.unit {
        "1" => String::new(),
        unit => format!(" {unit}"),
    };
    let mut words = format!(
        "{} {}{unit} ± {}",
        adopted.effect.name,
        short(f64::from(adopted.amount)),
        short(f64::from(adopted.amount_sigma)),
    );
    if !finding.group.is_empty() {
        words += &format!(
            " (or {}, which these drives cannot separate from it)",
            finding.group.join(", ")
        );
    }
    words
}

/// Formats a number with three significant digits.
pub(super) fn short(value: f64) -> String {
    let digits = if value == 0.0 {
        0
    } else {
        (2.0 - value.abs().log10().floor()).clamp(0.0, 6.0) as usize
    };
    format!("{value:.digits$}")
}

/// Returns the data that would separate an effect from similar ones.
pub(super) fn separated_by(name: &str) -> Option<&'static str> {
    Some(search_of(effect::named(name)?)?.separated_by)
}
