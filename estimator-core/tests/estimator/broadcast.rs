//! The frames of the estimate, read with their layout file by a library for such files.

use can_dbc::{Dbc, Message, MessageId};
use embedded_can::{Frame, Id};
use estimator_core::broadcast::{self, CELL_PGN, LIVE_PGN};
use estimator_core::{Cell, CellEnd, Condition, Estimate, Live, Uncertain};
use proptest::prelude::*;
use test_kit::TestFrame;

const SOURCE: u8 = 0xFE;

fn layout(pgn: u32) -> Message {
    let text = include_str!("../../dbc/grade.dbc");
    let messages = Dbc::try_from(text).unwrap().messages;
    let is_it = |message: &Message| match message.id {
        MessageId::Extended(id) => id >> 8 & 0xFFFF == pgn,
        MessageId::Standard(_) => false,
    };
    messages.into_iter().find(is_it).unwrap()
}

/// A signal by its name; `None` if its bits are all ones.
fn read(frame: &TestFrame, pgn: u32, name: &str) -> Option<f64> {
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

fn uncertain(value: f32, sigma: f32) -> Uncertain {
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
    }
}

fn near(read: Option<f64>, wanted: f32, step: f64) -> bool {
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

#[test]
fn nothing_is_known_before_the_first_estimate() {
    let frame: TestFrame = broadcast::live(None, SOURCE).unwrap();
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
