//! Scenarios for the tests of the simulator, and the readings on the simulated bus.

use embedded_can::{Frame, Id};
use estimator_core::signal::{FrameOutcome, Pgn};
use estimator_core::{Decoder, Instant, Signal, Value};
use host_sim::simulator::scenario::Scenario;
use host_sim::simulator::{SimulatedRun, simulate};
use host_sim::source::can_frame::{TRANSPORT_DATA, TRANSPORT_MANAGEMENT, TimedFrame};
use std::path::Path;

/// Neither noise nor latency: the reported values are true but for their resolution.
pub const QUIET: &str = r#"
[noise]
speed_sigma_mps = 0.0
yaw_rate_sigma_radps = 0.0
[gnss]
altitude_sigma_m = 0.0
altitude_white_sigma_m = 0.0
position_sigma_m = 0.0
speed_sigma_mps = 0.0
course_sigma_deg = 0.0
[latency_ms]
torque = 0.0
speed = 0.0
gearbox = 0.0
chassis = 0.0
gnss = 0.0
"#;
/// A road on which neither truck needs to shift or brake.
pub const MILD: &str =
    "[road]\nlength_m = 5000.0\ngrade_sigma_percent = 0.5\nlargest_grade_percent = 1.0\n";
pub const A: &str = "[[runs]]\nname = \"a\"\ntruck = \"A\"\n";
pub const B: &str = "[[runs]]\nname = \"b\"\ntruck = \"B\"\n";

pub fn scenario(parts: &[&str]) -> Scenario {
    Scenario::parse(&parts.concat(), Path::new("test")).unwrap()
}

pub fn run(parts: &[&str]) -> SimulatedRun {
    simulate(&scenario(parts), 0).unwrap()
}

/// Returns frames without those of multi-packet messages: for what counts or changes frames one by
/// one.
pub fn without_sessions(frames: Vec<TimedFrame>) -> Vec<TimedFrame> {
    let is_session = |timed: &TimedFrame| {
        let Id::Extended(id) = timed.frame.id() else {
            return false;
        };
        let pgn = Pgn::from_raw(id.as_raw()).number;
        [TRANSPORT_MANAGEMENT, TRANSPORT_DATA].contains(&pgn)
    };
    frames
        .into_iter()
        .filter(|timed| !is_session(timed))
        .collect()
}

/// Returns every reading on the bus, in order.
pub fn readings(run: &SimulatedRun) -> Vec<(Instant, u32, Signal, Value)> {
    let mut decoder = Decoder::new();
    let mut readings = Vec::new();
    for timed in &run.frames {
        let outcome = decoder.decode(&timed.frame, |_, pgn, reading| {
            readings.push((timed.time, pgn.number, reading.signal, reading.value));
        });
        assert!(
            matches!(
                outcome,
                FrameOutcome::Decoded { .. } | FrameOutcome::Partial
            ),
            "{outcome:?}"
        );
    }
    readings
}

/// Returns the values of one signal with their times in seconds from the first frame.
pub fn series(run: &SimulatedRun, wanted: Signal) -> Vec<(f64, f32)> {
    let start = run.frames[0].time;
    readings(run)
        .into_iter()
        .filter(|reading| reading.2 == wanted)
        .filter_map(|(time, _, _, value)| {
            Some((1e-6 * time.since(start).micros() as f64, value.real()?))
        })
        .collect()
}
