//! Multi-packet messages of J1939: sessions as trucks send them, and broken ones.

use estimator_core::signal::{FrameOutcome, Pgn, Rejection};
use estimator_core::{Decoder, Instant, Reading, Signal, Value};
use proptest::prelude::*;
use test_kit::{TO_ALL, TRANSPORT_DATA, TRANSPORT_MANAGEMENT, TestFrame, session_of};

const EC1: u32 = 65_251;
const RC: u32 = 65_249;
const DM1: u32 = 65_226;
/// EC1 of a truck that stands with its engine on: 2,386 Nm, 3.824 kg m².
const EC1_PAYLOAD: [u8; 39] = [
    0x50, 0x14, 0xbd, 0x32, 0x41, 0x8c, 0x20, 0x1c, 0xdf, 0xc0, 0x2b, 0xe1, 0x58, 0x34, 0xd3, 0xa0,
    0x41, 0xff, 0xff, 0x52, 0x09, 0xe0, 0x47, 0x03, 0x41, 0xd0, 0x7d, 0xe1, 0x30, 0x41, 0xbc, 0x03,
    0xff, 0xff, 0x80, 0xe0, 0xff, 0xff, 0xff,
];
const INERTIA_KGM2: f32 = 956.0 * 0.004;
const BROKEN: FrameOutcome = FrameOutcome::Rejected(Rejection::TransportOrder);

/// Frames at these times, ms.
fn decode_at(frames: &[(u32, TestFrame)]) -> (Vec<(Pgn, Reading)>, Vec<FrameOutcome>) {
    let mut decoder = Decoder::new();
    let mut readings = Vec::new();
    let outcomes = frames
        .iter()
        .map(|(millis, frame)| {
            let now = Instant::from_micros(1_000 * u64::from(*millis));
            decoder.decode_at(now, frame, |_, pgn, reading| readings.push((pgn, reading)))
        })
        .collect();
    (readings, outcomes)
}

/// Frames 50 ms apart, as EC1 is sent.
fn decode(frames: &[TestFrame]) -> (Vec<(Pgn, Reading)>, Vec<FrameOutcome>) {
    let timed: Vec<_> = (1..).map(|k| 50 * k).zip(frames.iter().cloned()).collect();
    decode_at(&timed)
}

fn ec1(source: u8, torque_nm: u16) -> Vec<u8> {
    let mut payload = EC1_PAYLOAD.to_vec();
    payload[0] = source;
    payload[19..21].copy_from_slice(&torque_nm.to_le_bytes());
    payload
}

fn torques(readings: &[(Pgn, Reading)]) -> Vec<(u8, Value)> {
    readings
        .iter()
        .filter(|(_, reading)| reading.signal == Signal::EngineReferenceTorque)
        .map(|(pgn, reading)| (pgn.source, reading.value))
        .collect()
}

#[test]
fn a_broadcast_engine_configuration_by_hand() {
    let (readings, outcomes) = decode(&session_of(EC1, 0, TO_ALL, &EC1_PAYLOAD));
    let pgn = Pgn {
        number: EC1,
        source: 0,
    };
    let reading = |signal, value| {
        let value = Value::Real(value);
        (pgn, Reading { signal, value })
    };
    assert_eq!(
        readings,
        [
            reading(Signal::EngineReferenceTorque, 2_386.0),
            reading(Signal::EngineInertia, INERTIA_KGM2),
        ]
    );
    assert_eq!(outcomes[..6], [FrameOutcome::Partial; 6]);
    assert!(matches!(
        outcomes[6],
        FrameOutcome::Decoded { source: 0, .. }
    ));
}

#[test]
fn a_retarder_configuration_by_hand() {
    let mut payload = [0xff; 19];
    payload[16..18].copy_from_slice(&3_250_u16.to_le_bytes());
    let (readings, _) = decode(&session_of(RC, 0x10, TO_ALL, &payload));
    let values: Vec<_> = readings
        .iter()
        .map(|(_, reading)| (reading.signal, reading.value))
        .collect();
    let expected = (Signal::RetarderReferenceTorque, Value::Real(3_250.0));
    assert_eq!(values, [expected]);
}

#[test]
fn a_session_between_two_others_is_heard() {
    let (sender, receiver) = (0, 0x21);
    let mut frames = session_of(EC1, sender, receiver, &EC1_PAYLOAD);
    let answer = |control, packets, next| {
        let data = [control, packets, next, 0xff, 0xff, 0xe3, 0xfe, 0x00];
        TestFrame::of_pgn(TRANSPORT_MANAGEMENT | u32::from(sender), receiver, &data)
    };
    // Clear to send three packets, then three again from the third: one is repeated.
    frames.insert(1, answer(17, 3, 1));
    frames.insert(5, answer(17, 4, 3));
    let third = frames[4].clone();
    frames.insert(6, third);
    frames.push(answer(19, 39, 6));
    let (readings, outcomes) = decode(&frames);
    assert_eq!(torques(&readings), [(0, Value::Real(2_386.0))]);
    assert!(!outcomes.contains(&BROKEN), "{outcomes:?}");
}

#[test]
fn an_older_engine_sends_less() {
    for (length, inertia) in [(39, true), (34, true), (32, true), (31, false), (28, false)] {
        let (readings, _) = decode(&session_of(EC1, 0, TO_ALL, &EC1_PAYLOAD[..length]));
        assert_eq!(torques(&readings), [(0, Value::Real(2_386.0))]);
        let expected = if inertia {
            Value::Real(INERTIA_KGM2)
        } else {
            Value::NotAvailable
        };
        assert_eq!(readings[1].1.value, expected, "{length} bytes");
    }
    let (readings, _) = decode(&session_of(EC1, 0, TO_ALL, &EC1_PAYLOAD[..20]));
    assert_eq!(torques(&readings), [(0, Value::NotAvailable)]);
}

#[test]
fn a_session_with_a_hole_is_dropped_whole() {
    let whole = session_of(EC1, 0, TO_ALL, &EC1_PAYLOAD);
    for lost in 0..whole.len() {
        let mut frames = whole.clone();
        frames.remove(lost);
        frames.extend(whole.clone());
        let (readings, outcomes) = decode(&frames);
        assert_eq!(torques(&readings).len(), 1, "frame {lost} lost");
        // Without its announcement it is any message.
        let broken = outcomes.iter().filter(|outcome| **outcome == BROKEN);
        assert_eq!(broken.count(), usize::from(lost > 0), "frame {lost} lost");
    }
}

#[test]
fn swapped_packets_and_a_packet_that_changes_break_a_session() {
    let whole = session_of(EC1, 0, TO_ALL, &EC1_PAYLOAD);
    let mut swapped = whole.clone();
    swapped.swap(3, 4);
    let mut changed = whole.clone();
    changed.insert(4, whole[3].clone());
    changed[4].data[5] ^= 1;
    let mut without_number = whole.clone();
    without_number[1].data[0] = 0;
    for frames in [swapped, changed, without_number] {
        let (readings, outcomes) = decode(&frames);
        assert!(readings.is_empty());
        assert!(outcomes.contains(&BROKEN));
    }
    let twice: Vec<_> = whole
        .iter()
        .skip(1)
        .flat_map(|of| [of.clone(), of.clone()])
        .collect();
    let (readings, outcomes) = decode(&[vec![whole[0].clone()], twice].concat());
    assert_eq!(torques(&readings).len(), 1);
    assert!(!outcomes.contains(&BROKEN));
}

#[test]
fn a_long_pause_ends_a_session() {
    for (destination, pause_ms, is_whole) in [
        (TO_ALL, 750, true),
        (TO_ALL, 751, false),
        (5, 1_250, true),
        (5, 1_251, false),
    ] {
        let frames = session_of(EC1, 0, destination, &EC1_PAYLOAD);
        for before in 1..frames.len() {
            let time = |k| 20 * k as u32 + if k >= before { pause_ms - 20 } else { 0 };
            let timed = frames.iter().cloned().enumerate();
            let timed: Vec<_> = timed.map(|(k, frame)| (time(k), frame)).collect();
            let (readings, outcomes) = decode_at(&timed);
            assert_eq!(torques(&readings).len(), usize::from(is_whole));
            assert_eq!(outcomes.contains(&BROKEN), !is_whole);
        }
    }
}

#[test]
fn another_announcement_ends_a_session() {
    let whole = session_of(EC1, 0, TO_ALL, &EC1_PAYLOAD);
    let other = session_of(DM1, 0, TO_ALL, &[0x55; 39]);
    // The announcement of another message comes after two packets, and its packets carry on.
    let frames = [&whole[..3], &other[..1], &other[3..]].concat();
    let (readings, outcomes) = decode(&frames);
    assert!(readings.is_empty());
    assert_eq!(outcomes[3], BROKEN);
    assert_eq!(outcomes[4..], [FrameOutcome::Ignored; 4]);
}

#[test]
fn an_abort_from_either_side_ends_a_session() {
    let (sender, receiver) = (0, 0x21);
    let whole = session_of(EC1, sender, receiver, &EC1_PAYLOAD);
    let data = [255, 1, 0xff, 0xff, 0xff, 0xe3, 0xfe, 0x00];
    for (from, to) in [(sender, receiver), (receiver, sender)] {
        let abort = TestFrame::of_pgn(TRANSPORT_MANAGEMENT | u32::from(to), from, &data);
        let mut frames = whole.clone();
        frames.insert(4, abort);
        let (readings, outcomes) = decode(&frames);
        assert!(readings.is_empty());
        assert_eq!(outcomes[4], BROKEN);
    }
}

#[test]
fn impossible_announcements_are_rejected() {
    let rejected = FrameOutcome::Rejected(Rejection::TransportAnnouncement);
    let sound = [32, 39, 0, 6, 0xff, 0xe3, 0xfe, 0x00];
    for (place, value) in [(0, 16), (1, 8), (1, 36), (2, 7), (3, 5), (3, 7), (3, 0)] {
        let mut data = sound;
        data[place] = value;
        let id = TRANSPORT_MANAGEMENT | u32::from(TO_ALL);
        let (_, outcomes) = decode(&[TestFrame::of_pgn(id, 0, &data)]);
        let expected = if (place, value) == (1, 36) {
            FrameOutcome::Partial
        } else {
            rejected
        };
        assert_eq!(outcomes, [expected], "byte {place} is {value}");
    }
    let short = TestFrame::of_pgn(TRANSPORT_MANAGEMENT | 255, 0, &sound[..7]);
    let truncated = FrameOutcome::Rejected(Rejection::Truncated);
    assert_eq!(decode(&[short]).1, [truncated]);
    // The group itself does not fit a frame.
    let alone = TestFrame::of_pgn(EC1, 0, &EC1_PAYLOAD[..8]);
    assert_eq!(decode(&[alone]).1, [truncated]);
}

#[test]
fn a_flood_of_sessions_costs_the_oldest() {
    let flood: Vec<_> = (1..=4)
        .map(|source| session_of(EC1, source, TO_ALL, &EC1_PAYLOAD)[0].clone())
        .collect();
    let whole = session_of(EC1, 0, TO_ALL, &EC1_PAYLOAD);
    let (readings, _) = decode(&[&whole[..2], &flood, &whole[2..]].concat());
    assert!(readings.is_empty());
    let (readings, _) = decode(&[&flood[..], &whole].concat());
    assert_eq!(torques(&readings).len(), 1);
}

/// A frame of a source that may be lost or repeated.
#[derive(Clone, Copy, Debug)]
enum Fate {
    Arrives,
    Lost,
    Twice,
}

fn fates() -> impl Strategy<Value = Vec<Fate>> {
    let fate = prop_oneof![
        6 => Just(Fate::Arrives),
        1 => Just(Fate::Lost),
        1 => Just(Fate::Twice),
    ];
    prop::collection::vec(fate, 200)
}

/// Six sessions of a source: EC1 with other values each time, and between them another message to all
/// and one to a single receiver.
fn sessions_of(source: u8, seed: u16) -> Vec<TestFrame> {
    (0..6_u16)
        .flat_map(|k| {
            let payload = ec1(source, value_of(source, seed, k));
            let destination = if k % 3 == 2 { 0x21 } else { TO_ALL };
            let mut frames = session_of(EC1, source, destination, &payload);
            frames.extend(session_of(DM1, source, TO_ALL, &[0x11; 30]));
            frames
        })
        .collect()
}

const fn value_of(source: u8, seed: u16, k: u16) -> u16 {
    1_000 + 1_000 * source as u16 + 100 * k + seed % 100
}

proptest! {
    /// Whatever is lost, repeated or interleaved, as long as no source is silent for a whole session: a
    /// payload is one that was sent.
    #[test]
    fn no_payload_mixes_two(
        order in prop::collection::vec(0..5_u8, 400),
        fates in prop::collection::vec(fates(), 5),
        seed in any::<u16>(),
    ) {
        let mut queues: Vec<_> = (0..5).map(|source| sessions_of(source, seed).into_iter()).collect();
        let mut counts = [0_usize; 5];
        let mut lost_in_a_row = [0; 5];
        let mut frames = Vec::new();
        for source in order {
            let k = usize::from(source);
            let Some(frame) = queues[k].next() else { continue };
            let fate = fates[k][counts[k] % 200];
            counts[k] += 1;
            match fate {
                Fate::Lost if lost_in_a_row[k] < 6 => {
                    lost_in_a_row[k] += 1;
                    continue;
                }
                Fate::Twice => frames.push(frame.clone()),
                _ => {}
            }
            lost_in_a_row[k] = 0;
            frames.push(frame);
        }
        let timed: Vec<_> = (1..).map(|k| 10 * k).zip(frames).collect();
        for (source, value) in torques(&decode_at(&timed).0) {
            let sent = (0..6).map(|k| Value::Real(f32::from(value_of(source, seed, k))));
            prop_assert!(sent.into_iter().any(|of| of == value), "{source}: {value:?}");
        }
    }

    /// Interleaved and undamaged, every message arrives.
    #[test]
    fn interleaved_sessions_all_arrive(order in prop::collection::vec(0..4_u8, 300)) {
        let mut queues: Vec<_> = (0..4).map(|source| sessions_of(source, 0).into_iter()).collect();
        let mut frames = Vec::new();
        for source in order {
            frames.extend(queues[usize::from(source)].next());
        }
        frames.extend(queues.into_iter().flatten());
        let timed: Vec<_> = frames.into_iter().map(|frame| (0, frame)).collect();
        let (readings, outcomes) = decode_at(&timed);
        prop_assert_eq!(torques(&readings).len(), 4 * 6);
        prop_assert!(!outcomes.contains(&BROKEN));
    }

    /// No frame of the protocol does harm, and no readings come from one that was not accepted.
    #[test]
    fn arbitrary_sessions_do_no_harm(
        frames in prop::collection::vec(
            (any::<bool>(), 0..3_u8, prop::sample::select(vec![TO_ALL, 0, 1]), 0..9_usize, any::<[u8; 8]>(), any::<u16>()),
            0..300),
    ) {
        let mut decoder = Decoder::new();
        let mut millis = 0;
        for (is_data, source, to, length, mut data, wait) in frames {
            millis += u64::from(wait % 400);
            if is_data {
                data[0] %= 8;
            } else if data[7] > 60 {
                data = [[16, 17, 19, 32, 32, 32, 255, 0][usize::from(data[0] % 8)], 39, 0, 6, data[4], 0xe3, 0xfe, 0];
            }
            let pgn = if is_data { TRANSPORT_DATA } else { TRANSPORT_MANAGEMENT };
            let frame = TestFrame::of_pgn(pgn | u32::from(to), source, &data[..length]);
            let mut count = 0;
            let now = Instant::from_micros(1_000 * millis);
            let outcome = decoder.decode_at(now, &frame, |_, _, _| count += 1);
            prop_assert_eq!(count > 0, matches!(outcome, FrameOutcome::Decoded { .. }));
        }
    }
}
