//! Marks of a run in which signals disagree, and the verdict on it.

use estimator_core::Disagreement;
use estimator_core::sample::Sample;
use host_sim::recorder::verdict::{DisagreementStretch, stretches, verdict};
use host_sim::recorder::{Recorder, RunSummary};
use host_sim::simulator::simulate;
use host_sim::smooth::{Disagreements, Known, SmoothedCell, smooth_pieces};
use test_kit::simulated::scenario;

const CLIMB: &str = "climb by GNSS against climb by the forces";
const SPEED: &str = "wheel speed against engine speed, or from two senders";

/// A drive of 3 km, with what disagrees in some cells, smoothed as a whole.
fn smoothed(disagrees: impl Fn(u32) -> Disagreement) -> (Vec<SmoothedCell>, Disagreements) {
    let text = "[road]\nlength_m = 3000.0\n[[runs]]\nname = \"x\"\ntruck = \"A\"\n";
    let drive = simulate(&scenario(&[text]), 0).unwrap();
    let mut recorder = Recorder::<f32>::new(drive.vehicle.model, Default::default()).unwrap();
    for frame in &drive.frames {
        recorder.on_frame(frame);
    }
    let context = recorder.estimator().context().clone();
    let (_, mut samples) = recorder.finish_with_samples().unwrap();
    for sample in &mut samples {
        sample.disagreement = disagrees(sample.end.cell);
    }
    let mut cells = Vec::new();
    let mut held: &[Sample] = &samples;
    let Ok(found) = smooth_pieces(&context, Known::default(), &mut held, None, |_, piece| {
        cells.extend(piece);
        Ok(())
    });
    (cells, found)
}

fn stretch(what: &'static str, from_m: f64, to_m: f64) -> DisagreementStretch {
    DisagreementStretch { what, from_m, to_m }
}

#[test]
fn cells_in_which_signals_disagree_are_marked_and_told() {
    let (cells, found) = smoothed(|cell| Disagreement {
        climb: (401..=500).contains(&cell),
        // A stretch with a gap of 50 m, and another one far away.
        speed: (441..=460).contains(&cell)
            || (481..=520).contains(&cell)
            || (801..=810).contains(&cell),
        ..Disagreement::default()
    });
    for cell in &cells {
        let is_marked =
            (401..=520).contains(&cell.end.cell) || (801..=810).contains(&cell.end.cell);
        assert_eq!(cell.is_consistent, !is_marked, "cell {}", cell.end.cell);
    }
    let stretches = stretches(&found);
    assert_eq!(
        stretches,
        [
            stretch(CLIMB, 1_000.0, 1_250.0),
            stretch(SPEED, 1_100.0, 1_300.0),
            stretch(SPEED, 2_000.0, 2_025.0),
        ]
    );
    let marked = cells.iter().filter(|cell| !cell.is_consistent).count();
    assert_eq!(marked, 130);
    assert_eq!(
        verdict(cells.len(), marked, &stretches, &[]),
        format!("suspect: {CLIMB}; {SPEED}")
    );
}

#[test]
fn a_drive_without_disagreement_is_consistent() {
    let (cells, found) = smoothed(|_| Disagreement::default());
    assert!(cells.iter().all(|cell| cell.is_consistent));
    assert_eq!(stretches(&found), []);
    assert_eq!(verdict(cells.len(), 0, &[], &[]), "consistent");
}

#[test]
fn the_summary_ends_with_mass_and_verdict() {
    let text = "[road]\nlength_m = 8000.0\n[[runs]]\nname = \"x\"\ntruck = \"A\"\n";
    let drive = simulate(&scenario(&[text]), 0).unwrap();
    let mut recorder = Recorder::<f32>::new(drive.vehicle.model, Default::default()).unwrap();
    for frame in &drive.frames {
        recorder.on_frame(frame);
    }
    let summary = RunSummary::new(&mut recorder.end().unwrap()).unwrap();
    let json = serde_json::to_value(&summary).unwrap();
    assert_eq!(json["verdict"], "consistent");
    assert_eq!(json["suspect_km"], 0.0);
    assert_eq!(json["disagreements"], serde_json::json!([]));
    let (mass_kg, sigma_kg) = (
        json["mass_kg"].as_f64().unwrap(),
        json["mass_sigma_kg"].as_f64().unwrap(),
    );
    // The torque is right within 4 %, and the scale nearly known.
    assert!((1_500.0..3_000.0).contains(&sigma_kg), "{sigma_kg}");
    assert!((mass_kg - 39_000.0).abs() < 2.0 * sigma_kg, "{mass_kg}");
    let table = summary.table().to_string();
    assert!(table.contains("verdict") && table.contains("gross mass, end"));
}

#[test]
fn a_drive_is_suspect_from_one_per_cent_and_200_m_on() {
    let told = [stretch(SPEED, 0.0, 500.0)];
    let suspect = format!("suspect: {SPEED}");
    for (cells, marked, expected) in [
        (20_000, 200, "consistent"),
        (20_000, 201, &suspect),
        (1_000, 79, "consistent"),
        (1_000, 80, &suspect),
        (0, 0, "consistent"),
    ] {
        assert_eq!(
            verdict(cells, marked, &told, &[]),
            expected,
            "{marked} of {cells}"
        );
    }
}
