//! Value of each sensor: the same drives without one signal or another.

use super::definition::{Setting, Study, StudyOutcome};
use super::drive_errors::{DriveErrors, DriveOnRoad, ErrorSums, WORDS, mean_of};
use crate::error::Result;
use crate::report::page::{Section, Table};
use crate::score::END_CUT_M;
use crate::simulator::truck::Preset;
use crate::terminal::progress;
use estimator_core::signal::Signal;
use rayon::prelude::*;

/// The study, for the list.
pub const STUDY: Study = Study {
    name: "sensors",
    about: "errors without friction torque, gear, brakes, GNSS altitude, ...: what each sensor is worth",
    run,
};

/// Roads for each truck. Each road is driven in both directions.
const ROADS: u64 = 5;
/// The receiver's slow altitude error, 1 sigma, m.
const RECEIVER_M: f64 = 2.0;
const TRUCKS: [Preset; 2] = [Preset::A, Preset::B];

const GEAR: &[Signal] = &[Signal::CurrentGear, Signal::SelectedGear, Signal::GearRatio];
const SHIFTS: &[Signal] = &[
    Signal::DrivelineEngaged,
    Signal::ShiftInProcess,
    Signal::ClutchSlip,
    Signal::OutputShaftSpeed,
];
const BRAKES: &[Signal] = &[
    Signal::BrakeSwitch,
    Signal::BrakePedal,
    Signal::BrakePressure,
    Signal::ParkingBrake,
];
const QUALITY: &[Signal] = &[
    Signal::FixMethod,
    Signal::Satellites,
    Signal::Hdop,
    Signal::Vdop,
];
const POSITION: &[Signal] = &[Signal::Latitude, Signal::Longitude];
const MOTION: &[Signal] = &[Signal::Course, Signal::GnssSpeed];
const AIR: &[Signal] = &[Signal::AmbientTemperature, Signal::AirPressure];
const ENGINE_SPEED: &[Signal] = &[Signal::EngineSpeed, Signal::ClutchSwitch];
const NEEDED: &[Signal] = &[
    Signal::WheelSpeed,
    Signal::EngineTorque,
    Signal::CurrentGear,
    Signal::Latitude,
    Signal::Longitude,
    Signal::Altitude,
];

/// Returns the cases: missing sensors in words, and their signals.
fn cases() -> Vec<(&'static str, Vec<Signal>)> {
    let all_but_needed = Signal::ALL.iter().filter(|signal| !NEEDED.contains(signal));
    vec![
        ("nothing", vec![]),
        ("mass (1760)", vec![Signal::Mass]),
        ("temperature, air pressure (171, 108)", AIR.to_vec()),
        ("friction torque (514)", vec![Signal::FrictionTorque]),
        ("retarder torque (520)", vec![Signal::RetarderTorque]),
        ("brake signals (597, 521, 70)", BRAKES.to_vec()),
        (
            "brake signals and retarder torque",
            [BRAKES, &[Signal::RetarderTorque]].concat(),
        ),
        ("gear (523, 524, 526)", GEAR.to_vec()),
        ("shift flags (560, 574, 522, 191)", SHIFTS.to_vec()),
        ("gear and shift flags", [GEAR, SHIFTS].concat()),
        (
            "gear, shift flags, engine speed, clutch",
            [GEAR, SHIFTS, ENGINE_SPEED].concat(),
        ),
        ("wheel speed (84)", vec![Signal::WheelSpeed]),
        ("front axle speed (904)", vec![Signal::FrontAxleSpeed]),
        (
            "GNSS quality (method, satellites, HDOP, VDOP)",
            QUALITY.to_vec(),
        ),
        ("GNSS course and speed", MOTION.to_vec()),
        ("GNSS altitude", vec![Signal::Altitude]),
        (
            "GNSS, all of it",
            [QUALITY, POSITION, MOTION, &[Signal::Altitude]].concat(),
        ),
        ("engine torque (513)", vec![Signal::EngineTorque]),
        (
            "all but wheel speed, engine torque, gear, GNSS fixes",
            all_but_needed.copied().collect(),
        ),
    ]
}

/// Errors on the drives of one truck in one case; `None` where there is no estimate.
type OfTruck = Vec<Option<DriveErrors>>;

fn run(setting: &Setting) -> Result<StudyOutcome> {
    let cases = cases();
    let bar = progress::count(TRUCKS.len() as u64 * 2 * ROADS, "drives");
    let mut of_trucks = Vec::new();
    for truck in TRUCKS {
        let drives = (0..2 * ROADS)
            .into_par_iter()
            .map(|i| {
                let drive = DriveOnRoad::new(setting.seed + i / 2, truck, i % 2 == 1, RECEIVER_M)?;
                let of_cases = cases
                    .iter()
                    .map(|(_, missing)| drive.errors(missing))
                    .collect();
                bar.inc(1);
                Ok(of_cases)
            })
            .collect::<Result<Vec<OfTruck>>>()?;
        of_trucks.push(drives);
    }
    bar.finish_and_clear();
    Ok(StudyOutcome::Done(Section {
        heading: "Which sensors permit which error".to_owned(),
        words: vec![format!(
            "{} drives of 40 km for each truck and line, the same in all lines. {WORDS} The \
             receiver's altitude has a slow error of {RECEIVER_M:.0} m. The first and last \
             {END_CUT_M:.0} m are left out. The signals of a line are missing from the bus for the \
             whole drive.",
            2 * ROADS
        )],
        tables: vec![table(&cases, &of_trucks)],
        ..Section::default()
    }))
}

fn table(cases: &[(&str, Vec<Signal>)], of_trucks: &[Vec<OfTruck>]) -> Table {
    let rows = cases.iter().enumerate().map(|(case, (missing, _))| {
        let mut row = vec![(*missing).to_owned()];
        for drives in of_trucks {
            let found: Vec<&DriveErrors> = drives
                .iter()
                .filter_map(|of_cases| of_cases[case].as_ref())
                .collect();
            let kinds: [fn(&DriveErrors) -> &ErrorSums; 3] =
                [|e| &e.smoothed, |e| &e.lagged, |e| &e.live];
            let mean = |value: &dyn Fn(&DriveErrors) -> f64| mean_of(found.iter().copied(), value);
            if found.is_empty() {
                row.extend(["none"; 4].map(str::to_owned));
                continue;
            }
            row.extend(kinds.map(|of| format!("{:.3}", mean(&|errors| of(errors).rmse()))));
            row.push(format!("{:.2}", mean(&|errors| errors.smoothed.nees())));
        }
        row
    });
    Table::new(
        "sensors",
        "Mean RMSE of grade over drives (%), and the mean normalised squared error of the \
         smoothed grade (NEES, 1 if the stated sigmas are consistent), without the signals (SPN) \
         of the first column. \"None\": the estimator has no output.",
        &[
            "missing",
            "A smoothed %",
            "A lagged %",
            "A live %",
            "A NEES",
            "B smoothed %",
            "B lagged %",
            "B live %",
            "B NEES",
        ],
    )
    .with_rows(rows)
}
