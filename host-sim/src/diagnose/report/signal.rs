//! Model and estimates against the accelerometer: JSON and a section of the page.

use crate::diagnose::findings::Diagnosis;
use crate::diagnose::signal_judgement::{
    DriveAgainstSignal, DriveErrors, JUDGED, OfDrive, Overall, SignalJudgement, WINDOW_M,
};
use crate::report::page::{Section, Table};
use estimator_core::Signal;
use serde_json::{Map, Value, json};
use std::path::Path;

/// Returns the judgement by the accelerometer for report.json: `null` without one.
pub(super) fn to_json(diagnosis: &Diagnosis) -> Value {
    let Some([before, after]) = &diagnosis.accelerometer else {
        return Value::Null;
    };
    json!({
        "signal": Signal::LongitudinalAcceleration.column(),
        "window_m": WINDOW_M,
        "before": judgement(before, diagnosis),
        "after": judgement(after, diagnosis),
    })
}

fn judgement(judgement: &SignalJudgement, diagnosis: &Diagnosis) -> Value {
    let mut json: Map<String, Value> = JUDGED
        .iter()
        .map(|(name, of)| {
            (
                (*name).to_owned(),
                judgement.overall(*of).map_or(Value::Null, overall),
            )
        })
        .collect();
    let drives = judgement.drives.iter().map(|drive| {
        let mut json: Map<String, Value> = JUDGED
            .iter()
            .map(|(name, of)| ((*name).to_owned(), of(drive).map_or(Value::Null, errors)))
            .collect();
        json.insert("log".to_owned(), name_of(drive, diagnosis).into());
        Value::Object(json)
    });
    json.insert("drives".to_owned(), drives.collect());
    Value::Object(json)
}

fn overall(overall: Overall) -> Value {
    json!({
        "mean_percent": overall.mean_percent,
        "median_rms_percent": overall.median_rms_percent,
        "nine_in_ten_rms_percent": overall.ninth_rms_percent,
    })
}

fn errors(errors: DriveErrors) -> Value {
    json!({
        "mean_percent": errors.mean_percent,
        "rms_percent": errors.rms_percent,
        "windows": errors.windows,
    })
}

fn name_of(drive: &DriveAgainstSignal, diagnosis: &Diagnosis) -> String {
    let path = diagnosis.judged.get(drive.drive);
    let name = path.and_then(|path| Path::file_name(path));
    name.map_or_else(String::new, |name| name.to_string_lossy().into_owned())
}

/// Returns the section of the page, if there is an accelerometer.
pub(super) fn section(diagnosis: &Diagnosis) -> Option<Section> {
    let [before, after] = diagnosis.accelerometer.as_ref()?;
    let header = [
        "drive",
        "bare: mean % before",
        "after",
        "RMS % before",
        "after",
        "smoothed: RMS % before",
        "after",
        "live: RMS % before",
        "after",
    ];
    let [bare, smoothed, _, live] = JUDGED.map(|(_, of)| of);
    let rows = before
        .drives
        .iter()
        .zip(&after.drives)
        .map(|(before, after)| {
            let mean = |of: OfDrive, drive| {
                of(drive).map_or_else(String::new, |e| format!("{:+.3}", e.mean_percent))
            };
            let rms = |of: OfDrive, drive| {
                of(drive).map_or_else(String::new, |e| format!("{:.3}", e.rms_percent))
            };
            let mut row = vec![
                name_of(before, diagnosis),
                mean(bare, before),
                mean(bare, after),
            ];
            for of in [bare, smoothed, live] {
                row.extend([rms(of, before), rms(of, after)]);
            }
            row
        });
    let caption = "The mean has the offset of the sensor in it; the RMS is without the mean.";
    Some(Section {
        heading: "Against the accelerometer".to_owned(),
        words: vec![format!(
            "Grade by the accelerometer, which the estimates did not see, over windows of \
             {WINDOW_M:.0} m. The bare model is judged where it holds."
        )],
        tables: vec![Table::new("accelerometer", caption, &header).with_rows(rows)],
        ..Section::default()
    })
}
