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
use std::path::{Path, PathBuf};
use std::{env, fs};

/// Files and the convention of their "not available" and "error" codes.
const FILES: [(&str, &str); 2] = [("j1939.dbc", "J1939"), ("nmea2000.dbc", "Nmea2000")];

/// SAE J1939-21: announcements and data of multi-packet messages.
const TRANSPORT: [u32; 2] = [60_160, 60_416];

/// What the layouts call the two bits in which a sender judges the signals of its message.
const MERIT: &str = "FigureOfMerit";

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

    let mut code = String::new();
    writeln!(
        code,
        "pub(super) static MESSAGES: [Message; {}] = [",
        messages.len()
    )
    .unwrap();
    for (pgn, convention, message) in &messages {
        writeln!(
            code,
            "Message {{ pgn: {pgn}, name: \"{}\", priority: {}, length: {}, framing: Framing::{}, end_bit: {}, merit_bit: {}, convention: Convention::{convention}, fields: &[",
            message.name,
            priority(message),
            message.size,
            framing(message, convention),
            end_bit(message),
            merit_bit(message)
        )
        .unwrap();
        let fields = message.signals.iter().filter(|s| s.name != MERIT);
        let (read, unread): (Vec<_>, Vec<_>) = fields.partition(|s| is_read(s));
        for signal in read.iter().chain(&unread) {
            writeln!(code, "    {},", field(message, convention, signal)).unwrap();
        }
        writeln!(code, "], read: {} }},", read.len()).unwrap();
    }
    writeln!(code, "];\n").unwrap();
    writeln!(
        code,
        "pub(super) const fn index_of(pgn: u32) -> Option<usize> {{ match pgn {{"
    )
    .unwrap();
    for (index, (pgn, ..)) in messages.iter().enumerate() {
        writeln!(code, "    {pgn} => Some({index}),").unwrap();
    }
    // Behind the last message: only what is neither ignored nor a message has to look at it.
    let [data, management] = TRANSPORT;
    let behind = messages.len();
    writeln!(code, "    {data} | {management} => Some({behind}),").unwrap();
    writeln!(code, "    _ => None,\n}} }}").unwrap();

    let out = PathBuf::from(env::var("OUT_DIR").unwrap()).join("layout_tables.rs");
    fs::write(out, code).expect("the build folder takes the generated tables");
    write_own_dbc_example();
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

/// Where its last signal ends.
fn end_bit(message: &Message) -> u64 {
    let ends = message.signals.iter().map(|s| s.start_bit + s.size);
    ends.max().expect("a message has signals")
}

/// Where its figure of merit is; 0 where it has none.
fn merit_bit(message: &Message) -> u64 {
    let merit = message.signals.iter().find(|s| s.name == MERIT);
    merit.map_or(0, |merit| {
        let is_pair = merit.size == 2 && merit.start_bit > 0 && merit.start_bit % 8 < 7;
        assert!(is_pair, "{}: not two bits of one byte", message.name);
        merit.start_bit
    })
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
            "Scaling::DegreesE7 {{ divisor: {{ static BY: Divisor = Divisor::new({}); &BY }}, offset: {} }}",
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
