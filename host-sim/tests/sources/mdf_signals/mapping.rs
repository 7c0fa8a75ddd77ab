//! Mapping by names, with and without the group.

use super::{at, error, plain, read, readings, reals};
use estimator_core::{Signal, Value};
use host_sim::source::read_options::ReadOptions;
use test_kit::mdf_signals::MdfGroup;

const SPEED: &str = "[signals.wheel_speed_mps]\nsignal = \"v\"\n";

fn named(name: &'static str, source: &'static str, mut group: MdfGroup) -> MdfGroup {
    (group.name, group.source) = (name, source);
    group
}

/// `v` is in two groups, `n` in one.
fn file() -> Vec<u8> {
    plain(&[
        named("10 ms", "XCP:1", reals("v", "km/h", &[(0.0, 36.0)])),
        named("100 ms", "CAN:1", reals("v", "m/s", &[(0.0, 11.0)])),
        named("", "CAN:1", reals("nmot\\XCP:1", "1/min", &[(0.0, 900.0)])),
    ])
}

fn speed(message: &str) -> Value {
    let found = readings(&file(), &format!("{SPEED}message = \"{message}\"\n"));
    assert_eq!(found.len(), 1);
    found[0].2
}

#[test]
fn a_group_is_named_by_itself_its_source_or_its_number() {
    for (message, expected) in [
        ("10 ms", 10.0),
        ("XCP:1", 10.0),
        ("100 ms", 11.0),
        ("group 1", 10.0),
        ("group 2", 11.0),
    ] {
        assert_eq!(speed(message), Value::Real(expected), "{message}");
    }
}

#[test]
fn a_device_behind_the_name_may_be_left_out() {
    for name in ["nmot\\\\XCP:1", "nmot"] {
        let toml = format!("[signals.engine_speed_rpm]\nsignal = \"{name}\"\n");
        let found = readings(&file(), &toml);
        assert_eq!(found, [(0, Signal::EngineSpeed, Value::Real(900.0))]);
    }
}

#[test]
fn mistakes_are_named_with_their_line() {
    let cases = [
        (
            SPEED.to_owned(),
            "S.toml:2: signals.wheel_speed_mps.signal is `v`, a channel of several groups; expected \
             message with the name of one, such as `10 ms`, `100 ms`",
        ),
        (
            SPEED.replace("\"v\"", "\"nmt\""),
            "S.toml:2: signals.wheel_speed_mps.signal is `nmt`; expected a channel, such as `v`",
        ),
        (
            format!("{SPEED}message = \"10ms\"\n"),
            "S.toml:3: signals.wheel_speed_mps.message is `10ms`; expected a group such as `10 ms`",
        ),
        (
            "[signals.engine_speed_rpm]\nsignal = \"nmot\"\nmessage = \"10 ms\"\n".to_owned(),
            "S.toml:2: signals.engine_speed_rpm.signal is `nmot`; expected a channel of group 10 ms, \
             such as `v`",
        ),
        (
            "[signals.engine_speed_rpm]\nsignal = \"v\"\nmessage = \"10 ms\"\n".to_owned(),
            "S.toml:2: signals.engine_speed_rpm has no scale, and its signal `v` is in `km/h`; \
             expected scale",
        ),
        (
            "[signals.engine_speed_rpm]\nmessage = \"10 ms\"\n".to_owned(),
            "S.toml:1: signals.engine_speed_rpm.signal is missing",
        ),
    ];
    for (toml, expected) in cases {
        let found = error(&file(), &toml);
        assert!(found.starts_with(expected), "{toml}\n{found}\n{expected}");
    }
    let found = error(&file(), "");
    assert!(
        found.contains("no channel of this MDF file is one of ours"),
        "{found}"
    );
    assert!(found.contains("--signals SIGNALS.toml"), "{found}");
}

#[test]
fn scale_and_offset_replace_the_unit() {
    let toml = format!("{SPEED}message = \"10 ms\"\nscale = 0.5\noffset = 1\n");
    let (found, report) = read(&file(), &toml).unwrap();
    assert_eq!(found[0].2, Value::Real(19.0));
    assert_eq!(report.notes, [""; 0]);
}

#[test]
fn channels_with_the_name_of_a_signal_need_no_mapping() {
    let file = plain(&[
        reals("wheel_speed_mps", "", &[(0.0, 10.0)]),
        reals("air_pressure_pa", "hPa", &[(0.0, 950.0)]),
        reals("yaw_rate_radps", "km/h", &[(0.0, 1.0)]),
        reals("gear", "", &[(0.0, 3.0)]),
        reals("gear", "", &[(0.0, 4.0)]),
        reals("other", "", &[(0.0, 4.0)]),
    ]);
    let (found, report) = read(&file, "").unwrap();
    let pressure = (0, Signal::AirPressure, Value::Real(95_000.0));
    let speed = (0, Signal::WheelSpeed, Value::Real(10.0));
    assert_eq!(found, [pressure, speed]);
    let told = [
        "gear is a channel of several groups; map it by --signals",
        "yaw_rate_radps is a channel in `km/h`; map it by --signals",
    ];
    assert_eq!(report.notes, told);
    // A mapping goes first, and leaves the others.
    let toml = "[signals.wheel_speed_mps]\nsignal = \"other\"\nscale = 1\n";
    let found = readings(&file, toml);
    let speed = (0, Signal::WheelSpeed, Value::Real(4.0));
    assert_eq!(found, [pressure, speed]);
    // A signal may be left out.
    let options = ReadOptions {
        ignore: vec![Signal::AirPressure],
        ..ReadOptions::default()
    };
    let (found, _) = super::read_as(&file, toml, &options).unwrap();
    assert_eq!(found, [speed]);
}

#[test]
fn a_mapped_channel_without_values_is_told() {
    let file = plain(&[
        reals("wheel_speed_mps", "", &[(0.0, 10.0), (1.0, 10.0)]),
        reals("h", "m", &[(0.0, f64::NAN)]),
    ]);
    let (found, report) = read(&file, "[signals.altitude_m]\nsignal = \"h\"\n").unwrap();
    assert_eq!(found.len(), 2);
    assert_eq!(found[1].0, at(1.0));
    assert_eq!(report.notes, ["no record has altitude_m"]);
}
