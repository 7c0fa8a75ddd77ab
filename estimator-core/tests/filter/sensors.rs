//! Vertical speed, accelerometer and pitch.

use estimator_core::estimator::CellEstimator;
use estimator_core::sample::{InertialMeasurement, Sample, SlopeMeasurement, SlopeSensor};
use estimator_core::vehicle::GRAVITY;
use estimator_core::{Cell, Context, Tuning};
use std::iter::from_fn;
use test_kit::{Noise, altitude, sample, speed, truck};

const CELLS: u32 = 6_000;
/// Cells in which the force is unknown: 100 m in each 500 m.
const UNKNOWN: std::ops::Range<u32> = 100..140;

/// Returns the slope of hills of 1 km and 3 % in the middle of a cell, and the altitude at its end, m.
fn hill(cell: u32) -> (f32, f32) {
    let angle = |cells: f32| cells * (core::f32::consts::TAU / 400.0);
    let slope = 0.03 * angle(cell as f32 + 0.5).sin();
    let altitude_m =
        0.03 * 1_000.0 / core::f32::consts::TAU * (1.0 - angle(cell as f32 + 1.0).cos());
    (slope, altitude_m)
}

/// Drives the hills at 20 m/s. `change` gets each sample with its slope. Returns the root mean square
/// error of the lagged grade, %, in cells without and with an unknown force, and the share of marked
/// cells.
fn drive(mut change: impl FnMut(u32, f32, &mut Sample)) -> [f32; 3] {
    let mut context = Context::new(truck(), Tuning::default()).unwrap();
    let mut estimator = Box::new(CellEstimator::<f32>::new());
    let mut cells: Vec<Cell> = Vec::new();
    let mut noise = Noise(11);
    for cell in 0..CELLS {
        let (slope, altitude_m) = hill(cell);
        let force_n = 3_926.0 + 39_000.0 * GRAVITY * slope;
        let mut sample = sample(cell, force_n, 20.0);
        sample.speed = speed(20.0);
        if cell % 8 == 0 {
            sample.altitude = altitude(altitude_m + noise.draw());
        }
        if UNKNOWN.contains(&(cell % 200)) {
            sample.end.condition.shifting = true;
        }
        change(cell, slope, &mut sample);
        estimator.push_and_work(&mut context, &sample);
        cells.extend(from_fn(|| estimator.next_cell(&mut context)));
    }
    let (mut squares, mut counts, mut marked) = ([0.0; 2], [0.0_f32; 2], 0.0);
    for cell in cells.iter().skip(1_000) {
        // The grade at the end of the cell.
        let slope = 0.5 * (hill(cell.end.cell).0 + hill(cell.end.cell + 1).0);
        let which = usize::from(cell.end.condition.shifting);
        squares[which] += (cell.lagged_grade_percent.value - 100.0 * slope).powi(2);
        counts[which] += 1.0;
        marked += f32::from(u8::from(!cell.lagged_consistent));
    }
    let [known, unknown] = [0, 1].map(|which| (squares[which] / counts[which]).sqrt());
    [known, unknown, marked / counts.iter().sum::<f32>()]
}

/// An accelerometer with an offset, which reads gravity along the vehicle at a steady speed.
fn accelerometer(slope: f32) -> Option<InertialMeasurement> {
    Some(InertialMeasurement {
        acceleration_mps2: GRAVITY * slope + 0.4,
        count: 10,
        resolution_mps2: 0.01,
    })
}

fn slope_of(sensor: SlopeSensor, slope_percent: f32) -> Option<SlopeMeasurement> {
    Some(SlopeMeasurement {
        slope_percent,
        sensor,
    })
}

#[test]
fn an_accelerometer_stands_in_where_the_force_is_unknown() {
    let [_, without, _] = drive(|_, _, _| ());
    let [known, with, marked] = drive(|_, slope, sample| sample.inertial = accelerometer(slope));
    assert!(with < 0.75 * without, "{with} % with, {without} % without");
    assert!(with < 2.0 * known + 0.02, "{with} %, {known} % elsewhere");
    assert!(marked < 0.01, "{marked}");
}

#[test]
fn so_does_a_pitch_sensor() {
    let [_, without, _] = drive(|_, _, _| ());
    let [_, with, _] = drive(|_, slope, sample| {
        sample.slope = slope_of(SlopeSensor::Pitch, 100.0 * slope - 1.5);
    });
    assert!(with < 0.8 * without, "{with} % with, {without} % without");
}

#[test]
fn a_pitch_of_the_other_sign_does_little_harm() {
    let [_, without, _] = drive(|_, _, _| ());
    let [_, with, _] = drive(|_, slope, sample| {
        sample.slope = slope_of(SlopeSensor::Pitch, -100.0 * slope);
    });
    assert!(with < 1.2 * without, "{with} % with, {without} % without");
}

#[test]
fn a_force_that_contradicts_the_accelerometer_is_in_doubt() {
    // The force lacks 3 % of the weight over 300 m, as if the torque had stuck.
    let stuck = |cell: u32, sample: &mut Sample| {
        if (4_000..4_120).contains(&cell) {
            sample.forces.traction_n -= 0.03 * 39_000.0 * GRAVITY;
        }
    };
    let [without, _, _] = drive(|cell, _, sample| stuck(cell, sample));
    let [with, _, _] = drive(|cell, slope, sample| {
        stuck(cell, sample);
        sample.inertial = accelerometer(slope);
    });
    assert!(with < 0.8 * without, "{with} % with, {without} % without");
}

#[test]
fn a_vertical_speed_measures_the_slope() {
    let mut noise = Noise(3);
    let [without, _, _] = drive(|_, _, _| ());
    let [with, _, _] = drive(|cell, slope, sample| {
        if cell % 2 == 0 {
            let read_percent = 100.0 * slope + 0.1 * noise.draw();
            sample.slope = slope_of(SlopeSensor::VerticalSpeed, read_percent);
        }
    });
    assert!(with < 0.9 * without, "{with} % with, {without} % without");
}

#[test]
fn wild_vertical_speeds_weigh_little() {
    let mut noise = Noise(3);
    let [without, _, _] = drive(|_, _, _| ());
    let [with, _, _] = drive(|cell, slope, sample| {
        if cell % 2 == 0 {
            let wild = if cell % 50 == 0 {
                20.0
            } else {
                0.1 * noise.draw()
            };
            sample.slope = slope_of(SlopeSensor::VerticalSpeed, 100.0 * slope + wild);
        }
    });
    assert!(with < without, "{with} % with, {without} % without");
}
