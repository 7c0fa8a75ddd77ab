//! The files that a board and a host exchange. What is written is read back, and malformed records
//! are refused.

use cross_tests::drive::{drive, truck};
use embedded_can::{ExtendedId, Frame, StandardId};
use estimator_core::effect::CATALOGUE;
use estimator_core::packed_vehicle::{self, PackedVehicleError};
use estimator_core::{AdoptedEffect, Cell, CellEnd, Condition, Gear, Instant, Traction, Uncertain};
use firmware::exchange::{cell, frame};
use host_sim::source::can_frame::CanFrame;

#[test]
fn vehicles_are_read_back() {
    let mut by_force = truck();
    by_force.vehicle.traction = Traction::Force;
    let mut many_gears = truck();
    let Traction::Powertrain(powertrain) = &mut many_gears.vehicle.traction else {
        unreachable!("the truck has an engine");
    };
    while !powertrain.gears.is_full() {
        let ratio = powertrain.gears.len() as f32;
        let efficiency = 0.9;
        powertrain.gears.push(Gear { ratio, efficiency }).unwrap();
    }
    let mut many_effects = truck();
    for (k, effect) in CATALOGUE.into_iter().enumerate() {
        let adopted = AdoptedEffect::new(effect, k as f32, 0.5);
        many_effects.effects.adopt(adopted).unwrap();
    }
    for model in [truck(), by_force, many_gears, many_effects] {
        assert_eq!(
            packed_vehicle::decode(&packed_vehicle::encode(&model)),
            Ok(model)
        );
    }
}

/// Offset of the first effect, bytes.
const FIRST_EFFECT: usize = 240;

/// Returns the header with the number of its first effect replaced.
fn with_first_effect(
    header: [u8; packed_vehicle::VEHICLE_BYTES],
    number: u32,
) -> [u8; packed_vehicle::VEHICLE_BYTES] {
    let mut header = header;
    header[FIRST_EFFECT..FIRST_EFFECT + 4].copy_from_slice(&number.to_le_bytes());
    header
}

#[test]
fn malformed_vehicles_are_refused() {
    let good = packed_vehicle::encode(&truck());
    let refusal = |header: &[u8]| packed_vehicle::decode(header).unwrap_err();
    assert_eq!(refusal(&good[..good.len() - 1]), PackedVehicleError::Length);
    let mut earlier_version = good;
    earlier_version[7] = b'2';
    assert_eq!(refusal(&earlier_version), PackedVehicleError::Magic);
    let mut too_many_gears = good;
    too_many_gears[28] = 25;
    assert_eq!(refusal(&too_many_gears), PackedVehicleError::Gears);
}

/// An effect is stored by its number. A release without it refuses the vehicle and does not take
/// another effect for it.
#[test]
fn a_catalogue_that_does_not_fit_is_refused() {
    let mut model = truck();
    let [first, second, ..] = CATALOGUE;
    for effect in [first, second] {
        let adopted = AdoptedEffect::new(effect, effect.typical, 0.1);
        model.effects.adopt(adopted).unwrap();
    }
    let header = packed_vehicle::encode(&model);
    assert_eq!(packed_vehicle::decode(&header).as_ref(), Ok(&model));
    for unknown in [CATALOGUE.len() as u32, 200, u32::MAX - 1] {
        let refused = packed_vehicle::decode(&with_first_effect(header, unknown));
        assert_eq!(refused, Err(PackedVehicleError::Effect(unknown)));
    }
    let other = model.effects.iter().nth(1).unwrap().effect.number;
    let twice = with_first_effect(header, other.into());
    assert_eq!(
        packed_vehicle::decode(&twice),
        Err(PackedVehicleError::Repeated)
    );
}

#[test]
fn frames_are_read_back() {
    let frames = drive();
    assert!(frames.iter().any(|timed| timed.frame.is_remote_frame()));
    assert!(frames.iter().any(|timed| timed.frame.is_standard()));
    for timed in frames {
        let record = frame::encode(timed.time, &timed.frame).unwrap();
        let (time, read) = frame::decode(&record).unwrap();
        assert_eq!(time, timed.time);
        assert_eq!(read.id(), timed.frame.id());
        assert_eq!(read.is_extended(), timed.frame.is_extended());
        assert_eq!(read.is_remote_frame(), timed.frame.is_remote_frame());
        assert_eq!(read.dlc(), timed.frame.dlc());
        assert_eq!(read.data(), timed.frame.data());
    }
}

#[test]
fn a_frame_is_laid_out_as_documented() {
    let id = ExtendedId::new(0x0cf0_0400).unwrap();
    let time = Instant::from_micros(0x0102_0304_0506_0708);
    let data = CanFrame::new(id, &[0xa1, 0xa2, 0xa3]).unwrap();
    assert_eq!(
        frame::encode(time, &data).unwrap(),
        [
            8, 7, 6, 5, 4, 3, 2, 1, 0x00, 0x04, 0xf0, 0x8c, 3, 0, 0, 0, 0xa1, 0xa2, 0xa3, 0, 0, 0,
            0, 0
        ]
    );
    let remote = CanFrame::new_remote(StandardId::MAX, 8).unwrap();
    assert_eq!(
        frame::encode(Instant::ZERO, &remote).unwrap()[8..],
        [0xff, 0x07, 0, 0x40, 8, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0]
    );
}

#[test]
fn malformed_frames_are_refused() {
    let frame = CanFrame::extended(0x18fe_f100, &[1, 2, 3, 4]).unwrap();
    let good = frame::encode(Instant::ZERO, &frame).unwrap();
    assert!(frame::decode(&good).is_some());
    assert_eq!(frame::decode(&good[..23]), None);
    for (offset, byte, why) in [
        (11, 0xb8, "an error frame"),
        (11, 0x18, "an 11-bit identifier with more bits"),
        (12, 9, "more than 8 bytes"),
        (15, 1, "a length beyond a byte"),
        (12, 3, "data beyond the length"),
        (11, 0xd8, "a remote frame with data"),
    ] {
        let mut bad = good;
        bad[offset] = byte;
        assert_eq!(frame::decode(&bad), None, "{why}");
    }
}

#[test]
fn cells_are_read_back() {
    let number = |n: u8| Uncertain {
        value: -0.1 * f32::from(n),
        sigma: 0.3 * f32::from(n),
    };
    for bits in 0_u8..=255 {
        let flag = |bit: u8| bits >> bit & 1 == 1;
        let cell = Cell {
            end: CellEnd {
                cell: u32::MAX - 1,
                time: Instant::from_micros(u64::MAX - 2),
                position_e7: flag(0).then_some((-899_999_999, 1_799_999_999)),
                speed_mps: 22.2,
                condition: Condition {
                    shifting: flag(1),
                    braking: flag(2),
                    no_traction: flag(3),
                    crawling: flag(4),
                },
            },
            live_grade_percent: number(10),
            lagged_grade_percent: number(20),
            altitude_m: flag(5).then_some(number(30)),
            live_consistent: flag(6),
            lagged_consistent: flag(7),
        };
        assert_eq!(cell::decode(&cell::encode(&cell)), Some(cell));
    }
}

#[test]
fn malformed_cells_are_refused() {
    let good = [0; cell::CELL_BYTES];
    assert!(cell::decode(&good).is_some());
    assert_eq!(cell::decode(&good[1..]), None);
    let mut unknown_flag = good;
    unknown_flag[13] = 0x01;
    assert_eq!(cell::decode(&unknown_flag), None);
}
