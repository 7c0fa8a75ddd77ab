//! The frames of the road ahead, read with their layout file.

use crate::broadcast::{near, read, uncertain};
use embedded_can::{ExtendedId, Frame, Id};
use estimator_core::Uncertain;
use estimator_core::broadcast::{self, AHEAD_PGN, PCC1_PGN};
use estimator_core::roadmap::{HorizonPart, NextGrade, NumberedPart};
use proptest::prelude::*;
use test_kit::TestFrame;

const SOURCE: u8 = 0xFE;

fn sent(sequence: u8, cell: u32, part: HorizonPart) -> TestFrame {
    let part = NumberedPart {
        sequence,
        cell,
        part,
    };
    broadcast::ahead(&part, SOURCE).unwrap()
}

fn known(frame: &TestFrame, pgn: u32, name: &str) -> f64 {
    read(frame, pgn, name).unwrap_or_else(|| panic!("{name} is not available"))
}

proptest! {
    #[test]
    fn pcc1_has_the_grade_and_the_next_one_where_it_is(
        grade in prop::option::of(-15.0_f32..15.0),
        next in prop::option::of((-15.0_f32..15.0, 0.0_f32..6_000.0)),
    ) {
        let next = next.map(|(grade_percent, ahead_m)| NextGrade { ahead_m, grade_percent });
        let frame: TestFrame = broadcast::pcc1(grade, next, SOURCE).unwrap();
        for (name, wanted, step) in [
            ("RoadwayPresentGrade", grade, 0.125),
            ("RoadwayNextGrade", next.map(|next| next.grade_percent), 0.125),
            ("NextGradeDistance", next.map(|next| next.ahead_m), 25.0),
        ] {
            let found = read(&frame, PCC1_PGN, name);
            match wanted {
                Some(wanted) => prop_assert!(near(found, wanted, step), "{} {:?}", name, found),
                None => prop_assert_eq!(found, None),
            }
        }
        // All other fields of PCC1 are "not available".
        for index in [0, 1, 2, 5, 7] {
            prop_assert_eq!(frame.data()[index], 0xFF);
        }
    }

    #[test]
    fn grades_ahead_are_read_as_they_are(
        sequence in 0_u8..15,
        branch in 0_u8..4,
        index in 0_u8..=80,
        first in prop::option::of((-30.0_f32..30.0, 0.0_f32..2.5)),
        second in prop::option::of((-30.0_f32..30.0, 0.0_f32..2.5)),
    ) {
        let grade = |known: Option<(f32, f32)>| known.map(|(value, sigma)| uncertain(value, sigma));
        let frame = sent(sequence, 7, HorizonPart::Grades {
            branch,
            ahead_m: 25.0 * f32::from(index),
            grades_percent: [grade(first), grade(second)],
        });
        prop_assert_eq!(known(&frame, AHEAD_PGN, "Content"), 1.0);
        prop_assert_eq!(frame.data()[0] >> 2 & 3, branch);
        prop_assert_eq!(known(&frame, AHEAD_PGN, "Sequence"), f64::from(sequence));
        prop_assert_eq!(known(&frame, AHEAD_PGN, "Ahead"), 25.0 * f64::from(index));
        for (name, wanted) in [("AheadGrade", first), ("FollowingGrade", second)] {
            let grade = read(&frame, AHEAD_PGN, name);
            let sigma = read(&frame, AHEAD_PGN, &format!("{name}Sigma"));
            match wanted {
                Some((value, wanted_sigma)) => {
                    prop_assert!(near(grade, value, 0.002));
                    prop_assert!(near(sigma, wanted_sigma, 0.01));
                }
                None => prop_assert_eq!((grade, sigma), (None, None)),
            }
        }
    }

    #[test]
    fn a_branch_begins_with_its_place_and_probability(
        cell in 0_u32..(1 << 24) - 1,
        from_m in 0.0_f32..2_000.0,
        probability in 0.0_f32..1.0,
    ) {
        let frame = sent(3, cell, HorizonPart::Branch {
            branch: 1,
            from_m,
            to_m: 2_000.0,
            probability,
        });
        let read = |name| read(&frame, AHEAD_PGN, name);
        prop_assert_eq!(read("Content"), Some(0.0));
        prop_assert_eq!(read("Branch"), Some(1.0));
        prop_assert_eq!(read("HorizonLength"), Some(2_000.0));
        prop_assert_eq!(read("HorizonDistance"), Some(2.5 * f64::from(cell)));
        prop_assert!(near(read("BranchFrom"), from_m, 1.0));
        prop_assert!(near(read("BranchProbability"), probability, 0.004));
    }
}

#[test]
fn frames_have_these_bytes() {
    let grade: fn(f32) -> Option<Uncertain> = |value| Some(uncertain(value, 0.04));
    let frame = sent(
        5,
        0,
        HorizonPart::Grades {
            branch: 2,
            ahead_m: 1_250.0,
            grades_percent: [grade(-1.5), None],
        },
    );
    assert_eq!(
        frame.id(),
        Id::Extended(ExtendedId::new(0x18FF_4AFE).unwrap())
    );
    // 31,250 steps of 0.002 % above -64 %, 4 of 0.01 %.
    assert_eq!(
        frame.data(),
        [0b0101_1001, 50, 0x12, 0x7A, 4, 0xFF, 0xFF, 0xFF]
    );
    let unknown = sent(6, 1_000, HorizonPart::Unknown);
    assert_eq!(
        unknown.data(),
        [0b0110_1110, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF]
    );
    let next = NextGrade {
        ahead_m: 175.0,
        grade_percent: -2.0,
    };
    let frame: TestFrame = broadcast::pcc1(Some(1.0), Some(next), 7).unwrap();
    assert_eq!(
        frame.id(),
        Id::Extended(ExtendedId::new(0x18F0_D307).unwrap())
    );
    assert_eq!(frame.data(), [0xFF, 0xFF, 0xFF, 136, 112, 0xFF, 7, 0xFF]);
}

#[test]
fn grades_beyond_the_range_of_pcc1_are_its_ends() {
    let steep = NextGrade {
        ahead_m: 1e9,
        grade_percent: 40.0,
    };
    let frame: TestFrame = broadcast::pcc1(Some(-40.0), Some(steep), SOURCE).unwrap();
    assert_eq!(frame.data(), [0xFF, 0xFF, 0xFF, 0, 250, 0xFF, 250, 0xFF]);
    let frame: TestFrame = broadcast::pcc1(Some(f32::NAN), None, SOURCE).unwrap();
    assert_eq!(frame.data(), [0xFF; 8]);
}
