//! Numbers: types of data, conversions, units, marks of what is invalid.

use super::{at, error, group, plain, read, readings};
use estimator_core::{Signal, Value};
use test_kit::mdf_signals::{MdfChannel, MdfConversion, MdfReference};

/// Reads one record with one channel, mapped to a signal without a unit.
fn value_of(channel: MdfChannel, bytes: &[u8]) -> Option<Value> {
    value_with(channel, bytes, "")
}

fn value_with(channel: MdfChannel, bytes: &[u8], keys: &str) -> Option<Value> {
    let other = MdfChannel::of_type("mass_kg", 0, 40, 8);
    let mut record = bytes.to_vec();
    record.resize(33, 1);
    let file = plain(&[group(vec![channel, other], [(0.5, record)])]);
    let toml = format!("[signals.gear_ratio]\nsignal = \"x\"\n{keys}");
    let found = readings(&file, &toml);
    assert!(found.iter().all(|of| of.0 == at(0.5)));
    let of = found.iter().find(|of| of.1 == Signal::GearRatio);
    of.map(|of| of.2)
}

fn number(channel: MdfChannel, bytes: &[u8]) -> f32 {
    match value_of(channel, bytes) {
        Some(Value::Real(number)) => number,
        other => panic!("{other:?}"),
    }
}

#[test]
fn every_type_of_number_is_read() {
    let channel = |data_type, bit, bits| MdfChannel {
        bit,
        ..MdfChannel::of_type("x", data_type, 8, bits)
    };
    let cases: [(u8, u8, u32, &[u8], f32); 17] = [
        (0, 0, 8, &[200], 200.0),
        (0, 3, 5, &[0b1010_1000], 21.0),
        (0, 0, 16, &[0x34, 0x12], 4660.0),
        (1, 0, 16, &[0x12, 0x34], 4660.0),
        (0, 4, 12, &[0x4f, 0x12], 292.0),
        (1, 4, 12, &[0x12, 0x4f], 292.0),
        (2, 0, 16, &[0xfe, 0xff], -2.0),
        (3, 0, 16, &[0xff, 0xfe], -2.0),
        (2, 1, 3, &[0b1100], -2.0),
        (2, 0, 64, &(-5_i64).to_le_bytes(), -5.0),
        (3, 0, 24, &[0xff, 0xff, 0xfd], -3.0),
        (4, 0, 32, &1.25_f32.to_le_bytes(), 1.25),
        (5, 0, 32, &1.25_f32.to_be_bytes(), 1.25),
        (4, 0, 64, &(-7.5_f64).to_le_bytes(), -7.5),
        (5, 0, 64, &(-7.5_f64).to_be_bytes(), -7.5),
        // Half precision: 1.5, and the smallest one.
        (4, 0, 16, &[0x00, 0x3e], 1.5),
        (5, 0, 16, &[0x00, 0x01], 5.960_464_5e-8),
    ];
    for (data_type, bit, bits, bytes, expected) in cases {
        let found = number(channel(data_type, bit, bits), bytes);
        assert_eq!(found, expected, "{data_type} {bit} {bits} {bytes:?}");
    }
    // 64 bits from the middle of a byte are in nine bytes.
    let wide = [0x50, 0, 0, 0, 0, 0, 0, 0, 0x00];
    assert_eq!(number(channel(0, 4, 64), &wide), 5.0);
}

#[test]
fn what_is_not_finite_is_missing() {
    for missing in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let found = value_of(MdfChannel::real("x", "", 8), &missing.to_le_bytes());
        assert_eq!(found, None, "{missing}");
    }
    // A conversion that divides by zero.
    let channel = MdfChannel::of_type("x", 0, 8, 8);
    let channel = channel.converted(2, &[0.0, 0.0, 1.0, 0.0, 1.0, 0.0]);
    assert_eq!(value_of(channel.clone(), &[0]), None);
    assert_eq!(value_of(channel, &[4]), Some(Value::Real(0.25)));
}

#[test]
fn conversions_of_numbers_are_read() {
    let channel =
        |kind, numbers: &[f64]| MdfChannel::of_type("x", 0, 8, 8).converted(kind, numbers);
    let real = |kind, numbers: &[f64]| MdfChannel::real("x", "", 8).converted(kind, numbers);
    let table = [0.0, 10.0, 10.0, 30.0, 20.0, 20.0];
    let ranges = [0.0, 4.0, 1.0, 5.0, 9.0, 2.0, -1.0];
    for (raw, kind, numbers, expected) in [
        (7, 0, &[][..], 7.0),
        (7, 1, &[-40.0, 0.5], -36.5),
        (2, 2, &[1.0, 2.0, 3.0, 0.0, 0.0, 4.0], 2.75),
        (5, 4, &table, 20.0),
        (15, 4, &table, 25.0),
        (30, 4, &table, 20.0),
        (5, 5, &table, 10.0),
        (6, 5, &table, 30.0),
        (30, 5, &table, 20.0),
        (4, 6, &ranges, 1.0),
        (5, 6, &ranges, 2.0),
        (99, 6, &ranges, -1.0),
    ] {
        let found = number(channel(kind, numbers), &[raw]);
        assert_eq!(found, expected, "{raw} by type {kind}");
    }
    // The ranges of numbers in floating point end before their ends.
    for (raw, expected) in [(3.9, 1.0), (4.0, -1.0), (5.0, 2.0)] {
        let found = number(real(6, &ranges), &f64::to_le_bytes(raw));
        assert_eq!(found, expected, "{raw}");
    }
    assert_eq!(number(real(4, &table), &2.5_f64.to_le_bytes()), 15.0);
}

#[test]
fn texts_leave_raw_numbers_unless_some_are_converted() {
    let text = MdfReference::Text;
    let names = MdfConversion {
        kind: 7,
        numbers: vec![0.0, 7.0],
        references: vec![text("neutral"), text("reverse"), text("other")],
        unit: "",
    };
    let gear = MdfChannel::of_type("x", 0, 8, 8).converted_by(names);
    assert_eq!(value_of(gear.clone(), &[7]), Some(Value::Real(7.0)));
    assert_eq!(value_of(gear.clone(), &[3]), Some(Value::Real(3.0)));
    let keys = "values = { \"7\" = -1 }\ninvalid = [3]\n";
    let reverse = value_with(gear.clone(), &[7], keys);
    assert_eq!(reverse, Some(Value::Real(-1.0)));
    assert_eq!(value_with(gear, &[3], keys), Some(Value::NotAvailable));

    // A text for what is not available, and a conversion of all other numbers.
    let linear = MdfConversion {
        kind: 1,
        numbers: vec![1.0, 0.5],
        ..MdfConversion::default()
    };
    let of = |kind, numbers: &[f64], references: Vec<MdfReference>| {
        let conversion = MdfConversion {
            kind,
            numbers: numbers.to_vec(),
            references,
            unit: "",
        };
        MdfChannel::of_type("x", 0, 8, 8).converted_by(conversion)
    };
    let inner = || MdfReference::Conversion(linear.clone());
    let coded = of(7, &[255.0], vec![text("n/a"), inner()]);
    assert_eq!(value_of(coded.clone(), &[255]), Some(Value::NotAvailable));
    assert_eq!(value_of(coded, &[4]), Some(Value::Real(3.0)));
    let ranged = of(
        8,
        &[0.0, 250.0, 251.0, 255.0],
        vec![inner(), text("error"), MdfReference::None],
    );
    assert_eq!(value_of(ranged.clone(), &[250]), Some(Value::Real(126.0)));
    assert_eq!(value_of(ranged, &[251]), Some(Value::NotAvailable));
}

#[test]
fn conversions_that_are_not_read_are_told_and_refused() {
    let file = |channel| {
        let speed = MdfChannel::of_type("wheel_speed_mps", 0, 8, 8);
        plain(&[group(vec![channel, speed], [(0.0, vec![3])])])
    };
    let toml = "[signals.gear_ratio]\nsignal = \"x\"\n";
    let formula = MdfChannel::of_type("x", 0, 8, 8).converted_by(MdfConversion {
        kind: 3,
        references: vec![MdfReference::Text("X*2")],
        ..MdfConversion::default()
    });
    let (_, report) = read(&file(formula.clone()), "").unwrap();
    let told = "channels that are not read: x (which has a formula as conversion)";
    assert_eq!(report.notes, [told]);
    assert_eq!(
        error(&file(formula), toml),
        "S.toml:2: signals.gear_ratio.signal is `x`, which has a formula as conversion; expected a \
         channel of numbers with a time"
    );
    // A text is no signal, and not worth a word until it is mapped.
    let text = MdfChannel::of_type("x", 7, 8, 8);
    assert_eq!(read(&file(text.clone()), "").unwrap().1.notes, [""; 0]);
    assert!(error(&file(text), toml).contains("is `x`, which is a text; expected"));
}

#[test]
fn units_of_channels_and_conversions_are_converted() {
    let speed = |channel: MdfChannel| {
        let file = plain(&[group(
            vec![channel],
            [(0.0, 72.0_f64.to_le_bytes().to_vec())],
        )]);
        let toml = "[signals.wheel_speed_mps]\nsignal = \"v\"\n";
        let (found, report) = read(&file, toml).unwrap();
        (found[0].2, report.notes)
    };
    let v = |unit| MdfChannel::real("v", unit, 8);
    let xml = "<CNunit><TX xml:space=\"preserve\">km/h</TX></CNunit>";
    let of_conversion = MdfConversion {
        kind: 1,
        numbers: vec![0.0, 1.0],
        references: Vec::new(),
        unit: "km/h",
    };
    for channel in [v("km/h"), v(xml), v("").converted_by(of_conversion)] {
        assert_eq!(speed(channel), (Value::Real(20.0), vec![]));
    }
    let note = "there is no unit, and ours is taken for it: v".to_owned();
    assert_eq!(speed(v("")), (Value::Real(72.0), vec![note]));
}

#[test]
fn invalid_values_are_missing() {
    let x = |bit| MdfChannel {
        invalid_bit: Some(bit),
        ..MdfChannel::of_type("x", 0, 8, 8)
    };
    let speed = MdfChannel {
        invalid_bit: Some(3),
        ..MdfChannel::of_type("wheel_speed_mps", 0, 9, 8)
    };
    let records = [
        (0.0, vec![1, 2, 0]),
        (1.0, vec![3, 4, 0b1000]),
        (2.0, vec![5, 6, 1]),
    ];
    let mut one = group(vec![x(0), speed], records);
    one.invalidation_bytes = 1;
    let toml = "[signals.gear_ratio]\nsignal = \"x\"\n";
    let found = readings(&plain(&[one]), toml);
    let real = Value::Real;
    assert_eq!(
        found,
        [
            (at(0.0), Signal::GearRatio, real(1.0)),
            (at(0.0), Signal::WheelSpeed, real(2.0)),
            (at(1.0), Signal::GearRatio, real(3.0)),
            (at(2.0), Signal::WheelSpeed, real(6.0)),
        ]
    );
}

#[test]
fn the_number_of_a_record_may_be_its_time_and_its_value() {
    let mut one = group(vec![], []);
    let ramp = MdfChannel::virtual_data("wheel_speed_mps").converted(1, &[1.0, 0.5]);
    let gear = MdfChannel::of_type("gear", 0, 0, 8);
    one.channels = vec![MdfChannel::virtual_time(10.0, 0.01), ramp, gear];
    one.records = (0..3).map(|k| (f64::from(k), vec![k as u8])).collect();
    let found = readings(&plain(&[one]), "");
    let expected = (0..3_u8).flat_map(|k| {
        let time = 10_000_000 + 10_000 * u64::from(k);
        let speed = 1.0 + 0.5 * f32::from(k);
        [
            (time, Signal::CurrentGear, Value::Real(k.into())),
            (time, Signal::WheelSpeed, Value::Real(speed)),
        ]
    });
    assert_eq!(found, expected.collect::<Vec<_>>());
}

#[test]
fn numbers_beyond_all_measure_are_damage() {
    let values: Vec<(f64, f64)> = (0..200).map(|k| (f64::from(k), 20.0)).collect();
    let mut wrong = values.clone();
    wrong[7].1 = 1e9;
    let file = |values: &[_]| plain(&[super::reals("wheel_speed_mps", "m/s", values)]);
    let (found, report) = read(&file(&wrong), "").unwrap();
    assert_eq!((found.len(), report.damage.lines), (199, 1));
    let problem = "a.mf4: wheel_speed_mps is 1000000000 (channel `wheel_speed_mps`) at 7.000000 s; \
                   expected a finite number from -1e4 to 1e4 m/s";
    assert!(
        report.damage.first[0].contains(problem),
        "{:?}",
        report.damage.first
    );
    // More than 1 %.
    for (_, value) in &mut wrong[20..30] {
        *value = 1e9;
    }
    assert!(error(&file(&wrong), "").contains("more than 1 %"));
}
