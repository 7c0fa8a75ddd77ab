//! Drives whose noises are known: the inference finds their variances.

use crate::cells::{LEVEL, first, fix};
use estimator_core::filter::{CellInput, Quantity, Record, State};
use estimator_core::inference::doubt::DoubtFinder;
use estimator_core::inference::round::Memory;
use estimator_core::inference::{
    CellModel, CellVariances, Levels, Numbers, Round, SEGMENT_CELLS, SegmentVariances, Stretch,
};
use test_kit::Noise;

const CELLS: usize = 4_000;

/// What happens on a drive.
#[derive(Clone, Copy, Default)]
struct Drive {
    /// Change of the slope rate, over the assumed one.
    road: f64,
    /// Step of the model's error in the middle, %.
    step_percent: f64,
    /// Error of every fiftieth fix, m.
    outlier_m: f32,
}

/// Returns the cells of a drive, and the slope of the road at the end of each, %.
fn drive(of: Drive, seed: u64) -> (Vec<CellInput>, Vec<f64>) {
    let numbers = Numbers::default();
    let mut noise = Noise(seed);
    let (mut rate, mut slope, mut altitude, mut energy) = (0.0, 0.0, 0.0, 200.0);
    let keep = 1.0 / (1.0 + 2.5 / f64::from(numbers.slope_rate_length_m));
    let sigma = of.road.sqrt() * f64::from(numbers.slope_rate_noise) * (1.0 - keep * keep).sqrt();
    let (mut cells, mut slopes) = (vec![first()], vec![0.0]);
    for k in 1..CELLS {
        rate = keep * rate + sigma * f64::from(noise.draw());
        let before = slope;
        slope += 2.5 * rate;
        // Roads come back to the level.
        slope *= 0.998;
        let middle = 0.5 * (before + slope);
        altitude += 0.025 * middle;
        let wrong = if k > CELLS / 2 { of.step_percent } else { 0.0 };
        // The force holds the speed, and the model misses a part of it.
        let holds = 0.245 * middle + (1.0 - 0.9995) * 200.0;
        let white = 0.245 * f64::from(LEVEL.force_variance).sqrt() * f64::from(noise.draw());
        energy = 0.9995 * (energy - 0.245 * middle) + holds + white;
        let measured = energy + f64::from(LEVEL.energy.variance).sqrt() * f64::from(noise.draw());
        let mut cell = CellInput {
            work: (holds + 0.245 * wrong) as f32,
            net_traction_percent: (holds / 0.245) as f32,
            ..LEVEL
        };
        cell.energy.value = measured as f32;
        cell.energy_behind_m = 0.0;
        cell.energy_per_slip = 0.0;
        if k % 8 == 0 {
            let outlier = if k % 400 == 0 { of.outlier_m } else { 0.0 };
            cell.altitude = fix(altitude as f32 + 0.3 * noise.draw() + outlier);
        }
        cells.push(cell);
        slopes.push(slope);
    }
    (cells, slopes)
}

struct Inferred {
    levels: Levels,
    segments: Vec<SegmentVariances>,
    own: Vec<CellVariances>,
    /// Root mean square of error over stated sigma, and of the error, %, of the smoothed slope.
    nees: f64,
    rmse_percent: f64,
}

fn infer(cells: &[CellInput], slopes: &[f64]) -> Inferred {
    let numbers = Numbers::default();
    let mut own = vec![CellVariances::START; cells.len()];
    let mut doubt = DoubtFinder::new(false);
    for (cell, own) in cells.iter().zip(&mut own) {
        doubt.next(&numbers, cell, own);
    }
    let mut segments =
        vec![SegmentVariances::start(&numbers, 1.0); cells.len().div_ceil(SEGMENT_CELLS)];
    let mut round = Round {
        model: CellModel::new(&numbers),
        levels: Levels::ONE,
        infers: true,
        leaving: 0,
    };
    let start = State::<f64>::at_start(&numbers, &cells[0], 0.0);
    let (mut squares, mut errors) = (0.0, 0.0);
    for last in [false; 12].into_iter().chain([true]) {
        let mut stretch = Stretch {
            cells,
            own: &mut own,
            segments: &mut segments,
        };
        let mut memory = Memory {
            checkpoints: &mut [State::ZERO],
            records: &mut vec![Record::EMPTY; cells.len()],
        };
        round.infers = !last;
        let pass = round.run(&start, &mut stretch, &mut memory, |k, record, adjoint| {
            let slope = adjoint.smooth(&record.state, Quantity::RoadSlope);
            if last && k > 200 && k < cells.len() - 200 {
                let error = slope.mean - slopes[k];
                squares += error * error / slope.variance;
                errors += error * error;
            }
        });
        if !last {
            pass.found.revive(&numbers, &mut segments);
            round.levels = pass.found.sums.levels(&numbers);
        }
    }
    let counted = (cells.len() - 401) as f64;
    Inferred {
        levels: round.levels,
        segments,
        own,
        nees: squares / counted,
        rmse_percent: (errors / counted).sqrt(),
    }
}

#[test]
fn the_roughness_of_the_road_is_found() {
    for road in [0.25, 4.0, 64.0] {
        let (cells, slopes) = drive(
            Drive {
                road,
                ..Drive::default()
            },
            1,
        );
        let inferred = infer(&cells, &slopes);
        let found = f64::from(inferred.levels.road) / road;
        // Multipliers of segments take a part of it.
        assert!(
            (0.25..1.5).contains(&found),
            "level {} for {road}",
            inferred.levels.road
        );
        assert!(inferred.nees < 2.0, "NEES {} for {road}", inferred.nees);
    }
}

#[test]
fn a_step_of_the_model_error_is_found_where_it_is() {
    let of = Drive {
        road: 0.25,
        step_percent: 0.6,
        ..Drive::default()
    };
    let (cells, slopes) = drive(of, 2);
    let inferred = infer(&cells, &slopes);
    let opened = |segment: &&SegmentVariances| segment.bias_shock > 0.04;
    let places: Vec<usize> = (0..inferred.segments.len())
        .filter(|k| opened(&&inferred.segments[*k]))
        .collect();
    let middle = CELLS / 2 / SEGMENT_CELLS;
    let largest = inferred
        .segments
        .iter()
        .map(|s| s.bias_shock)
        .fold(0.0, f32::max);
    assert!(
        !places.is_empty(),
        "largest {largest}, RMSE {}, {:?}",
        inferred.rmse_percent,
        inferred.levels
    );
    assert!(
        places.iter().all(|place| place.abs_diff(middle) <= 3),
        "{places:?}, not {middle}"
    );
    assert!(inferred.rmse_percent < 0.06, "{}", inferred.rmse_percent);
    assert!(inferred.nees < 2.5, "{}", inferred.nees);
}

#[test]
fn without_a_step_none_is_found() {
    for seed in 3..8 {
        let (cells, slopes) = drive(
            Drive {
                road: 1.0,
                ..Drive::default()
            },
            seed,
        );
        let inferred = infer(&cells, &slopes);
        assert!(
            inferred
                .segments
                .iter()
                .all(|segment| segment.bias_shock < 0.01)
        );
    }
}

#[test]
fn outliers_of_the_receiver_weigh_little() {
    let of = Drive {
        road: 0.25,
        outlier_m: 15.0,
        ..Drive::default()
    };
    let (cells, slopes) = drive(of, 9);
    let inferred = infer(&cells, &slopes);
    let outliers: Vec<f32> = (400..CELLS)
        .step_by(400)
        .map(|k| inferred.own[k].altitude_weight)
        .collect();
    assert!(outliers.iter().all(|weight| *weight < 0.05), "{outliers:?}");
    let (clean, clean_slopes) = drive(
        Drive {
            outlier_m: 0.0,
            ..of
        },
        9,
    );
    let without = infer(&clean, &clean_slopes);
    assert!(inferred.rmse_percent < 1.2 * without.rmse_percent);
}
