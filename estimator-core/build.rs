//! Turns the layouts in `dbc/*.dbc` into the constant tables of `signal::layout`.
//!
//! `can-dbc` parses; this file only writes down what it read. The ready-made generator on top of
//! it, `dbc-codegen`, does not fit here: its output does not compile for 64-bit fields with a
//! scale below one (PGN 129029), carries angles in f32 (0.4 m at 1e-7 deg), demands one source
//! address and exact payload lengths, and knows no "not available" codes.

#[path = "build/own_messages.rs"]
mod own_messages;

use can_dbc::{ByteOrder, Dbc, Message, MessageId, Signal, ValueType};
use std::fmt::Write as _;
use std::mem::replace;
use std::path::{Path, PathBuf};
use std::{env, fs};

/// Files and the convention of their "not available" and "error" codes.
const FILES: [(&str, &str); 2] = [("j1939.dbc", "J1939"), ("nmea2000.dbc", "Nmea2000")];

/// SAE J1939-21: announcements and data of multi-packet messages.
const TRANSPORT: [u32; 2] = [60_160, 60_416];

/// What the layouts call the two bits in which a sender judges the signals of its message.
const MERIT: &str = "FigureOfMerit";

/// A signal that most senders of this message leave out, in a byte of its own behind the others.
const OPTIONAL: (&str, &str) = ("VDC2", "LongitudinalAcceleration");

/// What the layouts call the estimator.
const RECEIVER: &str = "Estimator";

// The signals of the example: `CAR`.
include!("examples/own_dbc/signals.rs");

fn main() {
    let mut messages = Vec::new();
    for (file, convention) in FILES {
        let path = Path::new("dbc").join(file);
        println!("cargo::rerun-if-changed={}", path.display());
        let text = fs::read_to_string(&path).expect("a layout file that build.rs lists is missing");
        let dbc = Dbc::try_from(text.as_str()).unwrap_or_else(|e| panic!("{file}: {e}"));
        for message in dbc.messages {
            messages.push((pgn(&message), convention, message));
        }
    }
    messages.sort_by_key(|(pgn, ..)| *pgn);

    let mut code = tables(&messages);
    let numbers: Vec<u32> = messages.iter().map(|(pgn, ..)| *pgn).collect();
    code += &index_table(&numbers);

    let out = PathBuf::from(env::var("OUT_DIR").unwrap()).join("layout_tables.rs");
    fs::write(out, code).expect("the build folder takes the generated tables");
    write_own_dbc_example();
}

/// Returns the tables of the messages: what the estimator reads, and what only tools need.
fn tables(messages: &[(u32, &str, Message)]) -> String {
    let count = messages.len();
    let mut read_table = format!("pub(super) static MESSAGES: [Message; {count}] = [\n");
    let mut tool_table = format!("pub(super) static DESCRIPTIONS: [Description; {count}] = [\n");
    for (pgn, convention, message) in messages {
        let fields = message.signals.iter().filter(|s| s.name != MERIT);
        let (read, unread): (Vec<_>, Vec<_>) = fields.partition(|s| is_read(s));
        let lines = |signals: Vec<&Signal>| -> String {
            let lines = signals.into_iter().map(|s| field(message, convention, s));
            lines.map(|line| format!("    {line},\n")).collect()
        };
        writeln!(
            read_table,
            "Message {{ pgn: {pgn}, framing: Framing::{}, end_bit: {}, check: PayloadCheck::{}, fields: &[\n{}] }},",
            framing(message, convention),
            end_bit(message),
            payload_check(message),
            lines(read)
        )
        .unwrap();
        writeln!(
            tool_table,
            "Description {{ name: \"{}\", priority: {}, length: {}, convention: Convention::{convention}, unread: &[\n{}] }},",
            message.name,
            priority(message),
            message.size,
            lines(unread)
        )
        .unwrap();
    }
    let wheel_speed = index_of_signal(messages, "WheelSpeed");
    format!(
        "{read_table}];\n\n{tool_table}];\n\n\
         pub(crate) const WHEEL_SPEED_MESSAGE: usize = {wheel_speed};\n"
    )
}

/// Returns the index of the one message with a signal of this name.
fn index_of_signal(messages: &[(u32, &str, Message)], name: &str) -> usize {
    let has = |message: &Message| message.signals.iter().any(|signal| signal.name == name);
    let mut indices = (0..messages.len()).filter(|index| has(&messages[*index].2));
    let index = indices.next().expect("a message has the signal");
    assert!(indices.next().is_none(), "two messages have {name}");
    index
}

/// Returns the table that leads from a PGN to its message: a perfect hash by multiplication, since a
/// controller asks it for every frame. The transport protocol's own PGNs have the index behind the last
/// message, as have the slots that are left.
fn index_table(pgns: &[u32]) -> String {
    let behind = u8::try_from(pgns.len()).expect("at most 255 messages");
    let indices: Vec<(u32, u8)> = pgns
        .iter()
        .copied()
        .zip(0..)
        .chain(TRANSPORT.map(|pgn| (pgn, behind)))
        .collect();
    let (multiplier, bits) = (6..=16)
        .flat_map(|bits| {
            (0..1_000_000_u32).map(move |k| (0x9e37_79b1_u32.wrapping_add(2 * k), bits))
        })
        .find(|(multiplier, bits)| {
            let mut taken = vec![false; 1 << bits];
            indices
                .iter()
                .all(|(pgn, _)| !replace(&mut taken[slot(*pgn, *multiplier, *bits)], true))
        })
        .expect("some multiplier keeps a few hundred numbers apart");
    let mut slots = vec![behind; 1 << bits];
    for (pgn, index) in indices {
        slots[slot(pgn, multiplier, bits)] = index;
    }
    format!(
        "const MULTIPLIER: u32 = {multiplier};\nconst SLOT_BITS: u32 = {bits};\n\
         const TRANSPORT_PGNS: [u32; 2] = {TRANSPORT:?};\n\
         static SLOTS: [u8; 1 << SLOT_BITS] = {slots:?};\n"
    )
}

/// The slot of a PGN: the upper bits of the product.
fn slot(pgn: u32, multiplier: u32, bits: u32) -> usize {
    (pgn.wrapping_mul(multiplier) >> (32 - bits)) as usize
}

/// Writes the table of `examples/own_dbc`, as the build script of a firmware would.
fn write_own_dbc_example() {
    println!("cargo::rerun-if-changed=build");
    println!("cargo::rerun-if-changed=examples/own_dbc");
    let text = fs::read_to_string("examples/own_dbc/car.dbc").expect("the example has a .dbc");
    let code = own_messages::table(&text, "CAR_MESSAGES", CAR);
    let out = PathBuf::from(env::var("OUT_DIR").unwrap()).join("own_dbc_example.rs");
    fs::write(out, code).expect("the build folder takes the generated table");
}

/// Whether the estimator is among those that the layout names as receivers.
fn is_read(signal: &Signal) -> bool {
    signal.receivers.iter().any(|node| node == RECEIVER)
}

fn extended_id(message: &Message) -> u32 {
    match message.id {
        MessageId::Extended(id) => id,
        MessageId::Standard(id) => panic!("{}: 11-bit identifier {id:#x} has no PGN", message.name),
    }
}

fn pgn(message: &Message) -> u32 {
    (extended_id(message) >> 8) & 0x3_ffff
}

/// How frames carry it: more than 8 bytes need several.
fn framing(message: &Message, convention: &str) -> &'static str {
    match (message.size > 8, convention) {
        (false, _) => "Single",
        (true, "J1939") => "Transport",
        (true, _) => "FastPacket",
    }
}

fn priority(message: &Message) -> u32 {
    extended_id(message) >> 26
}

/// Whether a sender may leave this signal out.
fn is_optional(message: &Message, signal: &Signal) -> bool {
    (message.name.as_str(), signal.name.as_str()) == OPTIONAL
}

/// Where the last signal ends that it must have.
fn end_bit(message: &Message) -> u64 {
    let needed = message.signals.iter().filter(|s| !is_optional(message, s));
    let ends = needed.map(|s| s.start_bit + s.size);
    ends.max().expect("a message has signals")
}

/// What is to be looked at before its fields.
fn payload_check(message: &Message) -> String {
    if let Some(merit) = message.signals.iter().find(|s| s.name == MERIT) {
        let is_pair = merit.size == 2 && merit.start_bit % 8 < 7;
        assert!(is_pair, "{}: not two bits of one byte", message.name);
        return format!("Merit({})", merit.start_bit);
    }
    match message.signals.iter().find(|s| is_optional(message, s)) {
        Some(optional) => {
            let is_byte = optional.size == 8 && optional.start_bit.is_multiple_of(8);
            let is_last = is_byte && optional.start_bit >= end_bit(message);
            assert!(is_last, "{}: not a byte behind the others", message.name);
            format!("Optional({})", optional.start_bit / 8)
        }
        None => "None".to_owned(),
    }
}

/// One table entry; the units of the file become those of `Signal`.
fn field(message: &Message, convention: &str, signal: &Signal) -> String {
    assert!(
        signal.byte_order == ByteOrder::LittleEndian,
        "{}.{}: J1939 and NMEA 2000 are little endian",
        message.name,
        signal.name
    );
    assert!(
        signal.start_bit + signal.size <= 8 * message.size,
        "{}.{}: beyond the end of the message",
        message.name,
        signal.name
    );
    assert!(
        match signal.size {
            2..=25 => true,
            32 => signal.start_bit.is_multiple_of(8),
            64 => signal.start_bit.is_multiple_of(8) && signal.value_type == ValueType::Signed,
            _ => false,
        },
        "{}.{}: neither within four bytes nor a signed number of eight",
        message.name,
        signal.name
    );
    let scaling = if matches!(signal.name.as_str(), "Latitude" | "Longitude") {
        let per_e7 = 1e-7 / signal.factor;
        format!(
            "Scaling::DegreesE7({{ static ANGLE: AngleScaling = AngleScaling {{ divisor: Divisor::new({}), offset: {} }}; &ANGLE }})",
            per_e7.round() as i64,
            (signal.offset * 1e7).round() as i64
        )
    } else {
        let unit = match signal.unit.as_str() {
            "km/h" => 1.0 / 3.6,
            "kPa" => 1000.0,
            "rad" => 180.0 / std::f64::consts::PI,
            "deg/s" => std::f64::consts::PI / 180.0,
            "" | "%" | "rpm" | "degC" | "rad/s" | "kg" | "deg" | "m/s" | "m" | "m/s2" | "Nm"
            | "kgm2" => 1.0,
            other => panic!("{}.{}: unknown unit {other}", message.name, signal.name),
        };
        format!(
            "Scaling::Real {{ scale: {:e}_f32, offset: {:e}_f32 }}",
            (signal.factor * unit) as f32,
            (signal.offset * unit) as f32
        )
    };
    format!(
        "Field::new(Convention::{convention}, Signal::{}, {}, {}, {}, {scaling})",
        signal.name,
        signal.start_bit,
        signal.size,
        signal.value_type == ValueType::Signed
    )
}
