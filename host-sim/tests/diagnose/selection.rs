//! Selection of effects on evidence made by hand.

use estimator_core::CELL_LENGTH_M;
use host_sim::diagnose::candidates::{Candidate, Detail, DriveFacts, Menu};
use host_sim::diagnose::evidence::{Evidence, SegmentSums};
use host_sim::diagnose::selection::{Selection, Selector};
use nalgebra::{DMatrix, DVector};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

const DRIVES: usize = 4;
const SEGMENTS: usize = 10;
const MEASUREMENTS: usize = 40;

/// Responses of some columns to one usual amount each, in one measurement of a drive.
type Responses = Vec<(usize, f64)>;

fn menu() -> Menu {
    Menu::new(&DriveFacts {
        fitted: DRIVES,
        of: DRIVES,
        road_m: None,
        temperatures_k: 20.0,
        duration_s: 1_000.0,
    })
}

fn candidate<'m>(menu: &'m Menu, name: &str) -> &'m Candidate {
    let mut candidates = menu.candidates.iter();
    candidates.find(|candidate| candidate.name == name).unwrap()
}

/// Returns the columns of a candidate's first choice.
fn columns(menu: &Menu, name: &str) -> Vec<usize> {
    let choice = &candidate(menu, name).choices[0];
    choice.amounts.iter().flatten().copied().collect()
}

/// Returns evidence in which these amounts of columns are missing. `responses` draws those of one
/// measurement of a drive; innovations have unit variance.
fn evidence(
    menu: &Menu,
    missing: &[(usize, f64)],
    mut responses: impl FnMut(usize, &mut dyn FnMut() -> f64) -> Responses,
) -> Evidence {
    let mut rng = ChaCha8Rng::seed_from_u64(7);
    let mut normal = move || -> f64 { StandardNormal.sample(&mut rng) };
    let mut segments = Vec::new();
    for drive in 0..DRIVES {
        for _ in 0..SEGMENTS {
            let mut sums = SegmentSums {
                drive,
                information: DMatrix::zeros(menu.width(), menu.width()),
                score: DVector::zeros(menu.width()),
                negative_log_likelihood: 0.0,
            };
            for _ in 0..MEASUREMENTS {
                let mut response = DVector::zeros(menu.width());
                for (column, value) in responses(drive, &mut normal) {
                    response[column] = value;
                }
                let expected: f64 = missing
                    .iter()
                    .map(|(c, amount)| amount * response[*c])
                    .sum();
                let innovation = expected + normal();
                sums.information.ger(1.0, &response, &response, 1.0);
                sums.score.axpy(innovation, &response, 1.0);
            }
            segments.push(sums);
        }
    }
    segments.into_iter().collect()
}

fn select(menu: &Menu, evidence: &Evidence) -> Selection {
    Selector::new(menu, evidence, |_| false).select(None)
}

fn names(menu: &Menu, selection: &Selection) -> Vec<&'static str> {
    let steps = selection.steps.iter();
    let mut names: Vec<_> = steps
        .map(|step| menu.candidates[step.adopted.candidate].name)
        .collect();
    names.sort_unstable();
    names
}

/// Returns the column of an effect with one amount, and its usual amount.
fn single(menu: &Menu, name: &str) -> (usize, f64) {
    (columns(menu, name)[0], candidate(menu, name).typical)
}

#[test]
fn an_effect_that_later_ones_explain_is_dropped() {
    let menu = menu();
    let (rolling, rolling_amount) = single(&menu, "rolling_resistance");
    let (bends, bends_amount) = single(&menu, "cornering");
    let (mass, mass_amount) = single(&menu, "mass");
    let evidence = evidence(
        &menu,
        &[(rolling, rolling_amount), (bends, bends_amount)],
        |_, normal| {
            let (one, other) = (0.5 * normal(), 0.5 * normal());
            // Half of both, and not quite: the best single explanation of the two.
            let both = one + other + 0.25 * normal();
            vec![
                (rolling, one / rolling_amount),
                (bends, other / bends_amount),
                (mass, both / mass_amount),
            ]
        },
    );
    let selection = select(&menu, &evidence);
    let best = selection
        .alone
        .iter()
        .max_by(|a, b| a.evidence.total_cmp(&b.evidence));
    assert_eq!(menu.candidates[best.unwrap().candidate].name, "mass");
    assert_eq!(
        names(&menu, &selection),
        ["cornering", "rolling_resistance"]
    );
}

#[test]
fn two_effects_that_hide_each_other_are_found_together() {
    let menu = menu();
    let (torque, torque_amount) = single(&menu, "torque_scale");
    let (loss, loss_amount) = single(&menu, "driveline_loss");
    let evidence = evidence(
        &menu,
        &[(torque, torque_amount), (loss, loss_amount)],
        |_, normal| {
            let one = normal();
            vec![
                (torque, one / torque_amount),
                (loss, (0.3 * normal() - one) / loss_amount),
            ]
        },
    );
    let selection = select(&menu, &evidence);
    for case in &selection.alone {
        let name = menu.candidates[case.candidate].name;
        assert!(case.evidence < 8.0, "{name}: {}", case.evidence);
    }
    assert_eq!(names(&menu, &selection), ["driveline_loss", "torque_scale"]);
}

#[test]
fn a_pair_that_one_effect_imitates_is_in_its_group() {
    let menu = menu();
    let (torque, torque_amount) = single(&menu, "torque_scale");
    let (mass, mass_amount) = single(&menu, "mass");
    let (drag, drag_amount) = single(&menu, "air_drag");
    let evidence = evidence(
        &menu,
        &[(mass, mass_amount), (drag, drag_amount)],
        |_, normal| {
            let (one, other) = (normal(), normal());
            vec![
                (mass, one / mass_amount),
                (drag, other / drag_amount),
                (torque, (one + other) / torque_amount),
            ]
        },
    );
    let selection = select(&menu, &evidence);
    assert_eq!(names(&menu, &selection), ["torque_scale"]);
    let pairs = &selection.steps[0].pairs;
    let names: Vec<_> = pairs
        .iter()
        .map(|pair| pair.map(|candidate| menu.candidates[candidate].name))
        .collect();
    assert!(names.contains(&["air_drag", "mass"]), "{names:?}");
}

#[test]
fn drives_that_began_cold_share_one_amount() {
    let menu = menu();
    let of_drives = columns(&menu, "tyre_warmup");
    assert_eq!(of_drives.len(), DRIVES);
    let missing = [(of_drives[0], 0.8), (of_drives[2], 0.8)];
    let evidence = evidence(&menu, &missing, |drive, normal| {
        vec![(of_drives[drive], 0.6 * normal())]
    });
    let selection = select(&menu, &evidence);
    assert_eq!(names(&menu, &selection), ["tyre_warmup"]);
    let adopted = &selection.steps[0].adopted;
    let Detail::SomeDrives { with, of, .. } = adopted.choice.detail else {
        panic!("{:?}", adopted.choice.detail);
    };
    assert_eq!((with, of), (2, DRIVES));
    assert!((adopted.amounts[0] - 0.8).abs() < 4.0 * adopted.sigma(0));
    // Both drives count: the sigma is less than that of one.
    let one = 1.0 / (0.6 * ((SEGMENTS * MEASUREMENTS) as f64).sqrt());
    assert!(
        adopted.sigma(0) < 0.9 * one,
        "{} of {one}",
        adopted.sigma(0)
    );
}

#[test]
fn drives_of_which_each_differs_keep_their_own_amounts() {
    let menu = menu();
    let of_drives = columns(&menu, "tyre_warmup");
    let missing: Vec<(usize, f64)> = of_drives
        .iter()
        .copied()
        .zip([0.4, 1.0, 1.6, 2.4])
        .collect();
    let evidence = evidence(&menu, &missing, |drive, normal| {
        vec![(of_drives[drive], 0.6 * normal())]
    });
    let selection = select(&menu, &evidence);
    let adopted = &selection.steps[0].adopted;
    assert!(matches!(adopted.choice.detail, Detail::EachDrive(..)));
    for (amount, (_, expected)) in adopted.amounts.iter().zip(missing) {
        assert!((amount - expected).abs() < 0.4, "{:?}", adopted.amounts);
    }
}

#[test]
fn both_parts_of_a_wind_have_their_covariance() {
    let menu = menu();
    let parts = columns(&menu, "headwind");
    let [north, east] = parts[..] else {
        panic!("{parts:?}");
    };
    // A road to the north-east: what one part adds, the other takes.
    let evidence = evidence(&menu, &[(north, 3.0), (east, 3.0)], |_, normal| {
        let along = normal();
        let across = 0.2 * normal();
        vec![(north, along + across), (east, along - across)]
    });
    let selection = select(&menu, &evidence);
    assert_eq!(names(&menu, &selection), ["headwind"]);
    let adopted = &selection.steps[0].adopted;
    let covariance = &adopted.covariance;
    let correlation = covariance[(0, 1)] / (adopted.sigma(0) * adopted.sigma(1));
    assert!(correlation < -0.8, "{correlation}");
    // Along the road the wind is known much better than either part.
    let along = DVector::from_element(2, 0.5_f64.sqrt());
    let sigma = along.dot(&(covariance * &along)).sqrt();
    assert!(sigma < 0.5 * adopted.sigma(0), "{sigma}");
}

#[test]
fn an_effect_of_temperature_needs_other_temperatures() {
    let of = |temperatures_k| {
        let menu = Menu::new(&DriveFacts {
            fitted: DRIVES,
            of: DRIVES,
            road_m: None,
            temperatures_k,
            duration_s: 1_000.0,
        });
        let mut candidates = menu.candidates.iter();
        candidates.any(|candidate| candidate.name == "tyre_temperature")
    };
    assert!(!of(1.0));
    assert!(of(10.0));
}

#[test]
fn a_cycle_repeats_on_a_drive() {
    let periods = |duration_s| {
        let menu = Menu::new(&DriveFacts {
            fitted: 1,
            of: 1,
            road_m: Some(f64::from(CELL_LENGTH_M) * 1_000.0),
            temperatures_k: 0.0,
            duration_s,
        });
        candidate(&menu, "time (a cycle)").choices.len()
    };
    assert!(periods(600.0) < periods(6_000.0));
    assert!(periods(10.0) >= 1);
}
