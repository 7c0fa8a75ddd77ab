//! Inputs with a wrong time or speed, inputs that come too often, and inputs of another source.

use estimator_core::intake::{Rate, RateMonitor};
use estimator_core::signal::{FrameOutcome, Rejection, encode};
use estimator_core::{Counters, Decoder, Estimator, Instant, Outcome, Signal, Step, Tuning, Value};
use test_kit::{Noise, TestFrame, frames_of, truck};

const EEC1: u32 = 61_444;
const CCVS1: u32 = 65_265;
const EBC2: u32 = 65_215;
const ETC2: u32 = 61_445;
/// Engine speed of the truck in its direct gear at 1 m/s.
const RPM_PER_MPS: f32 = 55.77;
/// Torque that keeps about 20 m/s on a level road.
const TORQUE_PERCENT: f32 = 57.0;

/// A drive by frames: torque, gear and speeds, ten times a second.
struct Bus {
    estimator: Estimator<f32>,
    now_us: u64,
    /// Whether signals disagree in the cells, live.
    suspect: Vec<bool>,
    /// Whether they do in the finished cells, lagged.
    lagged_suspect: Vec<bool>,
}

/// What the bus reports at a moment.
#[derive(Clone, Copy)]
struct Moment {
    wheel_mps: f32,
    axle_mps: f32,
    engine_mps: f32,
    source: u8,
}

fn at(mps: f32) -> Moment {
    Moment {
        wheel_mps: mps,
        axle_mps: mps,
        engine_mps: mps,
        source: 0,
    }
}

fn frame(pgn: u32, moment: Moment) -> TestFrame {
    let mut payload = [0; 8];
    encode(pgn, &mut payload, |signal| match signal {
        Signal::EngineTorque => Value::Real(TORQUE_PERCENT),
        Signal::EngineSpeed => Value::Real(RPM_PER_MPS * moment.engine_mps),
        Signal::CurrentGear => Value::Real(11.0),
        Signal::WheelSpeed => Value::Real(moment.wheel_mps),
        Signal::FrontAxleSpeed => Value::Real(moment.axle_mps),
        _ => Value::NotAvailable,
    });
    TestFrame::of_pgn(pgn, moment.source, &payload)
}

impl Bus {
    fn new() -> Self {
        Self {
            estimator: Estimator::new(truck(), Tuning::default()).unwrap(),
            now_us: 10_000_000_000,
            suspect: Vec::new(),
            lagged_suspect: Vec::new(),
        }
    }

    fn put(&mut self, pgn: u32, moment: Moment) -> Outcome {
        let now = Instant::from_micros(self.now_us);
        let outcome = self.estimator.on_frame(now, &frame(pgn, moment));
        while let Some(step) = self.estimator.step() {
            if step != Step::Moved {
                continue;
            }
            let live = self.estimator.live().unwrap();
            self.suspect.push(!live.disagreement.is_none());
        }
        while let Some(cell) = self.estimator.next_cell() {
            self.lagged_suspect.push(!cell.lagged_consistent);
        }
        outcome
    }

    /// Drives on for some readings with a second sender of the wheel speed at the same address.
    fn on_with_second(&mut self, readings: usize, second_mps: f32) {
        for k in 0..readings {
            for pgn in [EEC1, ETC2, EBC2, CCVS1] {
                self.put(pgn, cruising(k));
            }
            self.now_us += 50_000;
            self.put(CCVS1, at(second_mps + 0.004 * (k % 5) as f32));
            self.now_us += 50_000;
        }
    }

    /// Returns how many cells in a row are suspect at the end, live.
    fn suspect_cells(&self) -> usize {
        self.suspect
            .iter()
            .rev()
            .take_while(|suspect| **suspect)
            .count()
    }

    /// Drives on for some readings.
    fn on(&mut self, readings: usize, moment: impl Fn(usize) -> Moment) {
        for k in 0..readings {
            for pgn in [EEC1, ETC2, EBC2, CCVS1] {
                self.put(pgn, moment(k));
            }
            self.now_us += 100_000;
        }
    }

    fn counters(&self) -> Counters {
        *self.estimator.counters()
    }

    fn distance_m(&self) -> f64 {
        self.estimator.live().unwrap().end.distance_m()
    }

    fn grade_percent(&self) -> f32 {
        self.estimator.live().unwrap().estimate.grade_percent.value
    }
}

/// A speed that never repeats.
fn cruising(k: usize) -> Moment {
    at(20.0 + 0.004 * (k % 5) as f32)
}

#[test]
fn a_clock_that_is_set_back_stops_nothing() {
    for back_us in [2_000_000, 3_600_000_000] {
        let mut bus = Bus::new();
        bus.on(600, cruising);
        let before_m = bus.distance_m();
        bus.now_us -= back_us;
        bus.on(600, cruising);
        let driven_m = bus.distance_m() - before_m;
        assert!((driven_m - 1_200.0).abs() < 5.0, "{driven_m} m");
        let counters = bus.counters();
        assert_eq!((counters.clocks_set_back, counters.gaps), (1, 0));
        assert!((1..=50).contains(&counters.time_backwards));
    }
}

#[test]
fn one_frame_of_another_day_stops_nothing() {
    let mut bus = Bus::new();
    bus.on(600, cruising);
    let (before_m, now_us) = (bus.distance_m(), bus.now_us);
    bus.now_us += 86_400_000_000;
    assert_eq!(bus.put(CCVS1, at(20.0)), Outcome::TimeAhead);
    bus.now_us = now_us;
    bus.on(600, cruising);
    let driven_m = bus.distance_m() - before_m;
    assert!((driven_m - 1_200.0).abs() < 5.0, "{driven_m} m");
    let counters = bus.counters();
    assert_eq!((counters.times_ahead, counters.silences), (1, 0));
    assert_eq!(counters.time_backwards, 0);
}

#[test]
fn after_a_long_silence_the_second_frame_counts() {
    let mut bus = Bus::new();
    bus.on(600, cruising);
    bus.now_us += 60_000_000;
    assert_eq!(bus.put(CCVS1, at(20.0)), Outcome::TimeAhead);
    assert_eq!(bus.put(CCVS1, at(20.0)), Outcome::Used);
    let counters = bus.counters();
    assert_eq!((counters.silences, counters.gaps), (1, 1));
}

#[test]
fn an_impossible_speed_is_rejected() {
    let mut bus = Bus::new();
    bus.on(600, cruising);
    let (before_m, grade_percent) = (bus.distance_m(), bus.grade_percent());
    bus.on(100, |k| {
        let fails = k % 20 < 3;
        if fails { at(0.0) } else { cruising(k) }
    });
    let driven_m = bus.distance_m() - before_m;
    assert!((driven_m - 200.0).abs() < 5.0, "{driven_m} m");
    assert!((bus.grade_percent() - grade_percent).abs() < 0.2);
    // Of both sensors, in five failures of three readings.
    assert_eq!(bus.counters().speed_leaps, 30);
    // A speed that lasts is accepted in the end.
    bus.on(60, |_| at(10.0));
    let before_m = bus.distance_m();
    bus.on(100, |k| at(10.0 + 0.004 * (k % 5) as f32));
    let driven_m = bus.distance_m() - before_m;
    assert!((driven_m - 100.0).abs() < 5.0, "{driven_m} m");
}

#[test]
fn another_scale_of_the_speed_is_no_slope() {
    // As when another sensor takes over: 3 % from one reading to the next.
    let mut bus = Bus::new();
    bus.on(600, cruising);
    let before = bus.grade_percent();
    bus.on(20, |k| {
        let mps = 1.03 * cruising(k).wheel_mps;
        Moment {
            engine_mps: mps,
            ..at(mps)
        }
    });
    assert!((bus.grade_percent() - before).abs() < 0.5);
    assert!((1..=3).contains(&bus.counters().speed_steps));
}

#[test]
fn a_brake_between_speeds_a_second_apart_is_no_step() {
    // As from loggers and receivers of 1 Hz: a city bus from stop to stop, without brake signals.
    let mut bus = Bus::new();
    let braking = |second: usize| match second % 40 {
        phase @ 0..10 => 18.0 - 1.5 * phase as f32,
        phase @ 10..20 => 3.0 + 1.5 * (phase - 10) as f32,
        phase => 18.0 + 0.004 * (phase % 5) as f32,
    };
    bus.on(10, |_| at(18.0));
    for second in 0..400 {
        bus.put(CCVS1, at(braking(second)));
        for _ in 0..10 {
            bus.put(EEC1, at(braking(second)));
            bus.put(ETC2, at(braking(second)));
            bus.now_us += 100_000;
        }
    }
    assert_eq!(bus.counters().speed_steps, 0);
}

#[test]
fn the_front_axle_replaces_a_stuck_wheel_speed() {
    let mut bus = Bus::new();
    bus.on(600, cruising);
    let before_m = bus.distance_m();
    // 20 m/s down to 15 in 50 s.
    let slower = |k: usize| at(20.0 - 0.01 * k as f32);
    bus.on(500, |k| Moment {
        wheel_mps: 20.0,
        ..slower(k)
    });
    assert!(bus.counters().frozen_speeds > 450);
    let driven_m = bus.distance_m() - before_m;
    assert!((driven_m - 875.0).abs() < 10.0, "{driven_m} m");
    // It was wrong since it stuck: for some 60 m.
    bus.on(600, |_| at(15.0));
    let suspect = bus
        .lagged_suspect
        .iter()
        .filter(|suspect| **suspect)
        .count();
    assert!((20..100).contains(&suspect), "{suspect} cells");
    // A speed that stays because the vehicle's does is no fault.
    let mut bus = Bus::new();
    bus.on(600, cruising);
    bus.on(600, |_| at(20.0));
    assert_eq!(bus.counters().frozen_speeds, 0);
}

#[test]
fn a_second_sender_at_the_same_address_is_counted() {
    let mut bus = Bus::new();
    bus.on(600, cruising);
    assert_eq!(bus.counters().rates_exceeded, 0);
    for k in 0..600 {
        for pgn in [EEC1, ETC2, EBC2, CCVS1] {
            bus.put(pgn, cruising(k));
        }
        bus.now_us += 50_000;
        bus.put(CCVS1, cruising(k));
        bus.now_us += 50_000;
    }
    // One message, once in eight frames. Jitter is not counted.
    assert_eq!(bus.counters().rates_exceeded, 1_200 / 8);
    let mut bus = Bus::new();
    for k in 0..600_u64 {
        bus.now_us = 10_000_000_000 + 100_000 * k + (k * 7_919) % 60_000;
        bus.put(CCVS1, cruising(k as usize));
    }
    assert_eq!(bus.counters().rates_exceeded, 0);
}

#[test]
fn cells_of_a_wheel_speed_that_comes_too_often_are_suspect() {
    let mut bus = Bus::new();
    bus.on(600, cruising);
    bus.on_with_second(100, 20.13);
    assert!(bus.suspect_cells() > 60, "{}", bus.suspect_cells());
    assert_eq!(bus.counters().speed_leaps, 0);
    bus.on(20, cruising);
    assert_eq!(bus.suspect_cells(), 0);
    // After two minutes it is the usual rate.
    bus.on_with_second(1_300, 20.13);
    assert_eq!(bus.suspect_cells(), 0);
    bus.on(600, cruising);
    assert_eq!(bus.suspect_cells(), 0);
    bus.on_with_second(100, 20.13);
    assert_eq!(bus.suspect_cells(), 0);
    // The same speed from both does no harm.
    let mut bus = Bus::new();
    bus.on(600, cruising);
    bus.on_with_second(100, 20.0);
    assert!(bus.counters().rates_exceeded > 20);
    assert!(!bus.suspect.contains(&true));
    // Jitter, and what waits for the bus, is no second sender.
    let mut bus = Bus::new();
    for k in 0..1_200_u64 {
        bus.now_us = 10_000_000_000 + 100_000 * (k / 20 * 20) + 1_000 * (k % 20);
        bus.put(CCVS1, cruising(k as usize));
    }
    assert!(!bus.suspect.contains(&true));
}

#[test]
fn speeds_of_two_senders_do_not_count() {
    for apart_mps in [0.25, 0.6, 5.0] {
        let mut bus = Bus::new();
        bus.on(600, cruising);
        bus.on_with_second(300, 20.0 + apart_mps);
        assert!(bus.counters().speed_leaps > 250, "{:?}", bus.counters());
        let live = bus.estimator.live().unwrap();
        // Neither the wheels' nor the axle's: that is one at least.
        assert!(
            (live.end.speed_mps - 20.0).abs() < 0.05,
            "{}",
            live.end.speed_mps
        );
        // The cells up to where that is known are suspect later on.
        bus.on(1_200, cruising);
        let suspect = bus
            .lagged_suspect
            .iter()
            .filter(|suspect| **suspect)
            .count();
        assert!(
            (10..400).contains(&suspect),
            "{suspect} with {apart_mps} m/s"
        );
        assert_eq!(bus.suspect_cells(), 0);
    }
}

#[test]
fn noisy_speeds_are_not_those_of_two_senders() {
    let mut noise = Noise(7);
    for sigma_mps in [0.1, 0.2, 0.3] {
        let mut bus = Bus::new();
        let noise: Vec<f32> = (0..3_000).map(|_| sigma_mps * noise.draw()).collect();
        bus.on(3_000, |k| Moment {
            wheel_mps: 20.0 + noise[k],
            ..at(20.0)
        });
        assert!(!bus.suspect.contains(&true));
        // Some are farther off than a vehicle can get.
        assert!(bus.counters().speed_leaps < 30, "{sigma_mps} m/s");
        assert_eq!(bus.counters().gaps, 0);
        let driven_m = bus.distance_m();
        assert!((driven_m - 6_000.0).abs() < 10.0, "{driven_m} m");
    }
}

#[test]
fn garbled_speeds_are_not_those_of_two_senders() {
    for every in [16, 20, 30] {
        let mut bus = Bus::new();
        bus.on(600, cruising);
        bus.on(2_000, |k| Moment {
            wheel_mps: cruising(k).wheel_mps + if k % every == 7 { 4.0 } else { 0.0 },
            ..cruising(k)
        });
        assert!(!bus.suspect.contains(&true));
        assert!((60..=130).contains(&bus.counters().speed_leaps));
        assert_eq!(bus.counters().gaps, 0);
    }
}

#[test]
fn cells_with_the_torque_of_a_stranger_are_suspect() {
    let stranger = |k: usize| Moment {
        source: 0x80,
        ..cruising(k)
    };
    let mut bus = Bus::new();
    bus.on(600, cruising);
    bus.on(200, stranger);
    assert!(bus.suspect_cells() > 100, "{}", bus.suspect_cells());
    bus.on(20, cruising);
    assert_eq!(bus.suspect_cells(), 0);
    // That of the wheel speed alone may be of a second sensor.
    let mut bus = Bus::new();
    bus.on(600, cruising);
    for k in 0..200 {
        bus.put(CCVS1, stranger(k));
        for pgn in [EEC1, ETC2, EBC2] {
            bus.put(pgn, cruising(k));
        }
        bus.now_us += 100_000;
    }
    assert!(bus.counters().source_switches > 0);
    assert!(!bus.suspect.contains(&true));
}

#[test]
fn the_true_source_gets_its_signal_back() {
    let other = |k: usize| Moment {
        source: 0x80,
        ..at(25.0 + 0.004 * (k % 5) as f32)
    };
    // It sends first.
    let mut bus = Bus::new();
    bus.on(50, other);
    for k in 0..300 {
        bus.put(CCVS1, other(k));
        bus.on(1, |_| cruising(k));
    }
    let now_mps = |bus: &Bus| bus.estimator.live().unwrap().estimate.speed_mps;
    assert!((now_mps(&bus) - 20.0).abs() < 0.1);
    // The other source sends in a pause of 10 s, and goes on.
    bus.on(100, other);
    assert!((now_mps(&bus) - 25.0).abs() < 0.1);
    for k in 0..100 {
        bus.put(CCVS1, other(k));
        bus.on(1, |_| cruising(k));
    }
    assert!((now_mps(&bus) - 20.0).abs() < 0.1);
    let counters = bus.counters();
    assert!(counters.source_switches >= 3 && counters.other_source >= 300);
    // After the first seconds no address takes precedence.
    let mut bus = Bus::new();
    let own = |k| Moment {
        source: 0x21,
        ..cruising(k)
    };
    bus.on(300, own);
    for k in 0..100 {
        bus.put(
            CCVS1,
            Moment {
                source: 3,
                ..at(25.0)
            },
        );
        bus.on(1, |_| own(k));
    }
    assert!((now_mps(&bus) - 20.0).abs() < 0.1);
    assert_eq!(bus.counters().source_switches, 0);
}

#[test]
fn a_packet_that_never_ends_is_counted() {
    let mut decoder = Decoder::new();
    let mut frames = frames_of(129_029, 0x23, 5, &[0xff; 43]);
    frames[0].data[1] = 223;
    let mut outcomes = Vec::new();
    for _ in 0..3 {
        outcomes.extend(
            frames
                .iter()
                .map(|frame| decoder.decode(frame, |_, _, _| {})),
        );
    }
    let cut_off = FrameOutcome::Rejected(Rejection::FastPacketOrder);
    let count = outcomes
        .iter()
        .filter(|outcome| **outcome == cut_off)
        .count();
    assert_eq!(count, 2, "{outcomes:?}");
}

#[test]
fn a_session_with_a_hole_is_counted_as_broken() {
    let mut frames = frames_of(65_251, 0, 0, &[0x55; 39]);
    frames.remove(3);
    let mut estimator = Estimator::<f32>::new(truck(), Tuning::default()).unwrap();
    let mut broken = Vec::new();
    for (k, frame) in (0..).zip(&frames) {
        let now = Instant::from_micros(50_000 * k);
        if let Outcome::Rejected(rejection) = estimator.on_frame(now, frame) {
            broken.push(rejection);
        }
    }
    assert_eq!(broken, [Rejection::TransportOrder]);
    let counters = estimator.counters();
    assert_eq!(
        (counters.sessions_broken, counters.frames_malformed),
        (1, 0)
    );
}

#[test]
fn a_message_that_the_monitor_does_not_know_has_no_rate() {
    let mut monitor = RateMonitor::new();
    for millis in 0..1_000 {
        let now = Instant::from_micros(1_000 * millis);
        assert_eq!(monitor.take(usize::MAX, now), Rate::Usual);
    }
}
