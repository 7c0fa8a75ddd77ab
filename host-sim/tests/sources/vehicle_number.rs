//! The vehicle identification number: of Vehicle Identification (J1939) and of diagnostic answers.

use estimator_core::Instant;
use host_sim::source::can_frame::{CanFrame, TimedFrame};
use host_sim::source::frame_readings::FrameReadings;

const NUMBER: &str = "1XKYD49X0EJ123456";
const VEHICLE_IDENTIFICATION: u32 = 65_260;

fn number(frames: impl IntoIterator<Item = CanFrame>) -> Option<String> {
    let mut reader = FrameReadings::default();
    for frame in frames {
        let time = Instant::from_micros(0);
        reader.decode(&TimedFrame { time, frame }, |_| panic!("a reading"));
    }
    reader.vehicle_number().map(str::to_owned)
}

fn told(source: u8, text: &str) -> Vec<CanFrame> {
    let text = format!("{text}*");
    CanFrame::broadcast(VEHICLE_IDENTIFICATION, source, text.as_bytes()).collect()
}

#[test]
fn a_broadcast_number_is_read_whole_or_not_at_all() {
    let whole = told(0, NUMBER);
    assert_eq!(number(whole.clone()).as_deref(), Some(NUMBER));
    for left_out in 0..whole.len() {
        let mut part = whole.clone();
        part.remove(left_out);
        assert_eq!(number(part), None, "without frame {left_out}");
    }
    let mut twice = whole.clone();
    twice.insert(2, whole[2]);
    assert_eq!(number(twice).as_deref(), Some(NUMBER), "a packet twice");
    // Data of another group.
    let text = format!("{NUMBER}*");
    let other = CanFrame::broadcast(65_259, 0, text.as_bytes());
    assert_eq!(number(other), None);
}

#[test]
fn what_is_no_number_counts_for_nothing() {
    for text in [
        "00000000000000000",
        "1XKYD49X0EJ12345",
        "1XKYD49X0OJ123456",
        "not known, sorry!",
    ] {
        assert_eq!(number(told(0, text)), None, "{text}");
    }
}

#[test]
fn the_vehicle_itself_comes_before_its_trailer() {
    let trailer = told(200, "9BW00000000000001");
    let both = trailer.into_iter().chain(told(0, NUMBER));
    assert_eq!(number(both).as_deref(), Some(NUMBER));
}

#[test]
fn diagnostic_answers_tell_the_number() {
    let heads = [&[0x49, 2, 1][..], &[0x62, 0xf8, 2], &[0x62, 0xf1, 0x90]];
    for head in heads {
        let answer = [head, NUMBER.as_bytes()].concat();
        let first = [&[0x10, answer.len() as u8], &answer[..6]].concat();
        let rest = answer[6..].chunks(7).zip(0x21..);
        let mut frames = vec![first];
        frames.extend(rest.map(|(part, control)| [&[control], part].concat()));
        let frames = frames
            .iter()
            .map(|data| CanFrame::standard(0x7e8, data).expect("an identifier"));
        assert_eq!(number(frames).as_deref(), Some(NUMBER), "{head:x?}");
    }
}
