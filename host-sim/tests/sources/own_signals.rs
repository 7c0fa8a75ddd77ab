//! Own signals: any `.dbc` file, mapped by a `SIGNALS.toml`.

use embedded_can::{ExtendedId, Frame, StandardId};
use estimator_core::signal::own_message::FrameMatch;
use estimator_core::{Reading, Signal, Value};
use host_sim::source::can_frame::CanFrame;
use host_sim::source::own_signals::OwnSignals;
use proptest::prelude::*;

/// A car: 11-bit identifiers and Motorola order, multiplexers, floats; and a J1939 message.
const DBC: &str = r#"VERSION "1.0"

NS_ :
	CM_
	BA_DEF_

BS_:

BU_: Gateway Logger

BO_ 416 ESP_1: 8 Gateway
 SG_ VehicleSpeed : 7|16@0+ (0.01,0) [0|655.35] "km/h" Logger
 SG_ YawRate : 23|16@0- (0.01,0) [-327.68|327.67] "deg/s" Logger
 SG_ Braking : 32|1@1+ (1,0) [0|1] "" Logger

BO_ 640 Gearbox: 3 Gateway
 SG_ Gear : 3|4@0+ (1,0) [0|15] "" Logger
 SG_ Ratio : 8|16@1+ (0.001,0) [0|65] "" Logger

BO_ 1264 Gnss: 8 Gateway
 SG_ Page M : 0|8@1+ (1,0) [0|255] "" Logger
 SG_ Latitude m0 : 8|32@1- (1E-07,0) [-90|90] "deg" Logger
 SG_ Longitude m1 : 8|32@1- (1E-07,0) [-180|180] "deg" Logger
 SG_ Height m2 : 8|32@1- (1,0) [0|0] "m" Logger
 SG_ Satellites m2 : 40|8@1+ (1,0) [0|255] "" Logger

BO_ 419358208 Tacho: 8 Vector__XXX
 SG_ Speed : 48|16@1+ (0.00390625,0) [0|250.996] "km/h" Logger

BO_ 2566844926 CCVS1: 8 Gateway
 SG_ WheelBasedVehicleSpeed : 8|16@1+ (0.00390625,0) [0|250.996] "km/h" Logger

BO_ 2000 Long: 64 Gateway
 SG_ Far : 80|16@1+ (1,0) [0|0] "m/s" Logger

CM_ BO_ 416 "A comment over
BO_ lines, with a word that is no statement
";
CAT_DEF_ 7 "a section that no parser knows" ???;
SIG_VALTYPE_ 1264 Height : 1;
VAL_ 640 Gear 0 "neutral" 7 "reverse" 15 "n/a" ;
"#;

fn read(dbc: &[u8], toml: &str) -> Result<OwnSignals, String> {
    let folder = test_kit::command::folder();
    let (dbc_path, toml_path) = (folder.path().join("car.dbc"), folder.path().join("S.toml"));
    std::fs::write(&dbc_path, dbc).unwrap();
    std::fs::write(&toml_path, toml).unwrap();
    let prefix = format!("{}/", folder.path().display());
    OwnSignals::read(&dbc_path, &toml_path).map_err(|e| e.to_string().replace(&prefix, ""))
}

fn mapped(toml: &str) -> OwnSignals {
    read(DBC.as_bytes(), toml).unwrap()
}

fn error(toml: &str) -> String {
    read(DBC.as_bytes(), toml).expect_err("a wrong file is refused")
}

fn readings(own: &OwnSignals, frame: &CanFrame) -> Vec<(Signal, Value)> {
    let mut readings = Vec::new();
    own.decode(frame, |Reading { signal, value }| {
        readings.push((signal, value));
    });
    readings
}

fn standard(id: u16, data: &[u8]) -> CanFrame {
    CanFrame::new(StandardId::new(id).unwrap(), data).unwrap()
}

fn extended(id: u32, data: &[u8]) -> CanFrame {
    CanFrame::new(ExtendedId::new(id).unwrap(), data).unwrap()
}

const SPEED: &str = "[signals.wheel_speed_mps]\nmessage = \"ESP_1\"\nsignal = \"VehicleSpeed\"\n";

#[test]
fn a_unit_is_known_or_told() {
    let with = |unit: &str| DBC.replace("[0|655.35] \"km/h\"", &format!("[0|655.35] \"{unit}\""));
    let frame = standard(416, &[0x1c, 0x20, 0, 0, 0, 0, 0, 0]);
    for (unit, expected) in [
        ("km/h", 20.0),
        ("kmph", 20.0),
        ("[km/h]", 20.0),
        ("Unit_KiloMeterPerHour", 20.0),
        ("knots", 72.0 * 1852.0 / 3600.0),
        ("", 72.0),
        ("-", 72.0),
    ] {
        let own = read(with(unit).as_bytes(), SPEED).expect(unit);
        let found = readings(&own, &frame);
        let [(Signal::WheelSpeed, Value::Real(mps))] = found[..] else {
            panic!("{found:?}");
        };
        assert!((mps - expected).abs() < 1e-3, "{unit}: {mps}");
    }
    for unit in ["furlongs", "0.1km/h", "kg"] {
        let message = read(with(unit).as_bytes(), SPEED).expect_err(unit);
        for words in [
            "signals.wheel_speed_mps has no scale",
            unit,
            "expected scale",
        ] {
            assert!(message.contains(words), "{words}: {message}");
        }
        let scaled = format!("{SPEED}scale = 0.5\n");
        read(with(unit).as_bytes(), &scaled).expect(unit);
    }
}

#[test]
fn a_car_is_read_by_its_dbc() {
    let own = mapped(&format!(
        "{SPEED}scale = 0.2777777777777778\n\
         [signals.yaw_rate_radps]\nmessage = 0x1a0\nsignal = \"YawRate\"\nscale = 0.01\n\
         [signals.brake]\nmessage = \"416\"\nsignal = \"Braking\"\n"
    ));
    // 72.00 km/h, -5.00 deg/s, the brake on.
    let frame = standard(416, &[0x1c, 0x20, 0xfe, 0x0c, 0x01, 0, 0, 0]);
    assert_eq!(
        readings(&own, &frame),
        [
            (Signal::BrakeSwitch, Value::Real(1.0)),
            (Signal::YawRate, Value::Real(-0.05)),
            (Signal::WheelSpeed, Value::Real(20.0)),
        ],
        "in the order of signals"
    );
    // What a frame is too short for is not there.
    let short = standard(416, &[0x1c, 0x20]);
    assert_eq!(
        readings(&own, &short),
        [(Signal::WheelSpeed, Value::Real(20.0))]
    );
    assert_eq!(readings(&own, &standard(417, &[0; 8])), []);
    assert_eq!(readings(&own, &extended(416, &[0; 8])), []);
    assert_eq!(
        own.frames().collect::<Vec<_>>(),
        [FrameMatch::Standard(416)]
    );
}

#[test]
fn raw_numbers_may_be_invalid_or_have_a_value() {
    let own = mapped(
        "[signals.gear]\nmessage = \"Gearbox\"\nsignal = \"Gear\"\n\
         invalid = [0xf]\nvalues = { \"7\" = -1, \"0x8\" = 0.0 }\n",
    );
    for (raw, value) in [
        (3, Value::Real(3.0)),
        (7, Value::Real(-1.0)),
        (8, Value::Real(0.0)),
        (15, Value::NotAvailable),
    ] {
        let frame = standard(640, &[raw, 0, 0]);
        assert_eq!(
            readings(&own, &frame),
            [(Signal::CurrentGear, value)],
            "{raw}"
        );
    }
}

#[test]
fn multiplexed_and_floating_point_signals_are_read() {
    let signal =
        |name: &str, of: &str| format!("[signals.{name}]\nmessage = \"Gnss\"\nsignal = \"{of}\"\n");
    let own = mapped(
        &[
            signal("latitude_deg", "Latitude"),
            signal("longitude_deg", "Longitude"),
            signal("altitude_m", "Height"),
            signal("satellites", "Satellites"),
        ]
        .concat(),
    );
    let frame = |page: u8, number: [u8; 4]| {
        let [a, b, c, d] = number;
        standard(1264, &[page, a, b, c, d, 9, 0, 0])
    };
    let angle = 473_769_123_i32;
    assert_eq!(
        readings(&own, &frame(0, angle.to_le_bytes())),
        [(Signal::Latitude, Value::DegreesE7(angle))]
    );
    assert_eq!(
        readings(&own, &frame(1, (-angle).to_le_bytes())),
        [(Signal::Longitude, Value::DegreesE7(-angle))]
    );
    assert_eq!(
        readings(&own, &frame(2, 431.25_f32.to_le_bytes())),
        [
            (Signal::Satellites, Value::Real(9.0)),
            (Signal::Altitude, Value::Real(431.25)),
        ]
    );
    assert_eq!(readings(&own, &frame(3, [0; 4])), []);
}

#[test]
fn multiplexers_of_multiplexers_select_ranges() {
    let dbc = "BO_ 1 Nested: 8 Vector__XXX\n\
        \x20SG_ Outer M : 0|4@1+ (1,0) [0|0] \"\" Vector__XXX\n\
        \x20SG_ Inner m2M : 4|4@1+ (1,0) [0|0] \"\" Vector__XXX\n\
        \x20SG_ Speed m1 : 8|8@1+ (1,0) [0|0] \"m/s\" Vector__XXX\n\
        SG_MUL_VAL_ 1 Inner Outer 2-2;\n\
        SG_MUL_VAL_ 1 Speed Inner 1-1, 5-7;\n";
    let own = read(
        dbc.as_bytes(),
        "[signals.wheel_speed_mps]\nmessage = 1\nsignal = \"Speed\"\n",
    )
    .unwrap();
    for (outer, inner, is_there) in [(2, 1, true), (2, 6, true), (2, 2, false), (1, 1, false)] {
        let found = readings(&own, &standard(1, &[inner << 4 | outer, 20]));
        assert_eq!(!found.is_empty(), is_there, "{outer} {inner}");
    }
}

#[test]
fn groups_are_read_from_any_address_with_the_codes_of_j1939() {
    for message in ["\"CCVS1\"", "65265", "\"65265\"", "\"0xFEF1\""] {
        let own = mapped(&format!(
            "[signals.wheel_speed_mps]\nmessage = {message}\nsignal = \"WheelBasedVehicleSpeed\"\n"
        ));
        let frame = |id, high| extended(id, &[0xff, 0x00, high, 0xff, 0xff, 0xff, 0xff, 0xff]);
        for id in [0x18fe_f100, 0x0cfe_f117] {
            // The unit of the file is known: 72 km/h.
            let found = readings(&own, &frame(id, 72));
            assert_eq!(
                found,
                [(Signal::WheelSpeed, Value::Real(20.0))],
                "{message}"
            );
        }
        let found = readings(&own, &frame(0x18fe_f100, 0xff));
        assert_eq!(found, [(Signal::WheelSpeed, Value::NotAvailable)]);
    }
}

#[test]
fn an_identifier_is_that_of_one_sender() {
    // The identifier of the file lacks the mark of 29 bits, as some tools write it.
    for message in ["\"Tacho\"", "419358208", "\"0x18FEE600\""] {
        let own = mapped(&format!(
            "[signals.wheel_speed_mps]\nmessage = {message}\nsignal = \"Speed\"\n"
        ));
        let data = [0, 0, 0, 0, 0, 0, 0, 72];
        let found = readings(&own, &extended(0x18fe_e600, &data));
        assert_eq!(
            found,
            [(Signal::WheelSpeed, Value::Real(20.0))],
            "{message}"
        );
        assert_eq!(readings(&own, &extended(0x18fe_e601, &data)), []);
    }
    // One sender of a group.
    let own = mapped(
        "[signals.wheel_speed_mps]\nmessage = \"0x18FEF117\"\nsignal = \"WheelBasedVehicleSpeed\"\n",
    );
    assert_eq!(
        own.frames().collect::<Vec<_>>(),
        [FrameMatch::Extended(0x18fe_f117)]
    );
}

#[test]
fn files_in_another_code_are_read() {
    let mut dbc = DBC.as_bytes().to_vec();
    // "°/s" as Windows-1252 writes it.
    let unit = dbc.windows(7).position(|at| at == b"\"deg/s\"").unwrap();
    dbc.splice(unit..unit + 7, *b"\"\xb0/s\"");
    let own = read(
        &dbc,
        "[signals.yaw_rate_radps]\nmessage = \"ESP_1\"\nsignal = \"YawRate\"\n",
    )
    .unwrap();
    let found = readings(&own, &standard(416, &[0, 0, 0xfe, 0x0c]));
    let rate = -5.0_f64.to_radians() as f32;
    assert_eq!(found, [(Signal::YawRate, Value::Real(rate))]);
}

#[test]
fn mistakes_are_named_with_their_line() {
    let cases = [
        (
            "[signals.wheel_sped_mps]\nmessage = \"ESP_1\"\nsignal = \"VehicleSpeed\"\n".to_owned(),
            "S.toml:1: signals.wheel_sped_mps: unknown signal; expected a name such as \
             `wheel_speed_mps`",
        ),
        (
            SPEED.replace("ESP_1", "ESP1"),
            "S.toml:2: signals.wheel_speed_mps.message is `ESP1`; expected a message of car.dbc, \
             such as `ESP_1`",
        ),
        (
            SPEED.replace("\"ESP_1\"", "417"),
            "S.toml:2: signals.wheel_speed_mps.message is `417`; expected the identifier or PGN of \
             a message of car.dbc",
        ),
        (
            SPEED.replace("VehicleSpeed", "VehicelSpeed"),
            "S.toml:3: signals.wheel_speed_mps.signal is `VehicelSpeed`; expected a signal of \
             message ESP_1, such as `VehicleSpeed`",
        ),
        (
            format!("{SPEED}\nscal = 2\n"),
            "S.toml:5: signals.wheel_speed_mps.scal: unknown key; expected a key such as `scale`",
        ),
        (
            format!("{SPEED}scale = \"2\"\n"),
            "S.toml:4: signals.wheel_speed_mps.scale is no number; expected a finite number",
        ),
        (
            format!("{SPEED}scale = nan\n"),
            "S.toml:4: signals.wheel_speed_mps.scale is no number; expected a finite number",
        ),
        (
            format!("{SPEED}scale = 0\n"),
            "S.toml:4: signals.wheel_speed_mps.scale is 0; expected a number other than 0",
        ),
        (
            format!("{SPEED}invalid = 255\n"),
            "S.toml:4: signals.wheel_speed_mps.invalid is no list of integers",
        ),
        (
            format!("{SPEED}values = {{ \"x\" = 1 }}\n"),
            "S.toml:4: signals.wheel_speed_mps.values is no table of numbers",
        ),
        (
            "[signals.wheel_speed_mps]\nmessage = \"ESP_1\"\n".to_owned(),
            "S.toml:1: signals.wheel_speed_mps.signal is missing",
        ),
        (
            "[signals.wheel_speed_mps]\nmessage = \"ESP_1\"\nsignal = \"YawRate\"\n".to_owned(),
            "S.toml:3: signals.wheel_speed_mps has no scale, and its signal `YawRate` is in \
             `deg/s`; expected scale",
        ),
        (
            "[signals.wheel_speed_mps]\nmessage = \"Long\"\nsignal = \"Far\"\n".to_owned(),
            "S.toml:3: signals.wheel_speed_mps.signal is `Far`, which ends in byte 12; expected one \
             within the 8 bytes",
        ),
        (
            "[vehicle]\n".to_owned(),
            "S.toml:1: unknown table `vehicle`",
        ),
        ("\n\n[signals\n".to_owned(), "S.toml:3: "),
        (String::new(), "S.toml: no signal; expected tables such as"),
        ("signals = 3".to_owned(), "S.toml:1: signals is no table"),
    ];
    for (toml, expected) in cases {
        let found = error(&toml);
        assert!(found.starts_with(expected), "{toml}\n{found}\n{expected}");
    }
}

#[test]
fn a_statement_that_is_not_understood_costs_itself_alone() {
    let head = "VERSION \"\"\n\nBO_ 416 ESP_1: 8 Gateway\n";
    let speed = " SG_ VehicleSpeed : 7|16@0+ (0.01,0) [0|655.35] \"km/h\" X\n";
    for (line, name) in [
        (" SG_ Power : 0|32@2- (1,0) [0|0] \"kW\" X", "Power"),
        (" SG_ Power : 0|32 (1,0) [0|0] \"kW\" X", "Power"),
        (" SG_ Power m1m0 : 0|8@1+ (1,0) [0|0] \"kW\" X", "Power"),
        (" SG_ Power : 0|8@1+ (one,0) [0|0] \"kW\" X", "Power"),
        (" SG_ Power : 0|8@1+ (1,0) [0|0] kW X", "Power"),
        (" SG_ Power : 0|8@1+ (nan,0) [0|0] \"kW\" X", "Power"),
        (
            " SG_ Power : 0|8@1+ (1,0) [0|0] \"\" X\nSIG_VALTYPE_ 416 Power : 3;",
            "Power",
        ),
    ] {
        for dbc in [
            format!("{head}{line}\n{speed}"),
            format!("{head}{speed}{line}\n"),
        ] {
            let own = read(dbc.as_bytes(), SPEED).unwrap();
            let frame = standard(416, &[0x1c, 0x20, 0, 0, 0, 0, 0, 0]);
            let expected = [(Signal::WheelSpeed, Value::Real(20.0))];
            assert_eq!(readings(&own, &frame), expected, "{dbc}");
            assert_eq!(own.left_out().count(), 1, "{dbc}");
            let told = &own.left_out().first()[0];
            assert!(
                told.contains("is not understood; expected a message"),
                "{told}"
            );
            // Where it is mapped, that is an error that says so.
            let mapped = SPEED.replace("VehicleSpeed", name);
            let message = read(dbc.as_bytes(), &mapped).unwrap_err();
            let words = "S.toml:3: signals.wheel_speed_mps.signal is `Power`, which is described by \
                         a statement that is not understood";
            assert!(message.starts_with(words), "{message}");
        }
    }
    // A message of which the statement is wrong takes its signals with it.
    let dbc = format!("BO_ x Bad: 8 X\n SG_ Lost : 0|8@1+ (1,0) [0|0] \"\" X\n{head}{speed}");
    let own = read(dbc.as_bytes(), SPEED).unwrap();
    assert_eq!(own.left_out().count(), 1);
    assert!(own.left_out().first()[0].contains("car.dbc:1: `BO_ x Bad: 8 X`"));
}

#[test]
fn statements_that_tools_write_are_understood() {
    // No receiver, names of other letters, no blank before the colon, and the message of no message.
    for line in [
        " SG_ VehicleSpeed : 7|16@0+ (0.01,0) [0|655.35] \"km/h\"",
        " SG_ VehicleSpeed: 7|16@0+ (0.01,0) [0|655.35] \"km/h\" X,Y",
        " SG_ VehicleSpeed : 7 | 16 @ 0 + ( 0.01 , 0 ) [ 0 | 655.35 ] \"km/h\"  X",
        "SG_ VehicleSpeed : 7|16@0+ (1E-2,0.0) [0|6.5E+02] \"km/h\" Vector__XXX",
    ] {
        let dbc = format!(
            "BO_ 3221225472 VECTOR__INDEPENDENT_SIG_MSG: 0 Vector__XXX\n SG_ X : 0|8@1+ (1,0) [0|0] \"\" X\n\
             BO_ 416 ESP_1: 8 X\n{line}\n SG_ Öl-Druck : 0|8@1+ (1,0) [0|0] \"\" X\n"
        );
        let own = read(dbc.as_bytes(), SPEED).unwrap();
        let frame = standard(416, &[0x1c, 0x20, 0, 0, 0, 0, 0, 0]);
        let expected = [(Signal::WheelSpeed, Value::Real(20.0))];
        assert_eq!(readings(&own, &frame), expected, "{line}");
        assert_eq!(own.left_out().count(), 0, "{line}");
    }
}

#[test]
fn the_frame_format_may_be_a_default_and_have_its_own_numbers() {
    let message = "BO_ 2566844672 Speed: 8 X\n SG_ V : 8|16@1+ (0.00390625,0) [0|0] \"km/h\" X\n";
    let toml = "[signals.wheel_speed_mps]\nmessage = \"Speed\"\nsignal = \"V\"\n";
    let usual = "BA_DEF_ BO_ \"VFrameFormat\" ENUM \"StandardCAN\",\"ExtendedCAN\",\"reserved\",\"J1939PG\";\n";
    let other = "BA_DEF_ BO_  \"VFrameFormat\" ENUM  \"J1939PG\", \"ExtendedCAN\";\n";
    for (attributes, is_group) in [
        (
            usual.to_owned() + "BA_DEF_DEF_ \"VFrameFormat\" \"J1939PG\";\n",
            true,
        ),
        (
            usual.to_owned() + "BA_DEF_DEF_ \"VFrameFormat\" \"ExtendedCAN\";\n",
            false,
        ),
        (
            usual.to_owned()
                + "BA_DEF_DEF_  \"VFrameFormat\" \"J1939PG\";\nBA_ \"VFrameFormat\" BO_ 2566844672 1;\n",
            false,
        ),
        (
            usual.to_owned()
                + "BA_DEF_DEF_ \"VFrameFormat\" \"\";\nBA_ \"VFrameFormat\" BO_ 2566844672 3;\n",
            true,
        ),
        (
            other.to_owned() + "BA_ \"VFrameFormat\" BO_ 2566844672 0;\n",
            true,
        ),
        (
            other.to_owned() + "BA_ \"VFrameFormat\" BO_ 2566844672 1;\n",
            false,
        ),
        ("BA_ \"VFrameFormat\" BO_ 2566844672 3;\n".to_owned(), true),
        (
            "BA_DEF_DEF_ \"VFrameFormat\" \"J1939PG\";\n".to_owned(),
            true,
        ),
    ] {
        let own = read(format!("{message}{attributes}").as_bytes(), toml).unwrap();
        let frame = extended(0x18fe_f117, &[0xff, 0, 72, 0xff, 0xff, 0xff, 0xff, 0xff]);
        assert_eq!(!readings(&own, &frame).is_empty(), is_group, "{attributes}");
    }
}

#[test]
fn long_names_are_known_beside_short_ones() {
    let dbc = "BO_ 416 Wheels_of_the_rear_axle_short_: 8 X\n\
        \x20SG_ Speed_of_the_left_rear_wheel_s : 7|16@0+ (0.01,0) [0|0] \"km/h\" X\n\
        BA_DEF_DEF_ \"SystemSignalLongSymbol\" \"\";\n\
        BA_ \"SystemMessageLongSymbol\" BO_ 416 \"Wheels_of_the_rear_axle_in_full\";\n\
        BA_ \"SystemSignalLongSymbol\" SG_ 416 Speed_of_the_left_rear_wheel_s \"Speed_in_full\";\n";
    for (message, signal) in [
        ("Wheels_of_the_rear_axle_in_full", "Speed_in_full"),
        (
            "Wheels_of_the_rear_axle_short_",
            "Speed_of_the_left_rear_wheel_s",
        ),
    ] {
        let toml =
            format!("[signals.wheel_speed_mps]\nmessage = \"{message}\"\nsignal = \"{signal}\"\n");
        let own = read(dbc.as_bytes(), &toml).unwrap();
        let frame = standard(416, &[0x1c, 0x20]);
        let expected = [(Signal::WheelSpeed, Value::Real(20.0))];
        assert_eq!(readings(&own, &frame), expected, "{message}");
    }
}

#[test]
fn a_wrong_dbc_is_refused_with_its_line() {
    for (dbc, expected) in [
        (
            "VERSION \"\"\n\nBO_ 416: 8 Gateway\n",
            "car.dbc:3: `BO_ 416: 8 Gateway` is not understood; expected ",
        ),
        ("", "car.dbc: no message; expected a .dbc file"),
        (
            "(1.0) can0 123#00\n",
            "car.dbc: no message; expected a .dbc file",
        ),
    ] {
        let found = read(dbc.as_bytes(), SPEED).unwrap_err();
        assert!(found.starts_with(expected), "{found}");
    }
}

proptest! {
    #[test]
    fn damaged_files_are_read_or_refused_by_name(
        damage in proptest::collection::vec((0_usize..2_500, any::<u8>(), 0_usize..20), 1..6),
        payload: [u8; 8],
    ) {
        let toml = format!("{SPEED}[signals.gear]\nmessage = 640\nsignal = \"Gear\"\n");
        let mut bytes = [DBC.as_bytes(), toml.as_bytes()].concat();
        for (at, byte, removed) in damage {
            let at = at % bytes.len();
            let end = (at + removed).min(bytes.len());
            bytes.splice(at..end, [byte]);
        }
        let split = bytes.len() - toml.len().min(bytes.len());
        let (dbc, toml) = bytes.split_at(split);
        match read(dbc, &String::from_utf8_lossy(toml)) {
            Ok(own) => {
                for id in [416, 640, 1264] {
                    own.decode(&standard(id, &payload), |reading| {
                        assert!(reading.value.real().is_none_or(f32::is_finite));
                    });
                }
            }
            Err(words) => prop_assert!(
                words.starts_with("car.dbc:") || words.starts_with("S.toml:"),
                "{words}"
            ),
        }
    }
}
