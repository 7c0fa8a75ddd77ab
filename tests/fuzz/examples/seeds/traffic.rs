//! Traffic on a bus.

use estimator_core::Signal;
use fuzz_targets::bus::Event;

pub type Events = Vec<Event>;

/// Returns traffic that brings the filter into states in which a fault can do harm.
pub fn of_estimator() -> Vec<(&'static str, Events)> {
    vec![
        ("a_drive", vec![drive(2_000), drive(2_200), drive(2_100)]),
        (
            "a_drive_without_gnss",
            vec![without_gnss(2_000), without_gnss(2_100)],
        ),
        (
            "a_steep_climb",
            vec![drive(1_500), climb(150, 90), climb(150, 90)],
        ),
        ("brakes_and_shifts", brakes_and_shifts()),
        (
            "stop_and_go",
            vec![drive(800), drive(0), drive(900), drive(3), drive(1_000)],
        ),
        (
            "gnss_jumps_and_comes_back",
            vec![
                drive(2_000),
                climb(5_000, 40),
                climb(-5_000, 40),
                drive(2_000),
            ],
        ),
        (
            "time_goes_back",
            vec![drive(2_000), wait(-30_000), drive(2_000)],
        ),
        (
            "an_hour_of_silence",
            vec![drive(2_000), wait(3_600_000), drive(2_000)],
        ),
        ("signals_that_are_no_numbers", no_numbers()),
        ("two_sources_of_one_message", two_sources()),
    ]
}

/// Returns known and unknown frames.
pub fn of_decode() -> Vec<(&'static str, Events)> {
    vec![
        ("a_drive", vec![drive(2_000)]),
        ("every_message_of_zeros", every_message(0x00)),
        ("every_message_not_available", every_message(0xff)),
        ("every_message_in_error", every_message(0xfe)),
        ("every_signal_largest", every_signal(f32::MAX)),
        ("every_signal_least", every_signal(f32::MIN)),
        ("fast_packets_out_of_order", parts(&[0, 2, 1, 3, 5, 4, 6])),
        (
            "fast_packets_without_their_first",
            parts(&[1, 2, 3, 4, 5, 6]),
        ),
        ("fast_packets_twice", parts(&[0, 0, 1, 1, 2, 2, 3, 3])),
        (
            "frames_cut_short",
            (0..9).map(|n| frame(0x0CF0_0400, n)).collect(),
        ),
        ("frames_that_have_no_data", no_data()),
    ]
}

pub fn drive(speed_cmps: u16) -> Event {
    Event::Drive {
        seconds: 40,
        speed_cmps,
        torque_percent: 35,
        gear: 2,
        climb_cmps: 20,
        braking: false,
        shifting: false,
        gnss: true,
    }
}

fn climb(climb_cmps: i16, torque_percent: i8) -> Event {
    Event::Drive {
        seconds: 20,
        speed_cmps: 1_500,
        torque_percent,
        gear: 1,
        climb_cmps,
        braking: false,
        shifting: false,
        gnss: true,
    }
}

fn without_gnss(speed_cmps: u16) -> Event {
    Event::Drive {
        seconds: 40,
        speed_cmps,
        torque_percent: 35,
        gear: 2,
        climb_cmps: 0,
        braking: false,
        shifting: false,
        gnss: false,
    }
}

fn brakes_and_shifts() -> Events {
    let short = |gear: i8, braking: bool, shifting: bool| Event::Drive {
        seconds: 3,
        speed_cmps: 1_400,
        torque_percent: if braking || shifting { 0 } else { 60 },
        gear,
        climb_cmps: -30,
        braking,
        shifting,
        gnss: true,
    };
    vec![
        drive(1_500),
        short(1, false, true),
        short(2, false, false),
        short(2, true, false),
        short(2, true, true),
        short(-1, false, false),
        drive(1_400),
    ]
}

fn wait(millis: i32) -> Event {
    Event::Wait { millis }
}

fn no_numbers() -> Events {
    let values = [
        f32::NAN,
        f32::INFINITY,
        f32::NEG_INFINITY,
        -0.0,
        f32::MIN_POSITIVE,
    ];
    let mut events = vec![drive(2_000)];
    for value in values {
        events.extend(every_signal(value));
    }
    events.push(drive(2_000));
    events
}

fn every_signal(value: f32) -> Events {
    let all = 0..Signal::ALL.len();
    all.map(|which| Event::Signal {
        which: which as u8,
        value,
        source: 0,
    })
    .collect()
}

fn two_sources() -> Events {
    let mut events = vec![drive(2_000)];
    for turn in 0..40 {
        events.push(Event::Message {
            which: turn / 2,
            source: 33 * (turn % 2),
            sequence: turn % 8,
            data: [turn; 16],
        });
    }
    events.push(drive(2_000));
    events
}

fn every_message(byte: u8) -> Events {
    let all = 0..estimator_core::signal::messages().count();
    all.map(|which| Event::Message {
        which: which as u8,
        source: 0,
        sequence: 0,
        data: [byte; 16],
    })
    .collect()
}

/// Returns frames of fast packets of every message, in the order of these counters.
fn parts(counters: &[u8]) -> Events {
    let all = 0..estimator_core::signal::messages().count();
    all.flat_map(|which| {
        counters.iter().map(move |counter| Event::Part {
            which: which as u8,
            source: 1,
            head: 0x40 | counter,
            length: 8,
            data: [43, 1, 2, 3, 4, 5, 6],
        })
    })
    .collect()
}

fn frame(id: u32, length: u8) -> Event {
    Event::Frame {
        id,
        extended: true,
        remote: false,
        length,
        data: [1, 2, 3, 4, 5, 6, 7, 8],
    }
}

fn no_data() -> Events {
    let kinds = [(false, false), (false, true), (true, false), (true, true)];
    kinds
        .into_iter()
        .map(|(extended, remote)| Event::Frame {
            id: 0x0CF0_0400,
            extended,
            remote,
            length: 0,
            data: [0; 8],
        })
        .collect()
}
