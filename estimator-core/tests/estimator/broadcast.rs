//! The frames of the estimate, read with their layout file by a library for such files.

use can_dbc::{Dbc, Message, MessageId};
use embedded_can::{Frame, Id};
use estimator_core::broadcast::{self, CELL_PGN, LIVE_PGN, STATUS_PGN};
use estimator_core::{Cell, CellEnd, Condition, Disagreement, Estimate, Live, Uncertain};
use proptest::prelude::*;
use std::sync::LazyLock;
use test_kit::TestFrame;

const SOURCE: u8 = 0xFE;

/// The messages of the layout file: to read it takes longer than a case of a property.
static MESSAGES: LazyLock<Vec<Message>> = LazyLock::new(|| {
    let text = include_str!("../../dbc/grade.dbc");
    Dbc::try_from(text).unwrap().messages
});

fn layout(pgn: u32) -> &'static Message {
    let is_it = |message: &&Message| match message.id {
        MessageId::Extended(id) => id >> 8 & 0xFFFF == pgn,
        MessageId::Standard(_) => false,
    };
    MESSAGES.iter().find(is_it).unwrap()
}

/// A signal by its name; `None` if its bits are all ones.
pub fn read(frame: &TestFrame, pgn: u32, name: &str) -> Option<f64> {
    let message = layout(pgn);
    let Id::Extended(id) = frame.id() else {
        panic!("a J1939 identifier has 29 bits");
    };
    assert_eq!(MessageId::Extended(id.as_raw()), message.id);
    let signal = message.signals.iter().find(|s| s.name == name).unwrap();
    let bits = u64::from_le_bytes(frame.data().try_into().unwrap());
    let mask = (1 << signal.size) - 1;
    let raw = bits >> signal.start_bit & mask;
    let value = raw as f64 * signal.factor + signal.offset;
    (raw != mask).then_some(value)
}

pub fn uncertain(value: f32, sigma: f32) -> Uncertain {
    Uncertain { value, sigma }
}

fn live(grade: f32, sigma: f32, bias: f32, scale: f32, condition: Condition) -> Live {
    Live {
        end: CellEnd {
            condition,
            ..CellEnd::default()
        },
        estimate: Estimate {
            grade_percent: uncertain(grade, sigma),
            bias_percent: uncertain(bias, 0.1),
            scale: uncertain(scale, 0.1),
            ..Estimate::default()
        },
        disagreement: Disagreement::default(),
    }
}

pub fn near(read: Option<f64>, wanted: f32, step: f64) -> bool {
    read.is_some_and(|read| (read - f64::from(wanted)).abs() <= 0.51 * step)
}

proptest! {
    #[test]
    fn the_sent_estimate_equals_the_estimate(
        grade in -30.0_f32..30.0,
        sigma in 0.0_f32..5.0,
        bias in -3.0_f32..3.0,
        scale in 0.5_f32..2.0,
        switches in 0_u8..16,
    ) {
        let condition = Condition {
            shifting: switches & 1 != 0,
            braking: switches & 2 != 0,
            no_traction: switches & 4 != 0,
            crawling: switches & 8 != 0,
        };
        let live = live(grade, sigma, bias, scale, condition);
        let frame: TestFrame = broadcast::live(Some(&live), SOURCE).unwrap();
        let read = |name| read(&frame, LIVE_PGN, name);
        prop_assert!(near(read("Grade"), grade, 0.002));
        prop_assert!(near(read("GradeSigma"), sigma, 0.02));
        prop_assert!(near(read("ModelBias"), bias, 0.002));
        prop_assert!(near(read("TractionScale"), scale, 1e-4));
        for (name, on) in [
            ("Shifting", condition.shifting),
            ("Braking", condition.braking),
            ("NoTraction", condition.no_traction),
            ("Crawling", condition.crawling),
        ] {
            prop_assert_eq!(read(name), Some(f64::from(u8::from(on))));
        }
    }

    #[test]
    fn a_cell_is_sent_with_its_distance(
        number in 0_u32..1 << 25,
        grade in -30.0_f32..30.0,
        sigma in 0.0_f32..5.0,
        altitude in prop::option::of(-400.0_f32..5_000.0),
    ) {
        let cell = Cell {
            end: CellEnd { cell: number, ..CellEnd::default() },
            live_grade_percent: uncertain(0.0, 1.0),
            lagged_grade_percent: uncertain(grade, sigma),
            altitude_m: altitude.map(|altitude| uncertain(altitude, 1.0)),
            live_consistent: true,
            lagged_consistent: true,
        };
        let frame: TestFrame = broadcast::cell(&cell, SOURCE).unwrap();
        let read = |name| read(&frame, CELL_PGN, name);
        let distance = read("Distance").unwrap_or(2.5 * f64::from((1 << 24) - 1));
        prop_assert_eq!(distance, 2.5 * f64::from(number % (1 << 24)));
        prop_assert!(near(read("LaggedGrade"), grade, 0.002));
        prop_assert!(near(read("LaggedGradeSigma"), sigma, 0.02));
        match altitude {
            Some(altitude) => prop_assert!(near(read("Altitude"), altitude, 0.125)),
            None => prop_assert_eq!(read("Altitude"), None),
        }
    }
}

proptest! {
    #[test]
    fn the_status_says_what_disagrees_and_the_mass(
        kinds in any::<[bool; Disagreement::KINDS]>(),
        mass in 500.0_f32..200_000.0,
        sigma in 0.0_f32..50_000.0,
        lagged in prop::option::of(any::<bool>()),
        cells_suspect in any::<u32>(),
    ) {
        let [climb, brake, torque, speed, gear] = kinds;
        let mut live = live(1.0, 0.1, 0.0, 1.0, Condition::default());
        live.estimate.mass_kg = uncertain(mass, sigma);
        live.disagreement = Disagreement { climb, brake, torque, speed, gear };
        let newest = lagged.map(a_cell);
        let frame: TestFrame =
            broadcast::status(Some(&live), newest.as_ref(), cells_suspect, SOURCE).unwrap();
        let read = |name| read(&frame, STATUS_PGN, name);
        let switch = |on| Some(f64::from(u8::from(on)));
        for (name, on) in [
            ("Consistent", kinds == [false; Disagreement::KINDS]),
            ("ClimbDisagrees", climb),
            ("BrakeDisagrees", brake),
            ("TorqueDisagrees", torque),
            ("SpeedDisagrees", speed),
            ("GearDisagrees", gear),
        ] {
            prop_assert_eq!(read(name), switch(on), "{}", name);
        }
        prop_assert_eq!(read("LaggedConsistent"), lagged.and_then(switch));
        prop_assert!(near(read("GrossMass"), mass, 10.0));
        prop_assert!(near(read("GrossMassSigma"), sigma, 10.0));
        let count = read("SuspectCells").unwrap_or(65_535.0);
        prop_assert_eq!(count, f64::from(cells_suspect % 65_536));
    }
}

fn a_cell(lagged_consistent: bool) -> Cell {
    Cell {
        end: CellEnd::default(),
        live_grade_percent: uncertain(0.0, 1.0),
        lagged_grade_percent: uncertain(0.0, 1.0),
        altitude_m: None,
        live_consistent: true,
        lagged_consistent,
    }
}

#[test]
fn a_status_has_these_bytes() {
    let mut live = live(1.0, 0.1, 0.0, 1.0, Condition::default());
    live.estimate.mass_kg = uncertain(39_000.0, 1_560.0);
    live.disagreement = Disagreement {
        brake: true,
        gear: true,
        ..Disagreement::default()
    };
    let newest = a_cell(true);
    let frame: TestFrame = broadcast::status(Some(&live), Some(&newest), 65_538, 7).unwrap();
    assert_eq!(
        frame.id(),
        Id::Extended(embedded_can::ExtendedId::new(0x18FF_4907).unwrap())
    );
    // 3,900 and 156 steps of 10 kg; the count has wrapped.
    assert_eq!(
        frame.data(),
        [0b0001_0000, 0b1101_0100, 0x3C, 0x0F, 0x9C, 0x00, 0x02, 0x00]
    );
}

#[test]
fn nothing_is_known_before_the_first_estimate() {
    let frame: TestFrame = broadcast::live(None, SOURCE).unwrap();
    assert_eq!(frame.data(), [0xFF; 8]);
    let frame: TestFrame = broadcast::status(None, None, 0, SOURCE).unwrap();
    assert_eq!(frame.data(), [0xFF; 8]);
}

#[test]
fn values_beyond_the_range_stay_at_its_ends_and_nan_is_not_available() {
    let beyond = live(1e9, 1e9, -1e9, f32::NAN, Condition::default());
    let frame: TestFrame = broadcast::live(Some(&beyond), 7).unwrap();
    assert_eq!(
        frame.id(),
        Id::Extended(embedded_can::ExtendedId::new(0x18FF_4607).unwrap())
    );
    assert_eq!(
        frame.data(),
        [0xFF, 0xFA, 0xFA, 0x00, 0x00, 0x00, 0xFF, 0xFF]
    );
}
