//! Whether logs are of one vehicle.

use super::gears;
use super::observation::Observation;
use crate::error::{Error, Result, on_one_line};
use estimator_core::Signal;
use std::path::{Path, PathBuf};

/// Largest spread of final drive over wheel radius between logs of one vehicle, relative: worn and
/// new tyres differ by 0.02 to 0.03.
const AXLES: f64 = 0.04;
/// Largest relative spread of a constant of the vehicle that the bus sends.
const TOLD: f64 = 0.02;
/// Largest factor between masses that the bus tells: of a tractor alone, and of a loaded road train.
const MASSES: f64 = 10.0;
/// Constants of the vehicle that a bus tells, with their names and units, and the largest spread.
const CONSTANTS: [(Signal, &str, &str, f64); 3] = [
    (
        Signal::EngineReferenceTorque,
        "a reference torque",
        "Nm",
        TOLD,
    ),
    (
        Signal::RetarderReferenceTorque,
        "a reference torque of the retarder",
        "Nm",
        TOLD,
    ),
    (Signal::Mass, "a mass", "kg", MASSES - 1.0),
];

/// Refuses logs that contradict each other about the vehicle.
///
/// # Errors
/// Names two logs, and what differs.
pub(super) fn check(logs: &[PathBuf], observed: &[Observation]) -> Result<()> {
    numbers(logs, observed)?;
    for (signal, name, unit, most) in CONSTANTS {
        let told = |of: &Observation| of.told(signal).map(|(mean, _)| mean);
        if let Some((least, greatest)) = spread(logs, observed, told)
            && greatest.1 / least.1 - 1.0 > most
        {
            let of = |(_, value): (&PathBuf, f64)| format!("{name} of {value:.0} {unit}");
            return Err(error(least.0, &of(least), greatest.0, &of(greatest)));
        }
    }
    if let Some((least, greatest)) = spread(logs, observed, gears::direct_turns_per_m)
        && greatest.1 / least.1 - 1.0 > AXLES
    {
        let percent = 100.0 * (greatest.1 / least.1 - 1.0);
        let more = format!(
            "an engine that turns {percent:.0} % further for a metre in the same gear ratio"
        );
        return Err(error(greatest.0, &more, least.0, "another axle or wheels"));
    }
    gearboxes(logs, observed)
}

/// Refuses logs with two vehicle identification numbers.
fn numbers(logs: &[PathBuf], observed: &[Observation]) -> Result<()> {
    let numbers = logs.iter().zip(observed);
    let mut numbers = numbers.filter_map(|(log, of)| Some((log, of.vehicle_number.as_ref()?)));
    let Some((first, number)) = numbers.next() else {
        return Ok(());
    };
    match numbers.find(|(_, other)| *other != number) {
        Some((log, other)) => {
            let has = |number| format!("the identification number {number}");
            Err(error(log, &has(other), first, &has(number)))
        }
        None => Ok(()),
    }
}

/// Refuses logs whose numbered gears mostly have other ratios.
fn gearboxes(logs: &[PathBuf], observed: &[Observation]) -> Result<()> {
    let with_ratios = || {
        logs.iter()
            .zip(observed)
            .map(|(log, of)| (log, gears::reported(of)))
    };
    let Some((first, ratios)) = with_ratios().max_by_key(|(_, ratios)| ratios.len()) else {
        return Ok(());
    };
    for (other, others) in with_ratios() {
        let shared = others
            .iter()
            .filter_map(|(gear, ratio)| Some((*ratio, *ratios.get(gear)?)));
        let differ: Vec<bool> = shared.map(|(a, b)| (a / b - 1.0).abs() > AXLES).collect();
        let count = differ.iter().filter(|differs| **differs).count();
        if differ.len() >= 2 && 2 * count > differ.len() {
            let what = format!("{count} gears with other ratios");
            return Err(error(other, &what, first, "its own"));
        }
    }
    Ok(())
}

/// The logs with the least and the greatest value.
type Spread<'l> = ((&'l PathBuf, f64), (&'l PathBuf, f64));

fn spread<'l>(
    logs: &'l [PathBuf],
    observed: &[Observation],
    value: impl Fn(&Observation) -> Option<f64>,
) -> Option<Spread<'l>> {
    let values = logs.iter().zip(observed);
    let values: Vec<(&PathBuf, f64)> = values
        .filter_map(|(log, of)| Some((log, value(of)?)))
        .collect();
    let least = values.iter().min_by(|a, b| a.1.total_cmp(&b.1))?;
    let greatest = values.iter().max_by(|a, b| a.1.total_cmp(&b.1))?;
    Some((*least, *greatest))
}

fn error(first: &Path, has: &str, other: &Path, others: &str) -> Error {
    let problem = format!(
        "is of another vehicle than {}: it has {has}, that has {others}; give the logs of one vehicle, or \
         say what it is (--like, or a vehicle file)",
        on_one_line(other)
    );
    Error::content(first, problem)
}
