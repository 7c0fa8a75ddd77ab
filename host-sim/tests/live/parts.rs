//! The parts of `replay` and `listen`, without an interface.

#![cfg(target_os = "linux")]

use embedded_can::{ExtendedId, Frame, StandardId};
use estimator_core::signal::own_message::FrameMatch;
use estimator_core::{
    CellEnd, Condition, Counters, Disagreement, Estimate, Instant, Live, Tuning, Uncertain, signal,
};
use host_sim::live::panel::{header, json, line, panel};
use host_sim::live::status_timing::StatusTiming;
use host_sim::live::view::{InterfaceView, LiveView};
use host_sim::live::{Reaction, Session};
use host_sim::recorder::{Recorder, SmoothedRun};
use host_sim::source::can_frame::{CanFrame, TimedFrame};
use host_sim::source::frame_log::FrameLog;
use host_sim::source::log_time::{self, LogTime};
use host_sim::source::own_signals::OwnSignals;
use host_sim::source::socketcan::{
    BusEvent, ClockReading, Received, ReceivedItem, SteadyClock, accepts, of_error_frame,
    of_frames, of_group, wanted,
};
use proptest::prelude::*;
use socketcan::CanErrorFrame;
use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, Instant as Monotonic, SystemTime};
use tempfile::TempDir;

/// Flag of a 29-bit identifier in SocketCAN's word.
const EXTENDED: u32 = 0x8000_0000;

#[test]
fn every_message_of_the_decoder_passes_the_filters_whoever_sends_it() {
    let filters = wanted();
    // EC1 comes in packets of the transport protocol: its announcements and its data.
    for packet in [0x1CEC_FF00, 0x1CEB_FF00, 0x1CEC_2100] {
        assert!(accepts(&filters, EXTENDED | packet));
    }
    // Answers of diagnosis, with 11 and with 29 bits.
    for answer in [0x7e8, 0x7ef, EXTENDED | 0x18da_f110] {
        assert!(accepts(&filters, answer));
    }
    assert!(!accepts(&filters, 0x7e0) && !accepts(&filters, 0x7f0));
    assert_eq!(filters.len(), signal::messages().count() + 4);
    for message in signal::messages() {
        for (priority, source) in [(0, 0), (3, 0x21), (7, 0xff)] {
            let id = priority << 26 | message.pgn() << 8 | source;
            assert!(accepts(&filters, EXTENDED | id), "{}", message.name());
            // An 11-bit identifier does not belong to J1939, whatever its bits.
            assert!(!accepts(&filters, id & 0x7ff));
        }
    }
}

#[test]
fn a_group_with_a_destination_passes_for_every_destination_and_no_other_group_does() {
    // TSC1, PGN 0, and its neighbour.
    let filters = [of_group(0)];
    for destination in [0, 0x10, 0xff] {
        assert!(accepts(&filters, EXTENDED | 0x0C00_0003 | destination << 8));
    }
    assert!(!accepts(&filters, EXTENDED | 0x0C01_0003));
    // Another data page is another group.
    assert!(!accepts(&filters, EXTENDED | 0x0D00_0003));
    let filters = [of_group(0xF004)];
    assert!(accepts(&filters, EXTENDED | 0x0CF0_0400));
    assert!(!accepts(&filters, EXTENDED | 0x0CF0_0500));
    assert!(!accepts(&filters, EXTENDED | 0x0DF0_0400));
}

proptest! {
    #[test]
    fn the_log_time_arrives_as_it_was_sent(micros in 0_u64..1 << 56) {
        let time = Instant::from_micros(micros);
        for message in [
            LogTime::Now(time),
            LogTime::Ready(time),
            LogTime::Answer(time),
            LogTime::End(time),
        ] {
            let frame = message.frame().unwrap();
            prop_assert_eq!(LogTime::read(&frame), Some(message));
        }
    }

    #[test]
    fn no_other_frame_is_taken_for_a_log_time(id in 0_u32..1 << 29, data: [u8; 8], length in 0_usize..=8) {
        let frame = CanFrame::extended(id, &data[..length]).unwrap();
        let is_it = id >> 8 & 0x3_ffff == log_time::PGN && length == 8 && data[7] < 4;
        prop_assert_eq!(LogTime::read(&frame).is_some(), is_it);
    }
}

#[test]
fn a_time_that_does_not_fit_is_not_sent() {
    assert!(
        LogTime::Now(Instant::from_micros(1 << 56))
            .frame()
            .is_none()
    );
    let standard = CanFrame::standard(0x7ff, &[0; 8]).unwrap();
    assert_eq!(LogTime::read(&standard), None);
    let id = ExtendedId::new(log_time::PGN << 8).unwrap();
    assert_eq!(LogTime::read(&CanFrame::new_remote(id, 8).unwrap()), None);
}

#[test]
fn error_frames_are_distinguished() {
    // Classes and codes of linux/can/error.h. The counters beside a state are no event.
    for (class, data, events) in [
        (0x040, vec![], vec![BusEvent::BusOff]),
        (0x100, vec![], vec![BusEvent::Restarted]),
        (0x204, vec![0, 0x04], vec![BusEvent::ErrorWarning]),
        (0x204, vec![0, 0x10], vec![BusEvent::ErrorPassive]),
        (0x204, vec![0, 0x24], vec![BusEvent::ErrorPassive]),
        (0x204, vec![0, 0x40], vec![BusEvent::ErrorActive]),
        (0x004, vec![0, 0x01], vec![BusEvent::ControllerOverflow]),
        (0x088, vec![0, 0, 0x04, 0x08], vec![BusEvent::WireError]),
        (0x020, vec![], vec![BusEvent::NotAcknowledged]),
        (0x002, vec![3], vec![BusEvent::OtherReport]),
        (0x001, vec![], vec![BusEvent::OtherReport]),
        (0x140, vec![], vec![BusEvent::BusOff, BusEvent::Restarted]),
    ] {
        let frame = CanErrorFrame::new_error(class, &data).unwrap();
        assert_eq!(of_error_frame(&frame), events, "{class:03x} {data:02x?}");
    }
}

#[test]
fn a_clock_that_is_set_does_not_move_the_time_of_frames() {
    let second = Duration::from_secs(1);
    let (start, day) = (Monotonic::now(), SystemTime::UNIX_EPOCH + 1_000 * second);
    let reading = |steady: Duration, of_day: Duration| ClockReading {
        monotonic: start + steady,
        of_day: day + of_day,
        apart: Duration::ZERO,
    };
    let mut clock = SteadyClock::new(reading(Duration::ZERO, Duration::ZERO));
    let micros = |clock: &SteadyClock, stamp, now| clock.time(stamp, now).micros();
    assert_eq!(micros(&clock, day, start), 1_000_000_000);
    // Microseconds between reading both clocks are no change.
    assert!(!clock.check(reading(second, second + Duration::from_micros(900))));
    // Nor is the time for which the thread waited for the processor between the two readings.
    let late = Duration::from_millis(80);
    assert!(!clock.check(ClockReading {
        apart: late,
        ..reading(second, second + late)
    }));
    assert!(clock.clone().check(reading(second, second + late)));

    // Set forward by fifty years.
    let leap = 50 * 365 * 86_400 * second;
    assert!(clock.check(reading(2 * second, 2 * second + leap)));
    assert!(!clock.check(reading(3 * second, 3 * second + leap)));
    let stamp = day + 3 * second + leap;
    assert_eq!(micros(&clock, stamp, start + 3 * second), 1_003_000_000);

    // And back by an hour.
    let back = 3_600 * second;
    assert!(clock.check(reading(4 * second, 4 * second + leap - back)));
    let stamp = day + 5 * second + leap - back;
    assert_eq!(micros(&clock, stamp, start + 5 * second), 1_005_000_000);
    // A time stamp from before the change that is read after it: its time is not in the future.
    let stamp = day + 5 * second + leap;
    assert_eq!(micros(&clock, stamp, start + 5 * second), 1_005_000_000);
}

fn view(live: Option<Live>) -> LiveView {
    LiveView {
        time_s: 3_725.25,
        live,
        road: None,
        memory: None,
        is_silent: false,
        cells_finished: 812,
        newest_cell_percent: Some((-1.25, 0.06)),
        counters: Counters {
            not_available: 17,
            ..Counters::default()
        },
        interfaces: vec![
            InterfaceView {
                name: "can0".to_owned(),
                frames: 123_456,
                frames_per_s: 412.4,
                lost: 3,
                events: [(BusEvent::BusOff, 2), (BusEvent::Restarted, 1)].into(),
            },
            InterfaceView {
                name: "can1".to_owned(),
                frames_per_s: 10.0,
                ..InterfaceView::default()
            },
        ],
        unpublished: Some(4),
        untimed: 0,
    }
}

fn live(condition: Condition) -> Live {
    let uncertain = |value, sigma| Uncertain { value, sigma };
    Live {
        end: CellEnd {
            cell: 1_000,
            condition,
            ..CellEnd::default()
        },
        estimate: Estimate {
            grade_percent: uncertain(-2.345, 0.123),
            altitude_m: None,
            speed_mps: 20.0,
            bias_percent: uncertain(0.05, 0.02),
            scale: uncertain(1.012, 0.03),
            mass_kg: uncertain(38_538.0, 1_920.0),
        },
        disagreement: Disagreement::default(),
    }
}

fn words(line: &str) -> Vec<&str> {
    line.split_whitespace().collect()
}

#[test]
fn lines_have_the_columns_of_their_header() {
    let names = header();
    let valid = line(&view(Some(live(Condition::default()))));
    assert_eq!(
        words(&valid),
        [
            "3725.2", "2500.0", "20.00", "-2.345", "0.123", "valid", "+0.050", "1.012", "812",
            "422", "3", "3", "38538", "1", "-", "-"
        ]
    );
    let waiting = line(&view(None));
    assert_eq!(
        words(&waiting),
        [
            "3725.2", "-", "-", "-", "-", "waiting", "-", "-", "812", "422", "3", "3", "-", "-",
            "-", "-"
        ]
    );
    for text in [&valid, &waiting] {
        assert_eq!(text.len(), names.len());
        assert_eq!(words(text).len(), words(&names).len());
    }
}

#[test]
fn the_mode_lists_the_conditions_of_the_model() {
    let all = Condition {
        shifting: true,
        braking: true,
        no_traction: true,
        crawling: true,
    };
    assert_eq!(
        view(Some(live(all))).mode(),
        "shifting+braking+no-traction+crawling"
    );
    let braking = Condition {
        braking: true,
        ..Condition::default()
    };
    assert_eq!(view(Some(live(braking))).mode(), "braking");
    let mut silent = view(Some(live(braking)));
    silent.is_silent = true;
    assert_eq!(silent.mode(), "silent");
}

#[test]
fn the_panel_shows_grade_interfaces_and_events() {
    let text = panel(&view(Some(live(Condition::default()))));
    for part in [
        "01:02:05   valid",
        "-2.35 % ± 0.12",
        "2.500 km",
        "altitude not known",
        "72.0 km/h",
        "bias +0.05 % ± 0.02   scale 1.012 ± 0.030",
        "mass      38538 kg ± 1920",
        "signals   consistent",
        "812 finished   newest -1.25 % ± 0.06",
        "412 frames/s   123456 in total, 3 lost, 2 × bus off, 1 × restarted",
        "17 values not available, 4 frames not published",
    ] {
        assert!(text.contains(part), "{part} in\n{text}");
    }
    let before = panel(&view(None));
    assert!(before.contains("no speed received yet"));
    // A steep slope does not widen the gauge.
    let mut steep = live(Condition::default());
    steep.estimate.grade_percent.value = 400.0;
    let widest = |text: &str| text.lines().map(|line| line.chars().count()).max();
    assert!(widest(&panel(&view(Some(steep)))) < Some(100));
}

#[test]
fn the_view_as_json_has_what_the_line_has_and_more() {
    let value = json(&view(Some(live(Condition::default()))));
    assert_eq!(value["mode"], "valid");
    assert!(value["altitude_m"].is_null());
    assert_eq!(value["interfaces"][0]["events"]["bus_off"], 2);
    assert_eq!(value["interfaces"][1]["name"], "can1");
    assert_eq!(value["events"]["values not available"], 17);
    assert_eq!(value["events"]["frames not published"], 4);
    assert_eq!(value["consistent"], true);
    assert!(json(&view(None))["grade_percent"].is_null());
    assert!(json(&view(None))["mass_kg"].is_null());
}

#[test]
fn the_views_say_what_disagrees() {
    let mut suspect = live(Condition::default());
    suspect.disagreement.speed = true;
    suspect.disagreement.gear = true;
    let view = view(Some(suspect));
    assert_eq!(words(&line(&view))[13], "0");
    let words = [
        "wheel speed against engine speed, or from two senders",
        "reported gear against engine and wheel speed",
    ];
    assert!(panel(&view).contains(&format!("signals   suspect: {}", words.join("; "))));
    let value = json(&view);
    assert_eq!(value["consistent"], false);
    assert_eq!(value["disagreements"], serde_json::json!(words));
    assert_eq!(value["mass_kg"]["value"], 38_538.0);
}

#[test]
fn the_status_is_due_each_second_and_at_each_change() {
    let start = Monotonic::now();
    let at = |ms| start + Duration::from_millis(ms);
    let good = live(Condition::default());
    let mut bad = good;
    bad.disagreement.climb = true;
    let mut timing = StatusTiming::default();
    assert!(timing.is_due(at(0), None, None));
    assert!(!timing.is_due(at(99), Some(&good), None));
    assert!(timing.is_due(at(100), Some(&good), None));
    assert!(!timing.is_due(at(1_099), Some(&good), None));
    assert!(timing.is_due(at(1_100), Some(&good), None));
    assert!(timing.is_due(at(1_250), Some(&bad), None));
    // A switch that flickers does not fill the bus.
    assert!(!timing.is_due(at(1_300), Some(&good), None));
    assert!(timing.is_due(at(1_350), Some(&good), None));
}

fn session(
    drive: &host_sim::simulator::SimulatedRun,
    log_time: bool,
    log: Option<&Path>,
) -> Session {
    let recorder = Recorder::<f32>::new(drive.vehicle.model.clone(), Tuning::default()).unwrap();
    Session::begin(recorder, &["can0".to_owned()], log_time, log).unwrap()
}

fn recorded(drive: &host_sim::simulator::SimulatedRun) -> SmoothedRun {
    let mut recorder =
        Recorder::<f32>::new(drive.vehicle.model.clone(), Tuning::default()).unwrap();
    for frame in &drive.frames {
        recorder.on_frame(frame);
    }
    recorder.finish().unwrap()
}

fn received(time: Instant, frame: CanFrame) -> Received {
    Received {
        interface: 0,
        time,
        item: ReceivedItem::Frame(frame),
    }
}

#[test]
fn frames_with_the_logs_time_give_the_logs_run() {
    let drive = test_kit::simulated::run(&[test_kit::simulated::MILD, test_kit::simulated::A]);
    let folder = TempDir::new().unwrap();
    let log = folder.path().join("heard.log");
    let mut session = session(&drive, true, Some(&log));
    // A frame before the first log time has no time.
    let arrival = Instant::from_micros(77);
    session
        .take(&received(arrival, drive.frames[0].frame))
        .unwrap();
    let first = drive.frames[0].time;
    let ready = received(arrival, LogTime::Ready(first).frame().unwrap());
    let answer = Reaction::Answer(LogTime::Answer(first));
    assert_eq!(session.take(&ready).unwrap(), answer);
    for TimedFrame { time, frame } in &drive.frames {
        let log_time = received(arrival, LogTime::Now(*time).frame().unwrap());
        assert_eq!(session.take(&log_time).unwrap(), Reaction::None);
        assert_eq!(
            session.take(&received(arrival, *frame)).unwrap(),
            Reaction::None
        );
    }
    let last = drive.frames.last().unwrap().time;
    let end = received(arrival, LogTime::End(last).frame().unwrap());
    let over = Reaction::End(LogTime::Answer(last));
    assert_eq!(session.take(&end).unwrap(), over);

    let view = session.view(None);
    assert_eq!(view.untimed, 1);
    assert_eq!(view.interfaces[0].frames, drive.frames.len() as u64);
    let (run, staged) = session.finish();
    let run = run.unwrap().in_memory().unwrap();
    assert_eq!(run.rows, recorded(&drive).rows);
    assert!(!log.exists());
    staged.unwrap().unwrap().commit().unwrap();
    let heard: Vec<TimedFrame> = FrameLog::open_candump(&log)
        .unwrap()
        .map(Result::unwrap)
        .collect();
    assert_eq!(heard, drive.frames);
}

#[test]
fn events_and_dropped_frames_are_counted_and_reported() {
    let drive = test_kit::simulated::run(&[test_kit::simulated::MILD, test_kit::simulated::A]);
    let mut session = session(&drive, false, None);
    let other = |item| Received {
        interface: 0,
        time: Instant::ZERO,
        item,
    };
    let bus_off = session
        .take(&other(ReceivedItem::Event(BusEvent::BusOff)))
        .unwrap();
    assert_eq!(bus_off, Reaction::Report(BusEvent::BusOff));
    assert_eq!(
        session.take(&other(ReceivedItem::Dropped(12))).unwrap(),
        Reaction::None
    );
    session.take(&other(ReceivedItem::Dropped(5))).unwrap();
    let view = session.view(None);
    assert_eq!((view.lost(), view.events()), (17, 1));
    assert_eq!(view.interfaces[0].frames, 0);
    let (run, log) = session.finish();
    let run = run.unwrap().in_memory().unwrap();
    assert!(run.rows.is_empty() && log.unwrap().is_none());
}

#[test]
fn own_messages_pass_the_filters() {
    let filters = [
        FrameMatch::Standard(0x101),
        FrameMatch::Extended(0x18fe_f117),
        FrameMatch::Group(65_256),
    ]
    .map(of_frames);
    for (word, passes) in [
        (0x101, true),
        (0x102, false),
        (EXTENDED | 0x101, false),
        (EXTENDED | 0x18fe_f117, true),
        (EXTENDED | 0x18fe_f118, false),
        (EXTENDED | 0x18fe_e817, true),
        (EXTENDED | 0x0cfe_e821, true),
    ] {
        assert_eq!(accepts(&filters, word), passes, "{word:#x}");
    }
}

#[test]
fn own_messages_make_cells_on_a_live_bus() {
    let folder = TempDir::new().unwrap();
    let write = |name: &str, text: &str| {
        let path = folder.path().join(name);
        std::fs::write(&path, text).unwrap();
        path
    };
    let dbc = write(
        "car.dbc",
        "BO_ 257 Car: 4 Car\n SG_ Force : 7|16@0- (1,0) [0|0] \"N\" Car\n \
         SG_ Speed : 23|16@0+ (0.01,0) [0|0] \"m/s\" Car\n",
    );
    let mapping = write(
        "signals.toml",
        "[signals.traction_force_n]\nmessage = \"Car\"\nsignal = \"Force\"\n\
         [signals.wheel_speed_mps]\nmessage = 257\nsignal = \"Speed\"\n",
    );
    let own = Arc::new(OwnSignals::read(&dbc, &mapping).unwrap());
    let cells = |own| {
        let recorder = Recorder::new(test_kit::by_force(), Tuning::default()).unwrap();
        let session = Session::begin(recorder, &["can0".to_owned()], false, None).unwrap();
        let mut session = session.with_own_signals(own);
        let frame = CanFrame::new(StandardId::new(257).unwrap(), &[0x0f, 0xa0, 0x07, 0xd0]);
        for k in 0..900 {
            let time = Instant::from_micros(100_000 * k);
            session.take(&received(time, frame.unwrap())).unwrap();
        }
        session.fetch_cells().len()
    };
    assert_eq!(cells(None), 0);
    assert!(cells(Some(own)) > 400, "1.8 km less the lag");
}
