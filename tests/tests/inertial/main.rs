//! What an accelerometer is worth: the live estimate where the force model does not hold.

#![allow(clippy::unwrap_used)]

mod drive;

fn plain_motorway(truck: &str, seed: u64, more: &str) -> String {
    format!(
        "seed = {seed}\n[road]\nlength_m = 30000.0\n{more}[[runs]]\nname = \"x\"\ntruck = \"{truck}\"\n"
    )
}

use drive::{Fault, LiveCell, errors, live, scenario};

#[test]
fn table() {
    for truck in ["A", "B"] {
        for seed in [1, 2, 3] {
            let (acc, smooth) = (
                "[accelerometer]\n",
                "[accelerometer]\nroughness_mps2 = 0.1\n",
            );
            for (sensor, text) in [
                ("-", scenario(truck, seed, "")),
                ("acc .3", scenario(truck, seed, acc)),
                ("acc .1", scenario(truck, seed, smooth)),
                ("plain -", plain_motorway(truck, seed, "")),
                ("plain .1", plain_motorway(truck, seed, smooth)),
            ] {
                let judged = |c: &LiveCell| c.distance_m > 500.0 && c.distance_m < 29_500.0;
                let plain = live(&text, Fault::None);
                let all = errors(&plain.cells, judged);
                let late = errors(&plain.cells, |c| judged(c) && c.distance_m > 5_000.0);
                let valid = errors(&plain.cells, |c| judged(c) && c.condition.is_valid());
                let invalid = errors(&plain.cells, |c| judged(c) && !c.condition.is_valid());
                println!(
                    "{truck}{seed} {} | all {:.4} nees {:.2} | >5km {:.4} nees {:.2} | valid {:.4} {:.2} | shift/brake {} {:.4} {:.2} ratio {:.2}",
                    sensor,
                    all.rmse_percent,
                    all.nees,
                    late.rmse_percent,
                    late.nees,
                    valid.rmse_percent,
                    valid.nees,
                    invalid.cells,
                    invalid.rmse_percent,
                    invalid.nees,
                    invalid.rmse_percent / valid.rmse_percent
                );
                let mut since: Option<f64> = None;
                for (i, c) in plain.cells.iter().enumerate() {
                    let on = c.disagreement.torque;
                    if on && since.is_none() {
                        since = Some(c.distance_m);
                    }
                    if !on && let Some(from) = since.take() {
                        println!(
                            "    marked {from:.0} .. {:.0} m; {:?}",
                            c.distance_m, plain.counters.accelerometers_rejected
                        );
                    }
                    let _ = i;
                }
                let missing = live(&text, Fault::TorqueMissing(600.0, 720.0));
                let during = errors(&missing.cells, |c| c.time_s > 600.0 && c.time_s < 722.0);
                let stuck = live(&text, Fault::TorqueStuck(600.0, 660.0));
                let in_stuck = |c: &LiveCell| c.time_s > 600.0 && c.time_s < 661.0;
                if std::env::var("DEBUG").is_ok() {
                    let first = stuck
                        .cells
                        .iter()
                        .find(|c| c.time_s > 600.0)
                        .unwrap()
                        .traction_percent;
                    let t: Vec<String> = stuck
                        .cells
                        .iter()
                        .filter(|c| c.time_s > 600.0 && c.time_s < 626.0)
                        .step_by(10)
                        .map(|c| {
                            format!("{:.1}:{:.2}", c.time_s - 600.0, c.traction_percent - first)
                        })
                        .collect();
                    println!("    traction {first:.2} {}", t.join(" "));
                }
                let held = errors(&stuck.cells, in_stuck);
                let unmarked = errors(&stuck.cells, |c| in_stuck(c) && c.disagreement.is_none());
                let seen = stuck
                    .cells
                    .iter()
                    .find(|c| c.time_s > 600.0 && c.disagreement.torque);
                let without_gnss = text.replacen(
                    "[[runs]]",
                    "[gnss]\noutages_m = [[12000.0, 22000.0]]\n[[runs]]",
                    1,
                );
                let dark = live(&without_gnss, Fault::None);
                let end = dark
                    .cells
                    .iter()
                    .rev()
                    .find(|c| c.distance_m < 21_950.0)
                    .unwrap();
                println!(
                    "    missing {:.3} nees {:.2} | stuck {:.3} nees {:.2} seen {:?} unmarked {} {:.3} {:.2} | altitude {:.2} of {:.2} m",
                    during.rmse_percent,
                    during.nees,
                    held.rmse_percent,
                    held.nees,
                    seen.map(|c| (10.0 * (c.time_s - 600.0)).round() / 10.0),
                    unmarked.cells,
                    unmarked.rmse_percent,
                    unmarked.nees,
                    end.altitude_error_m.unwrap(),
                    end.altitude_sigma_m
                );
            }
        }
    }
}
