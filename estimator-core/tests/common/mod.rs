//! A vehicle and samples for tests.
#![allow(dead_code)]

pub mod dense;
pub mod drive;
pub mod effect_drive;
pub mod hilly_drive;

use estimator_core::filter::{Backward, Filter, Record};
use estimator_core::lag::Lag;
use estimator_core::sampler::{
    AltitudeMeasurement, Circumstances, Continuity, Sample, SpeedMeasurement,
};
use estimator_core::vehicle::Load;
use estimator_core::{
    CELL_LENGTH_M, Cell, Condition, Counters, Effects, Estimate, Gear, Instant, Place, Powertrain,
    Scalar, Traction, Tuning, VehicleParameters,
};
use std::iter::from_fn;

/// A 39 t semi-trailer combination.
pub fn truck() -> VehicleParameters {
    let mut gears = heapless::Vec::new();
    for ratio in [11.3, 9.1, 7.1, 5.7, 4.5, 3.6, 2.9, 2.3, 1.8, 1.4, 1.0, 0.8] {
        gears
            .push(Gear {
                ratio,
                efficiency: 0.985,
            })
            .unwrap();
    }
    VehicleParameters {
        mass_kg: 39_000.0,
        drag_area_m2: 6.0,
        rolling_resistance: 0.0065,
        wheel_radius_m: 0.5,
        wheel_inertia_kgm2: 100.0,
        effects: Effects::default(),
        traction: Traction::Powertrain(Powertrain {
            engine_inertia_kgm2: 3.8,
            reference_torque_nm: 1_750.0,
            final_drive_ratio: 2.92,
            final_drive_efficiency: 0.98,
            gears,
        }),
    }
}

/// A sample at cell `cell` with nothing measured.
pub fn sample(cell: u32, traction_n: f32, speed_mps: f32) -> Sample {
    let duration_s = CELL_LENGTH_M / speed_mps;
    Sample {
        place: Place {
            cell,
            time: Instant::from_micros((f64::from(cell) * f64::from(duration_s) * 1e6) as u64),
            position_e7: None,
            speed_mps,
            condition: Condition::default(),
        },
        gap_cells: 0,
        length_m: CELL_LENGTH_M,
        duration_s,
        load: Load {
            traction_n,
            rotating_kg: 500.0,
            mass_kg: 39_000.0,
            air_density: 1.2,
        },
        circumstances: Circumstances::default(),
        speed: None,
        altitude: None,
        reopened: false,
    }
}

/// A speed taken at the cell's end.
pub fn speed(mean_mps: f32) -> Option<SpeedMeasurement> {
    Some(SpeedMeasurement {
        mean_mps,
        behind_m: 0.0,
        count: 1,
    })
}

/// An altitude taken at the cell's end.
pub fn altitude(altitude_m: f32) -> Option<AltitudeMeasurement> {
    Some(AltitudeMeasurement {
        altitude_m,
        behind_m: 0.0,
        dilution: 1.0,
        continuity: Continuity::Followed,
    })
}

/// A CAN frame for tests.
#[derive(Clone, Debug, PartialEq)]
pub struct TestFrame {
    pub id: embedded_can::Id,
    pub data: Vec<u8>,
    pub remote: bool,
}

impl TestFrame {
    /// A data frame of a parameter group from a source address.
    pub fn of_pgn(pgn: u32, source: u8, data: &[u8]) -> Self {
        let id = (6 << 26) | (pgn << 8) | u32::from(source);
        Self {
            id: embedded_can::ExtendedId::new(id).unwrap().into(),
            data: data.to_vec(),
            remote: false,
        }
    }
}

impl embedded_can::Frame for TestFrame {
    fn new(id: impl Into<embedded_can::Id>, data: &[u8]) -> Option<Self> {
        Some(Self {
            id: id.into(),
            data: data.to_vec(),
            remote: false,
        })
    }
    fn new_remote(id: impl Into<embedded_can::Id>, _dlc: usize) -> Option<Self> {
        Some(Self {
            id: id.into(),
            data: Vec::new(),
            remote: true,
        })
    }
    fn is_extended(&self) -> bool {
        matches!(self.id, embedded_can::Id::Extended(_))
    }
    fn is_remote_frame(&self) -> bool {
        self.remote
    }
    fn id(&self) -> embedded_can::Id {
        self.id
    }
    fn dlc(&self) -> usize {
        self.data.len()
    }
    fn data(&self) -> &[u8] {
        &self.data
    }
}

/// The frames of a payload: itself, or its fast-packet frames.
pub fn frames_of(pgn: u32, source: u8, sequence: u8, payload: &[u8]) -> Vec<TestFrame> {
    if payload.len() <= 8 {
        return vec![TestFrame::of_pgn(pgn, source, payload)];
    }
    let mut bytes = vec![sequence << 5, payload.len() as u8];
    bytes.extend_from_slice(&payload[..6]);
    let mut frames = vec![TestFrame::of_pgn(pgn, source, &bytes)];
    for (k, part) in payload[6..].chunks(7).enumerate() {
        let mut bytes = vec![(sequence << 5) | (k as u8 + 1)];
        bytes.extend_from_slice(part);
        bytes.resize(8, 0xff);
        frames.push(TestFrame::of_pgn(pgn, source, &bytes));
    }
    frames
}

/// Noise that a computer with a pencil can repeat.
pub struct Noise(pub u64);

impl Noise {
    pub fn next(&mut self) -> f32 {
        let mut sum = 0.0;
        for _ in 0..12 {
            self.0 = self
                .0
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1);
            sum += (self.0 >> 40) as f32 / (1_u64 << 24) as f32;
        }
        sum - 6.0
    }
}

/// The records of a drive of [`truck`].
pub fn run<S: Scalar>(samples: &[Sample], tuning: &Tuning) -> Vec<Record<S>> {
    run_counted(samples, tuning).0
}

/// The same, with what was counted.
pub fn run_counted<S: Scalar>(samples: &[Sample], tuning: &Tuning) -> (Vec<Record<S>>, Counters) {
    let vehicle = truck();
    let mut filter = Filter::new();
    let mut counters = Counters::default();
    let records = samples
        .iter()
        .filter_map(|sample| filter.step(&vehicle, tuning, sample, &mut counters))
        .collect();
    (records, counters)
}

/// Smoothed over all of them.
pub fn smooth<S: Scalar>(records: &[Record<S>]) -> Vec<Estimate> {
    let mut backward = Backward::new();
    let mut estimates: Vec<_> = records
        .iter()
        .rev()
        .map(|record| {
            let estimate = backward.estimate(&record.state);
            backward.retreat(&record.trace);
            estimate
        })
        .collect();
    estimates.reverse();
    estimates
}

/// The cells of a drive, none lost.
pub fn cells<S: Scalar>(records: &[Record<S>]) -> Vec<Cell> {
    let mut lag = Lag::new();
    let mut cells = Vec::new();
    for record in records {
        assert_eq!(lag.push(&record.moved(), &record.state), 0);
        cells.extend(from_fn(|| lag.next_cell()));
    }
    cells.extend(from_fn(|| lag.drain_cell()));
    cells
}
