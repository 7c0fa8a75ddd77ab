//! The CAN frames of a payload.

use embedded_can::Frame;
use host_sim::source::can_frame::CanFrame;

const ID: u32 = 0x0DF8_0542;

#[test]
fn up_to_eight_bytes_are_one_frame() {
    for length in 0..=8 {
        let payload: Vec<u8> = (0..length).collect();
        let frames: Vec<CanFrame> = CanFrame::carrying(ID, 5, &payload).collect();
        assert_eq!(frames, [CanFrame::extended(ID, &payload).expect("a frame")]);
    }
}

#[test]
fn a_broadcast_is_announced_and_numbered() {
    let payload: Vec<u8> = (0..39).collect();
    let frames: Vec<CanFrame> = CanFrame::broadcast(65_251, 5, &payload).collect();
    assert_eq!(frames.len(), 7);
    let announcement = [32, 39, 0, 6, 0xff, 0xe3, 0xfe, 0];
    assert_eq!(
        frames[0],
        CanFrame::extended(0x1cec_ff05, &announcement).unwrap()
    );
    let last = [6, 35, 36, 37, 38, 0xff, 0xff, 0xff];
    assert_eq!(frames[6], CanFrame::extended(0x1ceb_ff05, &last).unwrap());
    assert_eq!(CanFrame::broadcast(65_251, 5, &[0; 2_000]).count(), 256);
}

#[test]
fn more_is_a_fast_packet() {
    for length in [9, 13, 14, 43, 222, 223] {
        let payload: Vec<u8> = (0..length).collect();
        let mut bytes = Vec::new();
        for (number, frame) in (0..).zip(CanFrame::carrying(ID, 5, &payload)) {
            assert_eq!(
                frame.id(),
                CanFrame::extended(ID, &[]).expect("a frame").id()
            );
            let (head, part) = frame.data().split_first().expect("a head");
            assert_eq!(*head, 5 << 5 | number);
            assert_eq!(part.len(), 7);
            bytes.extend_from_slice(part);
        }
        let (whole, padding) = bytes.split_at(1 + payload.len());
        assert_eq!(whole[0], length);
        assert_eq!(whole[1..], payload);
        assert!(padding.len() < 7 && padding.iter().all(|byte| *byte == 0xff));
    }
}

#[test]
fn data_that_no_frame_can_carry_are_left_out() {
    assert_eq!(CanFrame::carrying(1 << 29, 0, &[0; 8]).count(), 0);
    assert_eq!(CanFrame::carrying(1 << 29, 0, &[0; 20]).count(), 0);
    // A frame's number has five bits.
    assert_eq!(CanFrame::carrying(ID, 0, &[0; 300]).count(), 32);
}
